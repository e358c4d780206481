#pragma once
// Effects with internal states, an inertia of their own, or a dependence on time: one law beside the spring and the
// damper of the oscillator, integrated by RK4 with so small a step that kinks need no search.
#include <functional>
#include <vector>

namespace truth {

/// Dimensionless, as Physics is. Only `force` is needed.
struct Law {
  int states = 0;
  std::vector<double> start;  ///< of the states; empty: zeros
  std::function<double(double tau, double x, double v, const double* z)> force;
  std::function<void(double tau, double x, double v, const double* z, double* rate)> rate;
  std::function<void(double x, double v, double* z)> settle;  ///< brings the states within their limits, after a step
  std::function<double(double x, double v)> mass;             ///< beside the oscillator's 1
  /// With time, or with what it went through: training and test records begin with it new, without a run-up.
  bool ages = false;
  std::function<double(double x, double v)> jump;  ///< the force jumps where its sign changes: a step is split there
};

namespace laws {

Law of_motion(std::function<double(double x, double v)> force, std::function<double(double x, double v)> jump = {});
Law of_time(std::function<double(double tau, double x, double v)> force);
Law that_ages(Law law);
/// A mass that depends on the motion, and the force that comes with it.
Law inertia(std::function<double(double x, double v)> mass, std::function<double(double x, double v)> force);
/// c D^p x: a dense sum of relaxations (Yuan and Agrawal 2002) from far below to far above the motion.
Law fractional(double c, double p);
/// Elastic slip of stiffness k; its limit on either side depends on the motion and on the work done in slip.
Law slip(double k, std::function<double(double x, double v, double work)> limit);
/// Elastic slip z (over its limit, quake q) and the force that is made of it, the velocity and the work done.
Law quake(double q, std::function<double(double z, double v, double work)> force);
/// Masing's rules on a backbone f(x), f(0) = 0, concave, by many slip elements.
Law masing(std::function<double(double x)> backbone, double reach);
/// Soil under a toe: no tension, yields at ultimate, springs back by the quake.
Law toe(double ultimate, double quake, double damping);
Law dahl(double stiffness, double friction);
Law lugre(double s0, double s1, double kinetic, double breakaway, double speed);
Law maxwell(double k, double tau);
Law hidden_mass(double mass, double k, double c);
/// A mass that is held by elastic slip.
Law plug(double mass, double k, double limit);
/// A slip limit that recovers from `first` to `last` with time.
Law recovery(double k, double first, double last, double tau);

}  // namespace laws
}  // namespace truth
