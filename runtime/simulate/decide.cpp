// Which mode follows: the decisions of ModeMachine.
#include <algorithm>
#include <cmath>

#include "simulate/modes.hpp"

namespace lunid {
namespace {

/// Below this part of the largest dg/dt met on a surface the two sides count as one: there is nothing to slide on.
constexpr double jump_threshold = 1e-9;
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
  if (component >= 0) {
    x[component] = 0;
    return;
  }
  load(drive, x);
  if (!d_.constant_gradients) refresh_gradients();
  run(drive);
  const auto l = std::find(sliding_.begin(), sliding_.end(), surface) - sliding_.begin();
  const double* jump = side_.data() + l * static_cast<std::ptrdiff_t>(out_.size());
  const double* g = gradient_.data() + static_cast<std::ptrdiff_t>(surface) * d_.inputs() + 1 + d_.exogenous;
  double along = 0;
  for (int i = 0; i < d_.n; ++i) along += g[i] * jump[i];
  const double step = g_[d_.surfaces[surface].switch_index] / along;
  if (!std::isfinite(step)) return;
  for (int i = 0; i < d_.n; ++i) x[i] -= step * jump[i];
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
    slope[side] = surface_rate(surface, drive, out_.data());
  }
  const auto [plus, minus] = slope;
  state.scale = std::max({state.scale, std::abs(plus), std::abs(minus)});
  if (plus <= 0 && minus >= 0 && minus - plus > jump_threshold * state.scale) {
    set_sliding(surface, true);
    set_on_surface(surface, drive, x);
  } else if (plus > 0 && minus > 0) {
    set_mode(surface, 1);
  } else if (plus < 0 && minus < 0) {
    set_mode(surface, -1);
  } else {
    set_mode(surface, arriving ? static_cast<std::int8_t>(-before) : before);
  }
}

void ModeMachine::start(const Drive& drive, double* x) {
  const auto by_sign = [&] {  // no mode is known yet
    load(drive, x);
    run_rate(free_mode_, out_.data());
  };
  while (sliding()) set_sliding(sliding_.back(), false);
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
    bounds_[j].held = out_[d_.n + j] <= 0 && out_[d_.n + bounds_.size() + j] < 0;
  update_drifting();
  for (const int s : touching) decide(s, drive, x, false);
  settle(drive, x);
}

void ModeMachine::resolve(int event, const Drive& drive, double* x) {
  const int count = static_cast<int>(surfaces_.size());
  if (event >= count) {
    BoundState& bound = bounds_[event - count];
    bound.held = !bound.held;
    if (bound.held) {
      load(drive, x);
      set_on_bound(event - count, x);
    }
    update_drifting();
  } else if (surfaces_[event].sliding) {
    load(drive, x);
    run(drive);
    const auto l = std::find(sliding_.begin(), sliding_.end(), event) - sliding_.begin();
    const std::int8_t side = weight_[l] < 0.5 ? 1 : -1;
    set_sliding(event, false);
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
      set_sliding(surface, false);
      set_mode(surface, side);
      continue;
    }
    bool released = false;
    for (std::size_t j = 0; j < bounds_.size() && !released; ++j)
      if (bounds_[j].held && out_[d_.n + bounds_.size() + j] > 0) {
        bounds_[j].held = false;
        released = true;
      }
    if (!released) return;
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
