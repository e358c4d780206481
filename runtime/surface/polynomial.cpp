// Polynomial surfaces in Chebyshev form.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "surface/chebyshev.hpp"
#include "surface/surface.hpp"

namespace lunid {

using detail::chebyshev_values;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index kBlock = 512;
/// Columns of length 1 whose part beside the others is below this are not told apart by the points: their coefficients
/// would carry the force's noise a hundred million times enlarged.
constexpr double kRank = 1e-8;

/// Map of min..max to -1..1.
struct Scale {
  double slope, shift;
  Scale(double min, double max) : slope(2 / (max - min)), shift(-(max + min) / (max - min)) {}
  double operator()(double x) const { return slope * x + shift; }
};

/// Column n holds the coefficients of T_n(slope*x + shift) in powers of x.
MatrixXd chebyshev_powers(const Scale& scale, int order) {
  MatrixXd p = MatrixXd::Zero(order + 1, order + 1);
  p(0, 0) = 1;
  const auto times_x = [&](Index n) {  // (slope*x + shift) * p_n
    VectorXd out = scale.shift * p.col(n);
    for (Index i = 0; i < order; ++i) out[i + 1] += scale.slope * p(i, n);
    return out;
  };
  if (order > 0) p.col(1) = times_x(0);
  for (Index n = 2; n <= order; ++n) p.col(n) = 2 * times_x(n - 1) - p.col(n - 2);
  return p;
}

/// The triangular factor of [basis, f], block by block.
MatrixXd factor(const SurfacePoints& points, const Cells& cells, const PolynomialOptions& o) {
  const Index columns = static_cast<Index>(o.order_y + 1) * (o.order_v + 1) + 1;
  const Scale scale_y(cells.y_min(), cells.y_max()), scale_v(cells.v_min(), cells.v_max());
  MatrixXd r = MatrixXd::Zero(columns, columns), stack;
  VectorXd ty(o.order_y + 1), tv(o.order_v + 1);
  for (Index first = 0; first < points.size(); first += kBlock) {
    const Index rows = std::min(kBlock, points.size() - first);
    stack.resize(columns + rows, columns);
    stack.topRows(columns) = r;
    for (Index k = 0; k < rows; ++k) {
      chebyshev_values(scale_y(points.y[first + k]), o.order_y, ty.data());
      chebyshev_values(scale_v(points.v[first + k]), o.order_v, tv.data());
      for (Index i = 0; i < ty.size(); ++i)
        stack.row(columns + k).segment(i * tv.size(), tv.size()) = ty[i] * tv.transpose();
      stack(columns + k, columns - 1) = points.f[first + k];
    }
    r = Eigen::HouseholderQR<MatrixXd>(stack).matrixQR().topRows(columns).triangularView<Eigen::Upper>();
  }
  return r;
}

[[noreturn]] void refuse_rank(Index rank, const PolynomialOptions& o) {
  throw InputError("surface: the points determine " + std::to_string(rank) + " of the " +
                       std::to_string((o.order_y + 1) * (o.order_v + 1)) + " coefficients of order {" +
                       std::to_string(o.order_y) + ", " + std::to_string(o.order_v) +
                       "}: they lie on a curve (one frequency, one amplitude?), lower the order or take more of the "
                       "record",
                   {}, Fault::data);
}

void check_range(const char* name, int value, int least, int greatest) {
  if (value < least || value > greatest)
    throw InputError(std::string("surface: ") + name + ": expected " + std::to_string(least) + " to " +
                     std::to_string(greatest) + ", got " + std::to_string(value));
}

}  // namespace

void validate(const PolynomialOptions& options) {
  check_range("order_y", options.order_y, 0, 20);
  check_range("order_v", options.order_v, 0, 20);
  check_range("cells_y", options.cells_y, 1, 1000);
  check_range("cells_v", options.cells_v, 1, 1000);
}

