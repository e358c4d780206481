// Lasso and elastic net: exact at each lambda, by a walk over the orthants of the coefficients' signs.
#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "regress/fit.hpp"
#include "regress/quadratic.hpp"
#include "regress/reduce.hpp"
#include "regress/stopwatch.hpp"

namespace lunid {

namespace {

using detail::Point;
using detail::Problem;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// min |r u - z|^2 / 2 + lambda * sum kappa_k |u_k - kink_k| under the problem's constraints, for one lambda after
/// another. The kinks lie at 0, but for constraints: those often hold with equality just there (b1 <= b2 at b1 = b2 =
/// 0), and then no single sign could change. The walk therefore sees the kinks moved by parts in 1e9, each by its own;
/// the active set that it ends with is solved with the kinks at 0.
class OrthantWalk {
 public:
  OrthantWalk(const Statistic& data, std::span<const Constraint> constraints, const std::vector<bool>& zero,
              double mixture)
      : problem_(detail::reduce(data, constraints, zero)), plain_(problem_), user_rows_(problem_.c.rows()) {
    const Index n = problem_.r.cols();
    const VectorXd size = detail::penalty_sizes(data);
    kappa_.resize(n);
    square_.resize(n);
    const double count = static_cast<double>(data.rows());
    for (Index k = 0; k < n; ++k) {
      const double ratio = size[problem_.columns[static_cast<std::size_t>(k)]] / problem_.size[k];
      kappa_[k] = mixture * count * size[data.features()] * ratio;
      square_[k] = (1 - mixture) * count * ratio * ratio;
      if (kappa_[k] > 0) penalised_.push_back(k);
    }
    sign_ = VectorXd::Ones(n);
    kink_ = VectorXd::Zero(n);
    if (user_rows_ > 0)
      for (Index k = 0; k < n; ++k)
        kink_[k] = 1e-9 * problem_.z.norm() * (std::fmod(0.618 * static_cast<double>(k + 1), 1) - 0.5);
    point_.u = user_rows_ == 0 ? unpenalised_only() : solve(problem_, data, constraints).u;
    const VectorXd fall = -gradient(point_.u);
    for (Index k = 0; k < n; ++k) sign_[k] = (point_.u[k] != kink_[k] ? point_.u[k] - kink_[k] : fall[k]) < 0 ? -1 : 1;
    const Index rows = user_rows_ + static_cast<Index>(penalised_.size());
    problem_.c.conservativeResizeLike(MatrixXd::Zero(rows, n));
    problem_.d.conservativeResizeLike(VectorXd::Zero(rows));
  }

  const Problem& problem() const { return problem_; }
  const MatrixXd& plain() const { return plain_.r; }  ///< the factor without the penalty on squares
  const Point& point() const { return point_; }

  /// The least lambda at which every penalised coefficient is 0 when there are no constraints.
  double greatest_lambda() const {
    const VectorXd g = gradient(unpenalised_only());
    double lambda = 0;
    for (Index k : penalised_) lambda = std::max(lambda, std::abs(g[k]) / kappa_[k]);
    return lambda;
  }

  void advance(double lambda) {
    int iterations = 0;
    if (square_.size() > 0 && square_.maxCoeff() > 0) {
      problem_.exact = plain_.exact;
      penalise(problem_, lambda * square_);
    }
    bool moved = step(lambda, iterations);
    // Each orthant's optimum lowers the objective, so that no orthant comes twice.
    while (moved) {
      const VectorXd before = sign_;
      const std::vector<Index> wrong = wrong_signs(lambda);
      moved = !wrong.empty() && flip(wrong, lambda, iterations);
      for (std::size_t i = 0; !moved && wrong.size() > 1 && i < wrong.size(); ++i)
        moved = flip({wrong[i]}, lambda, iterations);
      if (!moved) sign_ = before;
    }
    if (user_rows_ > 0) put_kinks_back(lambda);
    point_.iterations = iterations;
    point_.kkt = kkt_residual(lambda);
  }

 private:
  VectorXd gradient(const VectorXd& u) const { return problem_.r.transpose() * (problem_.r * u - problem_.z); }

  double objective(const VectorXd& u, double lambda) const {
    return 0.5 * (problem_.r * u - problem_.z).squaredNorm() + lambda * kappa_.dot((u - kink_).cwiseAbs());
  }

  /// The fit of the coefficients that carry no penalty (the constant), all others 0.
  VectorXd unpenalised_only() const {
    VectorXd u = VectorXd::Zero(kappa_.size());
    for (Index k = 0; k < kappa_.size(); ++k)
      if (kappa_[k] == 0) u[k] = problem_.r.col(k).dot(problem_.z) / problem_.r.col(k).squaredNorm();
    return u;
  }

