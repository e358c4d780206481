// Tail probabilities against closed forms and tables.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "statistics/statistics.hpp"

namespace lunid {
namespace {

void expect_relative(double got, double want, double tolerance = 1e-11) {
  EXPECT_NEAR(got / want, 1, tolerance) << got << " for " << want;
}

TEST(Tails, Normal) {
  expect_relative(normal_tail(1.959963984540054), 0.025, 1e-13);  // any table of quantiles
  expect_relative(normal_tail(10), 7.619853024160527e-24, 1e-12);
  expect_relative(normal_tail(-1), 0.841344746068543, 1e-13);
  for (double p : {1e-300, 1e-10, 0.025, 0.3, 0.5, 0.975, 1 - 1e-9}) {
    const double z = normal_quantile(p);
    expect_relative(p < 0.5 ? normal_tail(-z) : normal_tail(z), std::min(p, 1 - p), 1e-10);
  }
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-14);
  EXPECT_TRUE(std::isinf(normal_quantile(0)));
  EXPECT_TRUE(std::isnan(normal_quantile(1.5)));
}

TEST(Tails, ChiSquare) {
  // Two degrees of freedom: exp(-x/2); 2m: exp(-x/2) sum (x/2)^k / k!.
  for (double x : {1e-3, 0.5, 2.0, 30.0, 700.0}) expect_relative(chi_square_tail(x, 2), std::exp(-x / 2));
  for (double x : {0.5, 9.0, 60.0}) {
    double term = std::exp(-x / 2), sum = 0;
    for (int k = 0; k < 10; ++k) {
      sum += term;
      term *= x / 2 / (k + 1);
    }
    expect_relative(chi_square_tail(x, 20), sum);
  }
  // One: the two-sided normal tail.
  for (double z : {0.1, 1.0, 5.0}) expect_relative(chi_square_tail(z * z, 1), 2 * normal_tail(z));
  // Tables: upper 5 % points.
  expect_relative(chi_square_tail(18.307038053275146, 10), 0.05);
  expect_relative(chi_square_tail(124.34211340400407, 100), 0.05);
  EXPECT_EQ(chi_square_tail(0, 3), 1);
  // A large number of degrees of freedom: Wilson and Hilferty's normal approximation is right to 1e-4 there.
  const double k = 1e6, z = 2;
  EXPECT_NEAR(chi_square_tail(k * std::pow(1 - 2 / (9 * k) + z * std::sqrt(2 / (9 * k)), 3), k), normal_tail(z), 1e-6);
}

TEST(Tails, F) {
  // Two degrees of freedom above: (1 + 2 f / d)^(-d/2).
  for (double f : {0.01, 1.0, 20.0})
    for (double d : {3.0, 40.0, 5e4}) expect_relative(f_tail(f, 2, d), std::pow(1 + 2 * f / d, -d / 2), 1e-9);
  // One above: the two-sided t.
  expect_relative(f_tail(9, 1, 7), 2 * t_tail(3, 7));
  expect_relative(f_tail(3.325834530413011, 5, 10), 0.05);  // tables
  expect_relative(f_tail(4.102821, 2, 10), 0.05, 1e-6);
  // 1/F has the degrees of freedom exchanged.
  expect_relative(f_tail(0.4, 6, 9) + f_tail(2.5, 9, 6), 1, 1e-13);
  EXPECT_EQ(f_tail(0, 3, 4), 1);
  EXPECT_EQ(f_tail(INFINITY, 3, 4), 0);
}

TEST(Tails, FQuantile) {
  EXPECT_NEAR(f_quantile(0.05, 5, 10), 3.325834530413011, 1e-9);  // tables
  for (const double tail : {1e-6, 0.01, 0.5, 0.99})
    expect_relative(f_tail(f_quantile(tail, 3.5, 40), 3.5, 40), tail, 1e-9);
  expect_relative(f_quantile(0.95, 6, 9), 1 / f_quantile(0.05, 9, 6), 1e-9);
  EXPECT_EQ(f_quantile(0, 3, 4), INFINITY);
  EXPECT_EQ(f_quantile(1, 3, 4), 0);
  EXPECT_TRUE(std::isnan(f_quantile(-0.1, 3, 4)));
}

TEST(Tails, T) {
  for (double t : {0.0, 0.3, 2.0, 50.0}) {
    expect_relative(t_tail(t, 1), 0.5 - std::atan(t) / M_PI, 1e-10);            // Cauchy
    expect_relative(t_tail(t, 2), 0.5 - 0.5 * t / std::sqrt(2 + t * t), 1e-9);  // closed form
    EXPECT_NEAR(t_tail(-t, 5), 1 - t_tail(t, 5), 1e-15);
  }
  expect_relative(t_tail(2.2281388519862744, 10), 0.025);  // closed form for even degrees of freedom
  expect_relative(t_tail(1.5, 1e7), normal_tail(1.5), 1e-6);
  EXPECT_EQ(t_tail(INFINITY, 3), 0);
}

TEST(Tails, Beta) {
  for (double x : {0.01, 0.5, 0.9}) {
    expect_relative(beta_lower(x, 3.5, 1), std::pow(x, 3.5), 1e-13);
    expect_relative(beta_lower(x, 1, 3.5), 1 - std::pow(1 - x, 3.5), 1e-12);
    expect_relative(beta_lower(x, 2, 2), x * x * (3 - 2 * x), 1e-13);
  }
  EXPECT_EQ(beta_lower(0, 2, 3), 0);
  EXPECT_EQ(beta_lower(1, 2, 3), 1);
}

TEST(Tails, GammaOfWholeNumbers) {  // a sum of Poisson's, by the series and by the fraction
  expect_relative(gamma_upper(3, 2), std::exp(-2) * (1 + 2 + 2), 1e-13);
  expect_relative(gamma_upper(3, 9), std::exp(-9) * (1 + 9 + 40.5), 1e-13);
  EXPECT_EQ(gamma_upper(3, 0), 1);
}

}  // namespace
}  // namespace lunid
