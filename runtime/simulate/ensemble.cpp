#include "simulate/ensemble.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "record/parallel.hpp"
#include "simulate/bundle.hpp"
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
/// Samples of a force on which the first look at its peak rests.
constexpr Index look_samples = 64;

SimulateOptions simulate_options(const EnsembleOptions& options) {
  SimulateOptions o;
  o.solver = Solver::fixed;
  o.substeps = options.substeps;
  o.bound = options.bound;
  o.max_events = options.max_events;
  o.cancelled = options.cancelled;
  return o;
}

/// One thread's work on the members of a bundle.
class Job {
 public:
  Job(const Ensemble& ensemble, const EnsembleOptions& options, std::span<const Index> members, EnsembleResult& result)
      : ensemble_(ensemble),
        options_(options),
        system_(*ensemble.system),
        members_(members),
        result_(result),
        first_row_(static_cast<Index>(options.settled * static_cast<double>(ensemble.force.rows() - 1))) {}

  void run() {
    if (system_.dynamics().smooth())
      run_lanes();
    else
      for (const Index member : members_) run_alone(member);
  }

 private:
  std::span<const double> theta(Index member) const {
    return {ensemble_.theta.col(member).data(), static_cast<std::size_t>(ensemble_.theta.rows())};
  }

  /// A run that cannot begin is a result.
  bool refuse(Index member, double t0) {
    const std::string fault = mass_fault(system_, theta(member), t0, ensemble_.x0.col(member));
    if (!fault.empty()) stop(member, t0, fault);
    return !fault.empty();
  }
  void stop(Index member, double at, std::string cause) {
    result_.stopped_at[member] = at;
    result_.cause[static_cast<std::size_t>(member)] = std::move(cause);
  }

  void keep_row(const LaneSummaries& summaries, Index member, int lane, int width, Index row, const double* x,
                const double* f) {
    for (std::size_t s = 0; s < result_.trajectories.size(); ++s) {
      const auto& signal = summaries.signals()[s];
      result_.trajectories[s](row, member) = (signal.rate ? f : x)[width * signal.state + lane];
    }
  }
  void keep_values(const LaneSummaries& summaries, Index member, int lane, const FixedProblem& problem,
                   const FixedOutcome& outcome) {
    if (outcome.stop != Stop::none) {
      const std::string fault = force_fault(member, outcome.stopped_at);
      return stop(member, outcome.stopped_at, fault.empty() ? stop_cause(system_, problem, outcome) : fault);
    }
    for (Index j = 0; j < result_.values.cols(); ++j)
      result_.values(member, j) = summaries.value(static_cast<int>(j), lane);
  }

  struct AloneSink : RowSink {
    AloneSink(Job& job, Index member)
        : job(job),
          member(member),
          summaries(job.options_.outputs, width),
          n(job.system_.states()),
          x(n * width),
          f(x) {}
    void row(Index row, const double* from_x, const double* from_f, const double*) override {
      for (int i = 0; i < n; ++i) {
        std::fill_n(x.begin() + i * width, width, from_x[i]);
        std::fill_n(f.begin() + i * width, width, from_f[i]);
      }
      if (row >= job.first_row_) summaries.add(x.data(), f.data());
      job.keep_row(summaries, member, 0, width, row, x.data(), f.data());
    }
    static constexpr int width = 4;
    Job& job;
    Index member;
    LaneSummaries summaries;
    int n;
    std::vector<double> x, f;
  };

  void run_alone(Index member) {
    const Excitations excitation = ensemble_.force.excitation(member).ordered(system_);
    if (refuse(member, excitation.t0())) return;
    const VectorXd x0 = ensemble_.x0.col(member);
    const FixedProblem problem =
        free_problem(system_, theta(member), excitation, x0, result_.substeps, simulate_options(options_));
    AloneSink sink(*this, member);
    keep_values(sink.summaries, member, 0, problem, run_fixed(problem, x0, sink));
  }

  struct BundleSink : LaneSink {
    BundleSink(Job& job, std::span<const Index> members, int width)
        : job(job), members(members), width(width), summaries(job.options_.outputs, width) {}
    void row(Index row, const double* x, const double* f) override {
      if (row >= job.first_row_) summaries.add(x, f);
      if (job.result_.trajectories.empty()) return;
      for (std::size_t l = 0; l < members.size(); ++l)
        job.keep_row(summaries, members[l], static_cast<int>(l), width, row, x, f);
    }
    Job& job;
    std::span<const Index> members;
    int width;
    LaneSummaries summaries;
  };

