#pragma once
// The thesis's oscillators written by hand, and the fixed-step method of Dormand and Prince (1980) that steps
// on the samples of the force: the limit that a general tool is measured against.
#include <cmath>
#include <numbers>
#include <vector>

namespace bench {

/// m = 1 kg throughout.
struct Duffing {
  double k = 2e4, c = 10, k3 = 1e6;
  double operator()(double y, double v, double force) const { return force - (k + k3 * y * y) * y - c * v; }
};
struct TanhYield {
  double c = 10, e1 = 250, e2 = 80;
  double operator()(double y, double v, double force) const { return force - e1 * std::tanh(e2 * y) - c * v; }
};
struct VanDerPol {
  double k = 2e4, mu = 10, beta = 5e4;
  double operator()(double y, double v, double force) const { return force - k * y - (beta * y * y - mu) * v; }
};

/// A stop on one side, stepped over as if the force had no kink.
struct Stop {
  double k = 2e4, c = 10, ks = 2e4, gap = 2e-3;
  double operator()(double y, double v, double force) const {
    return force - k * y - c * v - (y > gap ? ks * (y - gap) : 0);
  }
};

/// `rows` samples of three cosines at 800 Hz.
inline std::vector<double> sampled_force(int rows, double amplitude) {
  std::vector<double> force(rows);
  for (int i = 0; i < rows; ++i) {
    const double t = i / 800.0, w = 2 * std::numbers::pi;
    force[i] = amplitude * (std::cos(w * 7 * t) + std::cos(w * 20 * t) + std::cos(w * 31 * t));
  }
  return force;
}

/// y on the samples from rest; the force is linear between them; one Dormand-Prince 5 step per sample, its
/// last stage the next one's first.
template <class Acceleration>
void dormand_prince(const Acceleration& a, const std::vector<double>& force, double dt, std::vector<double>& y) {
  double x = 0, v = 0, a1 = a(0, 0, force[0]);
  y[0] = x;
  for (std::size_t i = 0; i + 1 < force.size(); ++i) {
    const double f0 = force[i], df = force[i + 1] - f0, h = dt;
    const double v2 = v + h * (a1 / 5), x2 = x + h * (v / 5), a2 = a(x2, v2, f0 + df / 5);
    const double v3 = v + h * (3 * a1 + 9 * a2) / 40, x3 = x + h * (3 * v + 9 * v2) / 40, a3 = a(x3, v3, f0 + 0.3 * df);
    const double v4 = v + h * (44. / 45 * a1 - 56. / 15 * a2 + 32. / 9 * a3);
    const double x4 = x + h * (44. / 45 * v - 56. / 15 * v2 + 32. / 9 * v3), a4 = a(x4, v4, f0 + 0.8 * df);
    const double v5 = v + h * (19372. / 6561 * a1 - 25360. / 2187 * a2 + 64448. / 6561 * a3 - 212. / 729 * a4);
    const double x5 = x + h * (19372. / 6561 * v - 25360. / 2187 * v2 + 64448. / 6561 * v3 - 212. / 729 * v4);
    const double a5 = a(x5, v5, f0 + 8. / 9 * df);
    const double v6 =
        v + h * (9017. / 3168 * a1 - 355. / 33 * a2 + 46732. / 5247 * a3 + 49. / 176 * a4 - 5103. / 18656 * a5);
    const double x6 =
        x + h * (9017. / 3168 * v - 355. / 33 * v2 + 46732. / 5247 * v3 + 49. / 176 * v4 - 5103. / 18656 * v5);
    const double a6 = a(x6, v6, f0 + df);
    x += h * (35. / 384 * v + 500. / 1113 * v3 + 125. / 192 * v4 - 2187. / 6784 * v5 + 11. / 84 * v6);
    v += h * (35. / 384 * a1 + 500. / 1113 * a3 + 125. / 192 * a4 - 2187. / 6784 * a5 + 11. / 84 * a6);
    a1 = a(x, v, force[i + 1]);
    y[i + 1] = x;
  }
}

}  // namespace bench
