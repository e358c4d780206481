#pragma once
// Least squares with rows that are short: what smoothing splines and Kalman smoothers come down to.
#include <Eigen/Core>
#include <span>

namespace lunid {

/// min |A x - b| where each row of A has its entries within `band` neighbouring columns. Rows are folded into a banded
/// triangle R by Givens rotations, which does not square the condition as normal equations would. Add the rows in the
/// order of their first columns: each then costs band^2, else as much as there are columns. (Golub & Van Loan 2013,
/// 5.1.)
class BandedLeastSquares {
 public:
  BandedLeastSquares(Eigen::Index unknowns, Eigen::Index band);
  /// A row with the entries `row` in the columns first, first + 1, ...; at most `band` of them.
  void add(Eigen::Index first, std::span<const double> row, double right);
  /// The unknowns. Those that no row determines are NaN or infinite.
  Eigen::VectorXd solve() const;
  double squares() const { return squares_; }  ///< |A x - b|^2 at the solution
  double log_determinant() const;              ///< of R: half that of A^T A
  /// Band of (A^T A)^-1: column j holds the entries (j, j), (j, j + 1) ... (j, j + band - 1). (Takahashi, Fagan & Chen
  /// 1973; Hutchinson & de Hoog 1985.)
  Eigen::MatrixXd inverse_band() const;

 private:
  Eigen::Index unknowns_, band_;
  Eigen::MatrixXd triangle_;  ///< column j: R(j, j .. j + band - 1)
  Eigen::VectorXd right_;
  double squares_ = 0;
  Eigen::VectorXd work_;
};

}  // namespace lunid
