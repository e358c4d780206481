#pragma once
// Running summaries of the members of a bundle. Internal to this room.
#include <vector>

#include "simulate/ensemble.hpp"

namespace lunid {

/// Of `width` lanes side by side (a multiple of 4; lanes do not mix, so the bits do not depend on it).
class LaneSummaries {
 public:
  LaneSummaries(std::span<const EnsembleOutput> outputs, int width);

  /// One more row: value i of lane l at [i * width + l] of the states and of their rates.
  void add(const double* x, const double* f) noexcept;
  double value(int output, int lane) const;

  struct Signal {
    int state;
    bool rate;
    std::string name;
    bool extremes = false, sums = false, last = false;  ///< what the outputs need
  };
  const std::vector<Signal>& signals() const { return signals_; }

 private:
  enum Part { least, greatest, first, last, sum, squares, parts };
  double* part(std::size_t signal, Part p) noexcept { return memory_.data() + (parts * signal + p) * width_; }
  const double* part(std::size_t signal, Part p) const noexcept {
    return memory_.data() + (parts * signal + p) * width_;
  }

  std::span<const EnsembleOutput> outputs_;
  std::vector<Signal> signals_;
  std::vector<std::size_t> signal_of_;  ///< of each output
  std::size_t width_;
  long rows_ = 0;
  std::vector<double> memory_;
};

}  // namespace lunid
