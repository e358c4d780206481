// The kinds of surface side by side: each against the function that made the points, optimality where there is one,
// scores on common points, refusals.
#include "surface/interpolation.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "message.hpp"
#include "surface_samples.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A hardening spring with dry-like damping, about 60 N.
double smooth(double y, double v) { return 1.2e4 * y + 4e9 * y * y * y + 8 * std::tanh(6 * v); }

double rms_error(const ForceSurface& surface, double reach = 0.85) {
  double sum = 0;
  int count = 0;
  for (double y = -reach; y <= reach; y += 0.0413)
    for (double v = -reach; v <= reach; v += 0.0413, ++count)
      sum += std::pow(surface.value(2e-3 * y, 0.5 * v) - smooth(2e-3 * y, 0.5 * v), 2);
  return std::sqrt(sum / count);
}

const std::vector<Interpolator> all_kinds = {PolynomialOptions{.order_y = 6, .order_v = 6},
                                             GridOptions{},
                                             NearestOptions{},
                                             TriangulationOptions{},
                                             MlpOptions{},
                                             GaussianProcessOptions{},
                                             SupportVectorOptions{},
                                             ForestOptions{}};

}  // namespace

TEST(SurfaceInterpolation, each_kind_follows_a_smooth_surface_through_noise) {
  // 3 N of noise in 60 N. The bounds: what a kind's resolution (cells, leaves, neighbours) and noise average leave.
  const SurfacePoints p = uniform_points(6000, smooth, 3);
  const double bound[] = {0.5, 1.2, 1.6, 2.5, 0.6, 0.5, 1.0, 1.8};
  for (std::size_t k = 0; k < all_kinds.size(); ++k) {
    const FittedSurface fit = fit_surface(p, all_kinds[k]);
    EXPECT_LT(rms_error(*fit.surface), bound[k]) << name_of(all_kinds[k]);
    EXPECT_EQ(fit.surface->name(), name_of(all_kinds[k]));
    EXPECT_GT(fit.r2, 0.97) << name_of(all_kinds[k]);
  }
}

TEST(SurfaceInterpolation, the_same_points_give_the_same_bits) {
  const SurfacePoints p = uniform_points(300, smooth, 3);
  for (const Interpolator& how : all_kinds) {
    const FittedSurface a = fit_surface(p, how), b = fit_surface(p, how);
    EXPECT_EQ(a.surface->continued(0.3e-3, 0.1), b.surface->continued(0.3e-3, 0.1)) << name_of(how);
  }
}

TEST(SurfaceInterpolation, scale_does_not_matter) {
  // The same surface in micrometres and meganewtons: each kind normalises.
  const SurfacePoints p = uniform_points(1500, smooth, 3);
  SurfacePoints q = p;
  q.y *= 1e6;
  q.v *= 1e-3;
  q.f *= 1e-6;
  for (const Interpolator& how : all_kinds) {
    if (std::holds_alternative<MlpOptions>(how)) continue;  // its way to rest depends on roundings: below
    const double here = fit_surface(p, how).surface->value(0.31e-3, 0.107);
    const double there = fit_surface(q, how).surface->value(0.31e3, 0.107e-3);
    EXPECT_NEAR(there * 1e6, here, 2e-2 * std::abs(here)) << name_of(how);  // iterations stop at other roundings
  }
  // A thousand steps of descent take roundings far apart: the same quality, not the same network.
  const FittedSurface here = fit_surface(p, MlpOptions{}), there = fit_surface(q, MlpOptions{});
  EXPECT_NEAR(there.rmse * 1e6, here.rmse, 0.02 * here.rmse);
}

TEST(SurfaceInterpolation, gradients_agree_with_differences) {
  const SurfacePoints p = uniform_points(1500, smooth, 1);
  for (const Interpolator& how : {Interpolator(MlpOptions{}), Interpolator(GaussianProcessOptions{})}) {
    const auto surface = fit_surface(p, how).surface;
    const double y = 0.4e-3, v = -0.12, h = 1e-8, g = 1e-6;
    const Eigen::Vector2d slope = surface->gradient(y, v);
    EXPECT_NEAR(slope[0], (surface->value(y + h, v) - surface->value(y - h, v)) / (2 * h), 1e-4 * std::abs(slope[0]));
    EXPECT_NEAR(slope[1], (surface->value(y, v + g) - surface->value(y, v - g)) / (2 * g), 1e-4 * std::abs(slope[1]));
  }
}

