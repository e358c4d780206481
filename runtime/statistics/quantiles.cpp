#include "statistics/quantiles.hpp"

#include <algorithm>
#include <cmath>

#include "statistics/checks.hpp"
#include "statistics/distributions.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

Eigen::VectorXd sorted(std::span<const double> x) {
  Eigen::VectorXd result = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  std::sort(result.begin(), result.end());
  return result;
}

/// Blom's position of the i-th of n values, i from 0.
double position(Eigen::Index i, Eigen::Index n) {
  return (static_cast<double>(i) + 0.625) / (static_cast<double>(n) + 0.25);
}

/// `count` quantiles of ordered values, by straight lines between theirs.
Eigen::VectorXd quantiles_of(const Eigen::VectorXd& ordered, Eigen::Index count) {
  const Eigen::Index n = ordered.size();
  if (count == n) return ordered;
  return Eigen::VectorXd::NullaryExpr(count, [&](Eigen::Index i) {
    const double place =
        std::clamp(position(i, count) * (static_cast<double>(n) + 0.25) - 0.625, 0.0, static_cast<double>(n - 1));
    const auto below = std::min(static_cast<Eigen::Index>(place), n - 2);
    return ordered[below] + (place - static_cast<double>(below)) * (ordered[below + 1] - ordered[below]);
  });
}

}  // namespace

Quantiles normal_quantiles(std::span<const double> x) {
  check_columns("qq", {x}, {.rows = 3});
  const double mean = moments::mean(x), deviation = moments::standard_deviation(x);
  const auto n = static_cast<Eigen::Index>(x.size());
  return {Eigen::VectorXd::NullaryExpr(
              n, [&](Eigen::Index i) { return mean + deviation * normal_quantile(position(i, n)); }),
          sorted(x)};
}

Quantiles paired_quantiles(std::span<const double> expected, std::span<const double> found) {
  check_columns("qq", {expected, found}, {.rows = 3, .may_differ = true});
  const auto count = static_cast<Eigen::Index>(std::min(expected.size(), found.size()));
  return {quantiles_of(sorted(expected), count), quantiles_of(sorted(found), count)};
}

double quantile_correlation(const Quantiles& points) {
  const Eigen::VectorXd a = points.expected.array() - points.expected.mean();
  const Eigen::VectorXd b = points.found.array() - points.found.mean();
  return std::min(a.dot(b) / std::sqrt(a.squaredNorm() * b.squaredNorm()), 1.0);
}

}  // namespace lunid
