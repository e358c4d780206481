#include "record/autoregression.hpp"

#include <algorithm>
#include <cmath>

namespace lunid {
namespace {

/// Levinson's update of the coefficients by the next reflection.
void extend(std::vector<double>& a, double reflection) {
  const std::vector<double> old = a;
  a.push_back(reflection);
  for (std::size_t i = 0; i < old.size(); ++i) a[i] = old[i] - reflection * old[old.size() - 1 - i];
}

double mean_of(std::span<const double> x) {
  double sum = 0;
  for (double value : x) sum += value;
  return x.empty() ? 0 : sum / static_cast<double>(x.size());
}

}  // namespace

AutoregressiveFit fit_autoregression(std::span<const double> x, int max_order, OrderCriterion criterion) {
  AutoregressiveFit best;
  best.mean = mean_of(x);
  const auto n = static_cast<Eigen::Index>(x.size());
  if (n == 0) return best;
  Eigen::VectorXd forward = Eigen::Map<const Eigen::VectorXd>(x.data(), n).array() - best.mean;
  Eigen::VectorXd backward = forward;
  double variance = forward.squaredNorm() / static_cast<double>(n);
  best.variance = variance;
  if (!(variance > 0)) return best;
  const double rows = static_cast<double>(n), penalty = criterion == OrderCriterion::bic ? std::log(rows) : 2;
  best.criterion = rows * std::log(variance);
  std::vector<double> a;
  for (Eigen::Index order = 1; order <= std::min<Eigen::Index>(max_order, n / 3); ++order) {
    // forward[t] and backward[t - 1] for t = order .. n - 1
    const Eigen::Index count = n - order;
    const Eigen::VectorXd f = forward.tail(count), b = backward.segment(order - 1, count);
    const double reflection = 2 * f.dot(b) / (f.squaredNorm() + b.squaredNorm());
    if (!(std::abs(reflection) < 1)) break;  // predicted to the last digit
    extend(a, reflection);
    forward.tail(count) = f - reflection * b;
    backward.tail(count) = b - reflection * f;
    variance *= 1 - reflection * reflection;
    const double value = rows * std::log(variance) + penalty * static_cast<double>(order);
    if (value >= best.criterion) continue;
    best.criterion = value;
    best.coefficients = a;
    best.variance = variance;
  }
  return best;
}

Eigen::MatrixXd innovations(const Eigen::Ref<const Eigen::MatrixXd>& columns, const AutoregressiveFit& fit) {
  const auto order = static_cast<Eigen::Index>(fit.coefficients.size());
  const Eigen::Index rows = std::max<Eigen::Index>(columns.rows() - order, 0);
  Eigen::MatrixXd result = columns.bottomRows(rows);
  for (Eigen::Index i = 1; i <= order; ++i)
    result -= fit.coefficients[static_cast<std::size_t>(i - 1)] * columns.middleRows(order - i, rows);
  return result;
}

}  // namespace lunid
