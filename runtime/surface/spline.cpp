#include "surface/spline.hpp"

#include <algorithm>

namespace lunid::detail {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// Slope at x[0] of the polynomial through all points, by divided differences.
double slope_at_first(const VectorXd& x, VectorXd f) {
  double slope = 0, product = 1;
  for (Index order = 1; order < x.size(); ++order) {
    for (Index i = 0; i + order < x.size(); ++i) f[i] = (f[i + 1] - f[i]) / (x[i + order] - x[i]);
    slope += f[0] * product;
    product *= x[0] - x[order];
  }
  return slope;
}

}  // namespace

VectorXd spline_slopes(const VectorXd& places, const Eigen::Ref<const VectorXd>& values) {
  const Index n = places.size(), outer = std::min<Index>(4, n);
  VectorXd slopes(n), reduced = VectorXd::Zero(n);
  slopes[0] = slope_at_first(places.head(outer), values.head(outer));
  slopes[n - 1] = slope_at_first(places.tail(outer).reverse(), values.tail(outer).reverse());
  // Elimination downwards: slopes[i] + reduced[i] * slopes[i + 1] = what slopes[i] holds until the way back.
  for (Index i = 1; i + 1 < n; ++i) {
    const double left = 1 / (places[i] - places[i - 1]), right = 1 / (places[i + 1] - places[i]);
    const double pivot = 2 * (left + right) - left * reduced[i - 1];
    const double bend = 3 * (left * left * (values[i] - values[i - 1]) + right * right * (values[i + 1] - values[i]));
    reduced[i] = right / pivot;
    slopes[i] = (bend - left * slopes[i - 1]) / pivot;
  }
  for (Index i = n - 2; i > 0; --i) slopes[i] -= reduced[i] * slopes[i + 1];
  return slopes;
}

CubicWeights cubic_weights(double along, double width) {
  if (along < 0) return {{1, along * width, 0, 0}, {0, 1, 0, 0}};
  if (along > 1) return {{0, 0, 1, (along - 1) * width}, {0, 0, 0, 1}};
  const double s = along, r = 1 - along;
  return {{(1 + 2 * s) * r * r, s * r * r * width, s * s * (3 - 2 * s), -s * s * r * width},
          {-6 * s * r / width, r * (1 - 3 * s), 6 * s * r / width, s * (3 * s - 2)}};
}

}  // namespace lunid::detail
