// Planes over Delaunay triangles.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "surface/kinds.hpp"
#include "surface/learners.hpp"
#include "surface/normalised.hpp"

namespace lunid::detail {

using Eigen::Index;
using Eigen::Vector2d;

namespace {

class TriangleSurface : public ForceSurface {
 public:
  TriangleSurface(Cells cells, const Centres& data, const std::vector<std::array<int, 3>>& triangles)
      : ForceSurface(std::move(cells), 1), frame_(this->cells()) {
    around_.resize(static_cast<std::size_t>(kSide) * kSide);
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const auto& [a, b, c] = triangles[k];
      Eigen::Matrix2d sides;
      sides << data.at.col(b) - data.at.col(a), data.at.col(c) - data.at.col(a);
      triangles_.push_back({data.at.col(a), sides.inverse(), {data.f[a], data.f[b], data.f[c]}});
      Eigen::AlignedBox2d box;
      for (const int corner : triangles[k]) box.extend(data.at.col(corner));
      for (int i = side(box.min()[0]); i <= side(box.max()[0]); ++i)
        for (int j = side(box.min()[1]); j <= side(box.max()[1]); ++j)
          around_[static_cast<std::size_t>(i) * kSide + j].push_back(static_cast<int>(k));
    }
  }

  std::string name() const override { return "triangulation"; }

  double value(double y, double v) const override {
    const Vector2d x = frame_(y, v);
    constexpr double edge = -1e-12;  // a place on an edge belongs to both triangles to rounding
    for (const int k : around_[static_cast<std::size_t>(side(x[0])) * kSide + side(x[1])]) {
      const Triangle& triangle = triangles_[static_cast<std::size_t>(k)];
      const Vector2d part = triangle.inverse * (x - triangle.corner);
      const Eigen::Vector3d share(1 - part.sum(), part[0], part[1]);
      if (share.minCoeff() >= edge) return share.dot(triangle.f);
    }
    return std::nan("");  // outside the hull
  }

 private:
  static constexpr int kSide = 64;  // of the grid that lists the triangles near a place

  static int side(double x) { return std::clamp(static_cast<int>((x + 1) / 2 * kSide), 0, kSide - 1); }

  /// Its first corner, the map from there to shares of the other two, and the forces at all three.
  struct Triangle {
    Vector2d corner;
    Eigen::Matrix2d inverse;
    Eigen::Vector3d f;
  };

  Frame frame_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<int>> around_;
};

}  // namespace

Learnt triangulation(const SurfacePoints& points, const TriangulationOptions& options) {
  const Cells cells(points, kCells, kCells);
  const Centres data = cell_means(points, Frame(cells), options.cells);
  if (data.size() < 3)
    throw InputError(
        "surface: triangulation: " + std::to_string(data.size()) + " cells hold points, expected 3 or more", {},
        Fault::data);
  return {std::make_shared<TriangleSurface>(cells, data, open_learners()->triangulate(data.at))};
}

}  // namespace lunid::detail