  /// An expression without a finite value within the last interval before a stop, or "".
  std::string force_fault(Index member, double stopped_at) const {
    const MemberForce& force = ensemble_.force;
    if (!force.is_expression()) return "";
    const Tape& tape = force.tape();
    std::vector<double> in(static_cast<std::size_t>(tape.inputs())), scratch(tape.registers() + 1);
    std::vector<double> out(force.channels().size());
    std::copy_n(force.q(member), in.size() - 1, in.begin() + 1);
    constexpr int looks = 8;
    for (int i = looks; i >= 0; --i) {
      in[0] = stopped_at - force.dt(member) * i / looks;
      tape.run_point(in.data(), out.data(), scratch.data());
      for (std::size_t j = 0; j < out.size(); ++j)
        if (!std::isfinite(out[j]))
          return "the excitation " + force.channels()[j] + " has no finite value at t = " + number(in[0]) + " s";
    }
    return "";
  }

  /// The bound of simulate(), of which the peaks of the inputs on their samples are a part; taken on some samples only
  /// (stride > 1) it is a lower one.
  double bound_of(Index member, Index stride) const {
    if (options_.bound > 0) return options_.bound;
    const MemberForce& force = ensemble_.force;
    const Tape& tape = force.tape();
    std::vector<double> in(static_cast<std::size_t>(tape.inputs())), scratch(tape.registers() + 1);
    std::vector<double> out(force.channels().size());
    std::vector<InputRange> inputs(out.size());
    std::copy_n(force.q(member), in.size() - 1, in.begin() + 1);
    for (Index row = 0; row < force.rows(); row += stride) {
      in[0] = force.t0() + force.dt(member) * static_cast<double>(row);
      tape.run_point(in.data(), out.data(), scratch.data());
      for (std::size_t i = 0; i < out.size(); ++i) {
        if (row == 0) inputs[i] = {out[i], 0};
        inputs[i].peak = std::max(inputs[i].peak, std::abs(out[i]));
      }
    }
    const double time = force.dt(member) * static_cast<double>(force.rows() - 1);
    return default_bound(system_, theta(member), force.t0(), time, inputs, ensemble_.x0.col(member));
  }

  /// An expression of time has no stage grid; its bound is a lower one until the motion passes it.
  FixedProblem expression_problem(Index member) const {
    const MemberForce& force = ensemble_.force;
    FixedProblem problem;
    problem.dynamics = &system_.dynamics();
    problem.theta = theta(member);
    problem.t0 = force.t0();
    problem.dt = force.dt(member);
    problem.rows = force.rows();
    problem.substeps = result_.substeps;
    problem.bound = bound_of(member, std::max<Index>(1, force.rows() / look_samples));
    if (!(problem.bound > 0)) problem.bound = std::numeric_limits<double>::min();
    problem.max_events = options_.max_events;
    problem.cancelled = options_.cancelled;
    return problem;
  }

  void run_lanes() {
    const MemberForce& force = ensemble_.force;
    std::vector<Index> members;
    std::vector<Excitations> excitations;
    std::vector<FixedProblem> problems;
    std::vector<const double*> x0, q;
    for (const Index member : members_) {
      if (force.is_expression()) {
        if (refuse(member, force.t0())) continue;
        problems.push_back(expression_problem(member));
        q.push_back(force.q(member));
      } else {
        // their stage grids live as long as copies of them
        excitations.push_back(force.is_shared() && !excitations.empty() ? excitations.front()
                                                                        : force.excitation(member).ordered(system_));
        if (refuse(member, excitations.back().t0())) continue;
        problems.push_back(free_problem(system_, theta(member), excitations.back(), ensemble_.x0.col(member),
                                        result_.substeps, simulate_options(options_)));
      }
      x0.push_back(ensemble_.x0.col(member).data());
      members.push_back(member);
    }
    if (members.empty()) return;
    BundleProblem bundle{problems, x0, nullptr, q, {}};
    if (force.is_expression()) {
      bundle.force = &force.tape();
      bundle.true_bound = [&](int lane) { return bound_of(members[static_cast<std::size_t>(lane)], 1); };
    }
    std::vector<FixedOutcome> outcomes(members.size());
    BundleSink sink(*this, members, bundle_width(members.size()));
    run_bundle(bundle, sink, outcomes);
    for (std::size_t l = 0; l < members.size(); ++l)
      keep_values(sink.summaries, members[l], static_cast<int>(l), problems[l], outcomes[l]);
  }

