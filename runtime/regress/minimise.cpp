#include "regress/minimise.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>

#include "expr/error.hpp"

namespace lunid {

const std::vector<std::string>& search_methods() {
  static const std::vector<std::string> names = {"slsqp",
                                                 "lbfgs",
                                                 "mlsl",
                                                 "direct",
                                                 "esch",
                                                 "crs",
                                                 "isres",
                                                 "stogo",
                                                 "annealing",
                                                 "particle_swarm",
                                                 "puddle_jumping",
                                                 "monte_carlo",
                                                 "stochastic_gradient"};
  return names;
}

SearchMethod search_method(std::string_view name) {
  const std::vector<std::string>& names = search_methods();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<SearchMethod>(found - names.begin());
  throw InputError("search: no method '" + std::string(name) + "'" +
                   did_you_mean(nearest_word(std::string(name), names)));
}

std::string to_text(SearchMethod method) { return search_methods()[static_cast<std::size_t>(method)]; }

void validate(const SearchOptions& options) {
  if (options.starts < 1) throw InputError("search: starts: expected >= 1, got " + std::to_string(options.starts));
  if (options.evaluations < 10)
    throw InputError("search: evaluations: expected >= 10, got " + std::to_string(options.evaluations));
}

namespace detail {
namespace {

/// What crosses NLopt's frame: an exception is kept and thrown after it.
struct Call {
  const Objective& objective;
  nlopt_opt optimiser;
  double scale;
  Minimum best;
  std::exception_ptr fault;
};

double call_value(unsigned n, const double* x, double* gradient, void* data) {
  Call& call = *static_cast<Call*>(data);
  try {
    const double value = call.objective.value(x, gradient) / call.scale;
    if (gradient)
      for (unsigned i = 0; i < n; ++i) gradient[i] /= call.scale;
    if (value < call.best.value) call.best = {std::vector<double>(x, x + n), value};
    return value;
  } catch (...) {
    call.fault = std::current_exception();
    nlopt_force_stop(call.optimiser);
    return HUGE_VAL;
  }
}

using Optimiser = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, void (*)(nlopt_opt)>;

Optimiser make(nlopt_algorithm algorithm, int size) {
  Optimiser optimiser(nlopt_create(algorithm, static_cast<unsigned>(size)), nlopt_destroy);
  if (!optimiser) throw InputError(std::string("nlopt_create: no algorithm ") + nlopt_algorithm_to_string(algorithm));
  return optimiser;
}

nlopt_algorithm algorithm_of(SearchMethod method) {
  switch (method) {
    case SearchMethod::lbfgs: return NLOPT_LD_LBFGS;
    case SearchMethod::mlsl: return NLOPT_G_MLSL_LDS;
    case SearchMethod::direct: return NLOPT_GN_DIRECT_L;
    case SearchMethod::esch: return NLOPT_GN_ESCH;
    case SearchMethod::crs: return NLOPT_GN_CRS2_LM;
    case SearchMethod::isres: return NLOPT_GN_ISRES;
    case SearchMethod::stogo: return NLOPT_GD_STOGO;
    default: return NLOPT_LD_SLSQP;
  }
}

/// Runs NLopt in the box [0, 1]^n on the objective over its first value. The best point evaluated is the result,
/// whatever code NLopt ends with: one below 0 that is no fault of ours is a line search at its limit of rounding.
Minimum run(Optimiser& optimiser, const Objective& objective, std::vector<double> x, int evaluations) {
  const double first = objective.value(x.data(), nullptr);
  Call call{objective, optimiser.get(), first > 0 ? first : 1, {x, first > 0 ? 1.0 : first}, nullptr};
  nlopt_set_lower_bounds1(optimiser.get(), 0);
  nlopt_set_upper_bounds1(optimiser.get(), 1);
  nlopt_set_min_objective(optimiser.get(), call_value, &call);
  nlopt_set_maxeval(optimiser.get(), evaluations);
  double value = 0;
  nlopt_optimize(optimiser.get(), x.data(), &value);
  if (call.fault) std::rethrow_exception(call.fault);
  return {call.best.x, call.best.value * call.scale};
}

Optimiser local(nlopt_algorithm algorithm, int size) {
  Optimiser optimiser = make(algorithm, size);
  nlopt_set_xtol_rel(optimiser.get(), 1e-8);
  nlopt_set_ftol_rel(optimiser.get(), 1e-14);
  return optimiser;
}

constexpr int kDescent = 200;  // evaluations of one local descent, at most

/// The k-th point of the van der Corput sequence in a prime base: starts spread evenly without a random number.
double spread(int k, int base) {
  double value = 0, part = 1;
  for (; k > 0; k /= base) value += (part /= base) * (k % base);
  return value;
}

/// The best of several descents: from the start, then from points spread over the box.
Minimum from_many_starts(const Objective& objective, const std::vector<double>& start, const SearchOptions& options) {
  constexpr int primes[] = {2, 3, 5, 7, 11, 13, 17, 19};
  Minimum best;
  for (int k = 0; k < options.starts; ++k) {
    std::vector<double> x = start;
    for (std::size_t i = 0; k > 0 && i < x.size(); ++i) x[i] = spread(k, primes[i % std::size(primes)]);
    Minimum found = minimise_by_nlopt(objective, std::move(x), options);
    if (k == 0 || found.value < best.value) best = std::move(found);
  }
  return best;
}

bool is_local(SearchMethod method) { return method == SearchMethod::slsqp || method == SearchMethod::lbfgs; }

}  // namespace

Minimum minimise_by_nlopt(const Objective& objective, std::vector<double> start, const SearchOptions& options) {
  if (is_local(options.method)) {
    Optimiser optimiser = local(algorithm_of(options.method), objective.size);
    return run(optimiser, objective, std::move(start), kDescent);
  }
  nlopt_srand(options.seed);
  Optimiser optimiser = make(algorithm_of(options.method), objective.size);
  if (options.method == SearchMethod::mlsl) {
    const Optimiser inner = local(NLOPT_LD_SLSQP, objective.size);
    nlopt_set_local_optimizer(optimiser.get(), inner.get());
  }
  return run(optimiser, objective, std::move(start), options.evaluations);
}

Minimum descend(const Objective& objective, std::vector<double> start) {
  return minimise_by_nlopt(objective, std::move(start), SearchOptions{});
}

Minimum minimise(const Objective& objective, const std::vector<double>& start, const SearchOptions& options) {
  if (is_local(options.method)) return from_many_starts(objective, start, options);
  Minimum found;
  switch (options.method) {
    case SearchMethod::annealing: found = anneal(objective, start, options); break;
    case SearchMethod::particle_swarm: found = swarm(objective, start, options); break;
    case SearchMethod::puddle_jumping: return jump_puddles(objective, start, options);
    case SearchMethod::monte_carlo: found = scatter(objective, start, options); break;
    case SearchMethod::stochastic_gradient: found = drift(objective, start, options); break;
    default: found = minimise_by_nlopt(objective, start, options);
  }
  Minimum last = descend(objective, found.x);
  return last.value <= found.value ? last : found;
}

}  // namespace detail
}  // namespace lunid
