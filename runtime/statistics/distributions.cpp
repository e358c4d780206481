// Series and continued fractions of the incomplete gamma and beta functions, evaluated by Lentz's method
// (Abramowitz & Stegun 6.5.29, 6.5.31, 26.5.8; Thompson & Barnett 1986, J. Comput. Phys. 64, 490).
#include "statistics/distributions.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>

namespace lunid {
namespace {

constexpr double precision = 1e-15;
constexpr int most_terms = 1000000;  // the square root of the largest parameter is enough; a bound against NaN
constexpr double tiny = 1e-300;

double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);  // std::lgamma writes a global
}

double gamma_series(double a, double x) {
  double term = 1 / a, sum = term;
  for (int n = 1; n < most_terms && std::abs(term) > precision * std::abs(sum); ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(a * std::log(x) - x - log_gamma(a));
}

double gamma_fraction(double a, double x) {
  double b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
  for (int n = 1; n < most_terms; ++n) {
    const double an = -n * (n - a);
    b += 2;
    d = an * d + b;
    if (std::abs(d) < tiny) d = tiny;
    c = b + an / c;
    if (std::abs(c) < tiny) c = tiny;
    d = 1 / d;
    h *= d * c;
    if (std::abs(d * c - 1) < precision) break;
  }
  return h * std::exp(a * std::log(x) - x - log_gamma(a));
}

double beta_fraction(double x, double a, double b) {
  double c = 1, d = 1 - (a + b) * x / (a + 1);
  if (std::abs(d) < tiny) d = tiny;
  d = 1 / d;
  double h = d;
  for (int m = 1; m < most_terms; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    double change = 1;
    for (double coefficient : {even, odd}) {
      d = 1 + coefficient * d;
      if (std::abs(d) < tiny) d = tiny;
      c = 1 + coefficient / c;
      if (std::abs(c) < tiny) c = tiny;
      d = 1 / d;
      change = d * c;
      h *= change;
    }
    if (std::abs(change - 1) < precision) break;
  }
  return h;
}

/// I_x(a, b) with y = 1 - x given as well, so that neither end loses digits.
double beta_regularised(double x, double y, double a, double b) {
  if (!(x > 0)) return x == 0 ? 0 : std::numeric_limits<double>::quiet_NaN();
  if (!(y > 0)) return y == 0 ? 1 : std::numeric_limits<double>::quiet_NaN();
  const double front = std::exp(log_gamma(a + b) - log_gamma(a) - log_gamma(b) + a * std::log(x) + b * std::log(y));
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(x, a, b) / a;
  return 1 - front * beta_fraction(y, b, a) / b;
}

}  // namespace

double gamma_upper(double a, double x) {
  if (x <= 0) return 1;
  return x < a + 1 ? 1 - gamma_series(a, x) : gamma_fraction(a, x);
}

double beta_lower(double x, double a, double b) { return beta_regularised(x, 1 - x, a, b); }

double normal_tail(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

double normal_quantile(double p) {
  if (!(p > 0 && p < 1)) return p == 0 ? -INFINITY : p == 1 ? INFINITY : std::numeric_limits<double>::quiet_NaN();
  const double tail = std::min(p, 1 - p);
  const double t = std::sqrt(-2 * std::log(tail));
  // Abramowitz & Stegun 26.2.23 (error 4.5e-4), then Halley's steps on the tail.
  double z = t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  for (int step = 0; step < 3; ++step) {
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
    const double u = (normal_tail(z) - tail) / density;
    z += u / (1 - 0.5 * z * u);
  }
  return p < 0.5 ? -z : z;
}

double chi_square_tail(double x, double freedom) { return gamma_upper(freedom / 2, x / 2); }

double f_tail(double f, double freedom1, double freedom2) {
  if (f <= 0) return 1;
  if (std::isinf(f)) return 0;
  const double sum = freedom2 + freedom1 * f;
  return beta_regularised(freedom2 / sum, freedom1 * f / sum, freedom2 / 2, freedom1 / 2);
}

double f_quantile(double tail, double freedom1, double freedom2) {
  if (!(tail > 0 && tail < 1)) return tail == 0 ? INFINITY : tail == 1 ? 0 : std::numeric_limits<double>::quiet_NaN();
  double low = -700, high = 700;  // of the logarithm
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (f_tail(std::exp(middle), freedom1, freedom2) > tail ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

double t_tail(double t, double freedom) {
  const double square = t * t, sum = freedom + square;
  const double tail = std::isinf(t) ? 0 : 0.5 * beta_regularised(freedom / sum, square / sum, freedom / 2, 0.5);
  return t >= 0 ? tail : 1 - tail;
}

}  // namespace lunid
