#pragma once
// A TimeTape on the stage grids of many lanes at once: every lane has the bits of TimeTape::fill. Internal to this
// room.
#include "simulate/aligned_memory.hpp"
#include "simulate/time_tape.hpp"

namespace lunid {

class LaneForce {
 public:
  /// `width`: lanes in whole groups of Tape::lane_group. The tape is to stay.
  LaneForce(const TimeTape& tape, int width, int substeps);

  double* q(int i) const { return rest_place_[static_cast<std::size_t>(1 + i)]; }
  /// After q is set: `t0` and `dt` of each lane.
  void begin(const double* t0, const double* dt) noexcept;
  /// The outputs to the lanes `out`, at a place of a row's interval, counted as in the stage grid: 0 is the row itself.
  /// Rows may follow one another only, and each begins with its place 0, or with turn_to.
  void load(Eigen::Index row, int place, double* const* out) noexcept;

  /// For those who turn the waves on from a row themselves (StepTape): the row's place 0, and the factors.
  void turn_to(Eigen::Index row) noexcept;
  double* cosine(int wave) const noexcept { return now_ + 2 * width_ * wave; }
  double* sine(int wave) const noexcept { return cosine(wave) + width_; }
  double* cosine_of(int wave, int place) const noexcept { return by_place_ + 2 * width_ * (wave * nodes_ + place); }
  double* sine_of(int wave, int place) const noexcept { return cosine_of(wave, place) + width_; }
  /// What rest() takes of the waves, at a place of the row; `to`: rows of lanes, of which those at place 0 are not
  /// written but pointed to.
  void values(int place, double** to) noexcept;
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
  double *t0_, *dt_, *base_, *now_, *before_, *turns_, *by_place_, *work_;
  double* values_;  ///< of rest(), away from place 0
};

}  // namespace lunid
