#include "simulate/ensemble.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "expr/digits.hpp"
#include "expr/joined.hpp"
#include "record/parallel.hpp"
#include "simulate/ensemble_job.hpp"
#include "simulate/lane_summaries.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
/// Lanes of a bundle: enough to share the cost of an instruction, few enough that their registers stay in the first
/// cache.
constexpr Index most_lanes = 64;
/// Members on which the substeps are chosen, and the limit and the tolerance of simulate().
constexpr Index probes = 5;
constexpr int substep_limit = 64;
constexpr double substep_tolerance = 1e-5;
/// Members cut into bundles of about the same size, as many as keep all threads busy, of whole groups of lanes.
std::vector<std::span<const Index>> bundles_of(std::span<const Index> members, bool beside, int threads) {
  const auto count = static_cast<Index>(members.size());
  const Index workers = thread_count(threads), group = beside ? Tape::lane_group : 1;
  const Index most = beside ? most_lanes / group : 1, groups = (count + group - 1) / group;
  Index bundles = (groups + most - 1) / most;
  bundles = std::min((bundles + workers - 1) / workers * workers, groups);
  std::vector<std::span<const Index>> cut;
  for (Index b = 0; b < bundles; ++b) {
    const auto from = static_cast<std::size_t>(group * (groups * b / bundles)),
               to = static_cast<std::size_t>(std::min(group * (groups * (b + 1) / bundles), count));
    cut.push_back(members.subspan(from, to - from));
  }
  return cut;
}

/// A substep as one tape, where it serves: of smooth systems on an expression of time, whose waves it turns as well (on
/// samples stages one by one were measured to be faster), of others if it tells their events.
std::optional<StepTape> step_of(const Ensemble& e) {
  constexpr int most_states = 30;  // of which the code is short enough to be looked at
  const Dynamics& d = e.system->dynamics();
  if (d.n > most_states) return {};
  if (!d.smooth()) return StepTape::tells_events(d) ? std::optional<StepTape>(d) : std::nullopt;
  if (!e.force.is_expression()) return {};
  StepTape step(d, &e.force.tape());
  return step.worthwhile() ? std::optional(std::move(step)) : std::nullopt;
}

/// One where the members call a function that only this thread may call.
int threads_for(const Ensemble& e, const EnsembleOptions& options) {
  return e.system->rate().thread_safe() && e.force.tape().direct().thread_safe() ? options.threads : 1;
}

void check_sizes(const Ensemble& e) {
  const auto refuse = [](const std::string& what, Index expected, Index got) {
    throw InputError("ensemble: " + what + ": expected " + std::to_string(expected) + ", got " + std::to_string(got));
  };
  if (e.members() < 1) throw InputError("ensemble: expected 1 member or more, got 0");
  if (e.theta.rows() != e.system->parameters()) refuse("rows of theta", e.system->parameters(), e.theta.rows());
  if (e.x0.rows() != e.system->states()) refuse("rows of x0", e.system->states(), e.x0.rows());
  if (e.x0.cols() != e.members()) refuse("columns of x0", e.members(), e.x0.cols());
  if (e.force.is_expression() && e.force.channels() != e.system->inputs())
    refuse("inputs of the force", static_cast<Index>(e.system->inputs().size()),
           static_cast<Index>(e.force.channels().size()));
  if (e.force.rows() < 2) throw InputError("ensemble: the excitation is empty");
}

void check_members(const Ensemble& e) {
  const auto check = [&](Index member, const std::string& name, double value) {
    if (!std::isfinite(value))
      throw InputError("ensemble: member " + std::to_string(member + 1) + ": " + name +
                       ": expected a finite value, got " + number(value));
  };
  for (Index member = 0; member < e.members(); ++member) {
    for (Index i = 0; i < e.theta.rows(); ++i)
      check(member, "parameter '" + e.system->model().parameters[static_cast<std::size_t>(i)].name + "'",
            e.theta(i, member));
    for (Index i = 0; i < e.x0.rows(); ++i)
      check(member, "x0: " + e.system->dynamics().names[static_cast<std::size_t>(i)], e.x0(i, member));
    if (!e.force.is_expression()) continue;
    if (const double dt = e.force.dt(member); !(dt > 0) || !std::isfinite(dt))
      throw InputError("ensemble: member " + std::to_string(member + 1) + ": dt: expected > 0, got " + number(dt));
  }
}

