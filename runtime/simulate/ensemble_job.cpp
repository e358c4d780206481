#include "simulate/ensemble_job.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "expr/digits.hpp"
#include "simulate/bundle.hpp"
#include "simulate/lane_summaries.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Samples of a force on which the first look at its peak rests: so many, spread by the golden ratio, which no period
/// is a multiple of. The bound that follows from the peak is far away.
constexpr Index look_samples = 8;

/// One thread's work on the members of a bundle.
class Job {
 public:
  Job(const Ensemble& ensemble, const EnsembleOptions& options, const StepTape* step, std::span<const Index> members,
      EnsembleResult& result)
      : ensemble_(ensemble),
        options_(options),
        step_(step),
        system_(*ensemble.system),
        smooth_(system_.dynamics().smooth()),
        members_(members),
        result_(result),
        first_row_(static_cast<Index>(options.settled * static_cast<double>(ensemble.force.rows() - 1))) {}

  void run() {
    if (smooth_ || (step_ && !jumps()))
      run_lanes();
    else
      for (const Index member : members_) run_alone(member);
  }

 private:
  std::span<const double> theta(Index member) const {
    return {ensemble_.theta.col(member).data(), static_cast<std::size_t>(ensemble_.theta.rows())};
  }

  /// Inputs jump at the samples, where modes are decided anew.
  bool jumps() const {
    return ensemble_.force.excitation(members_.front()).ordered(system_).interpolation() == Interpolation::hold;
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
    const Tape& tape = force.tape().direct();
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

  /// The bound of simulate(), of which the peaks of the inputs on their samples are a part; taken on `samples` of them
  /// only it is a lower one.
  double bound_of(Index member, Index samples) const {
    if (options_.bound > 0) return options_.bound;
    const MemberForce& force = ensemble_.force;
    const Tape& tape = force.tape().direct();
    std::vector<double> in(static_cast<std::size_t>(tape.inputs())), scratch(tape.registers() + 1);
    std::vector<double> out(force.channels().size());
    std::vector<InputRange> inputs(out.size());
    std::copy_n(force.q(member), in.size() - 1, in.begin() + 1);
    const double stride = samples < force.rows() ? (std::numbers::phi - 1) * static_cast<double>(force.rows()) : 1;
    for (Index i = 0; i < samples; ++i) {
      const Index row = static_cast<Index>(static_cast<double>(i) * stride) % force.rows();
      in[0] = force.t0() + force.dt(member) * static_cast<double>(row);
      tape.run_point(in.data(), out.data(), scratch.data());
      for (std::size_t j = 0; j < out.size(); ++j) {
        if (row == 0) inputs[j].first = out[j];
        inputs[j].peak = std::max(inputs[j].peak, std::abs(out[j]));
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
    problem.bound = bound_of(member, std::min(look_samples, force.rows()));
    if (!(problem.bound > 0)) problem.bound = std::numeric_limits<double>::min();
    problem.max_events = options_.max_events;
    problem.cancelled = options_.cancelled;
    return problem;
  }

  void run_lanes() {
    const MemberForce& force = ensemble_.force;
    const bool expression = smooth_ && force.is_expression();  // those with switches have stage grids
    std::vector<Index> members;
    std::vector<Excitations> excitations;
    std::vector<FixedProblem> problems;
    std::vector<const double*> x0, q;
    for (const Index member : members_) {
      if (expression) {
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
    BundleProblem bundle{problems, x0, nullptr, q, step_, {}};
    if (expression) {
      bundle.force = &force.tape();
      bundle.true_bound = [&](int lane) { return bound_of(members[static_cast<std::size_t>(lane)], force.rows()); };
    }
    std::vector<FixedOutcome> outcomes(members.size());
    BundleSink sink(*this, members, bundle_width(members.size()));
    (smooth_ ? run_bundle : run_switch_bundle)(bundle, sink, outcomes);
    for (std::size_t l = 0; l < members.size(); ++l)
      keep_values(sink.summaries, members[l], static_cast<int>(l), problems[l], outcomes[l]);
  }

  const Ensemble& ensemble_;
  const EnsembleOptions& options_;
  const StepTape* step_;
  const System& system_;
  const bool smooth_;
  std::span<const Index> members_;
  EnsembleResult& result_;
  Index first_row_;
};

}  // namespace

SimulateOptions simulate_options(const EnsembleOptions& options) {
  SimulateOptions o;
  o.solver = Solver::fixed;
  o.substeps = options.substeps;
  o.bound = options.bound;
  o.max_events = options.max_events;
  o.cancelled = options.cancelled;
  return o;
}

void run_job(const Ensemble& ensemble, const EnsembleOptions& options, const StepTape* step,
             std::span<const Index> members, EnsembleResult& result) {
  Job(ensemble, options, step, members, result).run();
}

}  // namespace lunid
