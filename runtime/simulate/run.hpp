#pragma once
// What the ways to simulate share: checks, first looks at the system, causes in words. Internal to this room.
#include "simulate/fixed.hpp"
#include "simulate/simulate.hpp"

namespace lunid {

/// Six significant digits.
std::string number(double x);

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
/// Substeps per sample without which the linearisation at x0 is unstable on a side of a switch: a contact that is made
/// later in the run. 1 without switches and with more than Dynamics::dense_limit states.
double contact_substeps(const System& system, std::span<const double> theta, const Excitations& excitation,
                        const Eigen::VectorXd& x0);
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
};
StepChoice choose_by_halving(const System& system, std::span<const double> theta, const Excitations& excitation,
                             const Eigen::VectorXd& x0, double tolerance, int limit, const SimulateOptions& options,
                             double at_least = 1);

/// Ends a run where options.stop_when first rises above 0; the place is found by runs within the sample interval.
/// Throws InputError when the condition holds a symbol that is no part of the system.
void stop_where(const System& system, std::span<const double> theta, const Excitations& excitation,
                const SimulateOptions& options, Run& run);

/// A run by SUNDIALS; `options.solver` is one of its own.
Run run_sundials(const System& system, std::span<const double> theta, const Excitations& excitation,
                 const Eigen::VectorXd& x0, const SimulateOptions& options);

}  // namespace lunid