void check_options(const EnsembleOptions& o) {
  if (o.outputs.empty()) throw InputError("ensemble: outputs: expected 1 or more");
  if (o.substeps < 0) throw InputError("ensemble: substeps: expected >= 0, got " + std::to_string(o.substeps));
  if (!(o.settled >= 0 && o.settled < 1))
    throw InputError("ensemble: settled: expected >= 0 and < 1, got " + number(o.settled));
  if (!(o.bound >= 0)) throw InputError("ensemble: bound: expected >= 0, got " + number(o.bound));
  if (o.max_events < 1) throw InputError("ensemble: max_events: expected >= 1, got " + std::to_string(o.max_events));
}

/// Room for the trajectories, where it is allowed.
void take_trajectories(const Ensemble& e, const EnsembleOptions& options, EnsembleResult& result) {
  const LaneSummaries summaries(options.outputs, 4);
  for (const auto& signal : summaries.signals()) result.signals.push_back(signal.name);
  if (!options.trajectories) return;
  const double bytes = 8.0 * static_cast<double>(e.force.rows()) * static_cast<double>(e.members()) *
                       static_cast<double>(summaries.signals().size());
  if (bytes > options.memory)
    throw InputError("ensemble: the trajectories of " + std::to_string(e.members()) + " members, " +
                     std::to_string(e.force.rows()) + " rows and " + std::to_string(summaries.signals().size()) +
                     " signals need " + number(bytes / 1e9) + " GB, more than the " + number(options.memory / 1e9) +
                     " GB allowed; keep summaries, or run fewer members at a time");
  for (std::size_t s = 0; s < summaries.signals().size(); ++s)
    result.trajectories.emplace_back(Eigen::MatrixXd::Constant(e.force.rows(), e.members(), nan));
}

/// The substeps that the most demanding of a few members needs, as simulate() would choose them.
void choose_for_members(const Ensemble& e, const EnsembleOptions& options, EnsembleResult& result) {
  const Index count = std::min(probes, e.members());
  std::vector<StepChoice> choices(static_cast<std::size_t>(count));
  const auto member_of = [&](Index i) { return count == 1 ? 0 : i * (e.members() - 1) / (count - 1); };
  parallel_for(static_cast<int>(count), threads_for(e, options), [&](int i) {
    const Index member = member_of(i);
    const std::span theta{e.theta.col(member).data(), static_cast<std::size_t>(e.theta.rows())};
    const Excitations excitation = e.force.excitation(member).ordered(*e.system);
    const VectorXd x0 = e.x0.col(member);
    StepChoice& choice = choices[static_cast<std::size_t>(i)];
    choice.reached = true;
    if (!mass_fault(*e.system, theta, excitation.t0(), x0).empty()) return;
    choice = choose_by_halving(*e.system, theta, excitation, x0, substep_tolerance, substep_limit,
                               simulate_options(options));
    choice.substeps *= 2;  // the finer of the two runs that were compared
  });
  for (Index i = 0; i < count; ++i) {
    const StepChoice& choice = choices[static_cast<std::size_t>(i)];
    if (!choice.reached)
      throw InputError("ensemble: member " + std::to_string(member_of(i) + 1) + " needs more than " +
                       std::to_string(substep_limit) +
                       " substeps per sample; take a smaller dt, or lunid.simulate with solver = 'bdf' for each");
    result.substeps = std::max(result.substeps, choice.substeps);
    if (std::isfinite(choice.change)) result.change = std::max(result.change, choice.change);
  }
}

/// v, v1, v2 ...
bool is_speed(const std::string& state) {
  return state[0] == 'v' && state.find_first_not_of("0123456789", 1) == std::string::npos;
}

}  // namespace

