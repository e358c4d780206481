// Non-negative least squares and sparse relaxed regularised regression.
#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "regress/quadratic.hpp"
#include "regress/reduce.hpp"
#include "regress/solvers.hpp"
#include "regress/stopwatch.hpp"

namespace lunid {

using detail::Problem;
using Eigen::Index;
using Eigen::VectorXd;

Fit non_negative(const Statistic& data, std::span<const Constraint> constraints) {
  const detail::Stopwatch watch;
  std::vector<Constraint> all(constraints.begin(), constraints.end());
  for (int j = 0; j < data.features(); ++j) {
    const auto fixes = [&](const Constraint& c) {
      return c.equality() && c.terms.size() == 1 && c.terms.front().first == j && c.lower * c.terms.front().second >= 0;
    };
    if (std::none_of(constraints.begin(), constraints.end(), fixes)) all.push_back(at_least(j, 0));
  }
  Fit fit = detail::fit_selected(data, all, {});
  fit.summary.solver = "non-negative least squares";
  fit.summary.seconds = watch.seconds();
  return fit;
}

void validate(const Sr3Options& options) {
  const auto positive = [](const char* field, double value) {
    if (!(value > 0) || std::isinf(value))
      throw InputError("sr3: " + std::string(field) + ": expected > 0, got " + exact_number(value));
  };
  positive("threshold", options.threshold);
  positive("relaxation", options.relaxation);
  positive("tolerance", options.tolerance);
  if (options.max_passes < 1)
    throw InputError("sr3: max_passes: expected >= 1, got " + std::to_string(options.max_passes));
}

namespace {

/// The iteration in the scaled variables u of a Problem: s_k = weight_k u_k.
class Relaxed {
 public:
  Relaxed(const Statistic& data, const Sr3Options& options, std::span<const Constraint> constraints)
      : options_(options), problem_(detail::reduce(data, constraints)), penalised_(problem_) {
    const VectorXd size = detail::penalty_sizes(data);
    const double target = size[data.features()], rows = static_cast<double>(data.rows());
    weight_.resize(problem_.r.cols());
    for (Index k = 0; k < weight_.size(); ++k)
      weight_[k] = target > 0 ? size[problem_.columns[static_cast<std::size_t>(k)]] / problem_.size[k] / target : 0;
    // (rows size(z)^2) times the objective: |r u - z|^2 / 2 + pull / 2 * |weight u - w|^2
    pull_ = rows * target * target / options.relaxation;
    penalise(penalised_, pull_ * weight_.cwiseAbs2());
    w_ = prox(weight_.cwiseProduct(solve(problem_, data, constraints).u));
  }

  /// One turn over b and w; how far w moved, relative to its length.
  double turn() {
    const VectorXd right = problem_.r.transpose() * problem_.z + pull_ * weight_.cwiseProduct(w_);
    const VectorXd z = penalised_.r.transpose().triangularView<Eigen::Lower>().solve(right);
    u_ = problem_.c.rows() == 0 ? VectorXd(penalised_.r.triangularView<Eigen::Upper>().solve(z))
                                : solve_quadratic(penalised_.r, z, problem_.c, problem_.d, problem_.equalities).x;
    const VectorXd next = prox(weight_.cwiseProduct(u_));
    const double moved = (next - w_).norm(), length = next.norm();
    w_ = next;
    return length > 0 ? moved / length : moved;
  }

  const Problem& problem() const { return problem_; }
  /// w as coefficients; those without a penalty (the constant) from b.
  VectorXd coefficients() const {
    VectorXd u = u_;
    for (Index k = 0; k < u.size(); ++k)
      if (weight_[k] > 0) u[k] = w_[k] / weight_[k];
    return expand(problem_, u);
  }
  std::vector<bool> dropped(int features) const {
    std::vector<bool> zero(static_cast<std::size_t>(features), true);
    for (Index k = 0; k < w_.size(); ++k)
      zero[static_cast<std::size_t>(problem_.columns[static_cast<std::size_t>(k)])] = w_[k] == 0 && weight_[k] > 0;
    return zero;
  }

 private:
  VectorXd prox(const VectorXd& s) const {
    const double cut = options_.threshold;
    if (options_.absolute)
      return s.unaryExpr([cut](double x) { return std::copysign(std::max(std::abs(x) - cut, 0.0), x); });
    return s.unaryExpr([cut](double x) { return std::abs(x) > cut ? x : 0.0; });
  }

  Sr3Options options_;
  Problem problem_, penalised_;
  double pull_ = 0;
  VectorXd weight_, u_, w_;
};

}  // namespace

Fit sr3(const Statistic& data, const Sr3Options& options, std::span<const Constraint> constraints) {
  const detail::Stopwatch watch;
  validate(options);
  if (!options.refit && !constraints.empty())
    throw InputError("sr3: without refit the sparse copy need not meet '" + to_text(constraints.front(), data.names()) +
                         "': take refit = true, or no constraint",
                     constraints.front().where);
  Relaxed relaxed(data, options, constraints);
  int passes = 0;
  bool converged = false;
  while (!converged && passes < options.max_passes) {
    converged = relaxed.turn() <= options.tolerance;
    ++passes;
  }
  Fit fit =
      detail::fit_selected(data, constraints, detail::admissible(relaxed.dropped(data.features()), data, constraints));
  if (!options.refit) {
    fit.coefficients = relaxed.coefficients();
    detail::rescore(fit, data);
  }
  fit.unexcited = relaxed.problem().unexcited;
  fit.summary.solver = "sr3, threshold = " + number(options.threshold, 4) +
                       ", relaxation = " + number(options.relaxation, 4) +
                       (options.refit ? ", refitted by least squares" : "");
  fit.summary.iterations = passes;
  fit.summary.converged = fit.summary.converged && converged;
  fit.summary.stopped = converged ? "the sparse copy moves no more" : "max_passes reached";
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace lunid
