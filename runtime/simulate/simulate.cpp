#include "simulate/simulate.hpp"

#include <chrono>
#include <cmath>

#include "expr/external.hpp"
#include "simulate/integrator.hpp"
#include "simulate/run.hpp"
#include "simulate/sundials.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct Clock {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }
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
  summary.notes = externals.notes();
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

StepChoice choose_fixed(const System& system, std::span<const double> theta, const Excitations& excitation,
                        const VectorXd& x0, const SimulateOptions& options) {
  StepChoice choice = choose_by_halving(system, theta, excitation, x0, default_tolerance, fixed_limit, options);
  const double least = least_substeps(system, theta, excitation, x0, choice);
  if (choice.substeps >= least) return choice;
  const long spent = choice.spent;
  choice = choose_by_halving(system, theta, excitation, x0, default_tolerance, fixed_limit, options, least);
  choice.spent += spent;
  return choice;
}

Run run_by_halving(const System& system, std::span<const double> theta, const Excitations& excitation,
                   const VectorXd& x0, const SimulateOptions& options) {
  StepChoice choice = choose_fixed(system, theta, excitation, x0, options);
  Run run = std::move(choice.finer);
  run.summary.error = choice.change;
  run.summary.tried = choice.spent - run.summary.evaluations;
  return run;
}

Run run_sundials(const System& system, std::span<const double> theta, const Excitations& excitation, const VectorXd& x0,
                 const SimulateOptions& options) {
  Run run = empty_run(system, excitation);
  FreeSink sink(run);
  SundialsRun sundials(system, theta, excitation, x0, options, sink, false);
  sundials.go();
  run.summary = sundials.summary();
  return run;
}

void check_sensitivities(const System& system, const SimulateOptions& options) {
  const Solver solver = options.solver;
  if (solver != Solver::automatic && solver != Solver::fixed && !is_multistep(solver))
    throw InputError("simulate_sensitivities: solver: 'fixed', 'bdf' and 'adams' carry sensitivities, '" +
                     to_string(solver) + "' does not");
  if (!system.dynamics().dense())
    throw InputError("simulate_sensitivities: expected at most " + std::to_string(Dynamics::dense_limit) +
                     " states, got " + std::to_string(system.states()));
}

}  // namespace

void summarise_fixed(RunSummary& summary, const FixedProblem& problem, const FixedOutcome& outcome,
                     const System& system) {
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
  summarise_fixed(run.summary, problem, run_fixed(problem, x0, sink), system);
  return run;
}

Run run_prepared(const System& system, std::span<const double> theta, const Excitations& excitation, const VectorXd& x0,
                 const SimulateOptions& options) {
  const bool automatic = options.solver == Solver::automatic, fixed = options.solver == Solver::fixed;
  return (automatic || fixed) && options.substeps > 0
             ? run_free(system, theta, excitation, x0, options.substeps, options)
         : automatic ? run_automatic(system, theta, excitation, x0, options).run
         : fixed     ? run_by_halving(system, theta, excitation, x0, options)
                     : run_sundials(system, theta, excitation, x0, options);
}

Run simulate(const System& system, std::span<const double> theta, const Excitations& given, const VectorXd& x0,
             const SimulateOptions& options) {
  check_run("simulate", system, theta, given, x0, options);
  const Excitations excitation = given.of(system, theta);
  const Clock clock;
  const ExternalWatch externals(*system.model().pool);
  Run run = empty_run(system, excitation);
  if (refuse_start(system, theta, excitation, x0, run)) return externals.rethrow(), run;

  run = run_prepared(system, theta, excitation, x0, options);
  if (options.stop_when.valid()) stop_where(system, theta, excitation, options, run);
  close(run.summary, clock, externals);
  return run;
}

SensitivityRun simulate_sensitivities(const System& system, std::span<const double> theta, const Excitations& given,
                                      const VectorXd& x0, const SimulateOptions& options, std::span<const int> wanted) {
  check_run("simulate_sensitivities", system, theta, given, x0, options);
  const Excitations excitation = given.of(system, theta);
  check_sensitivities(system, options);
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
  SensitivitySink sink(out, columns, std::move(states));
  SimulateOptions chosen = options;
  double error = 0;
  std::string why;
  if (options.solver == Solver::automatic && options.substeps == 0) {
    const AutomaticRun plain = run_automatic(system, theta, excitation, x0, options);
    chosen.solver = plain.implicit ? Solver::bdf : Solver::fixed;
    chosen.substeps = plain.substeps;
    error = plain.implicit ? 0 : plain.run.summary.error;
    if (plain.implicit) why = plain.run.summary.solver.substr(plain.run.summary.solver.find(" (auto"));
  } else if (options.solver == Solver::fixed && options.substeps == 0) {
    const StepChoice choice = choose_fixed(system, theta, excitation, x0, options);
    chosen.substeps = choice.substeps;
    error = choice.change;
  }
  if (is_multistep(chosen.solver)) {
    SundialsRun sundials(system, theta, excitation, x0, chosen, sink, true);
    sundials.go();
    summary = sundials.summary();
    summary.solver += why;
  } else {
    FixedProblem problem = free_problem(system, theta, excitation, x0, chosen.substeps, options);
    problem.sensitivities = true;
    const FixedOutcome outcome = run_fixed(problem, x0, sink);
    summarise_fixed(summary, problem, outcome, system);
  }
  summary.error = error;
  close(summary, clock, externals);
  return out;
}

}  // namespace lunid
