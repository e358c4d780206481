#pragma once
// Inside regress: the search for parameters inside features, around the linear regression.
#include <span>
#include <vector>

#include "regress/columns.hpp"
#include "regress/regress.hpp"

namespace lunid::detail {

/// What the search needs: features, target and constraints of the linear problem, and the data.
struct ImplicitProblem {
  std::vector<Expr> features;
  Expr target;
  std::span<const Constraint> constraints;
  std::span<const Stream> records;
  std::span<const TimeBlock> blocks;
  const std::map<std::string, double>* values;  ///< of the other parameters
  int threads = 0;
  SearchOptions search;
  double mean_force = 0;  ///< part of the objective
};

/// Minimises the residual sum of squares of the constrained least-squares fit over the implicit parameters, within
/// their bounds: variable projection (Golub & Pereyra 1973, SIAM J. Numer. Anal. 10, 413) with the exact gradient,
/// by the method asked for (minimise.hpp). Returns them with values and standard deviations (joint with the
/// coefficients). `evaluations` counts passes over the data.
std::vector<ImplicitParameter> search(const ImplicitProblem& problem, std::vector<ImplicitParameter> implicit,
                                      int& evaluations);

}  // namespace lunid::detail
