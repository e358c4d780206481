#include "regress/reduce.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "expr/digits.hpp"
#include "regress/dense.hpp"
#include "regress/quadratic.hpp"

namespace lunid::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A column whose part orthogonal to the columns before it is below this part of its length is taken for a combination
/// of them. Ten times what rounding leaves of an exact combination; Filip's last column keeps 3e-10.
constexpr double kRank = 1e-14;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Values fixed by an equality on a single coefficient; NaN elsewhere.
VectorXd fixed_values(const Statistic& data, std::span<const Constraint> constraints) {
  VectorXd value = VectorXd::Constant(data.features(), std::numeric_limits<double>::quiet_NaN());
  for (const Constraint& c : constraints) {
    if (!c.equality() || c.terms.size() != 1) continue;
    const auto [feature, weight] = c.terms.front();
    const double wanted = c.lower / weight;
    if (!std::isnan(value[feature]) && value[feature] != wanted) refuse_contradiction(data, constraints);
    value[feature] = wanted;
  }
  return value;
}

/// A feature's name as a factor: a sum or a product in brackets.
std::string as_factor(const std::string& name) {
  return name.find_first_of(" +-*/") == std::string::npos ? name : "(" + name + ")";
}

/// "on these data a = -4.3e4*y + 12*v": column `k` as a combination of the columns `before` (all of length `size`).
Unexcited combination(const Statistic& data, const MatrixXd& r, const VectorXd& size, int k,
                      const std::vector<int>& before) {
  LongMatrix basis(r.rows(), static_cast<Index>(before.size()));
  for (Index i = 0; i < basis.cols(); ++i)
    basis.col(i) = (r.col(before[at(i)]) / size[before[at(i)]]).cast<long double>();
  const VectorXd weight = solve_by_qr(basis, (r.col(k) / size[k]).cast<long double>()).cast<double>();
  std::string text;
  std::vector<int> of;
  for (Index i = 0; i < weight.size(); ++i) {
    if (std::abs(weight[i]) < 1e-6 * weight.cwiseAbs().maxCoeff()) continue;
    const double factor = weight[i] * size[k] / size[before[at(i)]];
    text += text.empty() ? (factor < 0 ? "-" : "") : (factor < 0 ? " - " : " + ");
    text += number(std::abs(factor), 4) + "*" + as_factor(data.names()[at(before[at(i)])]);
    of.push_back(before[at(i)]);
  }
  return {k, "on these data " + as_factor(data.names()[at(k)]) + " = " + text, std::move(of)};
}

/// Moves those of `candidates` that are combinations of candidates before them to `out`.
std::vector<int> excited(const Statistic& data, const MatrixXd& r, const VectorXd& size,
                         const std::vector<int>& candidates, std::vector<Unexcited>& out) {
  std::vector<int> kept;
  MatrixXd basis(r.rows(), static_cast<Index>(candidates.size()));
  for (int k : candidates) {
    const Index q = static_cast<Index>(kept.size());
    VectorXd rest = r.col(k) / size[k];
    for (int pass = 0; pass < 2; ++pass) rest -= basis.leftCols(q) * (basis.leftCols(q).transpose() * rest);
    const double length = rest.norm();
    if (length <= kRank) {
      out.push_back(combination(data, r, size, k, kept));
      continue;
    }
    basis.col(q) = rest / length;
    kept.push_back(k);
  }
  return kept;
}

