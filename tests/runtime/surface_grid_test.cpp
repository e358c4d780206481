// Bilinear grids: exactness, cells without data, noise, refusals, tables.
#include <gtest/gtest.h>

#include "message.hpp"
#include "surface_samples.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double bilinear(double y, double v) { return 3 + 2e4 * y - 10 * v + 5e3 * y * v; }

}  // namespace

TEST(SurfaceGrid, a_bilinear_function_is_exact) {
  const SurfacePoints p = uniform_points(20000, bilinear);
  const GridSurface s = fit_grid(p);
  for (Index i = 0; i < p.size(); i += 101) {
    ASSERT_TRUE(s.has_data(p.y[i], p.v[i]));
    // First differences weigh 1e-9 of the points: that much of the force's 50 N is lost at most, times a few.
    EXPECT_NEAR(s.value(p.y[i], p.v[i]), p.f[i], 1e-6);
  }
  EXPECT_LT(s.rmse, 1e-6);
  EXPECT_NEAR(s.r2, 1, 1e-12);
}

TEST(SurfaceGrid, a_function_bilinear_in_each_cell_is_followed) {
  // |y| has its kink on a line of corners, which a smooth surface would round off.
  SurfacePoints p = uniform_points(40000, [](double y, double) { return 1e4 * std::abs(y); });
  p.y[0] = -2e-3;
  p.y[1] = 2e-3;
  p.f[0] = p.f[1] = 20;
  const GridSurface s = fit_grid(p, {.smoothness = 1e-6});
  EXPECT_LT(s.rmse, 1e-3);  // of 20 N
  EXPECT_NEAR(s.value(0, 0.1), 0, 2e-3);
}

TEST(SurfaceGrid, follows_a_smooth_function_to_second_order) {
  const auto f = [](double y, double v) { return std::sin(800 * y) * std::cos(3 * v); };
  const SurfacePoints p = uniform_points(100000, f);
  const double coarse = fit_grid(p, {.cells_y = 10, .cells_v = 10, .smoothness = 1e-8}).rmse;
  const double fine = fit_grid(p, {.cells_y = 20, .cells_v = 20, .smoothness = 1e-8}).rmse;
  EXPECT_NEAR(coarse / fine, 4, 0.5);  // h^2, less terms of h^4
}

TEST(SurfaceGrid, a_bicubic_function_is_exact_on_a_cubic_grid) {
  const auto f = [](double y, double v) {
    const double a = 1e3 * y, b = 2 * v;
    return (1 - a + 0.5 * a * a * a) * (2 + b * b - b * b * b);
  };
  const SurfacePoints p = uniform_points(20000, f);
  const GridSurface s = fit_grid(p, {.cells_y = 6, .cells_v = 5, .smoothness = 1e-12, .between = Between::cubic});
  EXPECT_EQ(s.name(), "bicubic grid");
  EXPECT_LT(s.rmse, 1e-7);  // of 2, what so little smoothness takes
  for (Index i = 0; i < p.size(); i += 101) EXPECT_NEAR(s.value(p.y[i], p.v[i]), p.f[i], 1e-6);
  const MatrixXd nodes = s.nodes();
  ASSERT_EQ(nodes.rows(), 7);
  const Cells& c = s.cells();
  for (Index i = 0; i < 7; ++i)
    for (Index j = 0; j < 6; ++j)
      EXPECT_NEAR(nodes(i, j),
                  f(c.y_min() + (c.y_max() - c.y_min()) * static_cast<double>(i) / 6,
                    c.v_min() + (c.v_max() - c.v_min()) * static_cast<double>(j) / 5),
                  1e-6);
}

TEST(SurfaceGrid, a_cubic_grid_follows_a_smooth_function_to_fourth_order_and_without_jumps) {
  const auto f = [](double y, double v) { return std::sin(800 * y) * std::cos(3 * v); };
  const SurfacePoints p = uniform_points(100000, f);
  const auto fit = [&](int cells) {
    return fit_grid(p, {.cells_y = cells, .cells_v = cells, .smoothness = 1e-12, .between = Between::cubic});
  };
  EXPECT_NEAR(fit(6).rmse / fit(12).rmse, 16, 4);
  const GridSurface s = fit(6);
  const double y = s.cells().y_min() + (s.cells().y_max() - s.cells().y_min()) / 3, step = 1e-8;  // an edge of cells
  EXPECT_NEAR((s.value(y + step, 0.1) - s.value(y, 0.1)) / step, (s.value(y, 0.1) - s.value(y - step, 0.1)) / step,
              0.01);
}

TEST(SurfaceGrid, a_cubic_grid_stays_within_its_data) {
  const SurfacePoints p = spiral(20000, bilinear);
  const GridSurface s = fit_grid(p, {.between = Between::cubic});
  EXPECT_TRUE(std::isnan(s.value(1.9e-3, 0.48)));
  EXPECT_TRUE(std::isnan(s.nodes()(0, 0)));
  EXPECT_NEAR(s.value(0.5e-3, 0.1), bilinear(0.5e-3, 0.1), 1e-3);
  EXPECT_LT(s.rmse, 1e-3);  // a plane and a twist cost no smoothness
}

