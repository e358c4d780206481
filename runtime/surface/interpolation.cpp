#include "surface/interpolation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "expr/digits.hpp"
#include "surface/kinds.hpp"

namespace lunid {

using detail::Learnt;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};

void expect(bool good, const char* kind, const char* field, const std::string& range, const std::string& got) {
  if (!good) throw InputError(std::string("surface: ") + kind + ": " + field + ": expected " + range + ", got " + got);
}

void expect_integer(const char* kind, const char* field, int value, int least, int most) {
  expect(value >= least && value <= most, kind, field, std::to_string(least) + " to " + std::to_string(most),
         std::to_string(value));
}

void check(const NearestOptions& o) { expect_integer("nearest", "neighbours", o.neighbours, 1, 1000); }

void check(const TriangulationOptions& o) { expect_integer("triangulation", "cells", o.cells, 2, 300); }

void check(const MlpOptions& o) {
  expect(!o.hidden.empty() && o.hidden.size() <= 4, "mlp", "hidden", "1 to 4 layers", std::to_string(o.hidden.size()));
  for (const int units : o.hidden) expect_integer("mlp", "hidden", units, 1, 500);
  expect(o.penalty >= 0 && std::isfinite(o.penalty), "mlp", "penalty", ">= 0", number(o.penalty));
  expect(o.evaluations >= 1, "mlp", "evaluations", ">= 1", std::to_string(o.evaluations));
}

void check(const GaussianProcessOptions& o) { expect_integer("gaussian_process", "centres", o.centres, 20, 3000); }

void check(const SupportVectorOptions& o) {
  expect(o.cost > 0 && std::isfinite(o.cost), "support_vectors", "cost", "> 0", number(o.cost));
  expect(o.epsilon >= 0 && std::isfinite(o.epsilon), "support_vectors", "epsilon", ">= 0", number(o.epsilon));
  if (o.width) expect(*o.width > 0 && std::isfinite(*o.width), "support_vectors", "width", "> 0", number(*o.width));
  expect_integer("support_vectors", "centres", o.centres, 20, 3000);
}

void check(const ForestOptions& o) {
  expect_integer("random_forest", "trees", o.trees, 1, 5000);
  expect(o.least_leaf >= 1, "random_forest", "least_leaf", ">= 1", std::to_string(o.least_leaf));
}

/// The two kinds that Surface has of its own validate themselves.
void check(const PolynomialOptions& o) { validate(o); }
void check(const GridOptions& o) { validate(o); }

Learnt learn(const SurfacePoints& points, const Interpolator& how) {
  return std::visit(
      Overloaded{[&](const PolynomialOptions& o) -> Learnt {
                   return {std::make_shared<PolynomialSurface>(fit_polynomial(points, o))};
                 },
                 [&](const GridOptions& o) -> Learnt { return {std::make_shared<GridSurface>(fit_grid(points, o))}; },
                 [&](const NearestOptions& o) { return detail::nearest(points, o); },
                 [&](const TriangulationOptions& o) { return detail::triangulation(points, o); },
                 [&](const MlpOptions& o) { return detail::mlp(points, o); },
                 [&](const GaussianProcessOptions& o) { return detail::gaussian_process(points, o); },
                 [&](const SupportVectorOptions& o) { return detail::support_vectors(points, o); },
                 [&](const ForestOptions& o) { return detail::forest(points, o); }},
      how);
}

/// The values of a surface at points, NaN where it has no data.
VectorXd values(const ForceSurface& surface, const SurfacePoints& points) {
  VectorXd out(points.size());
  for (Index k = 0; k < points.size(); ++k)
    out[k] = surface.has_data(points.y[k], points.v[k]) ? surface.value(points.y[k], points.v[k]) : std::nan("");
  return out;
}

}  // namespace

void validate(const Interpolator& how) {
  std::visit([](const auto& options) { check(options); }, how);
}

std::string name_of(const Interpolator& how) {
  static constexpr const char* names[] = {"polynomial",     "bilinear grid",    "nearest neighbours", "triangulation",
                                          "neural network", "Gaussian process", "support vectors",    "random forest"};
  const auto* grid = std::get_if<GridOptions>(&how);
  return grid && grid->between == Between::cubic ? "bicubic grid" : names[how.index()];
}

bool is_smooth(const Interpolator& how) {
  return std::visit(
      Overloaded{[](const PolynomialOptions&) { return true; }, [](const MlpOptions&) { return true; },
                 [](const GaussianProcessOptions&) { return true; }, [](const SupportVectorOptions&) { return true; },
                 [](const GridOptions& o) { return o.between == Between::cubic; }, [](const auto&) { return false; }},
      how);
}

FittedSurface fit_surface(const SurfacePoints& points, const Interpolator& how) {
  validate(how);
  const auto start = std::chrono::steady_clock::now();
  Learnt learnt = learn(points, how);
  FittedSurface out;
  out.surface = std::move(learnt.surface);
  out.stopped = std::move(learnt.stopped);
  out.converged = learnt.converged;
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const SurfaceScore on_fit = score(points, values(*out.surface, points));
  out.rmse = on_fit.rmse;
  out.r2 = on_fit.r2;
  return out;
}

std::vector<SurfaceRival> compare_surfaces(const SurfacePoints& points, std::span<const Interpolator> kinds,
                                           int blocks) {
  if (kinds.empty()) throw InputError("surface: expected at least one kind of interpolation");
  std::vector<SurfaceRival> rivals;
  std::vector<VectorXd> predicted;
  for (const Interpolator& how : kinds) {
    SurfaceRival rival{how, {}, {}, {}, {}};
    predicted.emplace_back();
    try {
      rival.fit = fit_surface(points, how);
      LeftOut left = leave_out(points, blocks, rival.fit.surface->cells(),
                               [&](const SurfacePoints& part) { return learn(part, how).surface; });
      rival.std = std::move(left.std);
      predicted.back() = std::move(left.predicted);
    } catch (const InputError& fault) {
      if (kinds.size() == 1) throw;
      rival.fit = {};
      rival.fault = fault.what();
    }
    rivals.push_back(std::move(rival));
  }
  if (std::all_of(rivals.begin(), rivals.end(), [](const SurfaceRival& r) { return !r.fault.empty(); }))
    throw InputError(rivals.front().fault, {}, Fault::data);
  VectorXd common = VectorXd::Zero(points.size());  // NaN where one of them has no data
  for (const VectorXd& each : predicted)
    if (each.size() > 0) common += each;
  for (std::size_t k = 0; k < rivals.size(); ++k)
    if (rivals[k].fault.empty())
      rivals[k].left_out = score(points, common.array().isNaN().select(common, predicted[k]));
  std::stable_sort(rivals.begin(), rivals.end(), [](const SurfaceRival& a, const SurfaceRival& b) {
    if (a.fault.empty() != b.fault.empty()) return a.fault.empty();
    return a.left_out.rmse < b.left_out.rmse;
  });
  return rivals;
}

}  // namespace lunid