TEST(SurfaceInterpolation, nearest_neighbours_are_the_nearest) {
  const SurfacePoints p = uniform_points(500, smooth);
  const auto surface = fit_surface(p, NearestOptions{.neighbours = 1}).surface;
  const Cells& c = surface->cells();
  const double y_half = (c.y_max() - c.y_min()) / 2, v_half = (c.v_max() - c.v_min()) / 2;
  for (int k = 0; k < 50; ++k) {  // brute force
    const double y = 2e-3 * std::sin(1.0 + k), v = 0.5 * std::cos(2.3 * k);
    Index best = 0;
    for (Index i = 0; i < p.size(); ++i) {
      const auto far = [&](Index j) { return std::hypot((p.y[j] - y) / y_half, (p.v[j] - v) / v_half); };
      if (far(i) < far(best)) best = i;
    }
    EXPECT_DOUBLE_EQ(surface->value(y, v), p.f[best]);
  }
}

TEST(SurfaceInterpolation, a_triangulation_is_exact_for_a_plane_inside_its_hull) {
  const auto plane = [](double y, double v) { return 5 + 3e3 * y - 20 * v; };
  const SurfacePoints p = spiral(4000, plane);
  const auto surface = fit_surface(p, TriangulationOptions{}).surface;
  EXPECT_NEAR(surface->value(0.7e-3, 0.11), plane(0.7e-3, 0.11), 1e-9);
  EXPECT_NEAR(surface->value(-0.2e-3, -0.31), plane(-0.2e-3, -0.31), 1e-9);
  EXPECT_TRUE(std::isnan(surface->value(1.9e-3, 0.48)));
  // Continued inwards to the hull, along the line to the middle: the ellipse is met at 0.7 of the corner.
  EXPECT_NEAR(surface->continued(1.9e-3, -0.48), plane(0.7 * 1.9e-3, -0.7 * 0.48), 0.8);
}

TEST(SurfaceInterpolation, a_gaussian_process_is_the_kernel_ridge_and_knows_where_it_is_thin) {
  // Closed form on the same centres: with fewer points than centres each point is one.
  const SurfacePoints p = spiral(200, smooth);
  const auto surface = fit_surface(p, GaussianProcessOptions{}).surface;
  const double known = surface->std(0, 0.05), thin = surface->std(1.95e-3, 0.49);
  EXPECT_GT(thin, 5 * known);
  // Without noise the posterior mean passes through the points, as near as the noise that it found allows.
  for (Index i = 20; i < 180; i += 20)
    EXPECT_NEAR(surface->value(p.y[i], p.v[i]), p.f[i], 6 * surface->std(p.y[i], p.v[i]) + 1e-3);
}

TEST(SurfaceInterpolation, deviations_of_a_gaussian_process_cover_the_truth) {
  // 40 noise realisations at 9 places; 95 % within 2 std, binomial slack because places of one fit are not independent.
  int inside = 0, all = 0;
  for (int seed = 0; seed < 40; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    SurfacePoints p = uniform_points(400, smooth);
    for (double& f : p.f) f += 3 * normal(random);
    const auto surface = fit_surface(p, GaussianProcessOptions{.centres = 150}).surface;
    for (double y : {-1e-3, 0.0, 1e-3})
      for (double v : {-0.25, 0.0, 0.25}) {
        inside += std::abs(surface->value(y, v) - smooth(y, v)) < 2 * surface->std(y, v);
        ++all;
      }
  }
  EXPECT_GT(inside, 0.85 * all);
  EXPECT_LT(inside, all);
}

TEST(SurfaceInterpolation, a_network_cut_short_is_a_result_that_says_so) {
  const SurfacePoints p = uniform_points(800, smooth, 3);
  const FittedSurface fit = fit_surface(p, MlpOptions{.evaluations = 5});
  EXPECT_FALSE(fit.converged);
  EXPECT_EQ(fit.stopped, "stopped after 5 evaluations, not at rest");
  const FittedSurface whole = fit_surface(p, MlpOptions{});
  EXPECT_TRUE(whole.converged) << whole.stopped;
  EXPECT_LT(whole.rmse, fit.rmse);
}

