#pragma once
// The few small dense factorisations that regress needs, by Householder reflections and plane rotations. Those that
// end in coefficients run in extended precision.
#include <Eigen/Core>

#include "regress/triangle.hpp"

namespace lunid::detail {

/// min |a x - b| by Householder QR; `a` of full column rank.
LongVector solve_by_qr(const LongMatrix& a, const LongVector& b);

/// a = q.leftCols(k) * triangle for `a` n x k of full column rank, k <= n; q is n x n and orthogonal, so that its last
/// n - k columns span what is orthogonal to `a`.
struct FullQr {
  LongMatrix q, triangle;
};
FullQr full_qr(LongMatrix a);

/// Largest over smallest singular value, by one-sided Jacobi rotations (relative accuracy for scaled columns: Demmel &
/// Veselic 1992, SIAM J. Matrix Anal. 13, 1204); 1 for no columns.
double condition_number(Eigen::MatrixXd a);

}  // namespace lunid::detail
