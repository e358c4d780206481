#pragma once
// The oscillator of the truth in dimensionless form,
//   x'' + 2 zeta x' + k x + (hidden effects) = u(tau),
// and an integrator of its own: RK4 with a very small fixed step inside one frozen mode (which way it slides,
// whether it sticks, which stops are touched), the end of a mode found by bisection.
#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "truth/excitation.hpp"
#include "truth/law.hpp"

namespace truth {

/// All coefficients are dimensionless: length L, time 1/omega0, force m omega0^2 L. Zero: absent.
struct Physics {
  double zeta = 0.03;                                ///< viscous damping ratio
  double k = 1;                                      ///< linear stiffness
  double k2 = 0, k3 = 0;                             ///< quadratic and cubic stiffness
  double constant = 0;                               ///< constant force
  double viscous = 0;                                ///< viscous v, counted as hidden (zeta is not)
  double coulomb = 0;                                ///< Coulomb friction, sticking included
  double drag = 0;                                   ///< drag |v| v
  double stop_k = 0, stop_gap = 0;                   ///< stop_k * max(x - stop_gap, 0)
  double clearance_k = 0, clearance_gap = 0;         ///< clearance_k * sign(x) * max(|x| - gap, 0)
  double bouc_k = 0, bouc_beta = 0, bouc_gamma = 0;  ///< bouc_k z, z' = v - beta |v| z - gamma v |z|
  std::function<double(double x, double v)> other;   ///< smooth effect outside the catalogue
  std::shared_ptr<const Law> law;                    ///< beside spring and damper; the fields above then stay zero
};

struct State {
  double x = 0, v = 0, z = 0;
};

/// One row per sample.
struct Motion {
  std::vector<double> force, x, v, hidden, restoring;  ///< hidden: effects' force; restoring: all but inertia
  long events = 0;
  double stuck = 0;  ///< time spent sticking
};

/// Integrates `level * signal` from `start` at tau = 0: `rows` samples, `spacing` apart, `substeps` RK4 steps
/// in each.
Motion integrate(const Physics& physics, const Signal& signal, double level, State start, int rows, double spacing,
                 int substeps);

}  // namespace truth
