#include "simulate/event_run.hpp"

#include <algorithm>
#include <limits>

#include "simulate/dormand_prince.hpp"

namespace lunid {
namespace {

namespace dp = dormand_prince;
using Eigen::Index;

/// A place in the substep is known to this part of it.
constexpr double location_tolerance = 1e-12;
constexpr double bracket_width = 4 * location_tolerance;
constexpr int location_iterations = 100;
constexpr int newton_iterations = 10;
/// Beyond this many events the rest of a substep is taken in one mode: the motion chatters faster than steps resolve.
constexpr int events_per_substep = 50;

}  // namespace

EventRun::EventRun(const FixedProblem& problem, const Eigen::VectorXd& x0)
    : problem_(problem),
      d_(*problem.dynamics),
      n_(d_.n),
      p_(d_.p),
      modes_(d_, problem.theta, problem.dt / problem.substeps),
      sensitivities_(problem.sensitivities ? std::optional<Sensitivities>(d_) : std::nullopt),
      saltation_(modes_, sensitivities_ ? &*sensitivities_ : static_cast<JumpSink*>(problem.motion)),
      x_(x0.data(), x0.data() + n_),
      trial_(n_),
      stage_(n_),
      k_(dp::stages * n_),
      now_(modes_.observation()),
      then_(modes_.observation()),
      above_(modes_.observation()) {
  if (sensitivities_) {
    s_stage_ = sensitivities_->s;
    ks_.resize(dp::stages * s_stage_.size());
    slopes_.resize(dp::stages * static_cast<std::size_t>(n_ * (n_ + p_)));
  }
  const Drive drive = drive_at_start(0);
  saltation_.start(drive, x_.data());
  modes_.observe(drive, x_.data(), now_);
}

bool EventRun::substep(Index row, int j) {
  Segment part = segment_of(problem_, row, j);
  return advance(part);
}

FixedOutcome EventRun::run(RowSink& sink) {
  long count = 0;
  for (Index row = 0; row < problem_.rows; ++row) {
    if (problem_.hold && row > 0) {
      const Drive drive = drive_at_start(row);
      modes_.settle(drive, x_.data());
      modes_.observe(drive, x_.data(), now_);
    }
    sink.row(row, x_.data(), now_.f.data(), sensitivities_ ? sensitivities_->s.data() : nullptr);
    if (row + 1 == problem_.rows) break;
    bool going = true;
    for (int j = 0; j < problem_.substeps && going; ++j) {
      if ((count++ & (cancel_interval - 1)) == 0) check_cancelled(problem_.cancelled);
      going = substep(row, j);
    }
    if (!going) break;
  }
  outcome_.steps = count;
  outcome_.evaluations = modes_.evaluations;
  outcome_.grazing = saltation_.grazing;
  return outcome_;
}

bool EventRun::failed(Segment& segment, double at, Stop stop) {
  outcome_.stop = stop;
  outcome_.stopped_at = segment.t + at * segment.h;
  outcome_.last = Eigen::Map<const Eigen::VectorXd>(x_.data(), n_);
  return false;
}

/// One substep with all its events; false when the run stops.
bool EventRun::advance(Segment& segment) {
  double at = 0;
  int idle = 0, met = 0;  // events in a row at one place, and all of this substep
  while (at < 1) {
    double to = 1;
    int event = due();
    if (event >= 0) {
      to = at;
    } else {
      event = first_event(segment, at, to);
      if (!all_finite(trial_.data(), n_)) return failed(segment, at, Stop::exploded);
    }
    const bool circling = event >= 0 && (idle > 4 * modes_.events() || met > events_per_substep);
    if (event < 0 || circling) {
      if (circling) probe(segment, at, to = 1, event);
      accept(segment, at, to);
      if (circling) modes_.start(drive(segment, 1), x_.data());
      if (circling) modes_.observe(drive(segment, 1), x_.data(), now_);
      at = 1;
    } else {
      idle = to > at ? 0 : idle + 1;
      if (to > at) accept(segment, at, to);
      happen(segment, to, event);
      at = to;
      ++met;
      if (++outcome_.events > problem_.max_events) {
        outcome_.event = event;
        return failed(segment, at, Stop::too_many_events);
      }
    }
    if (beyond(problem_, x_.data())) return failed(segment, at, Stop::exploded);
  }
  return true;
}

/// trial_ = x_ carried from one part of the substep to another in the present mode; N states (0: any number).
template <int N>
void EventRun::step_state(Segment& segment, double from, double to) noexcept {
  const double h = (to - from) * segment.h;
  double* const k = k_.data();
  std::copy_n(now_.f.data(), n_, k);
  const auto stage = [&]<int S> {
    dp::stage_state<S, N>(n_, h, x_.data(), k, stage_.data());
    modes_.rate(stage_drive(segment, from, to, S), stage_.data(), k + S * n_);
  };
  stage.template operator()<1>();
  stage.template operator()<2>();
  stage.template operator()<3>();
  stage.template operator()<4>();
  stage.template operator()<5>();
  dp::stage_state<6, N>(n_, h, x_.data(), k, trial_.data());
}

void EventRun::step(Segment& segment, double from, double to) noexcept {
  linearised_ = false;
  if (n_ == 2) return step_state<2>(segment, from, to);
  if (n_ == 3) return step_state<3>(segment, from, to);
  step_state<0>(segment, from, to);
}

/// The stages of that step with their derivatives, which the sensitivities take.
void EventRun::linearise(Segment& segment, double from, double to) noexcept {
  const double h = (to - from) * segment.h;
  const std::ptrdiff_t size = n_ * (n_ + p_);
  for (int stage = 0; stage < dp::stages; ++stage) {
    if (stage == 0)
      stage_ = x_;
    else
      dp::stage_state(stage, n_, h, x_.data(), k_.data(), stage_.data());
    const Derivatives at = modes_.derivatives(stage_drive(segment, from, to, stage), stage_.data());
    std::copy_n(at.f, n_, k_.data() + stage * n_);
    double* const slopes = slopes_.data() + stage * size;
    std::copy_n(at.jtheta, n_ * p_, std::copy_n(at.jx, n_ * n_, slopes));
  }
}

/// The sensitivities carried along with x_, which stays.
void EventRun::step_sensitivities(Segment& segment, double from, double to) noexcept {
  if (!linearised_) linearise(segment, from, to);
  const double h = (to - from) * segment.h;
  std::vector<double>& s = sensitivities_->s;
  const int size = static_cast<int>(s.size());
  for (int stage = 0; stage < dp::stages; ++stage) {
    if (stage > 0) dp::stage_state(stage, size, h, s.data(), ks_.data(), s_stage_.data());
    const double* const slopes = slopes_.data() + stage * static_cast<std::ptrdiff_t>(n_ * (n_ + p_));
    sensitivity_rate(n_, p_, slopes, slopes + n_ * n_, steepest / h, stage > 0 ? s_stage_.data() : s.data(),
                     ks_.data() + stage * size);
  }
  dp::stage_state<6>(size, h, s.data(), ks_.data(), s.data());
}

/// Steps to a part of the substep and returns the event function there (NaN where the state is not finite).
double EventRun::probe(Segment& segment, double from, double to, int event) noexcept {
  step(segment, from, to);
  modes_.observe(drive(segment, to), trial_.data(), then_);
  return then_.event[event];
}

/// A bound whose function is below zero already and does not rise: several may fall at one place (the elements of a
/// joint that all let go where the motion turns), and the first that is decided leaves the others so. -1: none. A
/// surface is left to the step: what pushes towards it is known only beyond it.
int EventRun::due() const noexcept {
  for (int e = static_cast<int>(d_.surfaces.size()); e < modes_.events(); ++e)
    if (now_.event[e] < 0 && !(now_.slope[e] > 0)) return e;
  return -1;
}

/// Among the event functions that are below zero at the end of a step, the one that a straight line takes there first.
int EventRun::estimate_first(double width) const noexcept {
  int first = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int e = 0; e < modes_.events(); ++e) {
    const double from = now_.event[e], to = then_.event[e];
    if (to >= 0) continue;
    const double place = from > 0 && to < 0 ? width * from / (from - to) : 0;
    if (first < 0 || place < least) {
      first = e;
      least = place;
    }
  }
  return first;
}

