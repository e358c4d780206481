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
  std::function<void(double a, double* rate)> shaken;  ///< what the rates take from the acceleration, after `rate`
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
/// Two of them side by side.
Law both(const Law& a, const Law& b);
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
/// A slip limit that grows from `first` with the slow part of the motion, a first-order lag by tau.
Law depth(double k, double first, double growth, double tau);
/// A slip limit that falls from `still` to `flowing` with exp(-amplitude of the acceleration over g), the amplitude
/// sqrt(2) times the rms over some tau (Holeyman 2002).
Law liquefaction(double k, double still, double flowing, double g, double tau);

/// Baber and Noori 1985, 1986 in the form of Foliente 1995 with A = 1 and the energy over k zy^2.
struct Wear {
  double k, zy, rho, n;
  double weaker = 0, softer = 0;                                        ///< delta_nu, delta_eta
  double pinched = 0, q = 0, p = 0, psi = 0.2, dpsi = 0, lambda = 0.5;  ///< of zeta1 and zeta2
};
Law pinching(const Wear& wear);

}  // namespace laws
}  // namespace truth
