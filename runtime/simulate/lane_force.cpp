#include "simulate/lane_force.hpp"

#include <algorithm>
#include <utility>

#include "expr/kernel.hpp"
#include "simulate/dormand_prince.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using kernel::quad;

LUNID_WIDE void set_times(int width, const double* t0, const double* dt, double part, double* t) noexcept {
  for (int l = 0; l < width; l += 4) quad(t + l) = quad(t0 + l) + quad(dt + l) * part;
}

/// Cosine and sine of the angles, side by side.
LUNID_WIDE void set_circle(int width, const double* angle, double* to) noexcept {
  kernel::sines(static_cast<std::size_t>(width), to, angle, 1);
  kernel::sines(static_cast<std::size_t>(width), to + width, angle, 0);
}
LUNID_WIDE void set_turn(int width, const double* rate, const double* dt, double part, double* work,
                         double* to) noexcept {
  for (int l = 0; l < width; l += 4) quad(work + l) = quad(rate + l) * (quad(dt + l) * part);
  kernel::sines(static_cast<std::size_t>(width), to, work, 1);
  kernel::sines(static_cast<std::size_t>(width), to + width, work, 0);
}

/// to = from turned on; both parts of it.
LUNID_WIDE void turn(int width, const double* from, const double* by, double* to) noexcept {
  for (int l = 0; l < width; l += 4) {
    const auto c = quad(from + l), s = quad(from + width + l);
    const auto rc = quad(by + l), rs = quad(by + width + l);
    quad(to + l) = c * rc - s * rs;
    quad(to + width + l) = s * rc + c * rs;
  }
}
LUNID_WIDE void turn_part(int width, const double* from, const double* by, bool sine, double* to) noexcept {
  const double *const c = from, *const s = from + width, *const rc = by, *const rs = by + width;
  if (sine)
    for (int l = 0; l < width; l += 4) quad(to + l) = quad(s + l) * quad(rc + l) + quad(c + l) * quad(rs + l);
  else
    for (int l = 0; l < width; l += 4) quad(to + l) = quad(c + l) * quad(rc + l) - quad(s + l) * quad(rs + l);
}

}  // namespace

LaneForce::LaneForce(const TimeTape& tape, int width, int substeps)
    : tape_(tape), width_(width), nodes_(dormand_prince::nodes * substeps), timed_(tape.rest().reads(0)) {
  for (int j = 0; j < substeps; ++j)
    for (int i = 0; i < dormand_prince::nodes; ++i) places_.push_back((j + dormand_prince::place[i]) / substeps);
  const auto room = [](const Tape& t) { return static_cast<std::size_t>(std::max(t.registers(), t.inputs()) + 1); };
  rest_place_.resize(room(tape.rest()));
  angle_place_.resize(room(tape.angles()));
  const auto waves = static_cast<std::size_t>(tape.waves()), turned = static_cast<std::size_t>(TimeTape::turned_rows);
  rows_ =
      rest_place_.size() + angle_place_.size() + 3 + 2 * waves * (3 + turned + places_.size()) + tape.values().size();
  memory_.resize(rows_ * static_cast<std::size_t>(width));
  std::size_t next = 0;
  const auto take = [&](std::size_t rows) { return lanes(std::exchange(next, next + rows)); };
  for (double*& place : rest_place_) place = take(1);
  for (double*& place : angle_place_) place = take(1);
  t0_ = take(1);
  dt_ = take(1);
  work_ = take(1);
  base_ = take(2 * waves);
  now_ = take(2 * waves);
  before_ = take(2 * waves);
  turns_ = take(2 * waves * turned);
  by_place_ = take(2 * waves * places_.size());
  values_ = take(tape.values().size());
  std::copy_n(rest_place_.begin() + 1, tape.inputs() - 1, angle_place_.begin() + 1);
  tape.rest().prepare_lanes(rest_place_.data(), width);
  tape.angles().prepare_lanes(angle_place_.data(), width);
}

void LaneForce::set_time(Index row, double place, double* t) const noexcept {
  set_times(width_, t0_, dt_, static_cast<double>(row) + place, t);
}

void LaneForce::begin(const double* t0, const double* dt) noexcept {
  std::copy_n(t0, width_, t0_);
  std::copy_n(dt, width_, dt_);
  if (tape_.waves() == 0) return;
  set_time(0, 0, angle_place_[0]);
  tape_.angles().run_lanes(angle_place_.data(), width_);
  const int pair = 2 * width_;
  for (int w = 0; w < tape_.waves(); ++w) {
    const double* const rate =
        angle_place_[static_cast<std::size_t>(tape_.angles().output_place() + tape_.waves() + w)];
    for (Index r = 0; r < TimeTape::turned_rows; ++r)
      set_turn(width_, rate, dt_, static_cast<double>(r), work_, turns_ + pair * (w * TimeTape::turned_rows + r));
    for (int p = 0; p < nodes_; ++p)
      set_turn(width_, rate, dt_, places_[static_cast<std::size_t>(p)], work_, by_place_ + pair * (w * nodes_ + p));
  }
}

void LaneForce::begin_block(Index row) noexcept {
  set_time(row, 0, angle_place_[0]);
  tape_.angles().run_lanes(angle_place_.data(), width_);
  for (int w = 0; w < tape_.waves(); ++w)
    set_circle(width_, angle_place_[static_cast<std::size_t>(tape_.angles().output_place() + w)],
               base_ + 2 * width_ * w);
}

void LaneForce::turn_to(Index row) noexcept {
  if (tape_.waves() == 0) return;
  const int pair = 2 * width_;
  const Index within = row % TimeTape::turned_rows;
  if (within == 0) begin_block(row);
  std::swap(now_, before_);
  for (int w = 0; w < tape_.waves(); ++w)
    turn(width_, base_ + pair * w, turns_ + pair * (w * TimeTape::turned_rows + within), now_ + pair * w);
}

void LaneForce::values(int place, double** to) noexcept {
  const auto values = tape_.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [wave, sine] = values[i];
    to[i] = place > 0 ? values_ + static_cast<std::ptrdiff_t>(i) * width_ : sine ? this->sine(wave) : cosine(wave);
    if (place > 0) turn_part(width_, cosine(wave), cosine_of(wave, place), sine, to[i]);
  }
}

void LaneForce::load(Index row, int place, double* const* out) noexcept {
  if (place == 0) turn_to(row);
  values(place, rest_place_.data() + tape_.inputs());
  std::copy_n(out, tape_.outputs(), rest_place_.begin() + tape_.rest().output_place());
  if (timed_) set_time(row, places_[static_cast<std::size_t>(place)], rest_place_[0]);
  tape_.rest().run_lanes(rest_place_.data(), width_);
}

void LaneForce::repeat_lane(int from, int to) noexcept {
  for (std::size_t row = 0; row < rows_; ++row) lanes(row)[to] = lanes(row)[from];
}

}  // namespace lunid
