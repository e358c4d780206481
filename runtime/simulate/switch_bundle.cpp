// Members with switches side by side. A lane runs in one mode; where its substep may hold an event, or ended beyond a
// switch, the lane leaves the bundle, takes that substep alone (EventRun) and comes back when its mode is one of sides
// again. What decides is what EventRun looks at, on the same bits: a lane stays only where EventRun finds nothing.
#include <algorithm>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "expr/kernel.hpp"
#include "simulate/aligned_memory.hpp"
#include "simulate/bundle.hpp"
#include "simulate/event_run.hpp"

namespace lunid {
namespace {

namespace dp = dormand_prince;
using Eigen::Index;
using kernel::quad;

constexpr Index cancel_rows = 256;

/// State, rates and event functions of all lanes at one time. Value i of lane l stands at [i * width + l].
struct Moment {
  double *x, *f, *event, *slope, *speed;
};

/// What a step left: the event functions' parts, and whether all is finite.
struct Parts {
  const double *const *base, *const *rate, *const *slope;
  const double* sound;
};

/// The event functions at the end of a step, and whether EventRun would find none in it and none of what else ends a
/// step: 1 for such lanes in `stays`, else 0.
LUNID_WIDE void look(int width, int n, int degrees, int events, const double* width_time, const double* bound,
                     const Parts& parts, const Moment& now, const Moment& then, double* stays) {
  for (int l = 0; l < width; l += 4) {
    auto good = quad(parts.sound + l) == 0.0;
    kernel::Quad sum{};
    for (int i = 0; i < n; ++i) sum += quad(then.x + width * i + l) * 0.0;
    good &= sum == 0.0;
    for (int i = 0; i < degrees; ++i) {
      const auto y = quad(then.x + 2 * i * width + l);
      good &= (y <= quad(bound + l)) & (-y <= quad(bound + l));
    }
    for (int e = 0; e < events; ++e) {
      const int at = e * width + l;
      const auto rate = quad(parts.rate[e] + l), size = rate < 0.0 ? -rate : rate, met = quad(now.speed + at);
      const auto speed = size > met ? size : met;
      const auto value = quad(parts.base[e] + l) + quad(width_time + l) * speed + ModeMachine::least_width;
      const auto slope = quad(parts.slope[e] + l);
      good &= value >= 0.0;
      good &= ~((quad(now.slope + at) < 0.0) & (slope > 0.0) & (quad(now.event + at) > 0.0));
      quad(then.speed + at) = speed;
      quad(then.event + at) = value;
      quad(then.slope + at) = slope;
    }
    const kernel::Quad one = {1, 1, 1, 1}, none{};
    quad(stays + l) = good ? one : none;
  }
}

class SwitchBundle {
 public:
  explicit SwitchBundle(const BundleProblem& problem);
  void run(LaneSink& sink, std::span<FixedOutcome> outcomes);

 private:
  void place_registers();
  void load_inputs(Index row, int j);
  void take_in(int lane);
  void substep(Index row, int j);
  void alone(Index row, int j, int lane);

