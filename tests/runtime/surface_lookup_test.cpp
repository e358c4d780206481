// Tables as functions: exact for what they can hold, straight beyond their ends, filled where a surface had no data.
#include "surface/lookup.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "message.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double bilinear(double y, double v) { return 3 + 2e4 * y - 10 * v + 5e3 * y * v; }

VectorXd axis(std::initializer_list<double> values) {
  VectorXd all(static_cast<Index>(values.size()));
  std::copy(values.begin(), values.end(), all.data());
  return all;
}

double value(const Lookup& f, double a, double b = 0) {
  const double x[] = {a, b};
  return f.call(ExternalPart(), x);
}
double slope(const Lookup& f, int i, double a, double b = 0) {
  const double x[] = {a, b};
  return f.call(ExternalPart().by(i), x);
}

TEST(SurfaceLookup, one_axis_is_straight_between_its_points_and_beyond) {
  const Lookup spring("spring", {axis({-1, 0, 2})}, axis({-90, 0, 210}));
  EXPECT_EQ(value(spring, -0.5), -45);
  EXPECT_EQ(value(spring, 1), 105);
  EXPECT_EQ(value(spring, 4), 420);
  EXPECT_EQ(value(spring, -2), -180);
  EXPECT_EQ(slope(spring, 0, -3), 90);
  EXPECT_EQ(slope(spring, 0, 0), 105);
}

TEST(SurfaceLookup, two_axes_hold_bilinear_functions_everywhere) {
  const VectorXd y = axis({-2e-3, -1e-3, 0.5e-3, 2e-3}), v = axis({-1, 0, 3});
  MatrixXd values(y.size(), v.size());
  for (Index i = 0; i < y.size(); ++i)
    for (Index j = 0; j < v.size(); ++j) values(i, j) = bilinear(y[i], v[j]);
  const Lookup f("f", {y, v}, values);
  for (const double a : {-5e-3, -1.4e-3, 0.5e-3, 1.9e-3, 4e-3})
    for (const double b : {-3.0, -0.2, 0.0, 2.9, 7.0}) {
      EXPECT_NEAR(value(f, a, b), bilinear(a, b), 1e-12 * 500);
      EXPECT_NEAR(slope(f, 0, a, b), 2e4 + 5e3 * b, 1e-12 * 1e6);
      EXPECT_NEAR(slope(f, 1, a, b), -10 + 5e3 * a, 1e-12 * 500);
    }
}

TEST(SurfaceLookup, a_surface_goes_on_straight_where_it_had_no_data) {
  // A plane seen on a disc: the corners of the rectangle are empty, and the plane is what least second differences add.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<std::array<double, 2>> at;
  while (at.size() < 5000)
    if (const double a = uniform(random), b = uniform(random); a * a + b * b < 1) at.push_back({1e-3 * a, 0.5 * b});
  const auto plane = [](double y, double v) { return 7 + 2e4 * y - 10 * v; };
  SurfacePoints p{VectorXd(5000), VectorXd(5000), VectorXd(5000)};
  for (Index k = 0; k < p.size(); ++k) {
    p.y[k] = at[static_cast<std::size_t>(k)][0];
    p.v[k] = at[static_cast<std::size_t>(k)][1];
    p.f[k] = plane(p.y[k], p.v[k]);
  }
  const GridSurface surface = fit_grid(p);
  const auto f = lookup_of(surface, "surface", Between::linear);
  ASSERT_TRUE(std::isnan(surface.value(0.95e-3, 0.48)));
  for (const double y : {-2e-3, -0.95e-3, 0.1e-3, 0.95e-3, 1.5e-3})
    for (const double v : {-0.8, -0.48, 0.0, 0.48}) EXPECT_NEAR(value(*f, y, v), plane(y, v), 1e-3);
  // Within the data it is the surface itself.
  for (Index k = 0; k < p.size(); k += 97)
    EXPECT_NEAR(value(*f, p.y[k], p.v[k]), surface.value(p.y[k], p.v[k]), 1e-12 * 50);
}

template <class F>
MatrixXd table_of(const VectorXd& first, const VectorXd& second, F f) {
  return MatrixXd::NullaryExpr(first.size(), second.size(), [&](Index i, Index j) { return f(first[i], second[j]); });
}

TEST(SurfaceLookup, splines_hold_cubics_and_their_slopes_on_uneven_axes) {
  const auto f = [](double y, double v) { return (3 - y + 2 * y * y * y) * (1 - v + 2 * v * v * v); };
  const auto by_y = [](double y, double v) { return (-1 + 6 * y * y) * (1 - v + 2 * v * v * v); };
  const auto by_v = [](double y, double v) { return (3 - y + 2 * y * y * y) * (-1 + 6 * v * v); };
  const VectorXd y = axis({-2, -1.2, -1, 0.5, 1.1, 2}), v = axis({-1, 0, 0.3, 1.5});
  const Lookup both("f", {y, v}, table_of(y, v, f), Between::cubic);
  const Lookup one("g", {y}, table_of(y, axis({0.25}), f), Between::cubic);
  for (const double a : {-2.0, -1.9, -1.0, -0.3, 0.5, 1.7, 2.0}) {
    for (const double b : {-1.0, -0.4, 0.3, 0.9, 1.5}) {
      EXPECT_NEAR(value(both, a, b), f(a, b), 1e-13 * 150);
      EXPECT_NEAR(slope(both, 0, a, b), by_y(a, b), 1e-12 * 150);
      EXPECT_NEAR(slope(both, 1, a, b), by_v(a, b), 1e-12 * 250);
    }
    EXPECT_NEAR(value(one, a), f(a, 0.25), 1e-13 * 20);
    EXPECT_NEAR(slope(one, 0, a), by_y(a, 0.25), 1e-12 * 20);
  }
}

