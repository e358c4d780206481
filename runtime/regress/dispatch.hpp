#pragma once
// Inside regress: one call for every solver of a regression on records, and for the choices of groups.
#include <functional>
#include <span>
#include <vector>

#include "regress/columns.hpp"
#include "regress/regress.hpp"

namespace lunid::detail {

/// What solvers see of the data.
struct Data {
  Pass pass;  ///< for those that need the rows again
  std::span<const Statistic> parts;
  std::vector<Expr> features;
  Expr target;
  const std::map<std::string, double>* values;  ///< of all parameters
  bool weak = false;                            ///< the parts are integrals: there are no rows to go back to
};

struct Solved {
  Fit fit;
  std::vector<PathPoint> path;
  Outliers outliers;
  /// The coefficients of the same features on other statistics, for block errors: of part k, or of all but part k.
  std::vector<Statistic> parts;  ///< of the rows as the solver weighed them
  std::function<Eigen::VectorXd(const Statistic& data)> again;
  std::vector<Constraint> constraints;  ///< with the choices of the groups
};

/// A group by the numbers of its features.
struct Choice {
  std::vector<int> features;
  int at_most = 1;
  SourceSpan where;
};

/// Solves; with groups, by each choice, and takes the one of least BIC. Throws InputError as the solvers do, and where
/// there are more than 1000 choices.
Solved solve(const RegressionSolver& solver, const Data& data, std::span<const Constraint> constraints,
             std::span<const Choice> groups);

}  // namespace lunid::detail
