#pragma once
// Intervals of any statistic of coloured rows.
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lunid {

/// Statistics of the rows with these numbers (they may repeat), in their order. Called by several threads at a time
/// where more than one is asked for.
using RowStatistics = std::function<Eigen::VectorXd(std::span<const Eigen::Index> rows)>;

struct IntervalOptions {
  double level = 0.95;            ///< > 0 and < 1
  int draws = 999;                ///< of the bootstrap; >= 99
  Eigen::Index block_length = 1;  ///< rows that stay together: 1 for independent rows (choose_block_length)
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all cores. The same bits for any number
};

struct Interval {
  double low = 0, high = 0;
  double std = 0;  ///< of the statistic
};

/// An interval for each statistic: quantiles of its values over rows resampled in blocks. (Efron 1979; Kuensch 1989.)
/// Throws InputError for options out of range and for a statistic that is not finite.
std::vector<Interval> bootstrap_intervals(Eigen::Index rows, const RowStatistics& of, const IntervalOptions& options);

/// The same with each block left out in turn: value +- z times the deviation that follows. For statistics that rows
/// which repeat would mislead, such as distances to nearest neighbours. (Kuensch 1989, 2.) At least 5 blocks; long
/// records are cut into 50.
std::vector<Interval> jackknife_intervals(Eigen::Index rows, const RowStatistics& of, const IntervalOptions& options);

}  // namespace lunid