  const BundleProblem& problem_;
  const FixedProblem& first_;
  const Dynamics& d_;
  const StepTape& step_;
  const int n_, events_, count_, width_;
  AlignedMemory memory_;
  std::vector<double*> place_;
  std::vector<const double*> base_, rate_, slope_;
  std::deque<EventRun> runs_;
  /// Of each lane: it runs beside the others; it has not stopped.
  std::vector<char> inside_, going_;
  int insiders_ = 0;
  Moment now_{}, then_{};
  double *mode_, *t0_, *h_, *bound_, *width_time_, *stays_;
};

SwitchBundle::SwitchBundle(const BundleProblem& problem)
    : problem_(problem),
      first_(problem.lanes[0]),
      d_(*first_.dynamics),
      step_(*problem.step),
      n_(d_.n),
      events_(static_cast<int>(d_.surfaces.size() + d_.bounds.size())),
      count_(static_cast<int>(problem.lanes.size())),
      width_(bundle_width(problem.lanes.size())),
      inside_(static_cast<std::size_t>(count_), 0),
      going_(inside_.size(), 1) {
  place_registers();
  for (int l = 0; l < count_; ++l) {
    const auto at = static_cast<std::size_t>(l);
    const FixedProblem& lane = problem.lanes[at];
    runs_.emplace_back(lane, Eigen::Map<const Eigen::VectorXd>(problem.x0[at], n_));
    t0_[l] = lane.t0;
    h_[l] = lane.dt / lane.substeps;
    width_time_[l] = runs_.back().modes().width_time();
    bound_[l] = lane.bound > 0 ? lane.bound : std::numeric_limits<double>::infinity();
    for (int i = 0; i < d_.p; ++i)
      place_[static_cast<std::size_t>(step_.theta() + i)][l] = lane.theta[static_cast<std::size_t>(i)];
    take_in(l);
  }
}

void SwitchBundle::place_registers() {
  const int surfaces = static_cast<int>(d_.surfaces.size());
  memory_.resize(static_cast<std::size_t>(width_) *
                     static_cast<std::size_t>(2 * (2 * n_ + 3 * events_) + surfaces + 5) +
                 step_.memory(width_));
  double* at = memory_.data();
  const auto take = [&](int values) { return std::exchange(at, at + width_ * values); };
  for (Moment* moment : {&now_, &then_}) *moment = {take(n_), take(n_), take(events_), take(events_), take(events_)};
  mode_ = take(surfaces);
  t0_ = take(1);
  h_ = take(1);
  bound_ = take(1);
  width_time_ = take(1);
  stays_ = take(1);
  place_ = step_.place(at, width_);
  place_[static_cast<std::size_t>(step_.h())] = h_;
  for (int s = 0; s < surfaces; ++s) place_[static_cast<std::size_t>(step_.mode() + s)] = mode_ + width_ * s;
  for (int e = 0; e < events_; ++e) {
    const auto of = static_cast<std::size_t>(step_.event(e));
    base_.push_back(place_[of]);
    rate_.push_back(place_[of + 1]);
    slope_.push_back(place_[of + 2]);
  }
  step_.tape().prepare_lanes(place_.data(), width_);
}

/// The lane goes on from where its own run is, if that is in a mode of sides.
void SwitchBundle::take_in(int l) {
  EventRun& run = runs_[static_cast<std::size_t>(l)];
  for (int i = 0; i < n_; ++i) {
    now_.x[width_ * i + l] = run.x()[static_cast<std::size_t>(i)];
    now_.f[width_ * i + l] = run.now().f[static_cast<std::size_t>(i)];
  }
  char& inside = inside_[static_cast<std::size_t>(l)];
  insiders_ -= inside;
  inside = run.modes().plain();
  insiders_ += inside;
  if (!inside) return;
  for (std::size_t s = 0; s < d_.surfaces.size(); ++s)
    mode_[width_ * static_cast<int>(s) + l] = run.modes().side(static_cast<int>(s));
  for (int e = 0; e < events_; ++e) {
    now_.event[width_ * e + l] = run.now().event[static_cast<std::size_t>(e)];
    now_.slope[width_ * e + l] = run.now().slope[static_cast<std::size_t>(e)];
    now_.speed[width_ * e + l] = run.modes().speed(e);
  }
}

void SwitchBundle::load_inputs(Index row, int j) {
  const Index number = row * first_.substeps + j, node = dp::nodes * number;
  for (int l = 0; l < width_; ++l)
    place_[static_cast<std::size_t>(step_.time())][l] = t0_[l] + static_cast<double>(number) * h_[l];
  for (int input = 0; input < d_.exogenous; ++input)
    for (int l = 0; l < count_; ++l) {
      const double* const u = problem_.lanes[static_cast<std::size_t>(l)].drive[static_cast<std::size_t>(input)] + node;
      for (int i = 1; i <= dp::nodes; ++i) place_[static_cast<std::size_t>(step_.drive(i) + input)][l] = u[i];
    }
  for (int i = 0; i < n_; ++i) {
    place_[static_cast<std::size_t>(step_.x() + i)] = now_.x + width_ * i;
    place_[static_cast<std::size_t>(step_.k() + i)] = now_.f + width_ * i;
    place_[static_cast<std::size_t>(step_.next_x() + i)] = then_.x + width_ * i;
  }
  for (std::size_t i = 0; i < step_.kept().size(); ++i)
    place_[static_cast<std::size_t>(step_.next_k()) + i] = then_.f + width_ * step_.kept()[i];
}

void SwitchBundle::substep(Index row, int j) {
  std::fill_n(stays_, width_, 0.0);
  if (insiders_ > 0) {
    load_inputs(row, j);
    step_.tape().run_lanes(place_.data(), width_);
    look(width_, n_, d_.degrees, events_, width_time_, bound_,
         {base_.data(), rate_.data(), slope_.data(), place_[static_cast<std::size_t>(step_.sound())]}, now_, then_,
         stays_);
    for (int i = 0; i < n_; ++i)
      if (const int speed = speed_of(d_, i); speed >= 0)
        std::copy_n(then_.x + width_ * speed, width_, then_.f + width_ * i);
  }
  std::swap(now_, then_);
  for (int l = 0; l < count_; ++l) {
    const auto at = static_cast<std::size_t>(l);
    if (going_[at] && !(inside_[at] && stays_[l] != 0)) alone(row, j, l);
  }
}

/// `then_` holds what was before the substep.
void SwitchBundle::alone(Index row, int j, int l) {
  const auto at = static_cast<std::size_t>(l);
  EventRun& run = runs_[at];
  if (inside_[at]) {
    for (int i = 0; i < n_; ++i) {
      run.x()[static_cast<std::size_t>(i)] = then_.x[width_ * i + l];
      run.now().f[static_cast<std::size_t>(i)] = then_.f[width_ * i + l];
    }
    for (int e = 0; e < events_; ++e) {
      run.now().event[static_cast<std::size_t>(e)] = then_.event[width_ * e + l];
      run.now().slope[static_cast<std::size_t>(e)] = then_.slope[width_ * e + l];
      run.modes().set_speed(e, then_.speed[width_ * e + l]);
    }
  }
  going_[at] = run.substep(row, j);
  if (going_[at]) return take_in(l);
  insiders_ -= inside_[at];
  inside_[at] = 0;
  for (int i = 0; i < n_; ++i)
    now_.x[width_ * i + l] = now_.f[width_ * i + l] = std::numeric_limits<double>::quiet_NaN();
}

void SwitchBundle::run(LaneSink& sink, std::span<FixedOutcome> outcomes) {
  for (Index row = 0; row < first_.rows; ++row) {
    sink.row(row, now_.x, now_.f);
    if (row + 1 == first_.rows) break;
    for (int j = 0; j < first_.substeps; ++j) substep(row, j);
    if (std::none_of(going_.begin(), going_.end(), [](char going) { return going; })) break;
    if (row % cancel_rows == 0) check_cancelled(first_.cancelled);
  }
  for (int l = 0; l < count_; ++l) outcomes[static_cast<std::size_t>(l)] = runs_[static_cast<std::size_t>(l)].outcome();
}

}  // namespace

void run_switch_bundle(const BundleProblem& problem, LaneSink& sink, std::span<FixedOutcome> outcomes) {
  SwitchBundle(problem).run(sink, outcomes);
}

}  // namespace lunid
