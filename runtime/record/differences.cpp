// Finite differences, plain and after smoothing; Savitzky-Golay behind the same face.
#include <algorithm>
#include <cmath>
#include <limits>

#include "record/derivative_error.hpp"
#include "record/method_parts.hpp"
#include "record/savitzky_golay.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd difference_weights(const VectorXd& at, int derivative) {
  // c(j, m): weight of position j for derivative m, over the positions 0 .. i so far.
  const Index points = at.size();
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(points, derivative + 1);
  c(0, 0) = 1;
  double before = 1;
  for (Index i = 1; i < points; ++i) {
    double product = 1;
    const auto most = static_cast<int>(std::min<Index>(i, derivative));
    for (Index j = 0; j < i; ++j) {
      const double apart = at[i] - at[j];
      product *= apart;
      if (j == i - 1)
        for (int m = most; m >= 0; --m)
          c(i, m) = before * ((m > 0 ? m * c(i - 1, m - 1) : 0.0) - at[i - 1] * c(i - 1, m)) / product;
      for (int m = most; m >= 0; --m) c(j, m) = (at[i] * c(j, m) - (m > 0 ? m * c(j, m - 1) : 0.0)) / apart;
    }
    before = product;
  }
  return c.col(derivative);
}

namespace {

/// Reach of the central stencil to either side, in steps.
int reach_of(int derivative, int accuracy) { return (derivative + 1) / 2 + accuracy / 2 - 1; }

VectorXd central_weights(int derivative, int accuracy) {
  const int reach = reach_of(derivative, accuracy);
  return difference_weights(VectorXd::LinSpaced(2 * reach + 1, -reach, reach), derivative);
}

/// The weights with zeros between them, over every row of the window; per row^derivative.
VectorXd spread(const VectorXd& weights, int derivative, int step) {
  VectorXd wide = VectorXd::Zero((weights.size() - 1) * step + 1);
  for (Index j = 0; j < weights.size(); ++j) wide[j * step] = weights[j] / std::pow(step, derivative);
  return wide;
}

int widest_step(Index rows, int derivative, int accuracy) {
  return static_cast<int>((rows - 1) / std::max(derivative + accuracy - 1, 1));
}

void check_differences(const std::string& where, int accuracy, int step, int derivative, Index rows) {
  if (accuracy < 2 || accuracy > 12 || accuracy % 2)
    refuse(where, "accuracy: expected an even number 2 to 12, got " + std::to_string(accuracy));
  if (step < 1 || step > widest_step(rows, derivative, accuracy))
    refuse(where, "step: expected 1 to " + std::to_string(widest_step(rows, derivative, accuracy)) + " for " +
                      std::to_string(rows) + " rows and accuracy " + std::to_string(accuracy) + ", got " +
                      std::to_string(step));
}

/// Mean squared weight of the one-sided stencils, counted over all rows: near the ends they let more noise through.
double end_gain(Index rows, int derivative, int accuracy, int step) {
  const int points = derivative + accuracy;
  double sum = 0;
  for (int before = 0; before < reach_of(derivative, accuracy); ++before) {
    const VectorXd at = VectorXd::LinSpaced(points, -before, points - 1 - before);
    sum += 2 * step * difference_weights(at, derivative).squaredNorm() / std::pow(step, 2 * derivative);
  }
  return sum / static_cast<double>(rows);
}

/// Two filters one after the other.
VectorXd convolve(const VectorXd& a, const VectorXd& b) {
  VectorXd both = VectorXd::Zero(a.size() + b.size() - 1);
  for (Index i = 0; i < b.size(); ++i) both.segment(i, a.size()) += b[i] * a;
  return both;
}

SavitzkyGolay window_of(const std::string& where, int rows, int order) {
  if (rows % 2 == 0) refuse(where, "rows: expected an odd number, got " + std::to_string(rows));
  return {rows / 2, order};
}

}  // namespace

FiniteDifferences chosen(const FiniteDifferences& given, const DerivativeError& error, double noise, Index rows,
                         int derivative) {
  if (given.accuracy || given.step)
    check_differences("finite_differences", given.accuracy ? given.accuracy : 2, given.step ? given.step : 1,
                      derivative, rows);
  FiniteDifferences best{given.accuracy ? given.accuracy : 2, given.step ? given.step : 1};
  double least = std::numeric_limits<double>::infinity();
  for (int accuracy : {2, 4, 6, 8}) {
    if (given.accuracy) accuracy = given.accuracy;
    const VectorXd weights = central_weights(derivative, accuracy);
    const int widest = std::min(widest_step(std::min(rows, error.length() - 1), derivative, accuracy),
                                std::max(1, static_cast<int>(rows / 10)));
    for (int step = given.step ? given.step : 1; step <= (given.step ? given.step : widest);
         step = std::max(step + 1, static_cast<int>(1.2 * step))) {
      if (step > widest_step(std::min(rows, error.length()), derivative, accuracy)) break;
      const double expected =
          error.of(spread(weights, derivative, step)) + noise * noise * end_gain(rows, derivative, accuracy, step);
      if (expected >= least) continue;
      least = expected;
      best = {accuracy, step};
    }
    if (given.accuracy) break;
  }
  return best;
}

