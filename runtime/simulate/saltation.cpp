#include "simulate/saltation.hpp"

#include <algorithm>
#include <cmath>

namespace lunid {
namespace {

/// A crossing whose speed is below this part of the fastest one met is a graze: its jump is not to be trusted.
constexpr double grazing_speed = 1e-6;
/// Rates that agree to this part on both sides of an event do not jump there.
constexpr double continuity = 1e-12;

bool agree(const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(std::abs(a[i] - b[i]) <= continuity * (std::abs(a[i]) + std::abs(b[i])))) return false;
  return true;
}

}  // namespace

Sensitivities::Sensitivities(const Dynamics& d)
    : columns(d.p + d.n), s(d.n * columns, 0.0), n_(d.n), p_(d.p), moved_(columns) {
  for (int i = 0; i < n_; ++i) s[i * columns + p_ + i] = 1;
}

void Sensitivities::jump(const double* gx, const double* gtheta, const double* direction) {
  for (int c = 0; c < columns; ++c) moved_[c] = c < p_ ? gtheta[c] : 0;
  const auto add = [columns = columns](double factor, const double* __restrict from, double* __restrict to) {
    if (factor == 0) return;
    for (int c = 0; c < columns; ++c) to[c] += factor * from[c];
  };
  for (int i = 0; i < n_; ++i) add(gx[i], s.data() + i * columns, moved_.data());
  for (int i = 0; i < n_; ++i) add(direction[i], moved_.data(), s.data() + i * columns);
}

Saltation::Saltation(ModeMachine& modes, JumpSink* sink)
    : modes_(modes), d_(modes.dynamics()), sink_(sink), gradient_(d_.inputs()), direction_(d_.n), before_(d_.n) {}

void Saltation::start(const Drive& drive, double* x) {
  std::copy_n(x, d_.n, before_.begin());
  modes_.start(drive, x);
  if (!sink_) return;
  for (std::size_t j = 0; j < d_.bounds.size(); ++j) {
    const auto [state, side] = d_.bounds[j];
    const bool cut = side > 0 ? x[state] < before_[state] : x[state] > before_[state];
    if (cut || modes_.held(static_cast<int>(j))) set_on_bound(static_cast<int>(j), drive, x);
  }
  for (int i = 0; i < static_cast<int>(d_.surfaces.size()); ++i)
    if (modes_.rests_on(i)) {
      rest(i, drive, x);
    } else if (const int state = d_.surfaces[i].component; modes_.slides_on(i) && state >= 0) {
      std::fill(gradient_.begin(), gradient_.end(), 0.0);
      std::fill(direction_.begin(), direction_.end(), 0.0);
      gradient_[1 + d_.exogenous + state] = 1;
      direction_[state] = -1;
      const double* gx = gradient_.data() + 1 + d_.exogenous;
      sink_->jump(gx, gx + d_.n, direction_.data());
    }
}

void Saltation::resolve(int event, const Drive& drive, double* x, Observation& now) {
  const bool jumps = sink_ && modes_.jumps(event);
  if (jumps) {
    before_ = now.f;
    std::copy_n(modes_.gradient(event, drive, x), d_.inputs(), gradient_.data());
  }
  modes_.resolve(event, drive, x);
  modes_.observe(drive, x, now);
  if (!jumps) return;
  for (int i = 0; i < d_.exogenous; ++i) gradient_[0] += gradient_[1 + i] * drive.rate[i];
  if (event < static_cast<int>(d_.surfaces.size()) && modes_.rests_on(event))
    rest(event, drive, x);
  else
    cross(gradient_.data(), before_, now.f);
  hold(drive, x);
}

void Saltation::project(const Drive& drive, double* x) {
  modes_.project(drive, x);
  if (sink_) hold(drive, x);
}

/// s+ = s- + (f+ - f-) (gx s- + gtheta) / (gx f- + gt): the time of the event moves with theta and x0. gradient[0]
/// holds the whole derivative by time.
void Saltation::cross(double* gradient, const std::vector<double>& before, const std::vector<double>& after) {
  const double* gx = gradient + 1 + d_.exogenous;
  double speed = gradient[0], size = std::abs(gradient[0]);
  for (int i = 0; i < d_.n; ++i) {
    speed += gx[i] * before[i];
    size += std::abs(gx[i] * before[i]);
  }
  if (agree(after, before)) return;
  if (!(std::abs(speed) > grazing_speed * size)) {
    ++grazing;
    return;
  }
  for (int i = 0; i < d_.n; ++i) direction_[i] = (after[i] - before[i]) / speed;
  sink_->jump(gx, gx + d_.n, direction_.data());
}

/// At rest on a surface of displacements: g and dg/dt stay zero, taken up along the accelerations of the surface.
void Saltation::rest(int surface, const Drive& drive, const double* x) {
  const double* place = modes_.gradient(surface, drive, x);
  const double* speed = modes_.rate_gradient(surface);
  const double* jump = modes_.jump_of(surface);
  double slope = 0;
  for (int i = 0; i < d_.degrees; ++i) slope += place[1 + d_.exogenous + 2 * i] * jump[2 * i + 1];
  for (int row = 0; row < 2; ++row) {
    const double* gx = (row == 0 ? place : speed) + 1 + d_.exogenous;
    std::fill(direction_.begin(), direction_.end(), 0.0);
    for (int i = 0; i < d_.degrees; ++i) direction_[2 * i + row] = -jump[2 * i + 1] / slope;
    sink_->jump(gx, gx + d_.n, direction_.data());
  }
}

/// States held at their bounds follow them.
void Saltation::hold(const Drive& drive, const double* x) {
  for (std::size_t j = 0; j < d_.bounds.size(); ++j)
    if (modes_.held(static_cast<int>(j))) set_on_bound(static_cast<int>(j), drive, x);
}

/// A state on its bound: ds = d bound.
void Saltation::set_on_bound(int bound, const Drive& drive, const double* x) {
  const double* gx = modes_.gradient(static_cast<int>(d_.surfaces.size()) + bound, drive, x) + 1 + d_.exogenous;
  std::fill(direction_.begin(), direction_.end(), 0.0);
  direction_[d_.bounds[bound].state] = d_.bounds[bound].side;
  sink_->jump(gx, gx + d_.n, direction_.data());
}

}  // namespace lunid