  const Ensemble& ensemble_;
  const EnsembleOptions& options_;
  const System& system_;
  std::span<const Index> members_;
  EnsembleResult& result_;
  Index first_row_;
};

/// Members cut into bundles of about the same size, as many as keep all threads busy.
std::vector<std::span<const Index>> bundles_of(std::span<const Index> members, bool smooth, int threads) {
  const auto count = static_cast<Index>(members.size());
  const Index workers = thread_count(threads), group = smooth ? Tape::lane_group : 1;
  const Index most = smooth ? most_lanes : 1;
  Index bundles = (count + most - 1) / most;
  bundles = std::min((bundles + workers - 1) / workers * workers, (count + group - 1) / group);
  std::vector<std::span<const Index>> cut;
  for (Index b = 0; b < bundles; ++b) {
    const auto from = static_cast<std::size_t>(count * b / bundles),
               to = static_cast<std::size_t>(count * (b + 1) / bundles);
    cut.push_back(members.subspan(from, to - from));
  }
  return cut;
}

/// One where the members call a function that only this thread may call.
int threads_for(const Ensemble& e, const EnsembleOptions& options) {
  return e.system->rate().thread_safe() && e.force.tape().thread_safe() ? options.threads : 1;
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

MemberForce MemberForce::of(Excitations excitation) {
  const Index rows = excitation.rows();
  MemberForce force = of(rows, [excitation = std::move(excitation)](Index) { return excitation; });
  force.shared_ = true;
  return force;
}

MemberForce MemberForce::of(Index rows, std::function<Excitations(Index)> make) {
  MemberForce force;
  force.rows_ = rows;
  force.make_ = std::move(make);
  return force;
}

MemberForce MemberForce::of(std::vector<std::string> channels, Tape tape, Eigen::MatrixXd q, double t0, VectorXd dt,
                            Index rows) {
  MemberForce force;
  force.rows_ = rows;
  force.channels_ = std::move(channels);
  force.tape_ = std::move(tape);
  force.q_ = std::move(q);
  force.t0_ = t0;
  force.dt_ = std::move(dt);
  return force;
}

Excitations MemberForce::excitation(Index member) const {
  if (make_) return make_(member);
  std::vector<double> in(static_cast<std::size_t>(tape_.inputs())), out(channels_.size());
  std::vector<double> scratch(static_cast<std::size_t>(tape_.registers() + 1));
  std::copy_n(q(member), in.size() - 1, in.begin() + 1);
  Excitations all;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    // mutable: an excitation evaluates its function on one thread at a time
    const auto value = [tape = tape_, i, in, out, scratch](double t) mutable {
      in[0] = t;
      tape.run_point(in.data(), out.data(), scratch.data());
      return out[i];
    };
    all.add(channels_[i], Excitation(t0_, dt_[member], rows_, value));
  }
  return all;
}

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
    if (choice.starts_with("max_")) signals += (signals.empty() ? "" : ", ") + choice.substr(4);
  const std::string near = nearest_word(std::string(name), choices);
  throw InputError("outputs: expected max, min, mean, std, rms, amplitude or last, '_' and a signal (" + signals +
                   "), got '" + std::string(name) + "'" + (near.empty() ? "" : ", did you mean '" + near + "'?"));
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
  const auto bundles = bundles_of(left, e.system->dynamics().smooth(), threads);
  std::mutex guard;
  parallel_for(static_cast<int>(bundles.size()), threads, [&](int i) {
    const auto bundle = bundles[static_cast<std::size_t>(i)];
    if (options.cancelled && options.cancelled->load(std::memory_order_relaxed)) return;
    try {
      Job(e, options, bundle, result).run();
      e.system->rate().rethrow();
      e.force.tape().rethrow();
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
