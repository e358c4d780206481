#pragma once
// Values of the switching operations, the same for points and columns. NaN propagates.
#include <cstdint>
#include <limits>

#include "expr/op.hpp"

namespace lunid::branch {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

inline double sign(double a) { return a > 0 ? 1 : a < 0 ? -1 : a == 0 ? 0 : nan; }
inline double min(double a, double b) { return a <= b || a != a ? a : b; }
inline double max(double a, double b) { return a >= b || a != a ? a : b; }
inline double greater(double a, double b) { return a > b ? 1 : a <= b ? 0 : nan; }
inline double greater_equal(double a, double b) { return a >= b ? 1 : a < b ? 0 : nan; }
inline double where(double condition, double a, double b) { return condition > 0 ? a : condition <= 0 ? b : nan; }

/// The value function of operation `op` on registers; unused operands are register 0 or any other.
inline double call(std::uint32_t op, std::uint32_t a, std::uint32_t b, std::uint32_t c, const double* r) {
  return row_of(static_cast<Op>(op)).value(r[a], r[b], r[c]);
}

}  // namespace lunid::branch
