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
  TriangleSurface(Cells cells, Centres data, std::vector<std::array<int, 3>> triangles)
      : ForceSurface(std::move(cells), 1),
        frame_(this->cells()),
        data_(std::move(data)),
        triangles_(std::move(triangles)) {
    around_.resize(static_cast<std::size_t>(kSide) * kSide);
    for (std::size_t k = 0; k < triangles_.size(); ++k) {
      Eigen::AlignedBox2d box;
      for (const int corner : triangles_[k]) box.extend(data_.at.col(corner));
      for (int i = side(box.min()[0]); i <= side(box.max()[0]); ++i)
        for (int j = side(box.min()[1]); j <= side(box.max()[1]); ++j)
          around_[static_cast<std::size_t>(i) * kSide + j].push_back(static_cast<int>(k));
    }
  }

  std::string name() const override { return "triangulation"; }

  double value(double y, double v) const override {
    Eigen::Vector3d share;
    const std::array<int, 3>* corners = find(frame_(y, v), share);
    if (!corners) return std::nan("");
    return share[0] * data_.f[(*corners)[0]] + share[1] * data_.f[(*corners)[1]] + share[2] * data_.f[(*corners)[2]];
  }

 private:
  static constexpr int kSide = 64;  // of the grid that lists the triangles near a place

  static int side(double x) { return std::clamp(static_cast<int>((x + 1) / 2 * kSide), 0, kSide - 1); }

  /// The triangle that holds x and the barycentric coordinates in it; nullptr outside the hull.
  const std::array<int, 3>* find(const Vector2d& x, Eigen::Vector3d& share) const {
    constexpr double edge = -1e-12;  // a place on an edge belongs to both triangles to rounding
    for (const int k : around_[static_cast<std::size_t>(side(x[0])) * kSide + side(x[1])]) {
      const auto& corners = triangles_[static_cast<std::size_t>(k)];
      const Vector2d a = data_.at.col(corners[0]), b = data_.at.col(corners[1]), c = data_.at.col(corners[2]);
      Eigen::Matrix2d sides;
      sides << b - a, c - a;
      const Vector2d part = sides.inverse() * (x - a);
      share << 1 - part.sum(), part;
      if (share.minCoeff() >= edge) return &corners;
    }
    return nullptr;
  }

  Frame frame_;
  Centres data_;
  std::vector<std::array<int, 3>> triangles_;
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
  std::vector<std::array<int, 3>> triangles = open_learners()->triangulate(data.at);
  return {std::make_shared<TriangleSurface>(cells, data, std::move(triangles))};
}

}  // namespace lunid::detail
