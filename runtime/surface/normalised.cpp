#include "surface/normalised.hpp"

#include <algorithm>
#include <cmath>

namespace lunid::detail {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

int cell_of(double x, int cells) { return std::clamp(static_cast<int>((x + 1) / 2 * cells), 0, cells - 1); }

/// Cells of the grid that hold points.
Index occupied(const SurfacePoints& points, const Frame& frame, int cells) {
  std::vector<char> full(static_cast<std::size_t>(cells) * cells);
  for (Index k = 0; k < points.size(); ++k) {
    const auto x = frame(points.y[k], points.v[k]);
    full[static_cast<std::size_t>(cell_of(x[0], cells)) * cells + cell_of(x[1], cells)] = 1;
  }
  return std::count(full.begin(), full.end(), 1);
}

}  // namespace

Centres cell_means(const SurfacePoints& points, const Frame& frame, int cells) {
  const Index all = static_cast<Index>(cells) * cells;
  Eigen::Matrix4Xd sums = Eigen::Matrix4Xd::Zero(4, all);
  for (Index k = 0; k < points.size(); ++k) {
    const auto x = frame(points.y[k], points.v[k]);
    sums.col(static_cast<Index>(cell_of(x[0], cells)) * cells + cell_of(x[1], cells)) +=
        Eigen::Vector4d(x[0], x[1], points.f[k], 1);
  }
  const Index full = (sums.row(3).array() > 0).count();
  Centres out{Eigen::Matrix2Xd(2, full), VectorXd(full), VectorXd(full)};
  for (Index c = 0, k = 0; c < all; ++c) {
    const double count = sums(3, c);
    if (count == 0) continue;
    out.at.col(k) = sums.col(c).head<2>() / count;
    out.f[k] = sums(2, c) / count;
    out.weight[k++] = count;
  }
  return out;
}

Centres cell_means_at_most(const SurfacePoints& points, const Frame& frame, int most) {
  int fine = std::max(2, static_cast<int>(std::sqrt(most)));  // holds: cells^2 <= most
  int coarse = 300;
  if (occupied(points, frame, coarse) <= most) return cell_means(points, frame, coarse);
  while (coarse - fine > 1) {  // occupied(fine) <= most < occupied(coarse)
    const int middle = (fine + coarse) / 2;
    (occupied(points, frame, middle) <= most ? fine : coarse) = middle;
  }
  return cell_means(points, frame, fine);
}

Level::Level(const VectorXd& f, const VectorXd& weight) : mean(f.dot(weight) / weight.sum()), spread(1) {
  const double square = (f.array() - mean).square().matrix().dot(weight) / weight.sum();
  if (square > 0) spread = std::sqrt(square);
}

}  // namespace lunid::detail