EnsembleOutput output_from(std::string_view name, const System& system) {
  static constexpr std::pair<const char*, Summary> summaries[] = {
      {"max", Summary::max}, {"min", Summary::min},   {"mean", Summary::mean},          {"std", Summary::std},
      {"rms", Summary::rms}, {"last", Summary::last}, {"amplitude", Summary::amplitude}};
  const auto& states = system.dynamics().names;
  std::vector<std::string> choices;
  for (const auto& [word, summary] : summaries) {
    const auto consider = [&](const std::string& signal, std::size_t state, bool rate) {
      choices.push_back(std::string(word) + "_" + signal);
      return choices.back() == name;
    };
    for (std::size_t i = 0; i < states.size(); ++i) {
      const int state = static_cast<int>(i);
      if (consider(states[i], i, false)) return {summary, state, false, std::string(name), states[i]};
      if (!is_speed(states[i])) continue;  // the acceleration, by the name of its speed
      const std::string a = "a" + states[i].substr(1);
      if (consider(a, i, true)) return {summary, state, true, std::string(name), a};
    }
  }
  std::string signals;
  for (const std::string& choice : choices)
    if (choice.starts_with("max_")) append_item(signals, choice.substr(4));
  throw InputError("outputs: expected max, min, mean, std, rms, amplitude or last, '_' and a signal (" + signals +
                   "), got '" + std::string(name) + "'" + did_you_mean(nearest_word(std::string(name), choices)));
}

Index EnsembleResult::finished() const { return std::count(done.begin(), done.end(), 1); }
Index EnsembleResult::stopped() const { return (stopped_at.array() == stopped_at.array()).count(); }

EnsembleResult prepare_ensemble(const Ensemble& e, const EnsembleOptions& options) {
  if (e.system->model().imposed_motion)
    throw InputError("ensemble: the motion of this model is imposed: there is no free run");
  if (e.system->model().delay.valid())
    throw InputError("ensemble: the force of this model is delayed, which ensembles do not run: shift the excitation");
  check_sizes(e);
  check_options(options);
  check_members(e);
  EnsembleResult result;
  for (const EnsembleOutput& output : options.outputs) result.outputs.push_back(output.name);
  take_trajectories(e, options, result);
  const auto members = static_cast<std::size_t>(e.members());
  result.values.setConstant(e.members(), static_cast<Index>(options.outputs.size()), nan);
  result.done.assign(members, 0);
  result.stopped_at.setConstant(e.members(), nan);
  result.cause.resize(members);
  result.substeps = std::max(1, options.substeps);
  if (options.substeps == 0) choose_for_members(e, options, result);
  return result;
}

void run_members(const Ensemble& e, const EnsembleOptions& options, std::span<const Index> members,
                 EnsembleResult& result) {
  std::vector<Index> left;
  for (const Index member : members)
    if (!result.done[static_cast<std::size_t>(member)]) left.push_back(member);
  const int threads = threads_for(e, options);
  const std::optional<StepTape> step = step_of(e);
  const StepTape* const whole = step ? &*step : nullptr;
  const auto bundles = bundles_of(left, whole || e.system->dynamics().smooth(), threads);
  std::mutex guard;
  parallel_for(static_cast<int>(bundles.size()), threads, [&](int i) {
    const auto bundle = bundles[static_cast<std::size_t>(i)];
    if (options.cancelled && options.cancelled->load(std::memory_order_relaxed)) return;
    try {
      run_job(e, options, whole, bundle, result);
      e.system->rate().rethrow();
      e.force.tape().direct().rethrow();
    } catch (const InputError& error) {
      if (error.fault() != Fault::interrupted) throw;
      return;
    }
    const std::lock_guard lock(guard);
    for (const Index member : bundle) result.done[static_cast<std::size_t>(member)] = 1;
    if (options.finished) options.finished(bundle);
  });
}

EnsembleResult run_ensemble(const Ensemble& e, const EnsembleOptions& options) {
  EnsembleResult result = prepare_ensemble(e, options);
  std::vector<Index> all(static_cast<std::size_t>(e.members()));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
  run_members(e, options, all, result);
  return result;
}

}  // namespace lunid
