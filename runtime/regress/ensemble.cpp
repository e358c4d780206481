// One call for all solvers that work on statistics, and ensembles of them.
#include <algorithm>
#include <cmath>
#include <random>

#include "expr/digits.hpp"
#include "regress/reduce.hpp"
#include "regress/solvers.hpp"
#include "regress/stopwatch.hpp"

namespace lunid {

namespace {

struct Validate {
  void operator()(const LeastSquaresOptions&) const {}
  void operator()(const NonNegativeOptions&) const {}
  template <class Options>
  void operator()(const Options& options) const {
    validate(options);
  }
};

struct Solve {
  const Statistic& data;
  std::span<const Constraint> constraints;
  Fit operator()(const LeastSquaresOptions&) const { return least_squares(data, constraints); }
  Fit operator()(const NonNegativeOptions&) const { return non_negative(data, constraints); }
  Fit operator()(const RidgeOptions& o) const { return ridge(data, o, constraints); }
  Fit operator()(const StlsqOptions& o) const { return stlsq(data, o, constraints); }
  Fit operator()(const LassoOptions& o) const { return lasso(std::span(&data, 1), o, constraints); }
  Fit operator()(const Sr3Options& o) const { return sr3(data, o, constraints); }
  Fit operator()(const FrolsOptions& o) const { return frols(data, o, constraints); }
  Fit operator()(const StepwiseOptions& o) const { return stepwise(data, o, constraints); }
  Fit operator()(const BestSubsetOptions& o) const { return best_subset(data, o, constraints); }
  Fit operator()(const SpikeSlabOptions& o) const { return spike_slab(data, o, constraints); }
};

/// A number below `count`, the same on every machine.
std::size_t below(std::mt19937_64& random, std::size_t count) { return random() % count; }

/// Features that a member may do without: those in no constraint.
std::vector<int> droppable(int features, std::span<const Constraint> constraints) {
  std::vector<int> out;
  for (int j = 0; j < features; ++j) {
    const auto in = [j](const Constraint& c) {
      return std::any_of(c.terms.begin(), c.terms.end(), [j](const auto& term) { return term.first == j; });
    };
    if (std::none_of(constraints.begin(), constraints.end(), in)) out.push_back(j);
  }
  return out;
}

/// `count` of the list, drawn without replacement.
std::vector<int> draw(std::mt19937_64& random, std::vector<int> list, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) std::swap(list[i], list[i + below(random, list.size() - i)]);
  list.resize(count);
  return list;
}

}  // namespace

void validate(const StatisticSolver& solver) { std::visit(Validate{}, solver); }

Fit solve(std::span<const Statistic> blocks, const StatisticSolver& solver, std::span<const Constraint> constraints,
          std::vector<PathPoint>* path) {
  if (const auto* o = std::get_if<LassoOptions>(&solver))
    return lasso(blocks, *o, constraints, o->lambda ? nullptr : path);
  const Statistic data = merged(blocks);
  return std::visit(Solve{data, constraints}, solver);
}

void validate(const BaggingOptions& options) {
  if (options.members < 2)
    throw InputError("ensemble_of: members: expected >= 2, got " + std::to_string(options.members));
  const auto share = [](const char* field, double value) {
    if (!(value > 0 && value <= 1))
      throw InputError("ensemble_of: " + std::string(field) + ": expected > 0 and <= 1, got " + exact_number(value));
  };
  share("features", options.features);
  share("inclusion", options.inclusion);
  validate(options.solver);
}

Fit ensemble(std::span<const Statistic> blocks, const BaggingOptions& options,
             std::span<const Constraint> constraints) {
  const detail::Stopwatch watch;
  validate(options);
  if (blocks.size() < 3)
    throw InputError("ensemble_of: resampling needs at least 3 blocks of time, got " + std::to_string(blocks.size()));
  const Statistic data = merged(blocks);
  const Fit whole = least_squares(data, constraints);  // says what cannot be before any member fails of it
  const int n = data.features();
  const std::vector<int> free = droppable(n, constraints);
  const std::size_t left_out =
      static_cast<std::size_t>(std::floor((1 - options.features) * static_cast<double>(free.size()) + 1e-9));
  std::mt19937_64 random(options.seed);
  std::vector<int> seen(static_cast<std::size_t>(n), 0), kept = seen;
  int members = 0;
  std::string member;
  for (int i = 0; i < options.members; ++i) {
    std::vector<Statistic> drawn;
    for (std::size_t b = 0; b < blocks.size(); ++b) drawn.push_back(blocks[below(random, blocks.size())]);
    std::vector<Constraint> all(constraints.begin(), constraints.end());
    std::vector<bool> hidden(static_cast<std::size_t>(n), false);
    for (const int j : draw(random, free, left_out)) {
      all.push_back(fixed(j, 0));
      hidden[static_cast<std::size_t>(j)] = true;
    }
    // Blocks drawn twice may leave out what only one of them excites: such a feature is not seen.
    const Eigen::VectorXd rms = merged(drawn).rms();
    for (const int j : free)
      if (rms[j] == 0 && !hidden[static_cast<std::size_t>(j)]) {
        all.push_back(fixed(j, 0));
        hidden[static_cast<std::size_t>(j)] = true;
      }
    const Fit fit = solve(drawn, options.solver, all);
    member = fit.summary.solver;
    ++members;
    for (int j = 0; j < n; ++j) {
      if (hidden[static_cast<std::size_t>(j)]) continue;
      ++seen[static_cast<std::size_t>(j)];
      kept[static_cast<std::size_t>(j)] += fit.coefficients[j] != 0;
    }
  }
  std::vector<bool> zero(static_cast<std::size_t>(n));
  Eigen::VectorXd inclusion = Eigen::VectorXd::Zero(n);
  for (int j = 0; j < n; ++j) {
    const std::size_t k = static_cast<std::size_t>(j);
    if (seen[k] > 0) inclusion[j] = static_cast<double>(kept[k]) / seen[k];
    zero[k] = inclusion[j] < options.inclusion;
  }
  Fit fit = detail::fit_selected(data, constraints, detail::admissible(zero, data, constraints));
  fit.inclusion = inclusion;
  fit.unexcited = whole.unexcited;
  fit.summary.solver =
      "ensemble of " + std::to_string(members) + " (" + member + "), kept by at least " + number(options.inclusion, 3);
  fit.summary.stopped = "members done";
  fit.summary.iterations = members;
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace lunid
