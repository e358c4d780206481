#pragma once
// Least squares under linear constraints: the strictly convex quadratic programme behind every constrained regression.
#include <Eigen/Core>
#include <vector>

namespace lunid {

struct QuadraticSolution {
  Eigen::VectorXd x;
  Eigen::VectorXd multipliers;  ///< one for each row of c; >= 0 for inequalities, 0 where inactive
  std::vector<int> active;      ///< rows that hold with equality, in the order in which they were taken up
  int iterations = 0;           ///< constraints taken up or dropped
  bool finished = true;         ///< false: stopped by the limit on iterations (rounding)
  int blocked = -1;             ///< not -1: this row cannot be met together with the others (infeasible)
};

/// min |r x - z|^2 / 2  subject to  c x = d for the first `equalities` rows and c x >= d for the rest.
/// `r` is n x n upper triangular and not singular; rows of `c` and columns of `r` should be of like size (scale
/// before). Dual active-set method of Goldfarb & Idnani (1983), Math. Programming 27, 1-33, on the triangular factor
/// itself, so that the condition is not squared.
QuadraticSolution solve_quadratic(const Eigen::MatrixXd& r, const Eigen::VectorXd& z, const Eigen::MatrixXd& c,
                                  const Eigen::VectorXd& d, int equalities);

}  // namespace lunid
