#pragma once
// Inside record: polynomials of signals that need not be in memory.
#include <Eigen/Core>
#include <span>

namespace lunid {

/// The least-squares polynomial of a signal that comes in pieces, by the discrete orthogonal polynomials (Gram 1883),
/// whose recurrence and norms are closed forms.
class PolynomialSum {
 public:
  /// `rows`: how many will come; `degree`: 0 to 12.
  PolynomialSum(Eigen::Index rows, int degree);
  /// The next rows. The pieces make part of the rounding: a stream's and a record's are the same (add_in_pieces).
  void add(std::span<const double> piece);
  /// Rows as a stream would bring them.
  void add_in_pieces(std::span<const double> all);
  /// Its values at rows [first, first + count), when all have come.
  Eigen::VectorXd values(Eigen::Index first, Eigen::Index count) const;

 private:
  /// Calls use(k, p_k over these rows) for the polynomials of degree k = 0, 1, ...
  template <class Use>
  void each(Eigen::Index first, Eigen::Index count, Use use) const;

  Eigen::Index rows_, seen_ = 0;
  Eigen::VectorXd sums_, squares_;  // of p_k times the signal, of p_k^2
};
}  // namespace lunid