/// Takes a trial step to `to`; returns the first event within it, having moved `to` and the trial there, or -1.
int EventRun::first_event(Segment& segment, double from, double& to) noexcept {
  if (sensitivities_ && from == 0) {  // most substeps hold no event: the trial will be accepted
    linearise(segment, from, to);
    dp::stage_state<6>(n_, (to - from) * segment.h, x_.data(), k_.data(), trial_.data());
    linearised_ = true;
  } else {
    step(segment, from, to);
  }
  if (!all_finite(trial_.data(), n_)) return -1;
  modes_.observe(drive(segment, to), trial_.data(), then_);
  int event = estimate_first(to - from);
  if (event < 0) event = find_dip(segment, from, to);
  if (event < 0) return -1;
  for (int guard = 0; guard <= modes_.events(); ++guard) {
    to = locate(segment, from, to, event);
    if (!(to > from)) return event;
    // another function may be below zero at the place found: then it was there earlier, or fell at the same place
    int earlier = -1;
    for (int e = 0; e < modes_.events(); ++e)
      if (e != event && then_.event[e] < 0 && now_.event[e] > 0 && !fell_here(segment, e)) earlier = e;
    if (earlier < 0) return event;
    event = earlier;
  }
  return event;
}

/// An event function that is above zero at both ends but below within: its least value on the cubic through both ends
/// is looked at by a real step.
int EventRun::find_dip(Segment& segment, double from, double& to) noexcept {
  const double width = to - from, h = width * segment.h;
  for (int e = 0; e < modes_.events(); ++e) {
    const double d0 = now_.slope[e] * h, d1 = then_.slope[e] * h, e0 = now_.event[e], e1 = then_.event[e];
    if (!(d0 < 0 && d1 > 0 && e0 > 0)) continue;
    // e0 + d0 s + b s^2 + a s^3
    const double a = 2 * (e0 - e1) + d0 + d1, b = 3 * (e1 - e0) - 2 * d0 - d1;
    const double root = std::sqrt(std::max(0.0, b * b - 3 * a * d0));
    const double s = std::clamp(std::abs(a) > 1e-9 * std::abs(b) ? (root - b) / (3 * a) : -d0 / (2 * b), 0.0, 1.0);
    if (e0 + s * (d0 + s * (b + s * a)) > 0) continue;
    const double middle = from + s * width;
    if (middle > from && probe(segment, from, middle, e) < 0) {
      to = middle;
      return e;
    }
    probe(segment, from, to, e);
  }
  return -1;
}

