// Polynomial surfaces: exact recovery, conversion of the basis, noise, refusals; points of a record; scores.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "expr/tape.hpp"
#include "message.hpp"
#include "surface/surface.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Points spread over y in -2..4 mm, v in -0.5..0.7 m/s by a fixed generator, with f(y, v).
template <class F>
SurfacePoints scattered(Index count, F f, double noise = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  SurfacePoints p{VectorXd(count), VectorXd(count), VectorXd(count)};
  for (Index i = 0; i < count; ++i) {
    p.y[i] = i == 0 ? -2e-3 : i == 1 ? 4e-3 : -2e-3 + 6e-3 * uniform(random);
    p.v[i] = i == 0 ? -0.5 : i == 1 ? 0.7 : -0.5 + 1.2 * uniform(random);
    p.f[i] = f(p.y[i], p.v[i]) + noise * normal(random);
  }
  return p;
}

double duffing(double y, double v) { return 2e4 * y + 10 * v + 1e9 * y * y * y - 4e3 * y * v * v; }

}  // namespace

TEST(SurfacePolynomial, recovers_a_polynomial_exactly) {
  const SurfacePoints points = scattered(2000, duffing);
  const PolynomialSurface s = fit_polynomial(points);
  for (Index i = 0; i < points.size(); i += 37)
    EXPECT_NEAR(s.value(points.y[i], points.v[i]), points.f[i], 1e-11);  // forces of 100 N
  EXPECT_NEAR(s.r2, 1, 1e-14);
  EXPECT_LT(s.rmse, 1e-11);
  const MatrixXd m = s.monomials();
  EXPECT_NEAR(m(1, 0) / 2e4, 1, 1e-10);
  EXPECT_NEAR(m(0, 1) / 10, 1, 1e-10);
  EXPECT_NEAR(m(3, 0) / 1e9, 1, 1e-10);
  EXPECT_NEAR(m(1, 2) / -4e3, 1, 1e-10);
  EXPECT_NEAR(m(0, 0), 0, 1e-11);
  EXPECT_NEAR(m(4, 0) * std::pow(4e-3, 4), 0, 1e-10);  // what a false term amounts to at the edge [N]
  EXPECT_LT(s.condition, 100);
}

