#pragma once
// Inside regress: the step of a trust region around a linear least-squares problem (More 1978, Lecture Notes in
// Mathematics 630, 105).
#include <Eigen/Core>

#include "regress/triangle.hpp"

namespace lunid::detail {

/// The step of a trust region: min |r step - z| with |scale * step| <= radius, over the free parameters.
struct TrustStep {
  Eigen::VectorXd change;
  double length = 0;   ///< |scale * change|
  bool inner = false;  ///< the whole Gauss-Newton step
};
/// By More's iteration for the damping at which the step has the radius's length, within a tenth.
TrustStep trust_step(const LongMatrix& r, const LongVector& z, const Eigen::VectorXd& scale, double radius);

/// True when the columns of `r` are independent of those before them, to rounding.
bool full_rank(const LongMatrix& r);

}  // namespace lunid::detail