PolynomialSurface::PolynomialSurface(Cells cells, MatrixXd chebyshev)
    : ForceSurface(std::move(cells), 1), chebyshev_(std::move(chebyshev)) {}

double PolynomialSurface::value(double y, double v) const {
  double ty[21], tv[21];  // orders are at most 20
  const int order_y = static_cast<int>(chebyshev_.rows()) - 1, order_v = static_cast<int>(chebyshev_.cols()) - 1;
  chebyshev_values(Scale(cells().y_min(), cells().y_max())(y), order_y, ty);
  chebyshev_values(Scale(cells().v_min(), cells().v_max())(v), order_v, tv);
  double sum = 0;
  for (int i = 0; i <= order_y; ++i)
    for (int j = 0; j <= order_v; ++j) sum += chebyshev_(i, j) * ty[i] * tv[j];
  return sum;
}

MatrixXd PolynomialSurface::monomials() const {
  const MatrixXd in_y =
      chebyshev_powers(Scale(cells().y_min(), cells().y_max()), static_cast<int>(chebyshev_.rows()) - 1);
  const MatrixXd in_v =
      chebyshev_powers(Scale(cells().v_min(), cells().v_max()), static_cast<int>(chebyshev_.cols()) - 1);
  return in_y * chebyshev_ * in_v.transpose();
}

Expr PolynomialSurface::expression(Pool& pool) const {
  const MatrixXd m = monomials();
  const Expr y = pool.channel("y"), v = pool.channel("v");
  Expr sum = pool.constant(m(0, 0));
  for (Index i = 0; i < m.rows(); ++i)
    for (Index j = 0; j < m.cols(); ++j) {
      if (i + j == 0) continue;
      const Expr power_y = pow(y, static_cast<double>(i)), power_v = pow(v, static_cast<double>(j));
      sum = sum + m(i, j) * (i == 0 ? power_v : j == 0 ? power_y : power_y * power_v);
    }
  return sum;
}

PolynomialSurface fit_polynomial(const SurfacePoints& points, const PolynomialOptions& options) {
  validate(options);
  Cells cells(points, options.cells_y, options.cells_v);
  const Index n = static_cast<Index>(options.order_y + 1) * (options.order_v + 1);
  if (points.size() < n)
    throw InputError("surface: order {" + std::to_string(options.order_y) + ", " + std::to_string(options.order_v) +
                         "} has " + std::to_string(n) + " coefficients, got " + std::to_string(points.size()) +
                         " points",
                     {}, Fault::data);
  const MatrixXd r = factor(points, cells, options);
  const VectorXd length = r.leftCols(n).colwise().norm();
  const MatrixXd scaled = r.topLeftCorner(n, n) * length.cwiseInverse().asDiagonal();
  Eigen::ColPivHouseholderQR<MatrixXd> qr(scaled);
  qr.setThreshold(kRank);
  if (qr.rank() < n) refuse_rank(qr.rank(), options);
  const VectorXd c = qr.solve(r.col(n).head(n)).cwiseQuotient(length);

  MatrixXd chebyshev(options.order_y + 1, options.order_v + 1);
  for (Index i = 0; i < chebyshev.rows(); ++i) chebyshev.row(i) = c.segment(i * chebyshev.cols(), chebyshev.cols());
  PolynomialSurface surface(std::move(cells), std::move(chebyshev));
  const VectorXd pivots = qr.matrixQR().diagonal().cwiseAbs();
  surface.condition = pivots[0] / pivots[n - 1];
  const double rows = static_cast<double>(points.size());
  const double total = (points.f.array() - points.f.mean()).matrix().squaredNorm();
  const double rss = (r.col(n) - r.leftCols(n) * c).squaredNorm();
  surface.rmse = std::sqrt(rss / rows);
  surface.r2 = total > 0 ? 1 - rss / total : std::nan("");
  return surface;
}

}  // namespace lunid