  /// The optimum within the orthant of sign_; false when the programme finds no point there (rounding).
  bool step(double lambda, int& iterations) {
    for (std::size_t i = 0; i < penalised_.size(); ++i) {
      const Index row = user_rows_ + static_cast<Index>(i), k = penalised_[i];
      problem_.c(row, k) = sign_[k];
      problem_.d[row] = sign_[k] * kink_[k];
    }
    const VectorXd slope = lambda * kappa_.cwiseProduct(sign_);
    const VectorXd z = problem_.z - problem_.r.transpose().triangularView<Eigen::Lower>().solve(slope);
    QuadraticSolution q = solve_quadratic(problem_.r, z, problem_.c, problem_.d, problem_.equalities);
    iterations += q.iterations;
    if (q.blocked >= 0) return false;
    for (int row : q.active)
      if (row >= user_rows_) q.x[at_kink(row)] = kink_[at_kink(row)];
    for (Index k : penalised_)
      if ((q.x[k] - kink_[k]) * sign_[k] < 0) q.x[k] = kink_[k];  // outside its orthant by rounding
    point_.u = std::move(q.x);
    point_.multipliers = std::move(q.multipliers);
    point_.active = std::move(q.active);
    point_.finished = q.finished;
    return true;
  }

  /// The coefficient whose sign's row this is.
  Index at_kink(int row) const { return penalised_[static_cast<std::size_t>(row - user_rows_)]; }

  /// The solution with the same signs and active rows, the kinks at 0.
  void put_kinks_back(double lambda) {
    const Index n = problem_.r.cols();
    Problem exact = problem_;
    exact.d.tail(exact.d.size() - user_rows_).setZero();
    const LongVector slope = (lambda * kappa_.cwiseProduct(sign_)).cast<long double>();
    exact.exact.col(n).head(n) -=
        exact.exact.topLeftCorner(n, n).transpose().triangularView<Eigen::Lower>().solve(slope);
    polish(exact, point_);
    for (int row : point_.active)
      if (row >= user_rows_) point_.u[at_kink(row)] = 0;
  }

  /// Zero coefficients that would lower the objective on the other side of 0.
  std::vector<Index> wrong_signs(double lambda) const {
    std::vector<Index> wrong;
    for (int row : point_.active) {
      if (row < user_rows_) continue;
      const Index k = at_kink(row);
      if (point_.multipliers[row] > 2 * lambda * kappa_[k] * (1 + 1e-10)) wrong.push_back(k);
    }
    return wrong;
  }

  /// Changes the signs of `which`; undone, with false, unless that lowers the objective.
  bool flip(const std::vector<Index>& which, double lambda, int& iterations) {
    const Point before = point_;
    for (Index k : which) sign_[k] = -sign_[k];
    const double reference = objective(before.u, lambda);
    if (step(lambda, iterations) && objective(point_.u, lambda) < reference * (1 - 1e-14)) return true;
    for (Index k : which) sign_[k] = -sign_[k];
    point_ = before;
    return false;
  }

  double kkt_residual(double lambda) const {
    const VectorXd force = problem_.c.topRows(user_rows_).transpose() * point_.multipliers.head(user_rows_) -
                           gradient(point_.u);  // what |u| has to balance
    double worst = 0;
    for (Index k = 0; k < force.size(); ++k) {
      const double limit = lambda * kappa_[k];
      worst = std::max(worst, point_.u[k] == 0 ? std::abs(force[k]) - limit
                                               : std::abs(force[k] - std::copysign(limit, point_.u[k])));
    }
    for (Index i = 0; i < user_rows_; ++i) {
      const double slack = problem_.c.row(i).dot(point_.u) - problem_.d[i];
      worst = std::max(worst, i < problem_.equalities ? std::abs(slack) : -slack);
    }
    const double size = problem_.z.norm();
    return size > 0 ? worst / size : worst;
  }

  Problem problem_, plain_;
  Index user_rows_;  // rows of c that are the user's; the signs' rows follow
  std::vector<Index> penalised_;
  VectorXd kappa_, square_, sign_, kink_;  // kappa, square: weights of |u| and u^2 / 2 at lambda = 1
  Point point_;
};

std::vector<double> lambdas(const LassoOptions& options, double greatest) {
  std::vector<double> grid(static_cast<std::size_t>(options.path));
  const double ratio = std::log(options.path_ratio) / (options.path - 1);
  greatest *= 1 + 1e-10;  // or rounding decides whether the first point is 0
  for (std::size_t i = 0; i < grid.size(); ++i) grid[i] = greatest * std::exp(ratio * static_cast<double>(i));
  return grid;
}

/// Left-out mean squares: (lambda, block).
MatrixXd cross_validate(std::span<const Statistic> blocks, std::span<const Constraint> constraints,
                        const std::vector<double>& grid, double mixture) {
  MatrixXd left_out(static_cast<Index>(grid.size()), static_cast<Index>(blocks.size()));
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    Statistic rest(blocks[k].names());
    for (std::size_t i = 0; i < blocks.size(); ++i)
      if (i != k) rest.merge(blocks[i]);
    // What only the left-out block excites has no coefficient from the others.
    const VectorXd rms = rest.rms();
    std::vector<bool> zero(blocks[k].names().size());
    for (std::size_t j = 0; j < zero.size(); ++j) zero[j] = rms[static_cast<Index>(j)] == 0;
    OrthantWalk walk(rest, constraints, zero, mixture);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      walk.advance(grid[i]);
      left_out(static_cast<Index>(i), static_cast<Index>(k)) =
          blocks[k].residual_sum(expand(walk.problem(), walk.point().u)) / static_cast<double>(blocks[k].rows());
    }
  }
  return left_out;
}

