#pragma once
// Inside record: the noise of a channel that comes in pieces.
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "record/spectrum.hpp"

namespace lunid {

/// noise_level() of a signal that comes in pieces, to the same bits; its size does not grow with the rows.
class NoiseSum {
 public:
  /// `rows`: how many will come.
  explicit NoiseSum(Eigen::Index rows);
  void add(std::span<const double> piece);
  double level() const;
  double low() const { return low_; }  ///< least and largest value so far
  double high() const { return high_; }

 private:
  Eigen::Index rows_, seen_ = 0;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
  std::vector<double> some_;  // every so many rows
  std::optional<WelchSum> spectrum_;
};

}  // namespace lunid
