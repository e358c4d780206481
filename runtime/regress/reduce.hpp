#pragma once
// Inside regress: a regression problem reduced to the coefficients that are free, in scaled variables.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "regress/fit.hpp"

namespace lunid::detail {

/// One side of a constraint as a row of `Problem::c`.
struct Side {
  int constraint = 0;
  bool upper = false;
  double size = 1;  ///< factor by which the row was divided
};

/// min |r u - z|^2 with c u = d (first `equalities` rows) and c u >= d (rest). u_k = size_k * b[column_k]; columns of r
/// have length 1 (before a penalty is added), rows of c too.
struct Problem {
  std::vector<int> columns;  ///< the free features
  Eigen::VectorXd size;      ///< length of each free column in the data
  LongMatrix exact;          ///< factor of [free columns, target], one row and column more than r
  Eigen::MatrixXd r;         ///< rounded from `exact`
  Eigen::VectorXd z;
  Eigen::MatrixXd c;
  Eigen::VectorXd d;
  int equalities = 0;
  std::vector<Side> sides;
  Eigen::VectorXd held;  ///< n: values of the coefficients that are not free
  std::vector<Unexcited> unexcited;
};

/// Takes out the coefficients that are fixed by a constraint, those with `zero[j]`, and those that the data do not
/// excite. Throws InputError as least_squares() says.
Problem reduce(const Statistic& data, std::span<const Constraint> constraints, const std::vector<bool>& zero = {});

/// Adds rows sqrt(weight_k) u_k to the problem (a ridge penalty), weight for each free coefficient.
void penalise(Problem& problem, const Eigen::VectorXd& weight);

/// A point of the problem with the rows of c that are active there.
struct Point {
  Eigen::VectorXd u, multipliers;
  std::vector<int> active;
  int iterations = 0;
  bool finished = true;
  double kkt = 0;  ///< largest violation of a first-order condition, relative to |z|
};
/// Solves the problem; throws InputError naming the constraint that cannot be met.
Point solve(const Problem& problem, const Statistic& data, std::span<const Constraint> constraints);

/// The solution where the rows `point.active` (independent) hold with equality, in extended precision: sets u and
/// multipliers.
void polish(const Problem& problem, Point& point);

/// All coefficients, in the user's units and order.
Eigen::VectorXd expand(const Problem& problem, const Eigen::VectorXd& u);

/// Fills in a Fit: scores, active bounds, and the covariance given that the active rows stay active. Rows of c beyond
/// `sides` are not constraints of the user's. `unpenalised`: the factor of the data alone, where problem.r holds a
/// penalty.
Fit report(const Problem& problem, const Point& point, const Statistic& data, std::span<const Constraint> constraints,
           const Eigen::MatrixXd* unpenalised = nullptr);

/// Scores of the coefficients that a fit now holds.
void rescore(Fit& fit, const Statistic& data);
/// Covariance and deviations: the square of residual_std times `unit`, that of the scaled free variables.
void set_covariance(Fit& fit, const Problem& problem, const Eigen::MatrixXd& unit);

/// Throws InputError, with its line, on a constraint that is not a single fixed coefficient.
void only_fixed(const char* solver, const Statistic& data, std::span<const Constraint> constraints);

/// Least squares under the constraints on the features that are not `zero`.
Fit fit_selected(const Statistic& data, std::span<const Constraint> constraints, const std::vector<bool>& zero);

/// `zero` with those features given back that the constraints need (so that they can be met again).
std::vector<bool> admissible(std::vector<bool> zero, const Statistic& data, std::span<const Constraint> constraints);

/// Throws InputError naming constraints that contradict one another (a smallest set of them, with their lines). Returns
/// when all can be met together.
void refuse_contradiction(const Statistic& data, std::span<const Constraint> constraints);

/// Size of each feature for a penalty (0: not penalised), and of the target (last).
Eigen::VectorXd penalty_sizes(const Statistic& data);

}  // namespace lunid::detail
