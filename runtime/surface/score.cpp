#include <cmath>

#include "surface/surface.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

SurfacePoints without(const SurfacePoints& p, Index from, Index to) {
  const Index after = p.size() - to, rows = from + after;
  SurfacePoints out{VectorXd(rows), VectorXd(rows), VectorXd(rows)};
  out.y << p.y.head(from), p.y.tail(after);
  out.v << p.v.head(from), p.v.tail(after);
  out.f << p.f.head(from), p.f.tail(after);
  return out;
}

}  // namespace

SurfaceScore score_left_out(const SurfacePoints& points, int blocks, const SurfaceFit& fit) {
  if (blocks < 2 || blocks > points.size())
    throw InputError("surface: blocks: expected 2 to " + std::to_string(points.size()) + ", got " +
                     std::to_string(blocks));
  std::vector<double> measured;
  double rss = 0;
  for (int k = 0; k < blocks; ++k) {
    const Index from = points.size() * k / blocks, to = points.size() * (k + 1) / blocks;
    const std::unique_ptr<ForceSurface> surface = fit(without(points, from, to));
    for (Index i = from; i < to; ++i) {
      if (!surface->has_data(points.y[i], points.v[i])) continue;
      const double off = points.f[i] - surface->value(points.y[i], points.v[i]);
      rss += off * off;
      measured.push_back(points.f[i]);
    }
  }
  SurfaceScore score;
  score.covered = static_cast<double>(measured.size()) / static_cast<double>(points.size());
  score.r2 = score.rmse = std::nan("");
  if (measured.empty()) return score;
  const Eigen::Map<const VectorXd> f(measured.data(), static_cast<Index>(measured.size()));
  const double total = (f.array() - f.mean()).matrix().squaredNorm();
  score.rmse = std::sqrt(rss / static_cast<double>(measured.size()));
  if (total > 0) score.r2 = 1 - rss / total;
  return score;
}

SurfaceTable tabulate(const ForceSurface& surface) {
  const Cells& cells = surface.cells();
  const int ny = cells.cells_y(), nv = cells.cells_v();
  SurfaceTable out{VectorXd(ny), VectorXd(nv), MatrixXd(ny, nv), cells.count()};
  for (int i = 0; i < ny; ++i) out.y[i] = cells.y_min() + (i + 0.5) * (cells.y_max() - cells.y_min()) / ny;
  for (int j = 0; j < nv; ++j) out.v[j] = cells.v_min() + (j + 0.5) * (cells.v_max() - cells.v_min()) / nv;
  for (int i = 0; i < ny; ++i)
    for (int j = 0; j < nv; ++j)
      out.f(i, j) = cells.count()(i, j) >= surface.least_count() ? surface.value(out.y[i], out.v[j]) : std::nan("");
  return out;
}

MatrixXd SurfaceTable::rows() const {
  MatrixXd out(f.size(), 4);
  Index row = 0;
  for (Index i = 0; i < f.rows(); ++i)
    for (Index j = 0; j < f.cols(); ++j) out.row(row++) << y[i], v[j], f(i, j), static_cast<double>(count(i, j));
  return out;
}

}  // namespace lunid
