// Kolmogorov-Smirnov tests and quantile plots: published tables, closed forms, levels by simulation.
#include <gtest/gtest.h>

#include <cmath>

#include "expr/error.hpp"
#include "statistics/statistics.hpp"
#include "statistics_noise.hpp"

namespace lunid {
namespace {

using test::alarms;
using test::autoregressive;
using test::message_of;
using test::span_of;

TEST(Kolmogorov, OneSampleIsThatOfTheTables) {
  // Two-sided critical values (Miller 1956, J. Am. Stat. Assoc. 51, 111; five digits): D is known to 5e-6, and P falls
  // by a factor of 4 d sqrt(n) * 5e-6 with it.
  const struct {
    int n;
    double d, p;
  } table[] = {{1, 0.97500, 0.05},  {2, 0.84189, 0.05},  {3, 0.70760, 0.05},   {5, 0.56328, 0.05},
               {10, 0.40925, 0.05}, {10, 0.48893, 0.01}, {20, 0.29408, 0.05},  {20, 0.35241, 0.01},
               {30, 0.24170, 0.05}, {50, 0.18841, 0.05}, {100, 0.13403, 0.05}, {100, 0.16081, 0.01},
               {20, 0.26473, 0.10}};
  for (const auto& row : table) EXPECT_NEAR(kolmogorov_tail(row.d, row.n) / row.p, 1, 3e-4) << row.n << " " << row.d;
  // Marsaglia, Tsang & Wang 2003: P(D_10 < 0.274) = 0.6284796154565043.
  EXPECT_NEAR(kolmogorov_tail(0.274, 10), 1 - 0.628479615456504275, 1e-13);
  // The limit: 1.3581 and 1.6276 for 5 and 1 %.
  EXPECT_NEAR(kolmogorov_tail(1.3580986 / 1e3, 1e6), 0.05, 5e-5);
  EXPECT_NEAR(kolmogorov_tail(1.6276236 / 1e3, 1e6), 0.01, 2e-5);
}

TEST(Kolmogorov, ItsFormsMeet) {
  // Exact and limit at 1000 rows; two-sided and one-sided at n d^2 = 4.
  for (double x : {0.5, 0.9, 1.3, 1.9}) {
    const double d = x / std::sqrt(1000.0);
    EXPECT_NEAR(kolmogorov_tail(d, 1000), kolmogorov_tail(x / std::sqrt(1000.5), 1000.5), 3e-5);
  }
  EXPECT_NEAR(kolmogorov_tail(std::sqrt(3.9999999 / 50), 50) / kolmogorov_tail(std::sqrt(4.0000001 / 50), 50), 1, 1e-6);
  // All rows beyond one end of the distribution: (1 - d)^n on either side.
  EXPECT_NEAR(kolmogorov_tail(0.9, 3) / (2 * std::pow(0.1, 3)), 1, 1e-9);
  EXPECT_EQ(kolmogorov_tail(0.05, 10), 1);
  EXPECT_EQ(kolmogorov_tail(1, 10), 0);
}

double choose(double n, double k) {
  return k < 0 ? 0 : std::round(std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1)));
}

TEST(Smirnov, TwoSamplesOfOneSizeFollowTheReflectionPrinciple) {
  // P(D >= k/n) = 2 sum (-1)^(i-1) C(2n, n - i k) / C(2n, n). (Gnedenko & Korolyuk 1951.)
  for (int n : {4, 5, 10, 15})
    for (int k = 1; k <= n; ++k) {
      double sum = 0;
      for (int i = 1; i * k <= n; ++i) sum += (i % 2 == 1 ? 2 : -2) * choose(2 * n, n - i * k);
      EXPECT_NEAR(smirnov_tail(static_cast<double>(k) / n, n, n), sum / choose(2 * n, n), 1e-12) << n << " " << k;
    }
  // Unequal sizes: of the 35 orders of 3 and 4 values two have D = 1, four more D >= 3/4 ... (by hand: 2/35).
  EXPECT_NEAR(smirnov_tail(1, 3, 4), 2 / 35.0, 1e-15);
  EXPECT_NEAR(smirnov_tail(0.06, 1000, 1000), smirnov_tail(0.06, 1000, 1001), 3e-3);  // exact beside the limit
}