TEST(SurfaceGrid, cells_without_data_have_no_value) {
  const SurfacePoints p = spiral(20000, bilinear);
  const GridSurface s = fit_grid(p);
  EXPECT_TRUE(std::isnan(s.value(1.9e-3, 0.48)));  // outside the ellipse, inside the rectangle
  EXPECT_FALSE(s.has_data(1.9e-3, 0.48));
  EXPECT_TRUE(std::isnan(s.value(1.0, 0)));
  EXPECT_NEAR(s.value(0.5e-3, 0.1), bilinear(0.5e-3, 0.1), 1e-6);
  EXPECT_TRUE(std::isnan(s.nodes()(0, 0)));
  // Every cell that counts as data gives a number, and no other.
  const SurfaceTable t = tabulate(s);
  for (Index i = 0; i < t.f.rows(); ++i)
    for (Index j = 0; j < t.f.cols(); ++j) EXPECT_EQ(std::isnan(t.f(i, j)), t.count(i, j) < 3);
}

TEST(SurfaceGrid, nothing_leaks_over_a_gap) {
  // Two islands of other levels: the smoothness must not reach across.
  SurfacePoints p = uniform_points(20000, bilinear);
  for (Index i = 0; i < p.size(); ++i) {
    if (std::abs(p.y[i]) < 0.5e-3) p.y[i] += p.y[i] < 0 ? -0.5e-3 : 0.5e-3;
    p.f[i] = p.y[i] < 0 ? -100 : 100;
  }
  const GridSurface s = fit_grid(p, {.smoothness = 10});
  EXPECT_NEAR(s.value(-0.8e-3, 0.1), -100, 1e-6);
  EXPECT_NEAR(s.value(0.8e-3, 0.1), 100, 1e-6);
  EXPECT_TRUE(std::isnan(s.value(0.1e-3, 0.1)));
}

TEST(SurfaceGrid, noise_averages_out) {
  const SurfacePoints p = uniform_points(40000, bilinear, 5);
  const GridSurface s = fit_grid(p);
  double sum = 0;
  for (Index i = 0; i < p.size(); ++i) sum += std::pow(s.value(p.y[i], p.v[i]) - bilinear(p.y[i], p.v[i]), 2);
  // 441 corners carry at most 441 / 40000 of the noise's variance, give or take 7 % (chi square).
  EXPECT_LT(sum / 40000, 25 * 441.0 / 40000 * 1.3);
  EXPECT_NEAR(s.rmse / 5, 1, 0.02);
}

TEST(SurfaceGrid, few_points_in_a_cell_still_give_a_surface) {
  SurfacePoints p{VectorXd(3), VectorXd(3), VectorXd(3)};
  p.y << 0, 1, 0.5;
  p.v << 0, 0.2, 1;
  p.f << 1, 1, 1;
  const GridSurface s = fit_grid(p, {.cells_y = 3, .cells_v = 3, .least_count = 1});
  EXPECT_NEAR(s.value(0, 0), 1, 1e-6);
  EXPECT_NEAR(s.value(0.5, 1), 1, 1e-6);
}

TEST(SurfaceGrid, table_lists_centres_values_and_counts) {
  const SurfacePoints p = uniform_points(5000, bilinear);
  const GridSurface s = fit_grid(p, {.cells_y = 4, .cells_v = 5});
  const SurfaceTable t = tabulate(s);
  const MatrixXd rows = t.rows();
  ASSERT_EQ(rows.rows(), 20);
  EXPECT_EQ(rows(7, 0), t.y[1]);
  EXPECT_EQ(rows(7, 1), t.v[2]);
  EXPECT_NEAR(rows(7, 2), bilinear(t.y[1], t.v[2]), 1e-6);
  EXPECT_EQ(rows.col(3).sum(), 5000);
  EXPECT_NEAR(t.y[0], p.y.minCoeff() + (p.y.maxCoeff() - p.y.minCoeff()) / 8, 1e-15);
}

TEST(SurfaceGrid, texts_of_what_cannot_be) {
  SurfacePoints p = uniform_points(50, bilinear);
  EXPECT_EQ(message([&] { fit_grid(p, {.least_count = 40}); }),
            "surface: no cell of the 20 x 20 grid holds 40 points: take fewer cells or more of the record");
  EXPECT_EQ(message([&] { fit_grid(p, {.cells_y = 0}); }), "surface: cells_y: expected 1 to 300, got 0");
  EXPECT_EQ(message([&] { fit_grid(p, {.least_count = 0}); }), "surface: least_count: expected >= 1, got 0");
  EXPECT_EQ(message([&] { fit_grid(p, {.smoothness = 0}); }), "surface: smoothness: expected > 0, got 0");
  p.v = -2 * p.y;
  EXPECT_EQ(message([&] { fit_grid(p); }).substr(0, 51), "surface: all points lie on the line v = -2*y + 0: a");
  p.v.conservativeResize(10);
  EXPECT_EQ(message([&] { fit_grid(p); }), "surface: expected y, v and f of one length, got 50, 10 and 50 values");
}