/// A place after `from` where an event function that starts at zero is above it; `from` when there is none.
double EventRun::inside(Segment& segment, double from, double to, int event) noexcept {
  for (int halving = 1; halving <= 40; ++halving) {
    const double at = from + std::ldexp(to - from, -halving);
    if (at > from && probe(segment, from, at, event) > 0) return at;
  }
  return from;
}

/// At the place that locate() found: within its tolerance before it the event function was still above zero.
bool EventRun::fell_here(const Segment& segment, int event) const noexcept {
  const double since = then_.event[event] / (then_.slope[event] * segment.h);
  if (since >= 0 && since <= bracket_width) return true;
  return closed_in_ && above_.event[event] > 0;
}

/// The zero of the cubic through the values and slopes of an event function at both ends of a step, as a part of it;
/// that of the straight line where there are no slopes. Above zero at 0, not at 1.
double EventRun::estimate_zero(double h, int event) const noexcept {
  const double e0 = now_.event[event], e1 = then_.event[event];
  const double d0 = now_.slope[event] * h, d1 = then_.slope[event] * h;
  const double line = e0 / (e0 - e1);
  if (!std::isfinite(d0) || !std::isfinite(d1)) return line;
  const double a = 2 * (e0 - e1) + d0 + d1, b = 3 * (e1 - e0) - 2 * d0 - d1;
  double low = 0, high = 1, s = line;
  for (int i = 0; i < 20; ++i) {
    const double value = e0 + s * (d0 + s * (b + s * a));
    (value > 0 ? low : high) = s;
    double next = s - value / (d0 + s * (2 * b + s * 3 * a));
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - s) < location_tolerance) return next;
    s = next;
  }
  return s;
}

/// The first place, within (from, to], at which the event function is below zero: by Newton's method within a bracket,
/// by false position (Dowell & Jarratt 1971, BIT 11, 168: "Illinois") where it has no slope, by halving where those
/// are slow. The trial is left there.
double EventRun::locate(Segment& segment, double from, double to, int event) noexcept {
  double low = from, high = to, above = now_.event[event];
  closed_in_ = false;
  if (!(above > 0)) {
    if (!(now_.slope[event] > 0)) return from;
    low = inside(segment, from, to, event);
    if (!(low > from)) {
      probe(segment, from, to, event);
      return to;
    }
    above = then_.event[event];
    probe(segment, from, to, event);
  }
  double at = high, value = then_.event[event], below = value;
  for (int i = 0; i < location_iterations && high - low > bracket_width; ++i) {
    // a little beyond the zero: that is where the place is wanted, and it closes the bracket from there
    double next = 0.5 * (low + high);
    const double slope = then_.slope[event] * segment.h;
    if (i == 0 && low == from)
      next = from + (to - from) * estimate_zero((to - from) * segment.h, event) + location_tolerance;
    else if (i <= newton_iterations && std::isfinite(slope))
      next = at - value / slope + location_tolerance;
    else if (i <= newton_iterations)
      next = low + (high - low) * above / (above - below) + (value > 0 ? location_tolerance : -location_tolerance);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const bool was_above = value > 0;
    at = next;
    value = probe(segment, from, at, event);
    if (value > 0) {
      low = at;
      above = value;
      if (was_above) below *= 0.5;
      above_.event = then_.event;
      closed_in_ = true;
    } else {
      high = at;
      below = value;
      if (!was_above) above *= 0.5;
      const double since = value / (then_.slope[event] * segment.h);
      if (since >= 0 && since <= 2 * location_tolerance) break;
    }
  }
  if (at != high) probe(segment, from, high, event);
  closed_in_ = closed_in_ && high - low <= bracket_width;
  return high;
}

/// Makes the trial the present state, sensitivities included.
void EventRun::accept(Segment& segment, double from, double to) {
  if (sensitivities_) step_sensitivities(segment, from, to);
  if (problem_.motion) problem_.motion->step(modes_, segment, from, to, x_.data());
  if (modes_.sliding()) outcome_.stuck += (to - from) * segment.h;
  x_.swap(trial_);
  std::swap(now_, then_);
  if (modes_.needs_projection()) saltation_.project(drive(segment, to), x_.data());
}

void EventRun::happen(Segment& segment, double at, int event) {
  saltation_.resolve(event, drive(segment, at), x_.data(), now_);
}

FixedOutcome run_with_events(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  return EventRun(problem, x0).run(sink);
}

}  // namespace lunid
