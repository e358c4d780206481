// Bilinear grid surfaces.
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>

#include "surface/number.hpp"
#include "surface/surface.hpp"

namespace lunid {

using detail::number;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Of the smoothness: weight of first differences, which alone decide where a cell's few points leave a corner open.
constexpr double kAnchor = 1e-6;

/// Bilinear weights of a cell's corners (i, j), (i+1, j), (i, j+1), (i+1, j+1).
std::array<double, 4> weights(const Cells::Place& at) {
  const double s = at.along_y, t = at.along_v;
  return {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
}

/// The normal equations of the corners that touch a cell with data.
class Corners {
 public:
  Corners(const Cells& cells, int least_count)
      : cells_(cells), number_(Eigen::MatrixXi::Constant(cells.cells_y() + 1, cells.cells_v() + 1, -1)) {
    for (int i = 0; i < cells.cells_y(); ++i)
      for (int j = 0; j < cells.cells_v(); ++j) {
        if (cells.count()(i, j) < least_count) continue;
        ++full_;
        for (const auto& [di, dj] : kCorner)
          if (number_(i + di, j + dj) < 0) number_(i + di, j + dj) = unknowns_++;
      }
  }

  int full_cells() const { return full_; }

  void add_points(const SurfacePoints& points, int least_count) {
    right_ = VectorXd::Zero(unknowns_);
    const int across = cells_.cells_v();
    std::vector<Eigen::Matrix4d> squares(static_cast<std::size_t>(cells_.cells_y()) * across, Eigen::Matrix4d::Zero());
    for (Index k = 0; k < points.size(); ++k) {
      const Cells::Place at = cells_.place(points.y[k], points.v[k]);
      if (cells_.count()(at.i, at.j) < least_count) continue;
      ++used_;
      const auto w = weights(at);
      const Eigen::Map<const Eigen::Vector4d> column(w.data());
      squares[static_cast<std::size_t>(at.i * across + at.j)] += column * column.transpose();
      for (int c = 0; c < 4; ++c) right_[corner(at.i, at.j, c)] += w[c] * points.f[k];
    }
    for (int i = 0; i < cells_.cells_y(); ++i)
      for (int j = 0; j < across; ++j) {
        if (cells_.count()(i, j) < least_count) continue;
        const Eigen::Matrix4d& square = squares[static_cast<std::size_t>(i * across + j)];
        for (int a = 0; a < 4; ++a)
          for (int b = 0; b < 4; ++b) entries_.emplace_back(corner(i, j, a), corner(i, j, b), square(a, b));
      }
  }

  /// Second differences among corners with data, along each axis; first differences with a far smaller weight.
  void add_smoothness(double smoothness) {
    const double weight = smoothness * static_cast<double>(used_) / full_;
    for (int i = 0; i < number_.rows(); ++i)
      for (int j = 0; j < number_.cols(); ++j)
        for (const auto& [di, dj] : {std::array{1, 0}, std::array{0, 1}}) {
          const int a = at(i, j), b = at(i + di, j + dj), c = at(i + 2 * di, j + 2 * dj);
          if (a >= 0 && b >= 0) add_square(std::array{a, b}, std::array{1.0, -1.0}, kAnchor * weight);
          if (a >= 0 && b >= 0 && c >= 0) add_square(std::array{a, b, c}, std::array{1.0, -2.0, 1.0}, weight);
        }
  }

  MatrixXd solve() const {
    Eigen::SparseMatrix<double> matrix(unknowns_, unknowns_);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const VectorXd x = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right_);
    MatrixXd nodes = MatrixXd::Constant(number_.rows(), number_.cols(), kNan);
    for (Index i = 0; i < nodes.rows(); ++i)
      for (Index j = 0; j < nodes.cols(); ++j)
        if (number_(i, j) >= 0) nodes(i, j) = x[number_(i, j)];
    return nodes;
  }

 private:
  static constexpr std::array<std::array<int, 2>, 4> kCorner = {{{0, 0}, {1, 0}, {0, 1}, {1, 1}}};

  int corner(int i, int j, int c) const { return number_(i + kCorner[c][0], j + kCorner[c][1]); }
  int at(int i, int j) const { return i < number_.rows() && j < number_.cols() ? number_(i, j) : -1; }

  /// weight * (w . x)^2
  template <std::size_t N>
  void add_square(const std::array<int, N>& n, const std::array<double, N>& w, double weight) {
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b < N; ++b) entries_.emplace_back(n[a], n[b], weight * w[a] * w[b]);
  }

  const Cells& cells_;
  Eigen::MatrixXi number_;  // of the unknown at each corner, -1: none
  int unknowns_ = 0, full_ = 0;
  Index used_ = 0;
  std::vector<Eigen::Triplet<double>> entries_;
  VectorXd right_;
};

}  // namespace

void validate(const GridOptions& options) {
  for (const auto& [name, value] : {std::pair{"cells_y", options.cells_y}, std::pair{"cells_v", options.cells_v}})
    if (value < 1 || value > 300)
      throw InputError(std::string("surface: ") + name + ": expected 1 to 300, got " + std::to_string(value));
  if (options.least_count < 1)
    throw InputError("surface: least_count: expected >= 1, got " + std::to_string(options.least_count));
  if (!(options.smoothness > 0) || std::isinf(options.smoothness))
    throw InputError("surface: smoothness: expected > 0, got " + number(options.smoothness, 6));
}

GridSurface::GridSurface(Cells cells, int least_count, MatrixXd nodes)
    : ForceSurface(std::move(cells), least_count), nodes_(std::move(nodes)) {}

double GridSurface::value(double y, double v) const {
  if (!has_data(y, v)) return kNan;
  const Cells::Place at = cells().place(y, v);
  const auto w = weights(at);
  return w[0] * nodes_(at.i, at.j) + w[1] * nodes_(at.i + 1, at.j) + w[2] * nodes_(at.i, at.j + 1) +
         w[3] * nodes_(at.i + 1, at.j + 1);
}

GridSurface fit_grid(const SurfacePoints& points, const GridOptions& options) {
  validate(options);
  Cells cells(points, options.cells_y, options.cells_v);
  Corners corners(cells, options.least_count);
  if (corners.full_cells() == 0)
    throw InputError("surface: no cell of the " + std::to_string(options.cells_y) + " x " +
                         std::to_string(options.cells_v) + " grid holds " + std::to_string(options.least_count) +
                         " points: take fewer cells or more of the record",
                     {}, Fault::data);
  corners.add_points(points, options.least_count);
  corners.add_smoothness(options.smoothness);
  GridSurface surface(cells, options.least_count, corners.solve());

  double rss = 0, sum = 0, squares = 0;
  Index used = 0;
  for (Index k = 0; k < points.size(); ++k) {
    const double model = surface.value(points.y[k], points.v[k]);
    if (std::isnan(model)) continue;
    const double off = points.f[k] - points.f[0];  // about a point: the mean's square would cancel digits
    rss += (points.f[k] - model) * (points.f[k] - model);
    sum += off;
    squares += off * off;
    ++used;
  }
  const double n = static_cast<double>(used), total = squares - sum * sum / n;
  surface.rmse = std::sqrt(rss / n);
  surface.r2 = total > 0 ? 1 - rss / total : kNan;
  return surface;
}

}  // namespace lunid
