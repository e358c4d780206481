#include "regress/trust_region.hpp"

#include <algorithm>
#include <cmath>

namespace lunid::detail {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr long double kRank = 1e-13L;  // diagonal of the scaled factor below which a column is one of those before it

/// One value of the damping: the step and d length / d damping.
struct Damped {
  LongVector step;
  double length = 0, slope = 0;
};

Damped damped(const LongMatrix& r, const LongVector& z, const VectorXd& scale, long double damping) {
  const Index k = r.cols();
  LongMatrix work = LongMatrix::Zero(k + 1, k + 1), below = LongMatrix::Zero(k, k + 1);
  work.topLeftCorner(k, k) = r;
  work.col(k).head(k) = z;
  below.leftCols(k).diagonal() = std::sqrt(damping) * scale.cast<long double>();
  triangularise(work, below);
  const LongMatrix root = work.topLeftCorner(k, k);
  Damped out;
  out.step = root.triangularView<Eigen::Upper>().solve(work.col(k).head(k));
  const LongVector scaled = scale.cast<long double>().cwiseProduct(out.step);
  const long double length = scaled.norm();
  out.length = static_cast<double>(length);
  if (!(length > 0)) return out;
  const LongVector q = scale.cast<long double>().cwiseProduct(scaled) / length;
  const LongVector w = root.triangularView<Eigen::Upper>().transpose().solve(q);
  out.slope = static_cast<double>(-length * w.squaredNorm());
  return out;
}

}  // namespace

bool full_rank(const LongMatrix& r) {
  for (Index j = 0; j < r.cols(); ++j)
    if (!(std::abs(r(j, j)) > kRank * r.col(j).head(j + 1).norm())) return false;
  return true;
}

TrustStep trust_step(const LongMatrix& r, const LongVector& z, const VectorXd& scale, double radius) {
  double low = 0;
  if (full_rank(r)) {
    const Damped whole = damped(r, z, scale, 0);
    if (whole.length <= 1.1 * radius) return {whole.step.cast<double>(), whole.length, true};
    low = -(whole.length - radius) / whole.slope;
  }
  const VectorXd gradient = (r.transpose() * z).cast<double>();
  double high = gradient.cwiseQuotient(scale).norm() / radius;
  double damping = std::max(low, 1e-3 * high);
  Damped found;
  for (int i = 0; i < 12; ++i) {
    if (!(damping > 0)) damping = std::max(1e-300, 1e-3 * high);
    found = damped(r, z, scale, damping);
    const double excess = found.length - radius;
    if (std::abs(excess) <= 0.1 * radius) break;
    (excess > 0 ? low : high) = excess > 0 ? std::max(low, damping) : std::min(high, damping);
    damping = std::max(low, damping - (found.length / radius) * excess / found.slope);
  }
  return {found.step.cast<double>(), found.length, false};
}

}  // namespace lunid::detail