TEST(SurfaceLookup, splines_of_few_points_are_the_polynomials_through_them) {
  const Lookup line("f", {axis({0, 2})}, axis({1, 5}), Between::cubic);
  EXPECT_DOUBLE_EQ(value(line, 0.5), 2);
  const Lookup parabola("g", {axis({-1, 0, 2})}, axis({1, 0, 4}), Between::cubic);
  for (const double x : {-0.7, 0.3, 1.9}) EXPECT_NEAR(value(parabola, x), x * x, 1e-14);
}

TEST(SurfaceLookup, splines_have_no_jump_in_two_derivatives_and_go_on_straight) {
  const VectorXd y = VectorXd::LinSpaced(9, -1, 1), v = VectorXd::LinSpaced(7, -2, 2);
  const auto f = [](double a, double b) { return std::sin(3 * a) * std::exp(b) + std::abs(a - b); };
  const Lookup g("f", {y, v}, table_of(y, v, f), Between::cubic);
  const double step = 1e-6;
  for (const double node : {y[1], y[4], y[7]}) {  // its slope by y, one-sided: that of both sides
    const double left = (slope(g, 0, node, 0.3) - slope(g, 0, node - step, 0.3)) / step;
    const double right = (slope(g, 0, node + step, 0.3) - slope(g, 0, node, 0.3)) / step;
    EXPECT_NEAR(left, right, 1e-3);  // of about 10; a jump of the third derivative times the step is left
  }
  for (const double out : {0.1, 0.7}) {
    EXPECT_NEAR(value(g, 1 + out, 0.3), value(g, 1, 0.3) + out * slope(g, 0, 1, 0.3), 1e-13);
    EXPECT_NEAR(slope(g, 0, 1 + out, 0.3), slope(g, 0, 1, 0.3), 1e-13);
    EXPECT_NEAR(value(g, 0.2, -2 - out), value(g, 0.2, -2) - out * slope(g, 1, 0.2, -2), 1e-13);
  }
}

TEST(SurfaceLookup, splines_approach_a_smooth_function_in_the_fourth_order) {
  const auto f = [](double a, double b) { return std::sin(3 * a + b) * std::exp(0.5 * b); };
  const auto error = [&](Index points, Between between) {
    const VectorXd y = VectorXd::LinSpaced(points, -1, 1), v = VectorXd::LinSpaced(points, -1, 1);
    const Lookup g("f", {y, v}, table_of(y, v, f), between);
    double most = 0;
    for (double a = -1; a <= 1; a += 0.0137)
      for (double b = -1; b <= 1; b += 0.0171) most = std::max(most, std::abs(value(g, a, b) - f(a, b)));
    return most;
  };
  EXPECT_NEAR(error(21, Between::cubic) / error(41, Between::cubic), 16, 3);
  EXPECT_NEAR(error(21, Between::linear) / error(41, Between::linear), 4, 0.3);
}

TEST(SurfaceLookup, names_what_is_between) {
  for (const Between between : {Between::linear, Between::cubic}) EXPECT_EQ(between_from(to_string(between)), between);
  EXPECT_EQ(message([] { between_from("smooth"); }), "between: expected linear or cubic, got 'smooth'");
}

TEST(SurfaceLookup, bad_tables_are_refused) {
  EXPECT_EQ(message([] {
              Lookup("f", {axis({0, 0, 1})}, axis({1, 2, 3}));
            }),
            "table 'f': axis 1: expected finite values that increase, got 0 as value 2");
  EXPECT_EQ(message([] { Lookup("f", {axis({0})}, axis({1})); }),
            "table 'f': axis 1: expected 2 values or more, got 1");
  EXPECT_EQ(message([] { Lookup("f", {axis({0, 1})}, axis({1, 2, 3})); }), "table 'f': values: expected 2, got 3");
  EXPECT_EQ(message([] {
              Lookup("f", {axis({0, 1}), axis({0, 1, 2})}, MatrixXd::Zero(3, 2));
            }),
            "table 'f': values: expected 2 rows of 3, got 3 rows of 2");
  EXPECT_EQ(message([] {
              Lookup("f", {axis({0, 1}), axis({0, 1}), axis({0, 1})}, MatrixXd::Zero(2, 2));
            }),
            "table 'f': expected 1 or 2 axes, got 3");
  EXPECT_EQ(message([] {
              Lookup("f", {axis({0, 1})}, axis({1, std::nan("")}));
            }),
            "table 'f': values: row 2, entry 1: expected a finite number");
}

}  // namespace
}  // namespace lunid