TEST(SurfaceInterpolation, rivals_are_ordered_by_what_they_had_not_seen) {
  const SurfacePoints p = uniform_points(3000, smooth, 3);
  const std::vector<Interpolator> kinds = {
      NearestOptions{.neighbours = 1}, PolynomialOptions{.order_y = 1, .order_v = 1},
      PolynomialOptions{.order_y = 5, .order_v = 5}, PolynomialOptions{.order_y = 20, .order_v = 20}};
  SurfacePoints few = p;
  few.y.conservativeResize(400);
  few.v.conservativeResize(400);
  few.f.conservativeResize(400);
  const auto rivals = compare_surfaces(few, kinds, 4);
  ASSERT_EQ(rivals.size(), 4u);
  EXPECT_EQ(std::get<PolynomialOptions>(rivals[0].how).order_y, 5);
  EXPECT_NEAR(rivals[0].left_out.rmse, 3.1, 0.3);  // the noise, and the fit's share of it
  // 441 coefficients for 400 points: refused, kept with the reason, last.
  EXPECT_EQ(rivals[3].fault, "surface: order {20, 20} has 441 coefficients, got 400 points");
  // On common points: the same part covered for all.
  EXPECT_EQ(rivals[0].left_out.covered, rivals[2].left_out.covered);
}

TEST(SurfaceInterpolation, the_jackknife_gives_the_deviation_of_a_polynomial) {
  // Against the spread over noise realisations, at the middle and near the edge of the data.
  const PolynomialOptions how{.order_y = 3, .order_v = 3, .cells_y = 8, .cells_v = 8};
  const int runs = 60;
  MatrixXd sum = MatrixXd::Zero(8, 8), squares = sum, told = sum;
  for (int seed = 0; seed < runs; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    SurfacePoints p = uniform_points(1600, smooth);
    for (double& f : p.f) f += 3 * normal(random);
    const Interpolator kind = how;
    const auto rivals = compare_surfaces(p, std::span(&kind, 1), 20);
    const MatrixXd f = tabulate(*rivals[0].fit.surface).f;
    sum += f;
    squares += f.cwiseAbs2();
    told += rivals[0].std;
  }
  const MatrixXd spread = ((squares - sum.cwiseAbs2() / runs) / (runs - 1)).cwiseSqrt();
  const double ratio = (told / runs).sum() / spread.sum();
  EXPECT_NEAR(ratio, 1, 0.12);
}

TEST(SurfaceInterpolation, texts_of_what_cannot_be) {
  const SurfacePoints p = uniform_points(200, smooth);
  EXPECT_EQ(message([&] { fit_surface(p, NearestOptions{.neighbours = 0}); }),
            "surface: nearest: neighbours: expected 1 to 1000, got 0");
  EXPECT_EQ(message([&] { fit_surface(p, MlpOptions{.hidden = {}}); }),
            "surface: mlp: hidden: expected 1 to 4 layers, got 0");
  EXPECT_EQ(message([&] {
              fit_surface(p, MlpOptions{.hidden = {20, 0}});
            }),
            "surface: mlp: hidden: expected 1 to 500, got 0");
  EXPECT_EQ(message([&] { fit_surface(p, SupportVectorOptions{.cost = -1}); }),
            "surface: support_vectors: cost: expected > 0, got -1");
  EXPECT_EQ(message([&] { fit_surface(p, ForestOptions{.trees = 0}); }),
            "surface: random_forest: trees: expected 1 to 5000, got 0");
  EXPECT_EQ(message([&] { fit_surface(p, GaussianProcessOptions{.centres = 5}); }),
            "surface: gaussian_process: centres: expected 20 to 3000, got 5");
  EXPECT_EQ(message([&] { compare_surfaces(p, {}, 4); }), "surface: expected at least one kind of interpolation");
  const Interpolator grid = GridOptions{};
  EXPECT_EQ(message([&] { compare_surfaces(p, std::span(&grid, 1), 1); }), "surface: blocks: expected 2 to 200, got 1");
}
