// Chebyshev expansion of a surface by quadrature.
#include <cmath>
#include <numbers>

#include "expr/digits.hpp"
#include "surface/chebyshev.hpp"
#include "surface/surface.hpp"

namespace lunid {

using detail::chebyshev_values;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Zeros of T_n: the places of Gauss-Chebyshev quadrature, all of weight pi/n.
VectorXd places(int nodes) {
  VectorXd x(nodes);
  for (int p = 0; p < nodes; ++p) x[p] = std::cos(std::numbers::pi * (p + 0.5) / nodes);
  return x;
}

/// Row p: (2 - d_i0)/nodes * T_i(x_p).
MatrixXd weighted_values(const VectorXd& x, int order) {
  MatrixXd t(order + 1, x.size());
  for (Index p = 0; p < x.size(); ++p) chebyshev_values(x[p], order, t.col(p).data());
  t *= 2 / static_cast<double>(x.size());
  t.row(0) /= 2;
  return t;
}

}  // namespace

double truncation(const PolynomialSurface& polynomial, const ForceSurface& surface) {
  const SurfaceTable table = tabulate(surface);
  double square = 0;
  Index count = 0;
  for (Index i = 0; i < table.f.rows(); ++i)
    for (Index j = 0; j < table.f.cols(); ++j) {
      if (std::isnan(table.f(i, j))) continue;
      const double off = table.f(i, j) - polynomial.value(table.y[i], table.v[j]);
      square += off * off;
      ++count;
    }
  return count > 0 ? std::sqrt(square / static_cast<double>(count)) : std::nan("");
}

Expansion expand_by_quadrature(const ForceSurface& surface, int order_y, int order_v, int nodes) {
  validate(PolynomialOptions{.order_y = order_y, .order_v = order_v});
  const int least = std::max(order_y, order_v) + 1;
  if (nodes < least || nodes > 200)
    throw InputError("surface: nodes: expected " + std::to_string(least) + " (the larger order + 1) to 200, got " +
                     std::to_string(nodes));
  const Cells& cells = surface.cells();
  const double y_middle = (cells.y_max() + cells.y_min()) / 2, y_half = (cells.y_max() - cells.y_min()) / 2;
  const double v_middle = (cells.v_max() + cells.v_min()) / 2, v_half = (cells.v_max() - cells.v_min()) / 2;
  const VectorXd x = places(nodes);
  MatrixXd f(nodes, nodes);
  int without = 0;
  for (int p = 0; p < nodes; ++p)
    for (int q = 0; q < nodes; ++q) {
      const double y = y_middle + y_half * x[p], v = v_middle + v_half * x[q];
      f(p, q) = surface.continued(y, v);
      without += !surface.has_data(y, v);
    }
  const MatrixXd coefficients = weighted_values(x, order_y) * f * weighted_values(x, order_v).transpose();
  Expansion out{PolynomialSurface(cells, coefficients)};
  out.continued = without / (static_cast<double>(nodes) * nodes);
  out.truncation = truncation(out.polynomial, surface);
  return out;
}

}  // namespace lunid
