#include "surface/lookup.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "expr/digits.hpp"
#include "surface/spline.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// First differences decide, with this weight beside that of the second ones, what those leave open.
constexpr double kAnchor = 1e-6;

/// A cell of an axis and the place in it: 0 to 1, beyond them outside the axis.
struct Place {
  Index cell;
  double along, width;
};

Place place(const VectorXd& axis, double x) {
  const double* const end = axis.data() + axis.size();
  const Index above = std::upper_bound(axis.data(), end, x) - axis.data();
  const Index cell = std::clamp<Index>(above - 1, 0, axis.size() - 2);
  const double width = axis[cell + 1] - axis[cell];
  return {cell, (x - axis[cell]) / width, width};
}

double straight(double a, double b, double along) { return a + along * (b - a); }

[[noreturn]] void refuse(const std::string& name, const std::string& message) {
  throw InputError("table '" + name + "': " + message);
}

void check_axis(const std::string& name, std::size_t i, const VectorXd& axis) {
  const std::string which = "axis " + std::to_string(i + 1) + ": ";
  if (axis.size() < 2) refuse(name, which + "expected 2 values or more, got " + std::to_string(axis.size()));
  for (Index k = 0; k < axis.size(); ++k)
    if (!std::isfinite(axis[k]) || (k > 0 && !(axis[k] > axis[k - 1])))
      refuse(name, which + "expected finite values that increase, got " + number(axis[k]) + " as value " +
                       std::to_string(k + 1));
}

/// Fills up the nodes that are NaN.
class Filling {
 public:
  explicit Filling(const MatrixXd& nodes)
      : nodes_(nodes), number_(Eigen::MatrixXi::Constant(nodes.rows(), nodes.cols(), -1)) {
    for (Index i = 0; i < nodes.rows(); ++i)
      for (Index j = 0; j < nodes.cols(); ++j)
        if (std::isnan(nodes(i, j))) number_(i, j) = unknowns_++;
  }

  MatrixXd run() {
    if (unknowns_ == 0) return nodes_;
    right_ = VectorXd::Zero(unknowns_);
    for (Index i = 0; i < nodes_.rows(); ++i)
      for (Index j = 0; j < nodes_.cols(); ++j)
        for (const auto& [di, dj] : {std::array{1, 0}, std::array{0, 1}}) {
          add<2>(i, j, di, dj, {1, -1}, kAnchor);
          add<3>(i, j, di, dj, {1, -2, 1}, 1);
        }
    Eigen::SparseMatrix<double> matrix(unknowns_, unknowns_);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const VectorXd x = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right_);
    MatrixXd full = nodes_;
    for (Index i = 0; i < full.rows(); ++i)
      for (Index j = 0; j < full.cols(); ++j)
        if (number_(i, j) >= 0) full(i, j) = x[number_(i, j)];
    return full;
  }

 private:
  /// weight * (difference of N nodes from (i, j) on)^2, with the known ones on the right.
  template <std::size_t N>
  void add(Index i, Index j, int di, int dj, const std::array<double, N>& w, double weight) {
    const Index last = static_cast<Index>(N) - 1;
    if (i + last * di >= nodes_.rows() || j + last * dj >= nodes_.cols()) return;
    double known = 0;
    std::array<int, N> n;
    for (std::size_t k = 0; k < N; ++k) {
      const Index a = i + static_cast<Index>(k) * di, b = j + static_cast<Index>(k) * dj;
      n[k] = number_(a, b);
      if (n[k] < 0) known += w[k] * nodes_(a, b);
    }
    for (std::size_t a = 0; a < N; ++a) {
      if (n[a] < 0) continue;
      right_[n[a]] -= weight * w[a] * known;
      for (std::size_t b = 0; b < N; ++b)
        if (n[b] >= 0) entries_.emplace_back(n[a], n[b], weight * w[a] * w[b]);
    }
  }

  const MatrixXd& nodes_;
  Eigen::MatrixXi number_;
  int unknowns_ = 0;
  VectorXd right_;
  std::vector<Eigen::Triplet<double>> entries_;
};

/// Ends of `cells` equal parts; the last is `to` itself.
VectorXd ends(double from, double to, Index cells) {
  VectorXd axis(cells + 1);
  for (Index i = 0; i < cells; ++i)
    axis[i] = from + (to - from) * (static_cast<double>(i) / static_cast<double>(cells));
  axis[cells] = to;
  return axis;
}

/// Slopes of the splines along the first axis, one for each column.
MatrixXd slopes_along_first(const VectorXd& axis, const MatrixXd& values) {
  MatrixXd slopes(values.rows(), values.cols());
  for (Index j = 0; j < values.cols(); ++j) slopes.col(j) = detail::spline_slopes(axis, values.col(j));
  return slopes;
}

}  // namespace

Between between_from(const std::string& name) {
  if (name == "linear") return Between::linear;
  if (name == "cubic") return Between::cubic;
  throw InputError("between: expected linear or cubic, got '" + name + "'");
}

std::string to_string(Between between) { return between == Between::linear ? "linear" : "cubic"; }

