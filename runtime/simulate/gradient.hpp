#pragma once
// The gradient of one number of a run by every parameter and first state, by the discrete adjoint of the fixed path:
// one backward sweep, whatever their number.
#include <functional>

#include "simulate/simulate.hpp"

namespace lunid {

/// A number of a completed run, and its slope by each state at each row (rows x states, zero when it is called).
using RowCost = std::function<double(const Run& run, Eigen::MatrixXd& slope)>;

struct GradientRun {
  Run run;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN where the run did not complete
  Eigen::VectorXd gradient;                                 ///< by theta, then by x0 (p + n)
  long evaluations = 0;  ///< of the backward sweep: rates taken again, and products with the transposed Jacobian
};

/// The transpose of each step of the fixed path, taken in reverse: the gradient is that of the computed run to
/// rounding, not that of the motion to a tolerance (Griewank & Walther 2008, Evaluating derivatives, chapter 15; Hager
/// 2000, Numer. Math. 87, 247). Without switches a step costs one pass of a tape of lambda' dx'/d(x, theta), as many
/// outputs as there are states and parameters, and nothing but the rows is kept. With switches and bounds each step
/// taken is kept with its mode, and each switch with its jump (saltation); up to Dynamics::dense_limit states.
class Adjoint {
 public:
  /// Changes the model's pool. Throws InputError for imposed motion, and for more than Dynamics::dense_limit states
  /// where there are switches or bounds. The system must outlive it.
  explicit Adjoint(const System& system);

  /// A run from x0 and the gradient of its cost. Throws InputError as simulate() does, and for a solver other than
  /// automatic and fixed: those of SUNDIALS have none.
  GradientRun run(std::span<const double> theta, const Excitations& excitation, const Eigen::VectorXd& x0,
                  const SimulateOptions& options, const RowCost& cost) const;

  /// Instructions of the backward tape; 0 with switches or bounds.
  int instructions() const { return tape_.instructions(); }

 private:
  const System& system_;
  Tape tape_;  ///< inputs (t, u, x, theta, lambda), outputs lambda' dx'/dx (n) and lambda' dx'/dtheta (p); smooth only
};

}  // namespace lunid
