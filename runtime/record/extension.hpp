#pragma once
// Inside record: a signal continued beyond its ends, so that filters and transforms see no edge.
#include <Eigen/Core>
#include <span>

#include "record/polynomial_sum.hpp"

namespace lunid {

/// x without its least-squares line, continued by `reach` rows on either side by linear prediction (Burg's model of the
/// rows near that end) and let down to zero: a cosine over the outer half. What a line becomes is known in closed form
/// for every filter here, and is put back by the caller.
struct Extended {
  Eigen::VectorXd values;  ///< reach + rows + reach
  Eigen::Index reach = 0;
  Eigen::VectorXd line;  ///< of the rows themselves
  double slope = 0;      ///< of the line, per row
};
Extended extend(std::span<const double> x, Eigen::Index reach);

/// What extend() makes of a signal that is not in memory as a whole.
struct Ends {
  Eigen::VectorXd before, after;  ///< the rows beyond its ends, without the line
  double origin = 0, slope = 0;   ///< of its least-squares line, at its first row and per row
  Eigen::Index rows = 0;          ///< of the signal itself

  Eigen::Index reach() const { return before.size(); }
  double line(double row) const { return origin + slope * row; }
  /// Rows [low, low + count) of the extended signal without its line, low >= -reach(); `inside`: those of them that are
  /// the signal's own, with its line.
  Eigen::VectorXd around(Eigen::Index low, Eigen::Index count, const Eigen::VectorXd& inside) const;
};
/// `head` and `tail`: its first and last ends_rows() rows; `line`: the sum of all rows, of degree 1.
Ends ends_of(Eigen::VectorXd head, Eigen::VectorXd tail, const PolynomialSum& line, Eigen::Index rows,
             Eigen::Index reach);
Eigen::Index ends_rows(Eigen::Index rows);

}  // namespace lunid
