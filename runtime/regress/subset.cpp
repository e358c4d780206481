#include "regress/subset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "regress/quadratic.hpp"

namespace lunid::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

Subsets::Subsets(const Statistic& data, std::span<const Constraint> constraints)
    : data_(data),
      constraints_(constraints),
      problem_(reduce(data, constraints)),
      rows_(static_cast<double>(data.rows())) {
  const Index n = data.features(), f = problem_.r.cols();
  rest_ =
      static_cast<double>(std::pow(data.factor()(n, n), 2)) + static_cast<double>(std::pow(problem_.exact(f, f), 2));
  target_ = problem_.z.squaredNorm() + rest_;
  const std::vector<bool> given_back = admissible(std::vector<bool>(at(n), true), data, constraints);
  for (int k = 0; k < count(); ++k)
    if (!given_back[at(problem_.columns[at(k)])]) needed_.push_back(k);
}

/// Triangular factor of [candidates in, target], (k + 1) x (k + 1).
MatrixXd Subsets::factor(const std::vector<int>& in) const {
  const Index k = static_cast<Index>(in.size()), f = problem_.r.rows();
  MatrixXd block(f, k + 1), r = MatrixXd::Zero(k + 1, k + 1);
  for (Index i = 0; i < k; ++i) block.col(i) = problem_.r.col(in[at(i)]);
  block.col(k) = problem_.z;
  triangularise(r, block);
  return r;
}

double Subsets::unconstrained(const std::vector<int>& in) const {
  const Index k = static_cast<Index>(in.size());
  const double last = factor(in)(k, k);
  return last * last + rest_;
}

double Subsets::rss(const std::vector<int>& in) const {
  if (!constrained()) return unconstrained(in);
  const Index k = static_cast<Index>(in.size());
  const MatrixXd r = factor(in);
  MatrixXd c(problem_.c.rows(), k);
  for (Index i = 0; i < k; ++i) c.col(i) = problem_.c.col(in[at(i)]);
  if (k == 0) {
    for (Index i = 0; i < c.rows(); ++i)
      if (problem_.d[i] > 1e-12 || (i < problem_.equalities && problem_.d[i] < -1e-12)) return kInfinity;
    return target_;
  }
  const MatrixXd square = r.topLeftCorner(k, k);
  const VectorXd z = r.col(k).head(k);
  const QuadraticSolution s = solve_quadratic(square, z, c, problem_.d, problem_.equalities);
  if (s.blocked >= 0) return kInfinity;
  return (square * s.x - z).squaredNorm() + r(k, k) * r(k, k) + rest_;
}

std::vector<int> Subsets::features(const std::vector<int>& in) const {
  std::vector<int> out;
  for (const int k : in) out.push_back(problem_.columns[at(k)]);
  return out;
}

Fit Subsets::fit(const std::vector<int>& in) const {
  std::vector<bool> zero(at(data_.features()), true);
  for (const int k : in) zero[at(problem_.columns[at(k)])] = false;
  Fit fit = fit_selected(data_, constraints_, zero);
  fit.unexcited = problem_.unexcited;
  return fit;
}

double information(bool bic, double rows, double rss, double target, int terms) {
  constexpr double kRounding = std::numeric_limits<double>::epsilon() * std::numeric_limits<double>::epsilon();
  const double k = terms, fit = rows * std::log(std::max(rss, kRounding * target) / rows);
  if (bic) return fit + k * std::log(rows);
  return rows - k - 1 > 0 ? fit + 2 * k + 2 * k * (k + 1) / (rows - k - 1) : kInfinity;
}

}  // namespace lunid::detail
