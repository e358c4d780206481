#pragma once
// Dependence between the values of one series.
#include <Eigen/Core>
#include <span>

namespace lunid {

/// A statistic and the probability of one as large where there is nothing to find.
struct TestResult {
  double statistic = 0;
  double p_value = 1;
};

/// A correlation of two series and the probability of one as far from 0 if they were uncorrelated.
struct Correlation {
  double coefficient = 0;
  double p_value = 1;
};

/// Sample autocorrelations at lags 0 .. lags (about the mean, divided by the number of rows, so positive
/// semidefinite). 1, 0, 0, ... for a constant series.
Eigen::VectorXd autocorrelation(std::span<const double> x, int lags);

/// Is x white? n (n + 2) sum r_k^2 / (n - k), chi-square with lags - fitted degrees of freedom; `fitted`:
/// parameters of the autoregression whose innovations x are. (Ljung & Box 1978, Biometrika 65, 297.) lags >
/// fitted.
TestResult ljung_box(std::span<const double> x, int lags, int fitted = 0);

/// Are the signs about the median in random order? Two-sided, normal approximation; the statistic is its z,
/// negative for fewer runs than chance gives. (Wald & Wolfowitz 1940.)
TestResult runs_test(std::span<const double> x);

/// F-test of nested least-squares models: sums of squares of the smaller and of the larger one, parameters
/// added, and rows less parameters of the larger one.
TestResult f_test(double squares_smaller, double squares_larger, double added, double freedom);

/// Variance of sqrt(n) times the mean of a coloured series: Newey & West 1987 (Econometrica 55, 703), after
/// whitening by an autoregression (Andrews & Monahan 1992) with Andrews' (1991) choice of lags. 0 for a
/// constant series.
double long_run_variance(std::span<const double> x);

}  // namespace lunid
