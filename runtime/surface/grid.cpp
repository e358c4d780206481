// Grid surfaces, bilinear or bicubic.
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>

#include "expr/digits.hpp"
#include "surface/surface.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Of the smoothness: weight of first differences, which alone decide where a cell's few points leave a value open.
constexpr double kAnchor = 1e-6;

/// B-splines of one axis that are not zero over a cell.
int splines(Between between) { return between == Between::linear ? 2 : 4; }

/// Their values at the part s of the way through it.
Eigen::Vector4d basis(Between between, double s) {
  if (between == Between::linear) return {1 - s, s, 0, 0};
  const double r = 1 - s;
  return Eigen::Vector4d(r * r * r, 3 * s * s * s - 6 * s * s + 4, 3 * r * r * r - 6 * r * r + 4, s * s * s) / 6;
}

using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 16, 1>;

/// The weights of the coefficients (i + a, j + b) of a cell (i, j), a fastest.
Weights weights(Between between, const Cells::Place& at) {
  const int n = splines(between);
  const Eigen::Vector4d y = basis(between, at.along_y), v = basis(between, at.along_v);
  Weights all(n * n);
  for (int b = 0; b < n; ++b) all.segment(b * n, n) = v[b] * y.head(n);
  return all;
}

/// The normal equations of the coefficients that a cell with data has.
class Coefficients {
 public:
  Coefficients(const Cells& cells, int least_count, Between between)
      : cells_(cells),
        between_(between),
        n_(splines(between)),
        number_(Eigen::MatrixXi::Constant(cells.cells_y() + n_ - 1, cells.cells_v() + n_ - 1, -1)) {
    for (int i = 0; i < cells.cells_y(); ++i)
      for (int j = 0; j < cells.cells_v(); ++j) {
        if (cells.count()(i, j) < least_count) continue;
        ++full_;
        for (int c = 0; c < n_ * n_; ++c)
          if (int& own = number_(i + c % n_, j + c / n_); own < 0) own = unknowns_++;
      }
  }

  int full_cells() const { return full_; }

  void add_points(const SurfacePoints& points, int least_count) {
    right_ = VectorXd::Zero(unknowns_);
    const int across = cells_.cells_v(), size = n_ * n_;
    std::vector<MatrixXd> squares(static_cast<std::size_t>(cells_.cells_y()) * across);
    for (Index k = 0; k < points.size(); ++k) {
      const Cells::Place at = cells_.place(points.y[k], points.v[k]);
      if (cells_.count()(at.i, at.j) < least_count) continue;
      ++used_;
      const Weights w = weights(between_, at);
      MatrixXd& square = squares[static_cast<std::size_t>(at.i * across + at.j)];
      if (square.size() == 0) square = MatrixXd::Zero(size, size);
      square += w * w.transpose();
      for (int c = 0; c < size; ++c) right_[of_cell(at.i, at.j, c)] += w[c] * points.f[k];
    }
    for (int i = 0; i < cells_.cells_y(); ++i)
      for (int j = 0; j < across; ++j) {
        const MatrixXd& square = squares[static_cast<std::size_t>(i * across + j)];
        for (int a = 0; a < square.rows(); ++a)
          for (int b = 0; b < square.cols(); ++b)
            entries_.emplace_back(of_cell(i, j, a), of_cell(i, j, b), square(a, b));
      }
  }

  /// Second differences along each axis; first differences with a far smaller weight.
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
    MatrixXd all = MatrixXd::Constant(number_.rows(), number_.cols(), kNan);
    for (Index i = 0; i < all.rows(); ++i)
      for (Index j = 0; j < all.cols(); ++j)
        if (number_(i, j) >= 0) all(i, j) = x[number_(i, j)];
    return all;
  }

 private:
  int of_cell(int i, int j, int c) const { return number_(i + c % n_, j + c / n_); }
  int at(int i, int j) const { return i < number_.rows() && j < number_.cols() ? number_(i, j) : -1; }

  /// weight * (w . x)^2
  template <std::size_t N>
  void add_square(const std::array<int, N>& n, const std::array<double, N>& w, double weight) {
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b < N; ++b) entries_.emplace_back(n[a], n[b], weight * w[a] * w[b]);
  }

  const Cells& cells_;
  Between between_;
  int n_;
  Eigen::MatrixXi number_;  // of the unknown, -1: none
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
    throw InputError("surface: smoothness: expected > 0, got " + number(options.smoothness));
}

GridSurface::GridSurface(Cells cells, int least_count, Between between, MatrixXd coefficients)
    : ForceSurface(std::move(cells), least_count), between_(between), coefficients_(std::move(coefficients)) {}

double GridSurface::value(const Cells::Place& at) const {
  const int n = splines(between_);
  const Weights w = weights(between_, at);
  double sum = 0;
  for (int c = 0; c < n * n; ++c) sum += w[c] * coefficients_(at.i + c % n, at.j + c / n);
  return sum;
}

double GridSurface::value(double y, double v) const { return has_data(y, v) ? value(cells().place(y, v)) : kNan; }

MatrixXd GridSurface::nodes() const {
  if (between_ == Between::linear) return coefficients_;
  const int last_y = cells().cells_y(), last_v = cells().cells_v();
  MatrixXd all = MatrixXd::Constant(last_y + 1, last_v + 1, kNan);
  for (int i = 0; i < last_y; ++i)
    for (int j = 0; j < last_v; ++j) {
      if (cells().count()(i, j) < least_count()) continue;
      for (const int a : {0, 1})
        for (const int b : {0, 1}) all(i + a, j + b) = value({i, j, static_cast<double>(a), static_cast<double>(b)});
    }
  return all;
}

GridSurface fit_grid(const SurfacePoints& points, const GridOptions& options) {
  validate(options);
  Cells cells(points, options.cells_y, options.cells_v);
  Coefficients coefficients(cells, options.least_count, options.between);
  if (coefficients.full_cells() == 0)
    throw InputError("surface: no cell of the " + std::to_string(options.cells_y) + " x " +
                         std::to_string(options.cells_v) + " grid holds " + std::to_string(options.least_count) +
                         " points: take fewer cells or more of the record",
                     {}, Fault::data);
  coefficients.add_points(points, options.least_count);
  coefficients.add_smoothness(options.smoothness);
  GridSurface surface(cells, options.least_count, options.between, coefficients.solve());

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