Lookup::Lookup(std::string name, std::vector<VectorXd> axes, MatrixXd values, Between between)
    : ExternalFunction(std::move(name), static_cast<int>(axes.size())),
      axes_(std::move(axes)),
      values_(std::move(values)),
      between_(between) {
  if (axes_.size() > 2) refuse(this->name(), "expected 1 or 2 axes, got " + std::to_string(axes_.size()));
  for (std::size_t i = 0; i < axes_.size(); ++i) check_axis(this->name(), i, axes_[i]);
  const Index columns = axes_.size() == 2 ? axes_[1].size() : 1;
  if (values_.rows() != axes_[0].size() || values_.cols() != columns)
    refuse(this->name(), "values: expected " + std::to_string(axes_[0].size()) +
                             (columns > 1 ? " rows of " + std::to_string(columns) : "") + ", got " +
                             std::to_string(values_.rows()) +
                             (values_.cols() > 1 ? " rows of " + std::to_string(values_.cols()) : ""));
  for (Index i = 0; i < values_.rows(); ++i)
    for (Index j = 0; j < columns; ++j)
      if (!std::isfinite(values_(i, j)))
        refuse(this->name(), "values: row " + std::to_string(i + 1) + ", entry " + std::to_string(j + 1) +
                                 ": expected a finite number");
  if (between_ == Between::linear) return;
  by_first_ = slopes_along_first(axes_[0], values_);
  if (axes_.size() == 1) return;
  by_second_ = slopes_along_first(axes_[1], values_.transpose()).transpose();
  by_both_ = slopes_along_first(axes_[0], by_second_);
}

double Lookup::value(const double* x) const {
  return between_ == Between::linear ? linear_value(x) : cubic(x, nullptr);
}

void Lookup::gradient(const double* x, double* slopes) const {
  if (between_ == Between::linear)
    linear_gradient(x, slopes);
  else
    cubic(x, slopes);
}

double Lookup::cubic(const double* x, double* slopes) const {
  const Place p = place(axes_[0], x[0]);
  const detail::CubicWeights first = detail::cubic_weights(p.along, p.width);
  const auto along_first = [&](const Eigen::Array4d& w, const MatrixXd& value, const MatrixXd& slope, Index j) {
    return w[0] * value(p.cell, j) + w[1] * slope(p.cell, j) + w[2] * value(p.cell + 1, j) +
           w[3] * slope(p.cell + 1, j);
  };
  if (axes_.size() == 1) {
    if (slopes) slopes[0] = along_first(first.of_slope, values_, by_first_, 0);
    return along_first(first.of_value, values_, by_first_, 0);
  }
  const Place q = place(axes_[1], x[1]);
  const detail::CubicWeights second = detail::cubic_weights(q.along, q.width);
  const auto across = [&](const Eigen::Array4d& w) -> Eigen::Array4d {
    return {along_first(w, values_, by_first_, q.cell), along_first(w, by_second_, by_both_, q.cell),
            along_first(w, values_, by_first_, q.cell + 1), along_first(w, by_second_, by_both_, q.cell + 1)};
  };
  const Eigen::Array4d values = across(first.of_value);
  if (slopes) {
    slopes[0] = (across(first.of_slope) * second.of_value).sum();
    slopes[1] = (values * second.of_slope).sum();
  }
  return (values * second.of_value).sum();
}

double Lookup::linear_value(const double* x) const {
  const Place p = place(axes_[0], x[0]);
  const auto along_first = [&](Index j) { return straight(values_(p.cell, j), values_(p.cell + 1, j), p.along); };
  if (axes_.size() == 1) return along_first(0);
  const Place q = place(axes_[1], x[1]);
  return straight(along_first(q.cell), along_first(q.cell + 1), q.along);
}

void Lookup::linear_gradient(const double* x, double* slopes) const {
  const Place p = place(axes_[0], x[0]);
  const auto slope = [&](Index j) { return (values_(p.cell + 1, j) - values_(p.cell, j)) / p.width; };
  if (axes_.size() == 1) {
    slopes[0] = slope(0);
    return;
  }
  const Place q = place(axes_[1], x[1]);
  const auto along_first = [&](Index j) { return straight(values_(p.cell, j), values_(p.cell + 1, j), p.along); };
  slopes[0] = straight(slope(q.cell), slope(q.cell + 1), q.along);
  slopes[1] = (along_first(q.cell + 1) - along_first(q.cell)) / q.width;
}

std::shared_ptr<const Lookup> lookup_of(const ForceSurface& surface, std::string name, Between between, int cells) {
  const Cells& data = surface.cells();
  const auto* grid = dynamic_cast<const GridSurface*>(&surface);
  const VectorXd y = ends(data.y_min(), data.y_max(), grid ? data.cells_y() : cells),
                 v = ends(data.v_min(), data.v_max(), grid ? data.cells_v() : cells);
  const auto at = [&](Index i, Index j) {
    return surface.has_data(y[i], v[j]) ? surface.value(y[i], v[j]) : std::nan("");
  };
  const MatrixXd nodes = grid ? grid->nodes() : MatrixXd(MatrixXd::NullaryExpr(y.size(), v.size(), at));
  return std::make_shared<const Lookup>(std::move(name), std::vector{y, v}, Filling(nodes).run(), between);
}

}  // namespace lunid