/// Fills in the path's left-out errors; the index of the lambda to take.
std::size_t choose(const MatrixXd& left_out, bool one_standard_error, std::vector<PathPoint>& path) {
  const double blocks = static_cast<double>(left_out.cols());
  const VectorXd mean = left_out.rowwise().mean();
  const VectorXd error = ((left_out.colwise() - mean).rowwise().squaredNorm() / (blocks * (blocks - 1))).cwiseSqrt();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Index row = static_cast<Index>(i);
    path[i].cv_rmse = std::sqrt(mean[row]);
    path[i].cv_std = mean[row] > 0 ? error[row] / (2 * path[i].cv_rmse) : 0;
  }
  Index best = 0;
  mean.minCoeff(&best);
  Index chosen = best;
  if (one_standard_error)
    while (chosen > 0 && mean[chosen - 1] <= mean[best] + error[best]) --chosen;
  return static_cast<std::size_t>(chosen);
}

std::vector<PathPoint> walk_path(const Statistic& data, std::span<const Constraint> constraints,
                                 const std::vector<double>& grid, double mixture) {
  OrthantWalk walk(data, constraints, {}, mixture);
  std::vector<PathPoint> path;
  for (double lambda : grid) {
    walk.advance(lambda);
    PathPoint point{lambda, expand(walk.problem(), walk.point().u), 0, std::nan(""), std::nan("")};
    point.rmse = std::sqrt(data.residual_sum(point.coefficients) / static_cast<double>(data.rows()));
    path.push_back(std::move(point));
  }
  return path;
}

/// Least squares on the features that the lasso selected.
Fit refit(const Statistic& data, std::span<const Constraint> constraints, const Fit& lasso) {
  std::vector<bool> zero(lasso.features.size());
  for (std::size_t j = 0; j < zero.size(); ++j) zero[j] = lasso.coefficients[static_cast<Index>(j)] == 0;
  Fit fit = detail::fit_selected(data, constraints, zero);
  fit.unexcited = lasso.unexcited;
  fit.summary.iterations += lasso.summary.iterations;
  return fit;
}

std::string name_of(const LassoOptions& options) { return options.mixture == 1 ? "lasso" : "elastic_net"; }

}  // namespace

void validate(const LassoOptions& options) {
  const std::string name = name_of(options);
  if (!(options.mixture > 0 && options.mixture <= 1))
    throw InputError(name + ": mixture: expected > 0 and <= 1, got " + exact_number(options.mixture));
  if (options.lambda && (!(*options.lambda > 0) || std::isinf(*options.lambda)))
    throw InputError(name + ": lambda: expected > 0, got " + exact_number(*options.lambda));
  if (options.path < 2) throw InputError(name + ": path: expected >= 2, got " + std::to_string(options.path));
  if (!(options.path_ratio > 0 && options.path_ratio < 1))
    throw InputError(name + ": path_ratio: expected > 0 and < 1, got " + exact_number(options.path_ratio));
}

Fit lasso(std::span<const Statistic> blocks, const LassoOptions& options, std::span<const Constraint> constraints,
          std::vector<PathPoint>* path) {
  const detail::Stopwatch watch;
  validate(options);
  if (!options.lambda && blocks.size() < 3)
    throw InputError(name_of(options) + ": cross-validation needs at least 3 blocks of time, got " +
                     std::to_string(blocks.size()));
  const Statistic data = merged(blocks);
  OrthantWalk walk(data, constraints, {}, options.mixture);

  double lambda = options.lambda.value_or(0);
  std::string how;
  if (path || !options.lambda) {
    const double greatest = walk.greatest_lambda();
    const std::vector<double> grid = lambdas(options, greatest > 0 ? greatest : 1);
    std::vector<PathPoint> points = walk_path(data, constraints, grid, options.mixture);
    if (!options.lambda) {
      const MatrixXd left_out = cross_validate(blocks, constraints, grid, options.mixture);
      lambda = points[choose(left_out, options.one_standard_error, points)].lambda;
      how = options.one_standard_error ? " (cross-validation, one standard error)" : " (cross-validation)";
    }
    if (path) *path = std::move(points);
  }
  walk.advance(lambda);
  Fit fit = report(walk.problem(), walk.point(), data, constraints, options.mixture < 1 ? &walk.plain() : nullptr);
  const std::string kind = options.mixture == 1 ? "lasso" : "elastic net, mixture = " + number(options.mixture, 3);
  const std::string selected = kind + ", lambda = " + number(lambda, 4) + how;
  if (options.refit) fit = refit(data, constraints, fit);
  fit.summary.solver = selected + (options.refit ? ", refitted by least squares" : "");
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace lunid
