#pragma once
// Quantile-quantile plots.
#include <Eigen/Core>
#include <span>

namespace lunid {

/// The points of a plot, both ascending: they lie on the line of equality where the two distributions are one.
struct Quantiles {
  Eigen::VectorXd expected, found;
};
/// x in order, beside the quantiles of the normal distribution of its mean and deviation, at (i - 3/8)/(n + 1/4). (Wilk
/// & Gnanadesikan 1968, Biometrika 55, 1; Blom 1958.) Throws InputError as check_columns() does; at least 3 rows.
Quantiles normal_quantiles(std::span<const double> x);
/// The quantiles of two samples, as many as the shorter one has rows. Throws as above.
Quantiles paired_quantiles(std::span<const double> expected, std::span<const double> found);

/// The correlation of a plot's points, QQCC: 1 where the distributions differ by place and width alone. The thesis
/// names it and does not define it; for the normal plot it is Filliben's (1975, Technometrics 17, 111).
double quantile_correlation(const Quantiles& points);

}  // namespace lunid
