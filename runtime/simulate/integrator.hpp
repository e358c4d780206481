#pragma once
// SUNDIALS behind one interface: CVODES (BDF, Adams, with sensitivities) and ARKODE (Runge-Kutta, explicit and
// implicit) with events. No SUNDIALS type and no exception crosses this border: what a callback throws is kept and
// thrown again after the library returned.
#include <memory>
#include <string>
#include <vector>

#include "simulate/simulate.hpp"

namespace lunid {

/// What is integrated. The members may throw.
struct Ode {
  virtual ~Ode() = default;
  virtual int states() const = 0;
  virtual int events() const = 0;
  virtual void rate(double t, const double* x, double* f) = 0;
  /// Where dx'/dx may differ from zero, by rows; null: everywhere.
  virtual const std::vector<Dynamics::Entry>* pattern() const = 0;
  /// dx'/dx: the entries of the pattern, or all, row-major.
  virtual void jacobian(double t, const double* x, double* j) = 0;
  /// The fall of an event function below zero ends a part; the rise of a watch above zero stops the integrator there
  /// without a consequence: each watch is the slope of an event function, so that a short dip below zero is seen.
  virtual void event_functions(double t, const double* x, double* g) = 0;  ///< events() values, then as many watches
  virtual void error_weights(const double* x, double* w) = 0;              ///< 1 / (tolerated error of each state)
  /// Sensitivities carried along: this many columns of states() values each; 0: none.
  virtual int columns() const = 0;
  virtual void sensitivity_rate(double t, const double* x, const double* const* s, double* const* ds) = 0;
  virtual void sensitivity_weights(int column, const double* s, double* w) = 0;
};

/// Steps after which the integrator pauses, and those within one sample after which it is given up.
inline constexpr long steps_per_pause = 20000, max_steps_per_sample = 200000;

class Integrator {
 public:
  virtual ~Integrator() = default;
  enum class Result { reached, event, paused, failed };
  /// Integrates x from t towards `to`; stops at the first fall of an event function below zero. t and x are updated.
  virtual Result advance(double to, double& t, Eigen::VectorXd& x) = 0;
  /// Begins anew at t, x: after an event. `s` are the sensitivities there, states x columns, row-major, or null.
  virtual void restart(double t, const Eigen::VectorXd& x, const double* s) = 0;
  /// The sensitivities where advance() ended, states x columns, row-major. Of CVODES only.
  virtual void sensitivities(double* s) = 0;
  /// The event functions that fell when advance() returned `event`; none when it was a watch.
  virtual std::vector<int> fired() const = 0;
  /// The call and the name of its return code when advance() returned `failed`.
  virtual std::string failure() const = 0;
  virtual long steps() const = 0;        ///< of all parts between restarts
  virtual long evaluations() const = 0;  ///< of the rate, those for Jacobians included
};

/// Largest step: one sample, so that no part of a sampled force is stepped over. Throws std::runtime_error when
/// SUNDIALS refuses its set-up, naming the call.
/// `s0`: first sensitivities where the Ode has some, else null.
std::unique_ptr<Integrator> make_cvode(Solver method, Ode& ode, double t0, const Eigen::VectorXd& x0, double max_step,
                                       const double* s0);
std::unique_ptr<Integrator> make_arkode(Solver method, Ode& ode, double t0, const Eigen::VectorXd& x0, double max_step);

/// What the method is called in SUNDIALS: "CVODE BDF", "ARKODE ERK Dormand-Prince 5(4)" ...
std::string sundials_name(Solver method);
/// True where no equation is solved in a step. Adams solves one, and falls back on its A-stable second order.
inline bool is_explicit(Solver method) {
  return method == Solver::rk23 || method == Solver::rk45 || method == Solver::rk78;
}
/// True for the Runge-Kutta methods, which are ARKODE's.
bool is_runge_kutta(Solver method);
/// True for CVODES' methods, which carry sensitivities.
inline bool is_multistep(Solver method) { return method == Solver::bdf || method == Solver::adams; }

}  // namespace lunid
