#pragma once
// Witnesses in closed form: the linear oscillator in the stretches between its switches.
#include <cmath>
#include <complex>
#include <functional>

namespace lunid::testing {

/// m y'' + c y' + k y = P cos(w t + phase) + A + B t from (y0, v0) at t0; any damping, k may be 0 where c is not and P,
/// B are 0. By the two roots of the characteristic equation, which must differ.
class LinearPiece {
 public:
  struct Law {
    double m = 1, c = 0, k = 0, P = 0, w = 0, phase = 0, A = 0, B = 0;
  };
  LinearPiece(const Law& law, double t0, double y0, double v0) : law_(law), t0_(t0) {
    const Complex root = std::sqrt(Complex(law.c * law.c - 4 * law.m * law.k, 0));
    r1_ = (-law.c + root) / (2 * law.m);
    r2_ = (-law.c - root) / (2 * law.m);
    const double dy = y0 - steady(t0), dv = v0 - steady_rate(t0);
    b_ = (dv - r1_ * dy) / (r2_ - r1_);
    a_ = dy - b_;
  }
  double y(double t) const {
    return (a_ * std::exp(r1_ * (t - t0_)) + b_ * std::exp(r2_ * (t - t0_))).real() + steady(t);
  }
  double v(double t) const {
    return (a_ * r1_ * std::exp(r1_ * (t - t0_)) + b_ * r2_ * std::exp(r2_ * (t - t0_))).real() + steady_rate(t);
  }

 private:
  using Complex = std::complex<double>;
  /// Amplitude of the answer to P exp(i (w t + phase)).
  Complex answer() const {
    return law_.P == 0 ? Complex(0) : law_.P / Complex(law_.k - law_.m * law_.w * law_.w, law_.c * law_.w);
  }
  Complex turned(double t) const { return answer() * std::polar(1.0, law_.w * t + law_.phase); }
  double steady(double t) const {
    const auto& [m, c, k, P, w, phase, A, B] = law_;
    if (k == 0) return A / c * t;
    return turned(t).real() + (A + B * t) / k - c * B / (k * k);
  }
  double steady_rate(double t) const {
    const auto& [m, c, k, P, w, phase, A, B] = law_;
    if (k == 0) return A / c;
    return (Complex(0, w) * turned(t)).real() + B / k;
  }

  Law law_;
  double t0_;
  Complex r1_, r2_, a_, b_;
};

/// The first sign change of f from above zero after `from`, by steps of `stride` and bisection; `until` when there is
/// none.
inline double first_fall(const std::function<double(double)>& f, double from, double until, double stride) {
  double low = from;
  while (low < until) {
    double high = std::min(low + stride, until);
    if (f(high) < 0) {
      for (int i = 0; i < 80; ++i) {
        const double middle = 0.5 * (low + high);
        (f(middle) < 0 ? high : low) = middle;
      }
      return 0.5 * (low + high);
    }
    low = high;
  }
  return until;
}

}  // namespace lunid::testing
