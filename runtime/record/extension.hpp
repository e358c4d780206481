#pragma once
// Inside record: a signal continued beyond its ends, so that filters and transforms see no edge.
#include <Eigen/Core>
#include <span>

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

}  // namespace lunid
