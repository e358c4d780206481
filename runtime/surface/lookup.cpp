#include "surface/lookup.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "surface/number.hpp"

namespace lunid {

using detail::number;
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

double between(double a, double b, double along) { return a + along * (b - a); }

[[noreturn]] void refuse(const std::string& name, const std::string& message) {
  throw InputError("table '" + name + "': " + message);
}

void check_axis(const std::string& name, std::size_t i, const VectorXd& axis) {
  const std::string which = "axis " + std::to_string(i + 1) + ": ";
  if (axis.size() < 2) refuse(name, which + "expected 2 values or more, got " + std::to_string(axis.size()));
  for (Index k = 0; k < axis.size(); ++k)
    if (!std::isfinite(axis[k]) || (k > 0 && !(axis[k] > axis[k - 1])))
      refuse(name, which + "expected finite values that increase, got " + number(axis[k], 6) + " as value " +
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

}  // namespace

Lookup::Lookup(std::string name, std::vector<VectorXd> axes, MatrixXd values)
    : ExternalFunction(std::move(name), static_cast<int>(axes.size())),
      axes_(std::move(axes)),
      values_(std::move(values)) {
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
}

double Lookup::value(const double* x) const {
  const Place p = place(axes_[0], x[0]);
  const auto along_first = [&](Index j) { return between(values_(p.cell, j), values_(p.cell + 1, j), p.along); };
  if (axes_.size() == 1) return along_first(0);
  const Place q = place(axes_[1], x[1]);
  return between(along_first(q.cell), along_first(q.cell + 1), q.along);
}

void Lookup::gradient(const double* x, double* slopes) const {
  const Place p = place(axes_[0], x[0]);
  const auto slope = [&](Index j) { return (values_(p.cell + 1, j) - values_(p.cell, j)) / p.width; };
  if (axes_.size() == 1) {
    slopes[0] = slope(0);
    return;
  }
  const Place q = place(axes_[1], x[1]);
  const auto along_first = [&](Index j) { return between(values_(p.cell, j), values_(p.cell + 1, j), p.along); };
  slopes[0] = between(slope(q.cell), slope(q.cell + 1), q.along);
  slopes[1] = (along_first(q.cell + 1) - along_first(q.cell)) / q.width;
}

std::shared_ptr<const Lookup> lookup_of(const GridSurface& surface, std::string name) {
  const Cells& cells = surface.cells();
  return std::make_shared<const Lookup>(std::move(name),
                                        std::vector{ends(cells.y_min(), cells.y_max(), cells.cells_y()),
                                                    ends(cells.v_min(), cells.v_max(), cells.cells_v())},
                                        Filling(surface.nodes()).run());
}

}  // namespace lunid