TEST(SurfacePolynomial, chebyshev_coefficients_are_the_known_ones) {
  // On -1..1: x^3 = (3 T1 + T3) / 4 and x^4 = (3 + 4 T2 + T4) / 8 (Abramowitz & Stegun 1964, table 22.3).
  SurfacePoints p = scattered(500, [](double, double) { return 0; });
  p.y = (p.y.array() - 1e-3) / 3e-3;
  p.v = (p.v.array() - 0.1) / 0.6;
  for (Index i = 0; i < p.size(); ++i) p.f[i] = std::pow(p.y[i], 3) + std::pow(p.v[i], 4) * p.y[i];
  MatrixXd known = MatrixXd::Zero(5, 5);
  known(1, 0) = 3.0 / 4 + 3.0 / 8;
  known(3, 0) = 1.0 / 4;
  known(1, 2) = 4.0 / 8;
  known(1, 4) = 1.0 / 8;
  const PolynomialSurface s = fit_polynomial(p);
  EXPECT_LE((s.chebyshev() - known).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(SurfacePolynomial, monomials_and_expression_are_the_same_surface) {
  const SurfacePoints points =
      scattered(3000, [](double y, double v) { return 50 * std::tanh(900 * y) + 3 * v * std::abs(v); });
  const PolynomialSurface s = fit_polynomial(points, {.order_y = 5, .order_v = 3});
  const MatrixXd m = s.monomials();
  Pool pool;
  const Expr f = s.expression(pool);
  const std::vector<Expr> inputs = {pool.channel("y"), pool.channel("v")};
  const Tape tape(std::span(&f, 1), inputs);
  std::vector<double> scratch(static_cast<std::size_t>(tape.registers()));
  for (Index k = 0; k < 50; ++k) {
    const double y = points.y[k], v = points.v[k], value = s.value(y, v);
    double sum = 0;
    for (Index i = 0; i < m.rows(); ++i)
      for (Index j = 0; j < m.cols(); ++j) sum += m(i, j) * std::pow(y, i) * std::pow(v, j);
    EXPECT_NEAR(sum, value, 1e-11);  // 24 terms of up to some 100 N
    const double in[] = {y, v};
    double out = 0;
    tape.run_point(in, &out, scratch.data());
    EXPECT_NEAR(out, value, 1e-11);
  }
}

TEST(SurfacePolynomial, noise_averages_out) {
  const double noise = 5;
  const Index count = 20000;
  const SurfacePoints points = scattered(count, duffing, noise);
  const PolynomialSurface s = fit_polynomial(points);
  EXPECT_NEAR(s.rmse / noise, 1, 0.03);  // deviation of the estimate: 1 / sqrt(2 * 20000) = 0.5 %
  double sum = 0;
  for (Index i = 0; i < count; ++i)
    sum += std::pow(s.value(points.y[i], points.v[i]) - duffing(points.y[i], points.v[i]), 2);
  // 25 coefficients carry 25 / 20000 of the noise's variance: chi square of 25, at most 60 in 1e-4 of all cases.
  EXPECT_LT(sum / count, noise * noise * 60 / count);
}

TEST(SurfacePolynomial, marks_where_there_is_no_data) {
  SurfacePoints p = scattered(5000, duffing);
  for (Index i = 0; i < p.size(); ++i)
    if (i > 1 && p.y[i] > 1e-3 && p.v[i] > 0.1) {  // an empty quadrant but for the corner point
      p.y[i] -= 3e-3;
      p.f[i] = duffing(p.y[i], p.v[i]);
    }
  const PolynomialSurface s = fit_polynomial(p);
  EXPECT_TRUE(s.has_data(-1e-3, 0));
  EXPECT_FALSE(s.has_data(2.5e-3, 0.4));
  EXPECT_FALSE(s.has_data(5e-3, 0));
  EXPECT_NEAR(s.value(2.5e-3, 0.4), duffing(2.5e-3, 0.4), 1e-9);  // extrapolates all the same
}

TEST(SurfacePolynomial, texts_of_what_cannot_be) {
  SurfacePoints p = scattered(100, duffing);
  EXPECT_EQ(message([&] { fit_polynomial(scattered(20, duffing)); }),
            "surface: order {4, 4} has 25 coefficients, got 20 points");
  EXPECT_EQ(message([&] { fit_polynomial(p, {.order_y = 21}); }), "surface: order_y: expected 0 to 20, got 21");
  SurfacePoints line = p;
  line.v = 3 * line.y.array() - 0.25;
  EXPECT_EQ(message([&] { fit_polynomial(line); }),
            "surface: all points lie on the line v = 3*y - 0.25: a surface needs points beside it");
  SurfacePoints still = p;
  still.y.setConstant(0.002);
  EXPECT_EQ(message([&] { fit_polynomial(still); }), "surface: y is constant (0.002)");
  SurfacePoints ellipse = p;
  for (Index i = 0; i < 100; ++i) {
    ellipse.y[i] = 2e-3 * std::sin(0.77 * static_cast<double>(i));
    ellipse.v[i] = 0.4 * std::cos(0.77 * static_cast<double>(i));
  }
  // On an ellipse y^2 is known from v^2: of the functions of an angle up to order 8, these products span 16.
  EXPECT_EQ(message([&] { fit_polynomial(ellipse); }).substr(0, 66),
            "surface: the points determine 16 of the 25 coefficients of order {");
  p.f[41] = std::nan("");
  EXPECT_EQ(message([&] { fit_polynomial(p); }), "surface: point 42 is not finite");
}

TEST(SurfacePoints, are_force_less_inertia) {
  const Index n = 50;
  const VectorXd t = VectorXd::LinSpaced(n, 0, 1), y = t.array().sin(), v = t.array().cos(), a = -y;
  const VectorXd force = 3 * a + 40 * y + 2 * v;
  const Record record(
      "r.csv", 0, 1.0 / 49,
      {{"F", "N", "", "", force}, {"y", "m", "", "", y}, {"v", "m/s", "", "", v}, {"a", "m/s^2", "", "", a}});
  Pool pool;
  const std::vector<Record> twice = {record, record.slice(10, 20)};
  const SurfacePoints p = restoring_points(twice, pool.constant(3));
  ASSERT_EQ(p.size(), 70);
  for (Index i = 0; i < n; ++i) EXPECT_NEAR(p.f[i], 40 * y[i] + 2 * v[i], 1e-13);
  EXPECT_EQ(p.y[50], y[10]);
  EXPECT_EQ(restoring_points(twice, Expr()).f[0], force[0]);
  EXPECT_EQ(message([&] { restoring_points(twice, pool.parameter("m")); }),
            "surface: the mass holds 'm', which has no value here");
}

TEST(SurfaceScore, left_out_blocks_score_what_they_should) {
  const SurfacePoints points = scattered(10000, duffing, 5);
  const auto fit = [](const SurfacePoints& p) { return std::make_unique<PolynomialSurface>(fit_polynomial(p)); };
  const auto left_out = [&](int blocks, const SurfaceFit& how) {
    return score(points, leave_out(points, blocks, Cells(points, 1, 1), how).predicted);
  };
  const SurfaceScore cubic = left_out(5, fit);
  EXPECT_NEAR(cubic.rmse / 5, 1, 0.04);
  const double variance = (points.f.array() - points.f.mean()).square().mean();
  EXPECT_NEAR(cubic.r2, 1 - 25 / variance, 0.01);
  EXPECT_GT(cubic.covered, 0.99);
  // A surface of too low an order explains less, and the score says so.
  const auto plane = [](const SurfacePoints& p) {
    return std::make_unique<PolynomialSurface>(fit_polynomial(p, {.order_y = 1, .order_v = 1}));
  };
  EXPECT_LT(left_out(5, plane).r2, cubic.r2 - 0.02);
  EXPECT_EQ(message([&] { left_out(1, fit); }), "surface: blocks: expected 2 to 10000, got 1");
}
