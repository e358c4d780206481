#pragma once
// Inside surface: Chebyshev polynomials of the first kind.

namespace lunid::detail {

/// T_0(x) .. T_order(x)
inline void chebyshev_values(double x, int order, double* t) {
  t[0] = 1;
  if (order > 0) t[1] = x;
  for (int n = 2; n <= order; ++n) t[n] = 2 * x * t[n - 1] - t[n - 2];
}

}  // namespace lunid::detail
