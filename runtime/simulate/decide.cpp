// Which mode follows: the decisions of ModeMachine.
#include <algorithm>
#include <cmath>

#include "simulate/modes.hpp"

namespace lunid {
namespace {

/// Below this part of the largest dg/dt met on a surface the two sides count as one: there is nothing to slide on.
constexpr double jump_threshold = 1e-9;
/// A surface of the displacement met at less than this part of the greatest speed so far: the rebound is 1e-12 of the
/// greatest, and the motion rests.
constexpr double resting_speed = 1e-6;
/// Surfaces and bounds let go one after another; more passes than this would be a circle.
constexpr int max_passes = 8;

}  // namespace

/// Takes the loaded state onto the bound, in x.
void ModeMachine::set_on_bound(int bound, double* x) noexcept {
  run_rate(rate_mode_, out_.data());
  x[d_.bounds[bound].state] += d_.bounds[bound].side * out_[d_.n + bound];
}

/// Takes x onto g = 0 along the jump of the rates, the one direction that the surface can act in.
void ModeMachine::set_on_surface(int surface, const Drive& drive, double* x) noexcept {
  const int component = d_.surfaces[surface].component;
  const bool resting = surfaces_[surface].order == 2;
  if (component >= 0) {
    x[component] = 0;
    if (resting) x[component + 1] = 0;
    return;
  }
  load(drive, x);
  if (!d_.constant_gradients) refresh_gradients();
  run(drive);
  const double value = g_[d_.surfaces[surface].switch_index];
  const double* g = row(surface) + 1 + d_.exogenous;
  const double* jump = jump_of(surface);
  double slope = 0;
  if (resting) {  // along the accelerations with which the surface acts, displacements and velocities alike
    const double rate = along(row(surface), drive, out_.data());
    for (int i = 0; i < d_.degrees; ++i) slope += g[2 * i] * jump[2 * i + 1];
    if (!std::isfinite(value / slope)) return;
    for (int i = 0; i < d_.degrees; ++i) {
      x[2 * i] -= value / slope * jump[2 * i + 1];
      x[2 * i + 1] -= rate / slope * jump[2 * i + 1];
    }
    return;
  }
  for (int i = 0; i < d_.n; ++i) slope += g[i] * jump[i];
  const double step = value / slope;
  if (!std::isfinite(step)) return;
  for (int i = 0; i < d_.n; ++i) x[i] -= step * jump[i];
}

/// On a surface of the displacement met at (nearly) no speed: the accelerations of both sides decide. True when they
/// have.
bool ModeMachine::decide_rest(int surface, const Drive& drive, const double (&slope)[2]) noexcept {
  SurfaceState& state = surfaces_[surface];
  const double speed = std::max(std::abs(slope[0]), std::abs(slope[1]));
  if (!d_.surfaces[surface].positional || speed > resting_speed * state.scale) return false;
  const double* gradient = row(events() + surface);
  const double plus = along(gradient, drive, plus_.data()), minus = along(gradient, drive, out_.data());
  state.second_scale = std::max({state.second_scale, std::abs(plus), std::abs(minus)});
  if (plus <= 0 && minus >= 0 && minus - plus > jump_threshold * state.second_scale) {
    set_sliding(surface, 2);
    return true;
  }
  if (speed > 0 || (plus > 0) != (minus > 0) || plus == 0 || minus == 0) return false;
  set_mode(surface, plus > 0 ? 1 : -1);
  return true;
}

/// Filippov's choice on a surface. `arriving`: the motion came from the side of the present mode.
void ModeMachine::decide(int surface, const Drive& drive, double* x, bool arriving) {
  SurfaceState& state = surfaces_[surface];
  const std::int8_t before = state.mode;
  double slope[2];
  for (const int side : {0, 1}) {
    set_mode(surface, side == 0 ? 1 : -1);
    load(drive, x);
    if (!d_.constant_gradients) refresh_gradients();
    run(drive);
    slope[side] = along(row(surface), drive, out_.data());
    if (side == 0) std::copy_n(out_.begin(), d_.n, plus_.begin());
  }
  const auto [plus, minus] = slope;
  state.scale = std::max({state.scale, std::abs(plus), std::abs(minus)});
  if (plus <= 0 && minus >= 0 && minus - plus > jump_threshold * state.scale) {
    set_sliding(surface, 1);
    set_on_surface(surface, drive, x);
  } else if (decide_rest(surface, drive, slope)) {
    if (state.order == 2) set_on_surface(surface, drive, x);
  } else if (plus > 0 && minus > 0) {
    set_mode(surface, 1);
  } else if (plus < 0 && minus < 0) {
    set_mode(surface, -1);
  } else {
    set_mode(surface, arriving ? static_cast<std::int8_t>(-before) : before);
  }
}

/// True when, after run(), the state is on this bound and its rate pushes outward.
bool ModeMachine::rests(int bound) const noexcept {
  const auto [state, side] = d_.bounds[bound];
  const double z = rate_r_[1 + d_.exogenous + state];
  return out_[d_.n + bound] <= 1e-12 * std::abs(z) && out_[d_.n + bounds_.size() + bound] < 0;
}

void ModeMachine::start(const Drive& drive, double* x) {
  const auto by_sign = [&] {  // no mode is known yet
    load(drive, x);
    run_rate(free_mode_, out_.data());
  };
  while (sliding()) set_sliding(sliding_.back(), 0);
  by_sign();
  for (std::size_t j = 0; j < bounds_.size(); ++j) {
    bounds_[j].held = false;
    if (out_[d_.n + j] < 0) x[d_.bounds[j].state] += d_.bounds[j].side * out_[d_.n + j];
    by_sign();
  }
  std::vector<int> touching;
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const double g = g_[d_.surfaces[s].switch_index];
    set_mode(static_cast<int>(s), g < 0 ? -1 : 1);
    if (g == 0) touching.push_back(static_cast<int>(s));
  }
  for (std::size_t j = 0; j < bounds_.size(); ++j)
    bounds_[j].held = rests(static_cast<int>(j)) && !held_by_opposite(static_cast<int>(j));
  update_drifting();
  for (const int s : touching) decide(s, drive, x, false);
  settle(drive, x);
}

