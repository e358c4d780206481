#include "simulate/simulate.hpp"

#include <chrono>
#include <cmath>

#include "expr/external.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Above this many substeps per sample the implicit method is the better choice.
constexpr int explicit_limit = 64;
/// A forced fixed path goes this far.
constexpr int fixed_limit = 4096;
/// Change of y on halving the step, over std(y), with which a run is content.
constexpr double default_tolerance = 1e-5;

struct Clock {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }
};

struct FreeSink : RowSink {
  explicit FreeSink(Run& run) : run(run) {}
  void row(Index row, const double* x, const double* f, const double*) override {
    for (Index i = 0; i < run.x.cols(); ++i) run.x(row, i) = x[i];
    for (Index i = 0; i < run.a.cols(); ++i) run.a(row, i) = f[2 * i + 1];
  }
  Run& run;
};

struct SensitivitySink : FreeSink {
  SensitivitySink(SensitivityRun& out, int columns, std::vector<int> wanted)
      : FreeSink(out.run), out(out), columns(columns), wanted(std::move(wanted)) {}
  void row(Index row, const double* x, const double* f, const double* s) override {
    FreeSink::row(row, x, f, s);
    for (const int state : wanted)
      for (int c = 0; c < columns; ++c) out.dx[state](row, c) = s[state * columns + c];
  }
  SensitivityRun& out;
  int columns;
  std::vector<int> wanted;
};

/// What the run took, and what its external functions did: an error of theirs is the study's, and no result.
void close(RunSummary& summary, const Clock& clock, const ExternalWatch& externals) {
  externals.rethrow();
  summary.seconds = clock.seconds();
  summary.notes = externals.notes(summary.seconds);
}

void summarise(RunSummary& summary, const FixedProblem& problem, const FixedOutcome& outcome, const System& system) {
  summary.solver = fixed_solver_name(problem.substeps);
  summary.steps = outcome.steps;
  summary.evaluations = outcome.evaluations;
  summary.events = outcome.events;
  summary.grazing = outcome.grazing;
  summary.stuck = outcome.stuck;
  if (outcome.stop == Stop::none) return;
  summary.completed = false;
  summary.stopped_at = outcome.stopped_at;
  summary.cause = stop_cause(system, problem, outcome);
}

/// A run that cannot begin, or nothing.
bool refuse_start(const System& system, std::span<const double> theta, const Excitations& excitation,
                  const VectorXd& x0, Run& run) {
  const std::string fault = start_fault(system, theta, excitation, x0);
  if (fault.empty()) return false;
  run.summary.completed = false;
  run.summary.stopped_at = run.t0;
  run.summary.cause = fault;
  return true;
}

/// BDF where explicit steps are too many, or where they exploded or did not converge, which may have been the method
/// and not the model: the implicit run then replaces `run` if it completes.
void try_implicit(const System& system, std::span<const double> theta, const Excitations& excitation,
                  const VectorXd& x0, SimulateOptions options, const StepChoice& choice, Run& run) {
  options.solver = Solver::bdf;
  Run implicit = run_sundials(system, theta, excitation, x0, options);
  if (choice.reached && !implicit.summary.completed) return;
  const bool exploded = !run.summary.completed;
  run = std::move(implicit);
  run.summary.solver +=
      !choice.reached ? " (auto: explicit steps would need more than " + std::to_string(explicit_limit) + " per sample)"
      : exploded      ? " (auto: explicit steps explode)"
                      : " (auto: halving explicit steps does not converge)";
}

}  // namespace

FixedProblem free_problem(const System& system, std::span<const double> theta, const Excitations& excitation,
                          const VectorXd& x0, int substeps, const SimulateOptions& options) {
  FixedProblem problem;
  problem.dynamics = &system.dynamics();
  problem.theta = theta;
  problem.t0 = excitation.t0();
  problem.dt = excitation.dt();
  problem.rows = excitation.rows();
  problem.substeps = substeps;
  for (int i = 0; i < excitation.count(); ++i) problem.drive[i] = excitation[i].stage_grid(substeps).data();
  problem.hold = excitation.interpolation() == Interpolation::hold;
  problem.bound = options.bound > 0 ? options.bound : default_bound(system, theta, excitation, x0);
  problem.max_events = options.max_events;
  problem.cancelled = options.cancelled;
  return problem;
}

std::string stop_cause(const System& system, const FixedProblem& problem, const FixedOutcome& outcome) {
  return outcome.stop == Stop::too_many_events
             ? chatter_cause(*problem.dynamics, outcome.event, problem.max_events)
             : explosion_cause(system, problem.theta, outcome.stopped_at, outcome.last, problem.dt);
}