/// Appends the sides of constraints[index] as rows in the free, scaled variables.
void add_sides(Problem& p, const Statistic& data, std::span<const Constraint> constraints, int index,
               const std::vector<int>& place, std::vector<VectorXd>& rows, std::vector<double>& bounds) {
  const Constraint& constraint = constraints[at(index)];
  VectorXd row = VectorXd::Zero(static_cast<Index>(p.columns.size()));
  double held = 0, scale = 0;
  for (const auto& [feature, weight] : constraint.terms) {
    const int k = place[at(feature)];
    if (k >= 0)
      row[k] += weight / p.size[k];
    else
      held += weight * p.held[feature];
    scale += k >= 0 ? 0 : std::abs(weight * p.held[feature]);
  }
  const double length = row.norm();
  if (length == 0) {
    const double slack = 1e-12 * (scale + (std::isfinite(constraint.lower) ? std::abs(constraint.lower) : 0) +
                                  (std::isfinite(constraint.upper) ? std::abs(constraint.upper) : 0));
    if (held < constraint.lower - slack || held > constraint.upper + slack) {
      refuse_contradiction(data, constraints);
      throw InputError("constraint '" + to_text(constraint, data.names()) +
                           "' needs features that are left out or that the data do not excite",
                       constraint.where);
    }
    return;
  }
  if (std::isfinite(constraint.lower)) {
    rows.push_back(row / length);
    bounds.push_back((constraint.lower - held) / length);
    p.sides.push_back({index, false, length});
  }
  if (std::isfinite(constraint.upper) && !constraint.equality()) {
    rows.push_back(-row / length);
    bounds.push_back(-(constraint.upper - held) / length);
    p.sides.push_back({index, true, length});
  }
}

/// Rows of all constraints but the fixed values; equalities first.
void add_constraints(Problem& p, const Statistic& data, std::span<const Constraint> constraints) {
  std::vector<int> place(at(data.features()), -1);
  for (std::size_t k = 0; k < p.columns.size(); ++k) place[at(p.columns[k])] = static_cast<int>(k);
  std::vector<VectorXd> rows;
  std::vector<double> bounds;
  for (const bool equality : {true, false}) {
    for (std::size_t i = 0; i < constraints.size(); ++i)
      if (constraints[i].equality() == equality)
        add_sides(p, data, constraints, static_cast<int>(i), place, rows, bounds);
    if (equality) p.equalities = static_cast<int>(rows.size());
  }
  p.c.resize(static_cast<Index>(rows.size()), static_cast<Index>(p.columns.size()));
  p.d.resize(p.c.rows());
  for (Index i = 0; i < p.c.rows(); ++i) {
    p.c.row(i) = rows[at(i)].transpose();
    p.d[i] = bounds[at(i)];
  }
}

/// Rounds the exact factor.
void set_factor(Problem& p, LongMatrix factor) {
  const Index f = factor.cols() - 1;
  p.exact = std::move(factor);
  p.r = p.exact.topLeftCorner(f, f).cast<double>();
  p.z = p.exact.col(f).head(f).cast<double>();
}

double kkt_residual(const Problem& p, const Point& point) {
  const VectorXd gradient = p.r.transpose() * (p.r * point.u - p.z);
  double worst = (gradient - p.c.transpose() * point.multipliers).lpNorm<Eigen::Infinity>();
  for (Index i = 0; i < p.c.rows(); ++i) {
    const double slack = p.c.row(i).dot(point.u) - p.d[i];
    worst = std::max(worst, i < p.equalities ? std::abs(slack) : -slack);
    if (i >= p.equalities) worst = std::max(worst, -point.multipliers[i]);
  }
  const double size = p.z.norm();
  return size > 0 ? worst / size : worst;
}

}  // namespace

Problem reduce(const Statistic& data, std::span<const Constraint> constraints, const std::vector<bool>& zero) {
  for (const Constraint& c : constraints) validate(c, data.names());
  const int n = data.features();
  const LongMatrix factor = data.factor();
  const MatrixXd r = factor.topLeftCorner(n, n).cast<double>();
  const VectorXd fixed = fixed_values(data, constraints), size = r.colwise().norm();

  Problem p;
  p.held = VectorXd::Zero(n);
  std::vector<int> candidates;
  for (int j = 0; j < n; ++j) {
    const bool is_zero = !zero.empty() && zero[at(j)];
    if (!std::isnan(fixed[j])) {
      p.held[j] = fixed[j];
    } else if (!is_zero) {
      if (size[j] == 0)
        throw InputError("feature '" + data.names()[at(j)] +
                             "' is zero on all rows: the data do not excite it, leave it out or fix its coefficient",
                         {}, Fault::data);
      candidates.push_back(j);
    }
  }
  if (static_cast<Index>(candidates.size()) > data.rows())
    throw InputError(std::to_string(candidates.size()) + " features need at least as many rows, got " +
                         std::to_string(data.rows()) + ": take fewer features or more of the record",
                     {}, Fault::data);
  p.columns = excited(data, r, size, candidates, p.unexcited);

  const Index f = static_cast<Index>(p.columns.size());
  p.size.resize(f);
  LongMatrix block(n, f + 1), scaled = LongMatrix::Zero(f + 1, f + 1);
  for (Index k = 0; k < f; ++k) {
    p.size[k] = size[p.columns[at(k)]];
    block.col(k) = factor.col(p.columns[at(k)]).head(n) / p.size[k];
  }
  block.col(f) = factor.col(n).head(n) - factor.topLeftCorner(n, n) * p.held.cast<long double>();
  triangularise(scaled, std::move(block));
  set_factor(p, std::move(scaled));
  add_constraints(p, data, constraints);
  return p;
}

