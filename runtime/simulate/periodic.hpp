#pragma once
// The branch of periodic answers to a periodic excitation, over lambda = log(omega): what harmonic balance and shooting
// have in common.
#include <memory>

#include "simulate/continuation.hpp"
#include "simulate/floquet.hpp"
#include "simulate/harmonics.hpp"
#include "simulate/period_run.hpp"

namespace lunid {

class PeriodicCurve : public Curve {
 public:
  /// Unknowns to start Newton's method from: rest, or a simulated period.
  virtual Eigen::VectorXd guess() = 0;
  virtual Eigen::VectorXd of_period(const Period& period) = 0;
  /// Motions of all states; false where there is no value.
  virtual bool motions(const Eigen::VectorXd& x, double lambda, std::vector<Motion>& motions) = 0;
  virtual Multipliers multipliers(const Eigen::VectorXd& x, double lambda) = 0;
  /// Half the range of a state.
  virtual double amplitude(const Eigen::VectorXd& x, double lambda, int state) = 0;
  /// What keeps the curve from a value, after evaluate() has failed; "" when it is not known.
  virtual std::string fault() const { return ""; }
  virtual int harmonics() const { return 0; }       ///< of the present solution; 0: it is no series
  virtual bool truncated() const { return false; }  ///< more harmonics would be needed than are allowed
};

std::unique_ptr<PeriodicCurve> make_balance_curve(const PeriodicProblem& problem);
std::unique_ptr<PeriodicCurve> make_shooting_curve(const PeriodicProblem& problem);

}  // namespace lunid