PolynomialWindow chosen(const PolynomialWindow& given, const DerivativeError& error, Index rows, int derivative) {
  if (!given.order) {
    const SavitzkyGolay filter = choose_savitzky_golay(error, rows, derivative);
    return {2 * filter.half_width + 1, filter.order};
  }
  double least = std::numeric_limits<double>::infinity();
  SavitzkyGolay filter{(given.order + 2) / 2, given.order};
  const auto widest = static_cast<int>(std::min(rows, error.length()) / 10);
  for (int h = filter.half_width; h <= widest; h = std::max(h + 1, static_cast<int>(1.2 * h))) {
    const double expected = error.of(savitzky_golay_weights(derivative, {h, given.order}));
    if (expected < least) filter.half_width = h;
    least = std::min(least, expected);
  }
  return {2 * filter.half_width + 1, filter.order};
}

SmoothedDifferences chosen(const SmoothedDifferences& given, const DerivativeError& error, Index rows, int derivative) {
  check_differences("smoothed_differences", given.accuracy, 1, derivative, rows);
  const VectorXd weights = central_weights(derivative, given.accuracy);
  const auto widest = static_cast<int>(std::min(rows, error.length()) / 10);
  SavitzkyGolay best{2, given.order ? given.order : 3};
  double least = std::numeric_limits<double>::infinity();
  for (int order : {3, 5}) {
    if (given.order) order = given.order;
    for (int h = (order + 1) / 2; h <= widest; h = std::max(h + 1, static_cast<int>(1.2 * h))) {
      const double expected = error.of(convolve(savitzky_golay_weights(0, {h, order}), weights));
      if (expected >= least) continue;
      least = expected;
      best = {h, order};
    }
    if (given.order) break;
  }
  return {2 * best.half_width + 1, best.order, given.accuracy};
}

VectorXd differences(std::span<const double> x, int derivative, int accuracy, int step) {
  const auto n = static_cast<Index>(x.size());
  const Eigen::Map<const VectorXd> values(x.data(), n);
  const Index reach = static_cast<Index>(reach_of(derivative, accuracy)) * step;
  const VectorXd central = central_weights(derivative, accuracy);
  const double scale = std::pow(step, derivative);
  VectorXd result = VectorXd::Zero(n);
  if (n > 2 * reach)
    for (Index j = 0; j < central.size(); ++j)
      result.segment(reach, n - 2 * reach) += central[j] / scale * values.segment(j * step, n - 2 * reach);
  const auto one_sided = [&](Index i) {
    const int points = derivative + accuracy;
    const Index before = i < reach ? i / step : points - 1 - std::min<Index>((n - 1 - i) / step, points - 1);
    VectorXd at(points);
    for (int j = 0; j < points; ++j) at[j] = static_cast<double>(j - before);
    const VectorXd weights = difference_weights(at, derivative);
    for (int j = 0; j < points; ++j) result[i] += weights[j] / scale * values[i + (j - before) * step];
  };
  for (Index i = 0; i < std::min(reach, n); ++i) one_sided(i);
  for (Index i = std::max(n - reach, reach); i < n; ++i) one_sided(i);
  return result;
}

Derivative differentiate_by(const FiniteDifferences& given, std::span<const double> x, double dt, double noise,
                            int derivative) {
  if (derivative == 0)
    return {Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size())), noise, "as measured"};
  FiniteDifferences method = given;
  if (!given.accuracy || !given.step)
    method = chosen(given, DerivativeError(x, noise, derivative), noise, static_cast<Index>(x.size()), derivative);
  check_differences("finite_differences", method.accuracy, method.step, derivative, static_cast<Index>(x.size()));
  const double scale = std::pow(dt, derivative);
  const double gain = central_weights(derivative, method.accuracy).norm() / std::pow(method.step * dt, derivative);
  return {
      differences(x, derivative, method.accuracy, method.step) / scale, noise * gain,
      "finite differences of accuracy " + std::to_string(method.accuracy) + ", step " + std::to_string(method.step)};
}

Derivative differentiate_by(const PolynomialWindow& given, std::span<const double> x, double dt, double noise,
                            int derivative) {
  const PolynomialWindow method =
      given.rows ? given
                 : chosen(given, DerivativeError(x, noise, derivative), static_cast<Index>(x.size()), derivative);
  const SavitzkyGolay filter = window_of("savitzky_golay", method.rows, method.order ? method.order : 3);
  return {savitzky_golay(x, dt, derivative, filter), noise * savitzky_golay_noise(dt, derivative, filter),
          "Savitzky-Golay of order " + std::to_string(filter.order) + " over " +
              std::to_string(2 * filter.half_width + 1) + " rows"};
}

Derivative differentiate_by(const SmoothedDifferences& given, std::span<const double> x, double dt, double noise,
                            int derivative) {
  check_differences("smoothed_differences", given.accuracy, 1, derivative, static_cast<Index>(x.size()));
  const SmoothedDifferences method =
      given.rows ? given
                 : chosen(given, DerivativeError(x, noise, derivative), static_cast<Index>(x.size()), derivative);
  const SavitzkyGolay filter = window_of("smoothed_differences", method.rows, method.order ? method.order : 3);
  const VectorXd smooth = savitzky_golay(x, 1, 0, filter);
  const VectorXd weights =
      derivative ? convolve(savitzky_golay_weights(0, filter), central_weights(derivative, given.accuracy))
                 : savitzky_golay_weights(0, filter);
  const VectorXd values = derivative ? differences({smooth.data(), x.size()}, derivative, given.accuracy, 1) : smooth;
  const double scale = std::pow(dt, derivative);
  return {values / scale, noise * weights.norm() / scale,
          "differences of accuracy " + std::to_string(given.accuracy) + " after Savitzky-Golay of order " +
              std::to_string(filter.order) + " over " + std::to_string(2 * filter.half_width + 1) + " rows"};
}

}  // namespace lunid
