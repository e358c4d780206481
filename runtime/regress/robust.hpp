#pragma once
// Huber's regression: outliers count linearly. It weighs rows anew in each pass, and is exempt from the one pass.
#include <vector>

#include "regress/columns.hpp"
#include "regress/fit.hpp"

namespace lunid {

struct HuberOptions {
  double threshold = 1.345;  ///< > 0: residuals beyond so many deviations count linearly (95 % efficient at the normal)
  double outlier = 4;        ///< > threshold: residuals beyond so many deviations are reported
  int max_passes = 100;      ///< >= 1, over the data
};
void validate(const HuberOptions& options);

/// A row whose residual is large.
struct Outlier {
  std::size_t record = 0;
  Eigen::Index row = 0;
  double time = 0;  ///< [s]
  double size = 0;  ///< residual over the scale of the residuals, with its sign
};
struct Outliers {
  Eigen::Index count = 0;
  std::vector<Outlier> largest;  ///< at most 20, the largest first
};

namespace detail {

/// The data of a regression as the passes of a reweighting see it.
struct Pass {
  const Columns& columns;
  std::span<const Stream> records;
  std::span<const TimeBlock> blocks;
  std::span<const double> values;
  int threads = 0;
};

/// Minimises the sum of Huber's function of the residuals over the coefficients and the scale together (Huber 1981,
/// Robust Statistics, 7.7: proposal 2, convex in both), by reweighted least squares under the constraints. `weighted`
/// receives the blocks' statistics of the weighted rows; rmse and r2 are those of the plain residuals. Covariance:
/// Huber 1981, equation 7.6.5.
Fit huber(const Pass& pass, std::span<const Statistic> plain, const HuberOptions& options,
          std::span<const Constraint> constraints, std::vector<Statistic>& weighted, Outliers& outliers);

}  // namespace detail
}  // namespace lunid
