// Chebyshev expansion by quadrature, truncation, sections.
#include <gtest/gtest.h>

#include "message.hpp"
#include "surface/interpolation.hpp"
#include "surface_samples.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A surface that is a formula over the whole rectangle of its data.
class Formula : public ForceSurface {
 public:
  Formula(const SurfacePoints& p, std::function<double(double, double)> f)
      : ForceSurface(Cells(p, 20, 20), 1), f_(std::move(f)) {}
  std::string name() const override { return "formula"; }
  double value(double y, double v) const override { return f_(y, v); }

 private:
  std::function<double(double, double)> f_;
};

/// Points over -1..1 in both coordinates, corners included.
SurfacePoints square(const std::function<double(double, double)>& f) {
  const int n = 60;
  SurfacePoints p{VectorXd(n * n), VectorXd(n * n), VectorXd(n * n)};
  for (int i = 0, k = 0; i < n; ++i)
    for (int j = 0; j < n; ++j, ++k) {
      p.y[k] = -1 + 2.0 * i / (n - 1);
      p.v[k] = -1 + 2.0 * j / (n - 1);
      p.f[k] = f(p.y[k], p.v[k]);
    }
  return p;
}

}  // namespace

TEST(SurfaceExpansion, a_polynomial_is_exact) {
  // T_3(y) T_2(v) = (4 y^3 - 3 y)(2 v^2 - 1), and a constant: only these coefficients.
  const auto f = [](double y, double v) { return 7 + 2 * (4 * y * y * y - 3 * y) * (2 * v * v - 1); };
  const Expansion e = expand_by_quadrature(Formula(square(f), f), 5, 5, 12);
  MatrixXd expected = MatrixXd::Zero(6, 6);
  expected(0, 0) = 7;
  expected(3, 2) = 2;
  EXPECT_LT((e.polynomial.chebyshev() - expected).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT(e.truncation, 1e-13);
  EXPECT_EQ(e.continued, 0);
  // In powers: 7 + 2 (4 y^3 - 3 y)(2 v^2 - 1)
  const MatrixXd m = e.polynomial.monomials();
  EXPECT_NEAR(m(3, 2), 16, 1e-12);
  EXPECT_NEAR(m(1, 0), 6, 1e-12);
  EXPECT_NEAR(m(0, 0), 7, 1e-12);
}

TEST(SurfaceExpansion, tanh_has_the_coefficients_of_the_integral) {
  // Against the integral (2/pi) int_0^pi tanh(3 cos u) cos(n u) du by Simpson's rule on 2000 parts.
  const auto f = [](double y, double) { return std::tanh(3 * y); };
  const Expansion e = expand_by_quadrature(Formula(square(f), f), 9, 0, 100);
  for (int n = 1; n <= 9; ++n) {
    double sum = 0;
    const int parts = 2000;
    for (int k = 0; k <= parts; ++k) {
      const double u = M_PI * k / parts, weight = k == 0 || k == parts ? 1 : k % 2 == 1 ? 4 : 2;
      sum += weight * std::tanh(3 * std::cos(u)) * std::cos(n * u);
    }
    EXPECT_NEAR(e.polynomial.chebyshev()(n, 0), 2 / M_PI * sum * M_PI / parts / 3, 1e-10) << n;
  }
  // What is left is of the size of the first coefficient left out, over sqrt 2; the next ones add a little.
  const double next = expand_by_quadrature(Formula(square(f), f), 11, 0, 100).polynomial.chebyshev()(11, 0);
  EXPECT_NEAR(e.truncation / (std::abs(next) / std::sqrt(2)), 1, 0.3);
}

TEST(SurfaceExpansion, places_without_data_are_continued_and_counted) {
  const auto f = [](double y, double v) { return 2e4 * y + 10 * v; };
  const FittedSurface grid = fit_surface(spiral(20000, f), GridOptions{});
  const Expansion e = expand_by_quadrature(*grid.surface, 3, 3);
  EXPECT_GT(e.continued, 0.2);  // the corners beyond the ellipse, where the nodes are dense
  EXPECT_LT(e.continued, 0.6);
  EXPECT_GT(e.truncation, 0);
  // Regression on the data itself does not need them.
  EXPECT_LT(truncation(fit_polynomial(spiral(20000, f), {.order_y = 3, .order_v = 3}), *grid.surface), e.truncation);
}

TEST(SurfaceExpansion, orders_and_nodes_are_checked) {
  const auto f = [](double y, double v) { return y * v; };
  const Formula surface(square(f), f);
  EXPECT_EQ(message([&] { expand_by_quadrature(surface, 8, 4, 6); }),
            "surface: nodes: expected 9 (the larger order + 1) to 200, got 6");
  EXPECT_EQ(message([&] { expand_by_quadrature(surface, 21, 4); }), "surface: order_y: expected 0 to 20, got 21");
}

TEST(SurfaceSection, cuts_along_either_axis_with_the_points_near_it) {
  const auto f = [](double y, double v) { return 2e4 * y + 10 * v; };
  const SurfacePoints p = spiral(20000, f);
  const FittedSurface grid = fit_surface(p, GridOptions{});
  const SurfaceSection along_y = section(*grid.surface, p, true, 0.1, 51);
  for (Index k = 0; k < 51; ++k)
    if (!std::isnan(along_y.f[k])) {
      EXPECT_NEAR(along_y.f[k], f(along_y.place[k], 0.1), 1e-5);
    }
  EXPECT_TRUE(std::isnan(section(*grid.surface, p, true, 0.4).f[0]));  // beyond the ellipse
  ASSERT_GT(along_y.points_place.size(), 500);
  for (Index k = 0; k < along_y.points_place.size(); ++k)
    EXPECT_NEAR(along_y.points_f[k], f(along_y.points_place[k], 0.1), 10 * along_y.half_width + 1e-9);
  const SurfaceSection along_v = section(*grid.surface, p, false, 0.5e-3, 11, 1e-4);
  EXPECT_EQ(along_v.half_width, 1e-4);
  EXPECT_NEAR(along_v.f[5], f(0.5e-3, along_v.place[5]), 1e-5);
  EXPECT_EQ(message([&] { section(*grid.surface, p, true, 0.7); }).substr(0, 52),
            "surface: section: v: expected within the data, -0.49");
  EXPECT_EQ(message([&] { section(*grid.surface, p, true, 0, 1); }), "surface: section: count: expected >= 2, got 1");
}
