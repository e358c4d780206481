// Smoothing splines: cardinal B-splines with a knot at each row, least squares with the penalty as further rows.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "record/banded.hpp"
#include "record/method_parts.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The derivatives of the degree + 1 cardinal B-splines that are not zero between two knots, at the part u of the way.
VectorXd basis(int degree, double u, int derivative) {
  VectorXd b = VectorXd::Zero(degree + 2);  // one more: the right neighbour of the last is 0
  b[0] = 1;
  const int plain = degree - derivative;
  for (int p = 1; p <= plain; ++p)  // de Boor and Cox, knots one apart
    for (int k = p; k >= 0; --k) b[k] = ((k > 0 ? (u + p - k) * b[k - 1] : 0.0) + (k + 1 - u) * b[k]) / p;
  for (int p = plain + 1; p <= degree; ++p)  // the derivative is a difference of splines of one degree less
    for (int k = p; k >= 0; --k) b[k] = (k > 0 ? b[k - 1] : 0.0) - b[k];
  return b.head(degree + 1);
}

/// Nodes and weights of Gauss on [0, 1], exact up to degree 2m - 1: the square of the m-th derivative has 2(m - 1).
struct Node {
  double at, weight;
};
std::vector<Node> gauss(int m) {
  if (m == 2) return {{0.5 - std::sqrt(1.0 / 12), 0.5}, {0.5 + std::sqrt(1.0 / 12), 0.5}};
  return {{0.5 - std::sqrt(0.15), 5.0 / 18}, {0.5, 4.0 / 9}, {0.5 + std::sqrt(0.15), 5.0 / 18}};
}

VectorXd knot_values(int degree, int derivative) { return basis(degree, 0, derivative).head(degree); }

/// The gain of the spline as a filter, away from the ends: 1/(1 + weight*w^(2m)).
double noise_gain(int degree, double weight, int derivative) {
  constexpr int points = 4000;
  double sum = 0;
  for (int i = 0; i < points; ++i) {
    // Denser towards 0, where a heavy weight leaves all that is left.
    const double s = (i + 0.5) / points, w = std::numbers::pi * s * s * s;
    const double gain = std::pow(w, derivative) / (1 + weight * std::pow(w, degree + 1));
    sum += gain * gain * 3 * s * s / points;
  }
  return std::sqrt(sum);
}

}  // namespace

Spline fit_spline(std::span<const double> x, int degree, double weight) {
  const int m = (degree + 1) / 2;
  const auto n = static_cast<Index>(x.size());
  const VectorXd at_knot = knot_values(degree, 0);
  std::vector<VectorXd> bends;
  for (const Node& node : gauss(m)) bends.push_back(std::sqrt(weight * node.weight) * basis(degree, node.at, m));
  BandedLeastSquares system(n + degree - 1, degree + 1);
  for (Index i = 0; i < n; ++i) {
    system.add(i, {at_knot.data(), static_cast<std::size_t>(degree)}, x[static_cast<std::size_t>(i)]);
    if (i + 1 == n) break;
    for (const VectorXd& bend : bends) system.add(i, {bend.data(), static_cast<std::size_t>(degree + 1)}, 0);
  }
  const VectorXd c = system.solve();
  const Eigen::MatrixXd inverse = system.inverse_band();
  Spline spline{Eigen::MatrixXd(n, 3), 0, 0};
  for (int d = 0; d < 3; ++d) {
    const VectorXd row = knot_values(degree, d);
    for (Index i = 0; i < n; ++i) spline.values(i, d) = row.dot(c.segment(i, degree));
  }
  for (Index i = 0; i < n; ++i) {
    const double off = x[static_cast<std::size_t>(i)] - spline.values(i, 0);
    spline.squares += off * off;
    for (int p = 0; p < degree; ++p)
      for (int q = p; q < degree; ++q)
        spline.trace += (q > p ? 2 : 1) * at_knot[p] * at_knot[q] * inverse(q - p, i + p);
  }
  return spline;
}

double minimise_over_scale(double low, double high, double ratio, const std::function<double(double)>& f) {
  double best = low, least = f(low);
  for (double h = low * ratio; h <= high; h *= ratio) {
    const double value = f(h);
    if (value < least) best = h, least = value;
  }
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double a = std::log(std::max(best / ratio, low)), b = std::log(std::min(best * ratio, high));
  double c = b - golden * (b - a), d = a + golden * (b - a), fc = f(std::exp(c)), fd = f(std::exp(d));
  for (int i = 0; i < 8; ++i) {
    if (fc < fd) {
      b = d, d = c, fd = fc;
      c = b - golden * (b - a), fc = f(std::exp(c));
    } else {
      a = c, c = d, fc = fd;
      d = a + golden * (b - a), fd = f(std::exp(d));
    }
  }
  const double inner = std::exp(fc < fd ? c : d);
  return std::min(fc, fd) < least ? inner : best;
}

double chosen_weight(const SmoothingSpline& given, std::span<const std::span<const double>> parts, double dt,
                     double noise) {
  if (given.weight > 0) return given.weight;
  const auto weight_of = [&](double h) { return std::pow(h, given.degree + 1); };  // h: rows that it smooths over
  double n = 0;
  for (const auto& x : parts) n += static_cast<double>(x.size());
  const double h = minimise_over_scale(0.3, static_cast<double>(parts[0].size()) / 4, 1.6, [&](double scale) {
    double squares = 0, trace = 0;
    for (const auto& x : parts) {
      const Spline spline = fit_spline(x, given.degree, weight_of(scale));
      squares += spline.squares;
      trace += spline.trace;
    }
    const double left = 1 - trace / n;
    return given.by == SmoothingSpline::Choice::cross_validation ? squares / (n * left * left)
                                                                 : squares / n + 2 * noise * noise * trace / n;
  });
  return weight_of(h) * std::pow(dt, given.degree);
}

std::string choice_words(const SmoothingSpline& given) {
  if (given.weight > 0) return "";
  return given.by == SmoothingSpline::Choice::cross_validation ? " by generalised cross-validation" : " by the noise";
}

Derivative differentiate_by(const SmoothingSpline& method, std::span<const double> x, double dt, double noise,
                            int derivative) {
  if (method.degree != 3 && method.degree != 5)
    refuse("spline", "degree: expected 3 or 5, got " + std::to_string(method.degree));
  const double weight = chosen_weight(method, {&x, 1}, dt, noise) / std::pow(dt, method.degree);
  const Spline spline = fit_spline(x, method.degree, weight);
  const double scale = std::pow(dt, derivative);
  return {spline.values.col(derivative) / scale, noise * noise_gain(method.degree, weight, derivative) / scale,
          std::string(method.degree == 3 ? "cubic" : "quintic") + " smoothing spline, weight " +
              short_number(weight * std::pow(dt, method.degree)) + " s^" + std::to_string(method.degree) +
              choice_words(method)};
}

}  // namespace lunid
