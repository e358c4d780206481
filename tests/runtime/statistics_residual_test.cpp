// Residual tests: levels under coloured noise, and what they say of forces of known kind.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "statistics/statistics.hpp"
#include "statistics_noise.hpp"

namespace lunid {
namespace {

using test::alarms;
using test::autoregressive;
using test::span_of;

constexpr double period = 40;  // rows

/// A motion of several tones near one period, whose amplitude swells and fades.
struct Motion {
  Eigen::VectorXd y, v;
};
Motion motion(int rows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> phase(0, 2 * M_PI);
  Motion m{Eigen::VectorXd::Zero(rows), Eigen::VectorXd::Zero(rows)};
  for (double ratio : {0.8, 0.87, 0.95, 1.04, 1.15, 1.31}) {
    const double w = 2 * M_PI * ratio / period, p = phase(random);
    for (int i = 0; i < rows; ++i) {
      m.y[i] += std::sin(w * i + p);
      m.v[i] += w * std::cos(w * i + p);
    }
  }
  return m;
}

Eigen::VectorXd force(const Motion& m, const std::function<double(double, double)>& f) {
  Eigen::VectorXd r(m.y.size());
  for (Eigen::Index i = 0; i < r.size(); ++i) r[i] = f(m.y[i], m.v[i]);
  return r;
}

/// Elastic up to a limit, then slipping: the element of Jenkins, the plainest force with memory.
Eigen::VectorXd elastic_slip(const Motion& m, double stiffness, double limit) {
  Eigen::VectorXd r(m.y.size());
  double slipped = 0;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double elastic = stiffness * (m.y[i] - slipped);
    r[i] = std::clamp(elastic, -limit, limit);
    slipped = m.y[i] - r[i] / stiffness;
  }
  return r;
}

TEST(Parity, TellsOddFromEven) {
  const Motion m = motion(4000, 1);
  const Eigen::VectorXd noise = 0.3 * autoregressive(4000, {0.6}, 1);
  const auto of = [&](const Eigen::VectorXd& r, const Eigen::VectorXd& x) {
    return parity(span_of(r), span_of(x), 80, 1);
  };
  const Parity cubic = of(force(m, [](double y, double) { return 0.2 * y * y * y; }) + noise, m.y);
  EXPECT_GT(cubic.odd, 0.8);
  EXPECT_LT(cubic.even, 0.05);
  EXPECT_LT(cubic.odd_p_value, 0.01);
  EXPECT_GT(cubic.even_p_value, 0.01);
  const Parity square = of(force(m, [](double y, double) { return 0.2 * y * y; }) + noise, m.y);
  EXPECT_GT(square.even, 0.7);
  EXPECT_LT(square.odd, 0.05);
  EXPECT_LT(square.even_p_value, 0.01);
  const Parity friction = of(force(m, [](double, double v) { return v > 0 ? 1.0 : -1.0; }) + noise, m.v);
  EXPECT_GT(friction.odd, 0.6);
  EXPECT_LT(friction.odd_p_value, 0.01);
  EXPECT_GT(friction.even_p_value, 0.01);
}

TEST(Parity, HoldsItsLevelUnderColouredNoise) {
  int odd = 0, even = 0;
  for (std::uint64_t draw = 1; draw <= 400; ++draw) {
    const Motion m = motion(1200, draw);
    const Parity p = parity(span_of(autoregressive(1200, {0.8}, draw)), span_of(m.y), 40, draw);
    odd += p.odd_p_value <= 0.05;
    even += p.even_p_value <= 0.05;
  }
  for (int count : {odd, even}) {
    EXPECT_GE(count, 0.02 * 400);
    EXPECT_LE(count, 0.09 * 400);
  }
}

TEST(Parity, OfNothingIsNothing) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(100), one = Eigen::VectorXd::Ones(100);
  EXPECT_EQ(parity(span_of(zero), span_of(one), 0, 1).odd_p_value, 1);
  EXPECT_EQ(parity(span_of(one), span_of(zero), 0, 1).even_p_value, 1);
}

