#include "statistics/lag_tests.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "expr/error.hpp"
#include "statistics/checks.hpp"
#include "statistics/correlation.hpp"
#include "statistics/distributions.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double two_sided = 1.959963984540054;  // 95 %

void check_lags(const char* who, int lags, int least, std::size_t rows) {
  if (lags < least || lags >= static_cast<int>(rows))
    throw InputError(std::string(who) + ": lags: expected " + std::to_string(least) + " to " +
                     std::to_string(rows - 1) + ", got " + std::to_string(lags));
}

void count_beyond(LagTest& test) {
  test.beyond = static_cast<int>((test.coefficients.array().abs() > test.bound).count());
}

VectorXd centred(std::span<const double> x) {
  return Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size())).array() - moments::mean(x);
}

/// Autocorrelations without those that may be chance: a thousand of these would add up. (The bound is that of Politis &
/// White 2004.)
VectorXd beyond_chance(std::span<const double> x, int lags) {
  const double n = static_cast<double>(x.size()), chance = 2 * std::sqrt(std::log10(n) / n);
  const VectorXd r = autocorrelation(x, lags);
  return r.unaryExpr([&](double value) { return std::abs(value) < chance ? 0.0 : value; });
}

/// sum_j r_a(j) r_b(j + h) for h = 0 .. most: covariances of cross-correlations that lie h lags apart, times n.
VectorXd products_of_correlations(std::span<const double> a, std::span<const double> b, int most) {
  const int reach = std::min(static_cast<int>(a.size()) - 1, std::max(1000, 2 * most));
  const VectorXd r_a = beyond_chance(a, reach), r_b = beyond_chance(b, reach);
  return VectorXd::NullaryExpr(most + 1, [&](Index h) {
    double sum = 0;
    for (int j = -reach; j <= reach; ++j) {
      const int other = std::abs(j + static_cast<int>(h));
      if (other <= reach) sum += r_a[std::abs(j)] * r_b[other];
    }
    return sum;
  });
}

}  // namespace

LagTest whiteness(std::span<const double> residual, int lags, int fitted) {
  check_columns("whiteness", {residual}, {.rows = 5});
  check_lags("whiteness", lags, fitted + 1, residual.size());
  LagTest test;
  for (int k = 1; k <= lags; ++k) test.lags.push_back(k);
  test.coefficients = autocorrelation(residual, lags).tail(lags);
  test.bound = two_sided / std::sqrt(static_cast<double>(residual.size()));
  count_beyond(test);
  const TestResult all = ljung_box(residual, lags, fitted);
  test.statistic = all.statistic;
  test.p_value = all.p_value;
  return test;
}

LagTest cross_correlation(std::span<const double> residual, std::span<const double> input, int lags) {
  check_columns("cross_correlation", {residual, input}, {.rows = 5});
  check_lags("cross_correlation", lags, 0, residual.size());
  const Index n = static_cast<Index>(residual.size());
  const VectorXd e = centred(residual), u = centred(input);
  const double scale = e.norm() * u.norm();
  LagTest test;
  test.coefficients.resize(2 * lags + 1);
  for (int k = -lags; k <= lags; ++k) {
    const Index shift = std::abs(k);
    test.lags.push_back(k);
    test.coefficients[k + lags] =
        (k >= 0 ? e.tail(n - shift).dot(u.head(n - shift)) : e.head(n - shift).dot(u.tail(n - shift))) / scale;
  }
  const VectorXd apart = products_of_correlations(residual, input, 2 * lags);
  test.bound = two_sided * std::sqrt(std::max(apart[0], 0.01) / static_cast<double>(n));
  count_beyond(test);
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::NullaryExpr(
      2 * lags + 1, 2 * lags + 1, [&](Index i, Index j) { return apart[std::abs(i - j)]; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(covariance);
  // Axes along which hardly anything can vary (an input of few frequencies) are known too badly to be tested.
  const double least = 0.05 * axes.eigenvalues().maxCoeff();
  const VectorXd along = axes.eigenvectors().transpose() * test.coefficients;
  double freedom = 0;
  for (Index i = 0; i < along.size(); ++i) {
    if (axes.eigenvalues()[i] < least) continue;
    test.statistic += static_cast<double>(n) * along[i] * along[i] / axes.eigenvalues()[i];
    ++freedom;
  }
  test.p_value = freedom > 0 ? chi_square_tail(test.statistic, freedom) : 1;
  return test;
}

}  // namespace lunid