void ModeMachine::resolve(int event, const Drive& drive, double* x) {
  const int count = static_cast<int>(surfaces_.size());
  if (event >= count) {
    BoundState& bound = bounds_[event - count];
    bound.held = !bound.held;
    load(drive, x);
    if (bound.held) {
      set_on_bound(event - count, x);
    } else if (bound.opposite >= 0) {
      run(drive);
      bounds_[bound.opposite].held = rests(bound.opposite);
    }
    update_drifting();
  } else if (surfaces_[event].order > 0) {
    load(drive, x);
    run(drive);
    const auto l = std::find(sliding_.begin(), sliding_.end(), event) - sliding_.begin();
    const std::int8_t side = weight_[l] < 0.5 ? 1 : -1;
    set_sliding(event, 0);
    set_mode(event, side);
  } else {
    decide(event, drive, x, true);
  }
  settle(drive, x);
}

void ModeMachine::settle(const Drive& drive, double* x) {
  for (int pass = 0; pass < max_passes; ++pass) {
    if (!sliding() && bounds_.empty()) return;
    load(drive, x);
    if (!d_.constant_gradients) refresh_gradients();
    run(drive);
    int leaving = -1;
    for (std::size_t l = 0; l < sliding_.size() && leaving < 0; ++l)
      if (weight_[l] < 0 || weight_[l] > 1) leaving = static_cast<int>(l);
    if (leaving >= 0) {
      const int surface = sliding_[leaving];
      const std::int8_t side = weight_[leaving] < 0 ? 1 : -1;
      set_sliding(surface, 0);
      set_mode(surface, side);
      continue;
    }
    bool changed = false;
    for (std::size_t j = 0; j < bounds_.size() && !changed; ++j) {
      BoundState& bound = bounds_[j];
      if (!bound.held || !(out_[d_.n + bounds_.size() + j] > 0)) continue;
      bound.held = false;
      changed = true;
      if (bound.opposite >= 0) bounds_[bound.opposite].held = rests(bound.opposite);  // the bounds have met
    }
    if (!changed) return;
    update_drifting();
  }
}

void ModeMachine::project(const Drive& drive, double* x) noexcept {
  for (const int s : sliding_)
    if (d_.surfaces[s].component < 0) set_on_surface(s, drive, x);
  for (std::size_t j = 0; j < bounds_.size(); ++j)
    if (bounds_[j].held) {
      load(drive, x);
      set_on_bound(static_cast<int>(j), x);
    }
}

}  // namespace lunid
