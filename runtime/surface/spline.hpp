#pragma once
// Cubic splines through the values of a table.
#include <Eigen/Core>

namespace lunid::detail {

/// Slopes at the points of the cubic spline through values at two or more increasing places: the second derivative is
/// continuous (de Boor 1978, chapter 4). The slope at an end is that of the cubic through the four points there, of
/// fewer where there are fewer, so that cubics are exact.
Eigen::VectorXd spline_slopes(const Eigen::VectorXd& places, const Eigen::Ref<const Eigen::VectorXd>& values);

/// The value as the sum of `of_value` times (left value, left slope, right value, right slope), and its slope by
/// `of_slope` likewise.
struct CubicWeights {
  Eigen::Array4d of_value, of_slope;
};
/// At `along` of a piece of this width, 0 to 1; beyond the piece, a straight line.
CubicWeights cubic_weights(double along, double width);

}  // namespace lunid::detail
