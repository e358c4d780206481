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

/// Middles of the cells along both axes.
std::pair<VectorXd, VectorXd> centres(const Cells& cells) {
  const auto middles = [](double least, double most, int count) {
    VectorXd out(count);
    for (int i = 0; i < count; ++i) out[i] = least + (i + 0.5) * (most - least) / count;
    return out;
  };
  return {middles(cells.y_min(), cells.y_max(), cells.cells_y()),
          middles(cells.v_min(), cells.v_max(), cells.cells_v())};
}

}  // namespace

LeftOut leave_out(const SurfacePoints& points, int blocks, const Cells& cells, const SurfaceFit& fit) {
  if (blocks < 2 || blocks > points.size())
    throw InputError("surface: blocks: expected 2 to " + std::to_string(points.size()) + ", got " +
                     std::to_string(blocks));
  LeftOut out{VectorXd::Constant(points.size(), std::nan("")), {}};
  const auto [y, v] = centres(cells);
  MatrixXd sum = MatrixXd::Zero(y.size(), v.size()), squares = sum, first = sum;
  for (int k = 0; k < blocks; ++k) {
    const Index from = points.size() * k / blocks, to = points.size() * (k + 1) / blocks;
    const std::shared_ptr<const ForceSurface> surface = fit(without(points, from, to));
    for (Index i = from; i < to; ++i)
      if (surface->has_data(points.y[i], points.v[i])) out.predicted[i] = surface->value(points.y[i], points.v[i]);
    for (Index i = 0; i < y.size(); ++i)
      for (Index j = 0; j < v.size(); ++j) {
        const double f = surface->has_data(y[i], v[j]) ? surface->value(y[i], v[j]) : std::nan("");
        if (k == 0) first(i, j) = f;
        const double off = f - first(i, j);  // about one of them: the square of the level would cancel digits
        sum(i, j) += off;
        squares(i, j) += off * off;
      }
  }
  // The jackknife of Tukey (1958) over blocks: what the fits without one block differ by, times blocks - 1.
  const double n = blocks;
  out.std = ((squares.array() - sum.array().square() / n).max(0) * ((n - 1) / n)).sqrt();
  return out;
}

SurfaceScore score(const SurfacePoints& points, const VectorXd& predicted) {
  std::vector<double> measured;
  double rss = 0;
  for (Index i = 0; i < points.size(); ++i) {
    if (std::isnan(predicted[i])) continue;
    rss += (points.f[i] - predicted[i]) * (points.f[i] - predicted[i]);
    measured.push_back(points.f[i]);
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
  const auto [y, v] = centres(cells);
  SurfaceTable out{y, v, MatrixXd(ny, nv), cells.count()};
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