TEST(KolmogorovSmirnov, HoldsItsLevelAndSeesADifference) {
  const auto normal = [](int rows, std::uint64_t draw) { return autoregressive(rows, {}, draw); };
  const double known =
      alarms(400, [&](std::uint64_t d) { return kolmogorov_normal(span_of(normal(80, d)), 0, 1).p_value; });
  const double own = alarms(400, [&](std::uint64_t d) { return lilliefors(span_of(normal(80, d)), d).p_value; });
  const double two = alarms(400, [&](std::uint64_t d) {
    return kolmogorov_two(span_of(normal(60, d)), span_of(normal(90, d + 4000))).p_value;
  });
  for (double share : {known, own, two}) {
    EXPECT_GE(share, 0.02);
    EXPECT_LE(share, 0.09);
  }
  const Eigen::VectorXd squares = normal(200, 1).cwiseAbs2();
  EXPECT_LT(lilliefors(span_of(squares), 1).p_value, 1e-3);
  EXPECT_LT(kolmogorov_normal(span_of(normal(200, 1)), 0.5, 1).p_value, 1e-6);
  EXPECT_LT(kolmogorov_two(span_of(squares), span_of(normal(100, 2))).p_value, 1e-6);
}

TEST(Lilliefors, IsThatOfItsTable) {
  // Lilliefors 1967, corrected by Dallal & Wilkinson 1986: 20 rows, 0.192 at 5 %. A sample whose D is within 0.002 of
  // that has a p-value within 12 % of 0.05; the error of its draws is as large.
  int met = 0;
  for (std::uint64_t draw = 1; draw < 500; ++draw) {
    const Eigen::VectorXd x = autoregressive(20, {}, draw);
    const TestResult found = lilliefors(span_of(x), 7);
    if (std::abs(found.statistic - 0.192) > 2e-3) continue;
    EXPECT_NEAR(found.p_value, 0.05, 0.02);
    ++met;
  }
  EXPECT_GE(met, 1);
}

TEST(Quantiles, OfANormalSampleLieOnALine) {
  EXPECT_GT(quantile_correlation(normal_quantiles(span_of(autoregressive(1000, {}, 1)))), 0.998);
  // Filliben's 5 % point for 100 rows is 0.987; squares of normal values stay far below.
  const Eigen::VectorXd squares = autoregressive(100, {}, 1).cwiseAbs2();
  EXPECT_LT(quantile_correlation(normal_quantiles(span_of(squares))), 0.95);
  // Blom's positions: the middle one of three is the mean, the outer ones +- 0.8694 deviations (z of 0.625/3.25).
  const Quantiles three = normal_quantiles(std::vector<double>{5, 1, 3});
  EXPECT_EQ(three.found, (Eigen::VectorXd(3) << 1, 3, 5).finished());
  EXPECT_NEAR(three.expected[1], 3, 1e-15);
  EXPECT_NEAR(three.expected[2] - 3, std::sqrt(8 / 3.0) * normal_quantile(2.625 / 3.25), 1e-14);
}

TEST(Quantiles, OfTwoSamplesAreThoseOfTheShorter) {
  const Quantiles same = paired_quantiles(std::vector<double>{3, 1, 2, 4}, std::vector<double>{2, 4, 1, 3});
  EXPECT_EQ(same.expected, same.found);
  const Eigen::VectorXd x = autoregressive(1000, {}, 3), y = 2 * autoregressive(300, {}, 4);
  const Quantiles points = paired_quantiles(span_of(x), span_of(y));
  EXPECT_EQ(points.expected.size(), 300);
  EXPECT_GT(quantile_correlation(points), 0.99);
  EXPECT_NEAR(points.found[225] / points.expected[225], 2, 0.35);  // upper quartiles
}

TEST(KolmogorovSmirnov, RefusesWhatItCannotTake) {
  EXPECT_EQ(message_of([] {
              kolmogorov_normal(std::vector<double>{1, 2}, 0, 0);
            }),
            "kolmogorov_smirnov: std: expected > 0");
  EXPECT_EQ(message_of([] {
              lilliefors(std::vector<double>{1, 2, 3}, 1);
            }),
            "kolmogorov_smirnov: the column: expected 5 rows or more, got 3");
  EXPECT_EQ(message_of([] {
              normal_quantiles(std::vector<double>{1, 1, 1});
            }),
            "qq: the column is constant, 1: nothing can vary with it");
}

}  // namespace
}  // namespace lunid
