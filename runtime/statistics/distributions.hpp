#pragma once
// Tail probabilities. All are accurate to about 1e-10 of their value, also far out in the tail.

namespace lunid {

double normal_tail(double z);                                      ///< P(Z > z)
double normal_quantile(double p);                                  ///< z with P(Z < z) = p, 0 < p < 1
double chi_square_tail(double x, double freedom);                  ///< P(X > x), freedom > 0
double f_tail(double f, double freedom1, double freedom2);         ///< P(F > f), both > 0
double f_quantile(double tail, double freedom1, double freedom2);  ///< f with P(F > f) = tail, 0 < tail < 1
double t_tail(double t, double freedom);                           ///< P(T > t), one-sided, freedom > 0

/// Regularised incomplete gamma function Q(a, x) = 1 - gamma(a, x)/Gamma(a); a > 0, x >= 0.
double gamma_upper(double a, double x);
/// Regularised incomplete beta function I_x(a, b); a, b > 0, 0 <= x <= 1.
double beta_lower(double x, double a, double b);

}  // namespace lunid
