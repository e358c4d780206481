#pragma once
// Where the mean square of a residual force is above its noise: over time, amplitude and frequency.
#include "discover/residual_maps.hpp"

namespace lunid {

constexpr double few_rows = 5;        ///< in a bin, below which it says nothing
constexpr double false_alarm = 0.05;  ///< of a map that noise alone makes

int bin_of(double x, double low, double high, int count);
/// Of `count` equal bins from `low` to `high`.
Eigen::VectorXd centres(double low, double high, int count);

/// The rows' time; where a record begins before the end of the one before it, it is put behind that.
Eigen::VectorXd running_time(const ResidualRows& rows);

/// The power of a noise, from what its blocks and its frequencies have in the middle: a force that acts for a part of
/// the time or at single frequencies is no noise, and does not raise it while that part is less than half.
struct NoisePower {
  double mean = 0;          ///< mean square
  double freedom = 1;       ///< degrees of freedom of a row, as the noise's colour makes them
  double all_rows = 1;      ///< from which it is known
  Eigen::VectorXd density;  ///< [unit^2/Hz] of the longest record's frequencies, without lines; 0 at 0

  /// Root of the mean square that so many rows stay below in all `bins` at once, 95 %.
  double level(double rows, double bins) const;
};

/// `noise`: what the residual has that is no function of y and v; `left`: the share of the noise's power that is left
/// in it.
NoisePower noise_power(const ResidualRows& rows, const Eigen::VectorXd& noise, double left);

BinnedMap time_map(const ResidualRows& rows, const NoisePower& noise);
/// Over the local amplitude sqrt(y^2 + (v/omega)^2).
BinnedMap amplitude_map(const ResidualRows& rows, const NoisePower& noise);
/// Of the longest record; its mean is left out.
BinnedMap frequency_map(const ResidualRows& rows, const NoisePower& noise);

}  // namespace lunid
