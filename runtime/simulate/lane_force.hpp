#pragma once
// A TimeTape on the stage grids of many lanes at once: every lane has the bits of TimeTape::fill. Internal to this
// room.
#include "simulate/aligned_memory.hpp"
#include "simulate/time_tape.hpp"

namespace lunid {

class LaneForce {
 public:
  /// `width`: lanes in whole groups of Tape::lane_group. The outputs go to the lanes `out`. The tape is to stay.
  LaneForce(const TimeTape& tape, int width, int substeps, std::span<double* const> out);

  double* q(int i) const { return rest_place_[static_cast<std::size_t>(1 + i)]; }
  /// After q is set: `t0` and `dt` of each lane.
  void begin(const double* t0, const double* dt) noexcept;
  /// The inputs at a place of a row's interval, counted as in the stage grid: 0 is the row itself. Rows may follow one
  /// another only, and each begins with its place 0.
  void load(Eigen::Index row, int place) noexcept;
  void repeat_lane(int from, int to) noexcept;

 private:
  double* lanes(std::size_t row) const { return memory_.data() + row * static_cast<std::size_t>(width_); }
  void begin_block(Eigen::Index row) noexcept;
  void set_time(Eigen::Index row, double place, double* t) const noexcept;

  const TimeTape& tape_;
  const int width_, nodes_;
  const bool timed_;            ///< rest() reads the time itself
  std::vector<double> places_;  ///< within an interval
  std::size_t rows_ = 0;        ///< of lanes in the memory
  AlignedMemory memory_;
  std::vector<double*> rest_place_, angle_place_;
  /// Pairs of cosines and sines: of each wave at the block's first row and at the present row; of each wave and row of
  /// a block; of each wave and place.
  double *t0_, *dt_, *base_, *now_, *turns_, *by_place_, *work_;
};

}  // namespace lunid
