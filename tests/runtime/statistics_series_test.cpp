// Measures of fit, correlations, autoregressions: closed forms and simulated truth.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "expr/error.hpp"
#include "statistics/statistics.hpp"
#include "statistics_noise.hpp"

namespace lunid {
namespace {

using test::alarms;
using test::autoregressive;
using test::span_of;

TEST(FitMeasures, FollowTheirDefinitions) {
  const std::vector<double> measured{1, 2, 3, 4}, model{1, 2, 3, 6};
  EXPECT_DOUBLE_EQ(rmse(measured, model), 1);
  EXPECT_DOUBLE_EQ(nrmse(measured, model), 1 / std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(r_squared(measured, model), 1 - 4 / 5.0);
  EXPECT_EQ(r_squared(measured, measured), 1);
  EXPECT_DOUBLE_EQ(gap(measured, model, 2), std::sqrt(2.0) / 0.5);
  EXPECT_EQ(nrmse(std::vector<double>{2, 2}, std::vector<double>{2, 2}), 0);
  EXPECT_TRUE(std::isinf(nrmse(std::vector<double>{2, 2}, std::vector<double>{2, 3})));
  EXPECT_TRUE(std::isnan(gap(measured, std::vector<double>{1, 2, NAN, 4}, 0)));
  EXPECT_THROW(rmse(measured, std::vector<double>{1}), InputError);
}

TEST(Autocorrelation, OfAFewNumbersByHand) {
  // 1 2 3 4: about the mean -1.5 -0.5 0.5 1.5; sums of products 5, 1.25, -1.5, -2.25.
  const Eigen::VectorXd r = autocorrelation(std::vector<double>{1, 2, 3, 4}, 4);
  const double want[] = {1, 0.25, -0.3, -0.45, 0};
  for (int k = 0; k <= 4; ++k) EXPECT_NEAR(r[k], want[k], 1e-15);
  EXPECT_EQ(autocorrelation(std::vector<double>(5, 3.0), 2), (Eigen::VectorXd(3) << 1, 0, 0).finished());
}

TEST(LjungBox, FollowsItsFormulaAndHoldsItsLevel) {
  // Q = 4*6*(0.25^2/3 + 0.3^2/2)
  const TestResult result = ljung_box(std::vector<double>{1, 2, 3, 4}, 2);
  EXPECT_NEAR(result.statistic, 24 * (0.0625 / 3 + 0.045), 1e-12);
  EXPECT_NEAR(result.p_value, std::exp(-result.statistic / 2), 1e-12);
  EXPECT_THROW(ljung_box(std::vector<double>{1, 2, 3, 4}, 2, 2), InputError);
  EXPECT_THROW(ljung_box(std::vector<double>{1, 2, 3, 4}, 4), InputError);
  const double share =
      alarms(400, [](std::uint64_t draw) { return ljung_box(span_of(autoregressive(300, {}, draw)), 10).p_value; });
  // 400 draws of a 5 % test: 2 to 9 % is within three deviations (1.1 % each) and a little of its own error.
  EXPECT_GE(share, 0.02);
  EXPECT_LE(share, 0.09);
  EXPECT_LT(ljung_box(span_of(autoregressive(300, {0.4}, 1)), 10).p_value, 1e-6);
}

TEST(RunsTest, CountsRuns) {
  // Ten alternations of 20 values: 20 runs where 11 are expected, variance 10 * 9 / 19.
  std::vector<double> x;
  for (int i = 0; i < 20; ++i) x.push_back(i % 2);
  EXPECT_NEAR(runs_test(x).statistic, 9 / std::sqrt(90.0 / 19), 1e-12);
  EXPECT_LT(runs_test(x).p_value, 1e-4);
  EXPECT_EQ(runs_test(std::vector<double>(10, 1.0)).p_value, 1);
  const double share =
      alarms(400, [](std::uint64_t draw) { return runs_test(span_of(autoregressive(300, {}, draw))).p_value; });
  EXPECT_GE(share, 0.02);
  EXPECT_LE(share, 0.09);
}

TEST(FTest, ComparesNestedModels) {
  const TestResult result = f_test(20, 10, 2, 30);
  EXPECT_DOUBLE_EQ(result.statistic, 15);
  EXPECT_DOUBLE_EQ(result.p_value, f_tail(15, 2, 30));
  EXPECT_EQ(f_test(10, 10, 2, 30).p_value, 1);
}

TEST(Autoregression, IsRecovered) {
  // AR(2) with a resonance. Standard deviation of a coefficient: sqrt((1 - 0.8^2) / n) = 0.006.
  const Eigen::VectorXd x = autoregressive(10000, {1.5, -0.8}, 3);
  const AutoregressiveFit fit = fit_autoregression(span_of(x), 20);
  ASSERT_GE(fit.coefficients.size(), 2u);
  ASSERT_LE(fit.coefficients.size(), 3u);  // BIC seldom takes more
  EXPECT_NEAR(fit.coefficients[0], 1.5, 0.025);
  EXPECT_NEAR(fit.coefficients[1], -0.8, 0.025);
  EXPECT_NEAR(fit.variance, 1, 0.06);  // sqrt(2 / n) = 0.014
  EXPECT_GE(fit_autoregression(span_of(x), 20, OrderCriterion::aic).coefficients.size(), fit.coefficients.size());
}

TEST(Autoregression, OfWhiteNoiseIsEmpty) {
  int more = 0;
  for (std::uint64_t draw = 0; draw < 50; ++draw)
    more += !fit_autoregression(span_of(autoregressive(2000, {}, draw)), 20).coefficients.empty();
  EXPECT_LE(more, 3);  // BIC: about 1 % at 2000 rows
  EXPECT_TRUE(fit_autoregression(std::vector<double>(30, 2.0), 5).coefficients.empty());
  EXPECT_TRUE(fit_autoregression(std::vector<double>{}, 5).coefficients.empty());
}

TEST(Autoregression, FilterTurnsItsNoiseWhite) {
  const Eigen::VectorXd x = autoregressive(5000, {0.9, -0.3}, 4);
  const AutoregressiveFit fit = fit_autoregression(span_of(x), 10);
  const Eigen::VectorXd e = innovations(x, fit);
  EXPECT_EQ(e.size(), 5000 - static_cast<Eigen::Index>(fit.coefficients.size()));
  EXPECT_LT(ljung_box(span_of(x), 20).p_value, 1e-10);
  EXPECT_GT(ljung_box(span_of(e), 20, static_cast<int>(fit.coefficients.size())).p_value, 1e-3);
  // By hand: u_t - 0.5 u_(t-1) + 0.25 u_(t-2).
  AutoregressiveFit known;
  known.coefficients = {0.5, -0.25};
  Eigen::MatrixXd columns(4, 2);
  columns << 1, 8, 2, 4, 4, 2, 8, 1;
  EXPECT_EQ(innovations(columns, known), (Eigen::MatrixXd(2, 2) << 3.25, 2, 6.5, 1).finished());
}

TEST(LongRunVariance, OfAnAutoregressionIsItsSpectrumAtZero) {
  // sigma^2 / (1 - sum)^2; 20000 rows: a few per cent.
  EXPECT_NEAR(long_run_variance(span_of(autoregressive(20000, {}, 5))), 1, 0.1);
  EXPECT_NEAR(long_run_variance(span_of(autoregressive(20000, {0.7}, 6))) * 0.09, 1, 0.15);
  EXPECT_NEAR(long_run_variance(span_of(autoregressive(20000, {-0.5}, 7))) * 2.25, 1, 0.15);
  EXPECT_EQ(long_run_variance(std::vector<double>(100, 4.0)), 0);
}

TEST(LongRunVariance, GivesATestOfTheMeanItsLevel) {
  for (const std::vector<double>& coefficients : {std::vector<double>{0.6}, {1.5, -0.8}}) {
    const double share = alarms(400, [&](std::uint64_t draw) {
      const Eigen::VectorXd x = autoregressive(500, coefficients, draw);
      return 2 * normal_tail(std::abs(x.mean()) / std::sqrt(long_run_variance(span_of(x)) / 500));
    });
    EXPECT_GE(share, 0.02);
    EXPECT_LE(share, 0.09);
  }
}

}  // namespace
}  // namespace lunid
