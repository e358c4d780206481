#pragma once
// What the ways to simulate share: checks, first looks at the system, causes in words. Internal to this room.
#include "simulate/fixed.hpp"
#include "simulate/simulate.hpp"

namespace lunid {

/// Throws InputError for wrong sizes, non-finite values and options out of range, naming `caller`.
void check_run(const char* caller, const System& system, std::span<const double> theta, const Excitations& excitation,
               const Eigen::VectorXd& x0, const SimulateOptions& options);

/// A displacement that no sound run passes: 1e6 times what the largest force alone could reach in the time.
double default_bound(const System& system, std::span<const double> theta, const Excitations& excitation,
                     const Eigen::VectorXd& x0);
/// The same from what it needs to know of each input over `time` [s] from t0: its first value and its peak.
struct InputRange {
  double first, peak;
};
double default_bound(const System& system, std::span<const double> theta, double t0, double time,
                     std::span<const InputRange> inputs, const Eigen::VectorXd& x0);

/// A run of NaN rows, to be filled.
Run empty_run(const System& system, const Excitations& excitation);

/// Why there is no motion from x0: "" when the effective mass is positive there.
std::string mass_fault(const System& system, std::span<const double> theta, double t, const Eigen::VectorXd& x);

/// Why a run exploded, from the last finite state and the time to the next: what grows beyond where, and the term at
/// its root.
std::string explosion_cause(const System& system, std::span<const double> theta, double t, Eigen::VectorXd x,
                            double dt);
/// Why there is no motion from x0: "" when mass and rates have finite values there.
std::string start_fault(const System& system, std::span<const double> theta, const Excitations& excitation,
                        const Eigen::VectorXd& x0);
/// What chatters.
std::string chatter_cause(const Dynamics& dynamics, int event, long max_events);

/// A fixed-step run of free motion as run_fixed takes it. Valid as long as its arguments live.
FixedProblem free_problem(const System& system, std::span<const double> theta, const Excitations& excitation,
                          const Eigen::VectorXd& x0, int substeps, const SimulateOptions& options);
/// What a fixed-step run did.
void summarise_fixed(RunSummary& summary, const FixedProblem& problem, const FixedOutcome& outcome,
                     const System& system);
/// Why a fixed-step run stopped early, in words.
std::string stop_cause(const System& system, const FixedProblem& problem, const FixedOutcome& outcome);

/// A fixed-step run of free motion.
Run run_free(const System& system, std::span<const double> theta, const Excitations& excitation,
             const Eigen::VectorXd& x0, int substeps, const SimulateOptions& options);

/// The fastest motion of the linearisation.
struct Fastest {
  double rate = 0;      ///< |eigenvalue| [1/s]; 0 where the Jacobian is not finite
  bool decays = false;  ///< it dies away faster than it swings; never said of more than Dynamics::dense_limit states
};
Fastest fastest_motion(const System& system, std::span<const double> theta, const Excitations& excitation, double t,
                       const Eigen::VectorXd& x);
/// What to do where steps are too small for an explicit method.
inline constexpr const char* take_implicit = "take solver = \"bdf\" or \"esdirk\"";

/// Largest |a - b| of the displacement over the standard deviation of b; infinite when only one of them completed.
double relative_change(const Run& a, const Run& b);

/// Substeps found by halving from at_least on.
struct StepChoice {
  int substeps = 1;
  double change = 0;     ///< of y on halving, over std(y)
  bool reached = false;  ///< change is below the tolerance, or smaller steps are no better (chaotic motion)
  Run finer;             ///< the run with 2 * substeps
  long spent = 0;        ///< evaluations of all runs made
};
StepChoice choose_by_halving(const System& system, std::span<const double> theta, const Excitations& excitation,
                             const Eigen::VectorXd& x0, double tolerance, int limit, const SimulateOptions& options,
                             double at_least = 1);

/// Substeps per sample without which the linearisation at x0 is unstable on a side of a switch, where the chosen run
/// met one: two runs whose steps are too long for a contact can agree by chance. 1 without, and with more than
/// Dynamics::dense_limit states.
double least_substeps(const System& system, std::span<const double> theta, const Excitations& excitation,
                      const Eigen::VectorXd& x0, const StepChoice& choice);

/// The same run by run.
class Halving {
 public:
  /// All that is given must outlive it.
  Halving(const System& system, std::span<const double> theta, const Excitations& excitation, const Eigen::VectorXd& x0,
          double tolerance, int limit, const SimulateOptions& options, double at_least = 1);
  bool done() const { return done_; }
  void next();                                                       ///< makes a run
  double next_cost() const;                                          ///< of it, in evaluations
  long spent() const { return choice_.spent; }                       ///< evaluations so far
  const Run* last() const { return coarse_ ? &*coarse_ : nullptr; }  ///< the finest so far, while not done
  StepChoice take() { return std::move(choice_); }                   ///< when done

 private:
  Run run(int substeps);

  const System& system_;
  std::span<const double> theta_;
  const Excitations& excitation_;
  const Eigen::VectorXd& x0_;
  const SimulateOptions& options_;
  const double tolerance_;
  double previous_;
  const int limit_;
  int stalled_ = 0;
  bool done_ = false;
  std::optional<Run> coarse_;
  StepChoice choice_;
};

/// True when a motion that dies away within a sample was met at rows of a run: then stability may hold explicit steps
/// down. Of more than Dynamics::dense_limit states also when a motion is that fast and does not.
bool may_be_stiff(const System& system, std::span<const double> theta, const Excitations& excitation, const Run& run);

/// A run by solver = automatic, and what it was by.
struct AutomaticRun {
  Run run;
  bool implicit = false;
  int substeps = 1;  ///< whose result halving found good
};
AutomaticRun run_automatic(const System& system, std::span<const double> theta, const Excitations& excitation,
                           const Eigen::VectorXd& x0, const SimulateOptions& options);

/// Above this many substeps per sample the implicit method is the better choice; a forced fixed path goes further.
inline constexpr int explicit_limit = 64, fixed_limit = 4096;
/// Change of y on halving the step, over std(y), with which a run is content.
inline constexpr double default_tolerance = 1e-5;

/// Writes the rows of a run.
struct FreeSink : RowSink {
  explicit FreeSink(Run& run) : run(run) {}
  void row(Eigen::Index row, const double* x, const double* f, const double*) override {
    for (Eigen::Index i = 0; i < run.x.cols(); ++i) run.x(row, i) = x[i];
    for (Eigen::Index i = 0; i < run.a.cols(); ++i) run.a(row, i) = f[2 * i + 1];
  }
  Run& run;
};

/// simulate() on inputs as the system takes them (Excitations::of), without its checks and its end by a condition.
Run run_prepared(const System& system, std::span<const double> theta, const Excitations& excitation,
                 const Eigen::VectorXd& x0, const SimulateOptions& options);
/// The same signals in `parts` parts of length dt from a time within an interval.
Excitations within(const Excitations& excitation, double from, double dt, int parts);
/// Options of a run between two rows of another, by the same method.
SimulateOptions options_between_rows(const SimulateOptions& options, const Run& run);

/// Ends a run where options.stop_when first rises above 0; the place is found by runs within the sample interval.
/// Throws InputError when the condition holds a symbol that is no part of the system.
void stop_where(const System& system, std::span<const double> theta, const Excitations& excitation,
                const SimulateOptions& options, Run& run);

}  // namespace lunid