TEST(Correlation, HasItsCoefficientAndLevel) {
  const Motion m = motion(2000, 2);
  const Eigen::VectorXd size = m.y.cwiseAbs();
  EXPECT_NEAR(correlation(span_of(size), span_of(size), 0, 1).coefficient, 1, 1e-12);
  EXPECT_LT(correlation(span_of(size), span_of(size), 0, 1).p_value, 0.01);
  EXPECT_EQ(correlation(span_of(size), span_of(Eigen::VectorXd::Ones(2000)), 0, 1).p_value, 1);
  const double share = alarms(400, [](std::uint64_t draw) {
    const Eigen::VectorXd y = motion(1200, draw).y.cwiseAbs();
    return correlation(span_of(autoregressive(1200, {0.7}, draw)), span_of(y), 40, draw).p_value;
  });
  EXPECT_GE(share, 0.02);
  EXPECT_LE(share, 0.09);
}

TEST(Memory, IsSeenInASlippingElement) {
  const Motion m = motion(6400, 3);
  for (double limit : {0.5, 1.5}) {
    const Eigen::VectorXd r = elastic_slip(m, 1, limit) + 0.05 * autoregressive(6400, {0.6}, 1);
    const Memory found = memory(span_of(r), span_of(m.y), span_of(m.v), period, 80, 1);
    EXPECT_LT(found.p_value, 0.01) << limit;
    EXPECT_GT(found.explained, 0.02) << limit;
    EXPECT_GT(found.contrast, 0.2) << limit;
  }
}

TEST(Memory, IsNotSeenInForcesWithout) {
  const Motion m = motion(6400, 3);
  const std::vector<std::function<double(double, double)>> forces{
      [](double y, double) { return 0.2 * y * y * y; }, [](double, double v) { return v > 0 ? 1.0 : -1.0; },
      [](double y, double) { return y > 1 ? 3 * (y - 1) : 0.0; },
      [](double, double v) { return 20 * v * std::abs(v); }};
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const Eigen::VectorXd r = force(m, forces[i]) + 0.1 * autoregressive(6400, {0.6}, 1);
    const Memory found = memory(span_of(r), span_of(m.y), span_of(m.v), period, 80, 1);
    EXPECT_GT(found.p_value, 0.01) << i;
    EXPECT_LT(found.explained, 0.002) << i;  // a tenth of the least found above
  }
}

TEST(Memory, HoldsItsLevelUnderColouredNoise) {
  for (const std::vector<double>& coefficients : {std::vector<double>{}, {0.8}, {1.5, -0.8}}) {
    const double share = alarms(400, [&](std::uint64_t draw) {
      const Motion m = motion(1000, draw);
      const Eigen::VectorXd r = autoregressive(1000, coefficients, draw) + force(m, [](double y, double) { return y; });
      return memory(span_of(r), span_of(m.y), span_of(m.v), period, 40, draw).p_value;
    });
    EXPECT_GE(share, 0.02) << coefficients.size();
    EXPECT_LE(share, 0.09) << coefficients.size();
  }
}

TEST(Memory, CannotBeSeenInASteadyCycle) {
  Motion m{Eigen::VectorXd(4000), Eigen::VectorXd(4000)};
  for (int i = 0; i < 4000; ++i) {
    m.y[i] = std::sin(2 * M_PI * i / 40.37);
    m.v[i] = std::cos(2 * M_PI * i / 40.37);
  }
  const Eigen::VectorXd r = elastic_slip(m, 1, 0.3);
  EXPECT_LT(memory(span_of(r), span_of(m.y), span_of(m.v), 40.37, 80, 1).contrast, 0.1);
}

TEST(ResidualTests, GiveOneLook) {
  const Motion m = motion(4000, 5);
  const Eigen::VectorXd r = force(m, [](double y, double) { return 0.3 * y * y; }) + autoregressive(4000, {0.5}, 2);
  const ResidualTests tests = residual_tests(span_of(r), span_of(m.y), span_of(m.v), period, 80, 1);
  EXPECT_LT(tests.in_y.even_p_value, 0.01);
  EXPECT_LT(tests.with_abs_y.p_value, 0.01);
  EXPECT_GT(tests.with_abs_y.coefficient, 0.3);
  EXPECT_GT(tests.in_v.odd_p_value, 0.01);
}

}  // namespace
}  // namespace lunid