void penalise(Problem& p, const VectorXd& weight) {
  const Index f = p.r.cols();
  LongMatrix factor = p.exact, block = LongMatrix::Zero(f, f + 1);
  block.leftCols(f).diagonal() = weight.cwiseSqrt().cast<long double>();
  triangularise(factor, std::move(block));
  set_factor(p, std::move(factor));
}

void polish(const Problem& p, Point& point) {
  const Index q = static_cast<Index>(point.active.size()), n = p.r.cols();
  const auto r = p.exact.topLeftCorner(n, n);
  const auto z = p.exact.col(n).head(n);
  if (q == 0) {
    point.u = r.triangularView<Eigen::Upper>().solve(z).cast<double>();
    return;
  }
  LongMatrix rows(n, q);
  LongVector bound(q);
  for (Index k = 0; k < q; ++k) {
    rows.col(k) = p.c.row(point.active[at(k)]).transpose().cast<long double>();
    bound[k] = p.d[point.active[at(k)]];
  }
  const FullQr qr = full_qr(rows);
  const auto triangle = qr.triangle.triangularView<Eigen::Upper>();
  LongVector u = qr.q.leftCols(q) * triangle.transpose().solve(bound);
  if (q < n) {
    const LongMatrix free = qr.q.rightCols(n - q);
    u += free * solve_by_qr(r * free, z - r * u);
  }
  const LongVector gradient = r.transpose() * (r * u - z);
  const VectorXd multiplier = triangle.solve(qr.q.leftCols(q).transpose() * gradient).cast<double>();
  // What the rows hold at 0 is 0, not what rounding leaves.
  const long double rounding = 1e-15L * p.z.norm();
  point.u = (u.array().abs() <= rounding).select(LongVector::Zero(n), u).cast<double>();
  point.multipliers.setZero();
  for (Index k = 0; k < q; ++k) point.multipliers[point.active[at(k)]] = multiplier[k];
}

Point solve(const Problem& p, const Statistic& data, std::span<const Constraint> constraints) {
  QuadraticSolution q = solve_quadratic(p.r, p.z, p.c, p.d, p.equalities);
  if (q.blocked >= 0) {
    refuse_contradiction(data, constraints);
    const Constraint& c = constraints[at(p.sides[at(q.blocked)].constraint)];
    throw InputError("constraint '" + to_text(c, data.names()) +
                         "' cannot be met together with the others: it needs features that are left out or that the "
                         "data do not excite",
                     c.where);
  }
  Point point{std::move(q.x), std::move(q.multipliers), std::move(q.active), q.iterations, q.finished, 0};
  polish(p, point);
  point.kkt = kkt_residual(p, point);
  return point;
}

VectorXd expand(const Problem& p, const VectorXd& u) {
  VectorXd b = p.held;
  for (std::size_t k = 0; k < p.columns.size(); ++k)
    b[p.columns[k]] = u[static_cast<Index>(k)] / p.size[static_cast<Index>(k)];
  return b;
}

Fit fit_selected(const Statistic& data, std::span<const Constraint> constraints, const std::vector<bool>& zero) {
  const Problem problem = reduce(data, constraints, zero);
  return report(problem, solve(problem, data, constraints), data, constraints);
}

VectorXd penalty_sizes(const Statistic& data) {
  const int constant = data.constant_feature();
  if (constant < 0) return data.rms();
  VectorXd size = data.deviation();
  size[constant] = 0;
  return size;
}

}  // namespace lunid::detail