std::string fixed_solver_name(int substeps) {
  return "fixed DP5, " + std::to_string(substeps) + (substeps == 1 ? " substep" : " substeps");
}

Run run_free(const System& system, std::span<const double> theta, const Excitations& excitation, const VectorXd& x0,
             int substeps, const SimulateOptions& options) {
  Run run = empty_run(system, excitation);
  const FixedProblem problem = free_problem(system, theta, excitation, x0, substeps, options);
  FreeSink sink(run);
  summarise(run.summary, problem, run_fixed(problem, x0, sink), system);
  return run;
}

Run simulate(const System& system, std::span<const double> theta, const Excitations& given, const VectorXd& x0,
             const SimulateOptions& options) {
  check_run("simulate", system, theta, given, x0, options);
  const Excitations excitation = given.of(system, theta);
  const Clock clock;
  const ExternalWatch externals(*system.model().pool);
  Run run = empty_run(system, excitation);
  if (refuse_start(system, theta, excitation, x0, run)) return externals.rethrow(), run;

  const bool automatic = options.solver == Solver::automatic;
  if ((automatic || options.solver == Solver::fixed) && options.substeps > 0) {
    run = run_free(system, theta, excitation, x0, options.substeps, options);
  } else if (automatic || options.solver == Solver::fixed) {
    const int limit = automatic ? explicit_limit : fixed_limit;
    StepChoice choice = choose_by_halving(system, theta, excitation, x0, default_tolerance, limit, options);
    if (choice.finer.summary.events > 0) {  // two runs whose steps are too long for a contact can agree by chance
      const double contact = contact_substeps(system, theta, excitation, x0);
      if (choice.substeps < contact)
        choice = choose_by_halving(system, theta, excitation, x0, default_tolerance, limit, options, contact);
    }
    run = std::move(choice.finer);
    run.summary.error = choice.change;
    if (automatic && !(choice.change < default_tolerance && run.summary.completed))
      try_implicit(system, theta, excitation, x0, options, choice, run);
  } else {
    run = run_sundials(system, theta, excitation, x0, options);
  }
  if (options.stop_when.valid()) stop_where(system, theta, excitation, options, run);
  close(run.summary, clock, externals);
  return run;
}

SensitivityRun simulate_sensitivities(const System& system, std::span<const double> theta, const Excitations& given,
                                      const VectorXd& x0, const SimulateOptions& options, std::span<const int> wanted) {
  check_run("simulate_sensitivities", system, theta, given, x0, options);
  const Excitations excitation = given.of(system, theta);
  if (options.solver != Solver::automatic && options.solver != Solver::fixed)
    throw InputError("simulate_sensitivities: solver: only 'fixed' carries sensitivities, got '" +
                     to_string(options.solver) + "'");
  if (!system.dynamics().dense())
    throw InputError("simulate_sensitivities: expected at most " + std::to_string(Dynamics::dense_limit) +
                     " states, got " + std::to_string(system.states()));
  std::vector<int> states(wanted.begin(), wanted.end());
  for (int i = 0; wanted.empty() && i < system.states(); ++i) states.push_back(i);
  const Clock clock;
  const ExternalWatch externals(*system.model().pool);
  const int columns = system.parameters() + system.states();
  SensitivityRun out;
  out.run = empty_run(system, excitation);
  out.dx.resize(static_cast<std::size_t>(system.states()));
  for (const int state : states)
    out.dx.at(state).setConstant(excitation.rows(), columns, std::numeric_limits<double>::quiet_NaN());
  if (refuse_start(system, theta, excitation, x0, out.run)) return externals.rethrow(), out;

  RunSummary& summary = out.run.summary;
  int substeps = options.substeps;
  if (substeps == 0) {
    const StepChoice choice =
        choose_by_halving(system, theta, excitation, x0, default_tolerance,
                          options.solver == Solver::fixed ? fixed_limit : explicit_limit, options);
    substeps = choice.substeps;
    summary.error = choice.change;
  }
  FixedProblem problem = free_problem(system, theta, excitation, x0, substeps, options);
  problem.sensitivities = true;
  SensitivitySink sink(out, columns, std::move(states));
  const FixedOutcome outcome = run_fixed(problem, x0, sink);
  summarise(summary, problem, outcome, system);
  close(summary, clock, externals);
  return out;
}

}  // namespace lunid
