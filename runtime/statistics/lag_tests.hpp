#pragma once
// Is there anything left in a residual: of its own past, or of an input?
#include <Eigen/Core>
#include <span>
#include <vector>

namespace lunid {

/// Correlations at several lags, where there is nothing to find each within +- bound at 95 %, and all together as far
/// from 0 with probability p_value.
struct LagTest {
  std::vector<int> lags;
  Eigen::VectorXd coefficients;
  double bound = 0;
  int beyond = 0;  ///< coefficients outside the bound
  double statistic = 0;
  double p_value = 1;
};

/// Autocorrelations at lags 1 .. lags beside 1.96 / sqrt(n), and Ljung and Box's test of all of them. `fitted` as in
/// ljung_box(). Throws InputError as check_columns() does, and for lags out of range.
LagTest whiteness(std::span<const double> residual, int lags, int fitted = 0);

/// Correlation of residual(t) with input(t - lag) at lags -lags .. lags. The residual need not be white: the variance
/// of a coefficient is then sum_j r_e(j) r_u(j) / n (Bartlett 1935; Ljung 1999, System Identification, 16.6), which is
/// 1 / n where either is white, and the covariance of those at two lags follows likewise; the statistic is the sum of
/// squares of what is left of them along the axes of that covariance. A feedback shows at negative lags. Throws as
/// above.
LagTest cross_correlation(std::span<const double> residual, std::span<const double> input, int lags);

}  // namespace lunid
