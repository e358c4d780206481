#include "simulate/bundle.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "expr/kernel.hpp"
#include "simulate/aligned_memory.hpp"
#include "simulate/dormand_prince.hpp"
#include "simulate/lane_force.hpp"

namespace lunid {
namespace {

namespace dp = dormand_prince;
using Eigen::Index;
using kernel::quad;

/// Rows between two looks at `cancelled`.
constexpr Index cancel_rows = 256;

/// What a substep works on. Value i of lane l stands at [i * width + l].
struct Stepper {
  const Tape* tape;
  LaneForce* force;
  const FixedProblem* lanes;
  int n, exogenous;
  int width;          ///< lanes, those that nobody needs included
  bool shared;        ///< one stage grid drives all lanes
  bool timed;         ///< the rates depend on time
  const int* source;  ///< the problem that drives each lane
  double** place;     ///< of the registers of the tape
  double **state_place, **rate_place;
  double* states[dp::stages];  ///< at each stage; the first are those of the run
  double** rates;              ///< of state i at stage S: rates[S * n + i]. That of y is v at the stage, in its place
  const double *t0, *h;        ///< of each lane
};

/// The exogenous inputs at a node of the stage grid, which is a place of a row's interval.
LUNID_INLINE void load_inputs(const Stepper& s, Index node, Index row, int place, double* const* to) {
  if (s.force) return s.force->load(row, place, to);
  for (int i = 0; i < s.exogenous; ++i) {
    double* in = to[i];
    const auto input = static_cast<std::size_t>(i);
    if (s.shared) {
      const kernel::Quad value = kernel::Quad{} + s.lanes[0].drive[input][node];
      for (int l = 0; l < s.width; l += 4) quad(in + l) = value;
    } else {
      for (int l = 0; l < s.width; ++l) in[l] = s.lanes[s.source[l]].drive[input][node];
    }
  }
}

/// The rates at stage S, at its states and the inputs that are loaded; time is that of step `step` and `part` steps
/// more.
LUNID_INLINE void rate(const Stepper& s, double step, double part, int stage) {
  if (s.timed) {
    double* time = s.place[0];
    for (int l = 0; l < s.width; l += 4) {
      const auto h = quad(s.h + l), t = quad(s.t0 + l) + step * h;
      quad(time + l) = t + part * h;
    }
  }
  for (int i = 0; i < s.n; ++i) {
    s.state_place[i] = s.states[stage] + s.width * i;
    s.rate_place[i] = s.rates[stage * s.n + i];
  }
  s.tape->run_lanes_without_copies(s.place, s.width);
}

/// out = x + h * (weights of stage S) . k, in the order of dormand_prince::stage_state.
template <int S>
LUNID_INLINE void stage_state(const Stepper& s, double* out) {
  using dp::weight;
  const int n = s.n;
  for (int i = 0; i < n; ++i) {
    const double* const* k = s.rates + i;
    const double *const k0 = k[0], *const k1 = k[n], *const k2 = k[2 * n], *const k3 = k[3 * n], *const k4 = k[4 * n],
                        *const k5 = k[5 * n];
    const double* const x = s.states[0] + s.width * i;
    double* const to = out + s.width * i;
    for (int l = 0; l < s.width; l += 4) {
      auto sum = weight[S][0] * quad(k0 + l);
      if constexpr (S > 1 && weight[S][1] != 0) sum = sum + weight[S][1] * quad(k1 + l);
      if constexpr (S > 2) sum = sum + weight[S][2] * quad(k2 + l);
      if constexpr (S > 3) sum = sum + weight[S][3] * quad(k3 + l);
      if constexpr (S > 4) sum = sum + weight[S][4] * quad(k4 + l);
      if constexpr (S > 5) sum = sum + weight[S][5] * quad(k5 + l);
      quad(to + l) = quad(x + l) + quad(s.h + l) * sum;
    }
  }
}

/// One substep of all lanes; the rates at its start stand in k, and afterwards those at its end. It works on a copy of
/// its stepper, which no store through a pointer can change.
LUNID_WIDE void substep_by_stages(Stepper s, Index row, int j, int substeps, bool hold) {
  const Index step = row * substeps + j, node = dp::nodes * step;
  const double at = static_cast<double>(step);
  const auto stage = [&]<int S>() __attribute__((always_inline)) {
    stage_state<S>(s, s.states[S]);
    load_inputs(s, node + S, row, dp::nodes * j + S, s.place + 1);
    rate(s, at, dp::place[S], S);
  };
  stage.template operator()<1>();
  stage.template operator()<2>();
  stage.template operator()<3>();
  stage.template operator()<4>();
  stage_state<5>(s, s.states[5]);
  const bool within = j + 1 < substeps;
  load_inputs(s, hold ? node + dp::nodes - 1 : node + dp::nodes, within ? row : row + 1,
              within ? dp::nodes * (j + 1) : 0, s.place + 1);
  rate(s, at, 1, 5);
  stage_state<6>(s, s.states[0]);  // y before v, whose old value is the first rate of y
  rate(s, at, 1, 0);
}

/// Rates at the samples themselves: the first, and after each jump of a held input.
LUNID_WIDE void start(Stepper s, Index row, int substeps) {
  const Index step = row * substeps;
  load_inputs(s, dp::nodes * step, row, 0, s.place + 1);
  rate(s, static_cast<double>(step), 0, 0);
}

/// The time at the start of a substep, in each lane.
LUNID_WIDE void set_times(const Stepper& s, double step, double* time) {
  for (int l = 0; l < s.width; l += 4) quad(time + l) = quad(s.t0 + l) + step * quad(s.h + l);
}

/// True when every lane is finite and within its bound, which is finite.
LUNID_WIDE bool all_sound(const double* x, int n, int degrees, int width, const double* bound) {
  auto sound = quad(bound) == quad(bound);
  for (int l = 0; l < width; l += 4) {
    kernel::Quad sum{};
    for (int i = 0; i < n; ++i) {
      const auto value = quad(x + width * i + l);
      if (i < 2 * degrees && i % 2 == 0)
        sound &= (value <= quad(bound + l)) & (-value <= quad(bound + l));
      else
        sum += value * 0.0;  // NaN for NaN and infinity
    }
    sound &= sum == 0.0;
  }
  return (sound[0] & sound[1] & sound[2] & sound[3]) != 0;
}

class BundleRun {
 public:
  explicit BundleRun(const BundleProblem& problem);
  void run(LaneSink& sink, std::span<FixedOutcome> outcomes);

 private:
  void place_registers();
  void place_step();
  void substep_by_tape(Index row, int j);
  void load_step(Index row, int j);
  void load_turns(int j);
  double* rate_row(int stage, int i) const;
  void load_lane(int lane);
  void repeat_lane(int from, int to);
  bool keep_going(Index row, std::span<FixedOutcome> outcomes);
  void stop_lane(Index row, int lane, FixedOutcome& outcome);
  bool beyond(int lane) const;
  bool passes_bound(int lane);

  const BundleProblem& problem_;
  const FixedProblem& first_;
  const Dynamics& d_;
  const int n_, count_, width_;
  AlignedMemory memory_;
  std::vector<double*> place_, step_place_;
  std::optional<LaneForce> force_;
  std::vector<double*> rates_;
  double *k_, *previous_, *t0_, *dt_, *h_, *bound_;
  double *next_ = nullptr, *next_k_ = nullptr;  ///< where a step tape writes
  int turns_of_ = -1;                           ///< the substep whose turns are loaded
  std::vector<int> speed_;                      ///< of each state, as speed_of
  std::vector<char> alive_, bound_known_;
  std::vector<int> source_;
  Stepper s_{};
};

BundleRun::BundleRun(const BundleProblem& problem)
    : problem_(problem),
      first_(problem.lanes[0]),
      d_(*first_.dynamics),
      n_(d_.n),
      count_(static_cast<int>(problem.lanes.size())),
      width_(bundle_width(problem.lanes.size())),
      alive_(static_cast<std::size_t>(width_)),
      bound_known_(alive_),
      source_(alive_.size()) {
  s_.source = source_.data();
  s_.tape = &d_.rate;
  s_.lanes = problem.lanes.data();
  s_.n = n_;
  s_.exogenous = d_.exogenous;
  s_.width = width_;
  s_.shared = true;
  s_.timed = d_.rate.reads(0);
  for (int i = 0; i < n_; ++i) speed_.push_back(speed_of(d_, i));
  place_registers();
  for (int l = 0; l < width_; ++l) load_lane(l);
  if (force_) force_->begin(t0_, dt_);
}

void BundleRun::place_registers() {
  place_.resize(static_cast<std::size_t>(std::max(d_.rate.registers(), d_.inputs()) + 1));
  const StepTape* const step = problem_.step;
  memory_.resize(static_cast<std::size_t>(width_) * (place_.size() + static_cast<std::size_t>(15 * n_ + 4)) +
                 (step ? step->memory(width_) : 0));
  double* at = memory_.data();
  const auto take = [&](int values) { return std::exchange(at, at + width_ * values); };
  for (double*& place : place_) place = take(1);
  for (double*& states : s_.states) states = take(n_);
  k_ = take(6 * n_);
  rates_.resize(static_cast<std::size_t>(dp::stages * n_));
  for (int stage = 0; stage < dp::stages; ++stage)
    for (int i = 0; i < n_; ++i) rates_[static_cast<std::size_t>(stage * n_ + i)] = rate_row(stage, i);
  s_.rates = rates_.data();
  previous_ = take(n_);
  s_.t0 = t0_ = take(1);
  dt_ = take(1);
  s_.h = h_ = take(1);
  bound_ = take(1);
  next_ = take(n_);
  next_k_ = take(n_);
  if (step) step_place_ = step->place(at, width_);
  s_.place = place_.data();
  s_.state_place = s_.place + 1 + d_.exogenous;
  s_.rate_place = s_.place + d_.rate.output_place();
  d_.rate.prepare_lanes(s_.place, width_);
  if (problem_.force) s_.force = &force_.emplace(*problem_.force, width_, first_.substeps);
  if (step) place_step();
}

/// What stays where it is.
void BundleRun::place_step() {
  const StepTape& step = *problem_.step;
  const auto at = [&](int place) -> double*& { return step_place_[static_cast<std::size_t>(place)]; };
  at(step.h()) = h_;
  for (int i = 0; i < d_.p; ++i) at(step.theta() + i) = s_.place[d_.inputs() - d_.p + i];
  if (step.turns())
    for (int i = 0; i + 1 < problem_.force->inputs(); ++i) at(step.q() + i) = force_->q(i);
  step.tape().prepare_lanes(step_place_.data(), width_);
}

/// What moves from substep to substep.
void BundleRun::load_step(Index row, int j) {
  const StepTape& step = *problem_.step;
  double** const place = step_place_.data();
  const int substeps = first_.substeps;
  const Index number = row * substeps + j, node = dp::nodes * number;
  if (s_.timed) set_times(s_, static_cast<double>(number), place[step.time()]);
  for (int i = 0; i < n_; ++i) {
    place[step.x() + i] = s_.states[0] + width_ * i;
    place[step.k() + i] = k_ + width_ * i;
    place[step.next_x() + i] = next_ + width_ * i;
  }
  for (std::size_t i = 0; i < step.kept().size(); ++i)
    place[static_cast<std::size_t>(step.next_k()) + i] = next_k_ + width_ * step.kept()[i];
  const bool within = j + 1 < substeps;
  const Index end_row = within ? row : row + 1;
  const int end_place = within ? dp::nodes * (j + 1) : 0;
  if (!step.turns()) {
    for (int i = 1; i < dp::nodes; ++i) load_inputs(s_, node + i, row, dp::nodes * j + i, place + step.drive(i));
    return load_inputs(s_, first_.hold ? node + dp::nodes - 1 : node + dp::nodes, end_row, end_place,
                       place + step.drive(dp::nodes));
  }
  for (int w = 0; w < problem_.force->waves(); ++w) {
    place[step.wave(w)] = force_->cosine(w);
    place[step.wave(w) + 1] = force_->sine(w);
  }
  if (j != turns_of_) load_turns(j);
  if (!within) force_->turn_to(end_row);  // the waves of this row stay where they are
  force_->values(end_place, place + step.end_value());
}

/// The turns to the nodes of a substep.
void BundleRun::load_turns(int j) {
  const StepTape& step = *problem_.step;
  for (int w = 0; w < problem_.force->waves(); ++w)
    for (int i = 1; i < dp::nodes; ++i) {
      double** const place = step_place_.data() + step.turn(i, w);
      place[0] = force_->cosine_of(w, dp::nodes * j + i);
      place[1] = force_->sine_of(w, dp::nodes * j + i);
    }
  turns_of_ = j;
}

void BundleRun::substep_by_tape(Index row, int j) {
  load_step(row, j);
  problem_.step->tape().run_lanes(step_place_.data(), width_);
  std::swap(s_.states[0], next_);
  if (j == 0) std::swap(previous_, next_);  // the state at the row stays
  std::swap(k_, next_k_);
  for (int i = 0; i < n_; ++i) rates_[static_cast<std::size_t>(i)] = rate_row(0, i);
}

/// Where the rate of state i at a stage is kept: that of a displacement is a speed, which stands there already.
double* BundleRun::rate_row(int stage, int i) const {
  const int speed = speed_[static_cast<std::size_t>(i)];
  return speed >= 0 ? s_.states[stage] + width_ * speed : k_ + width_ * (stage * n_ + i);
}

/// Lanes that nobody needs repeat the last one.
void BundleRun::load_lane(int l) {
  const auto from = static_cast<std::size_t>(std::min(l, count_ - 1));
  source_[static_cast<std::size_t>(l)] = static_cast<int>(from);
  const FixedProblem& lane = problem_.lanes[from];
  t0_[l] = lane.t0;
  dt_[l] = lane.dt;
  h_[l] = lane.dt / lane.substeps;
  bound_[l] = lane.bound > 0 ? lane.bound : std::numeric_limits<double>::max();
  alive_[static_cast<std::size_t>(l)] = l < count_;
  for (int i = 0; i < n_; ++i) s_.states[0][width_ * i + l] = problem_.x0[from][i];
  for (int i = 0; i < d_.p; ++i) s_.place[d_.inputs() - d_.p + i][l] = lane.theta[static_cast<std::size_t>(i)];
  if (force_)
    for (int i = 0; i + 1 < problem_.force->inputs(); ++i) force_->q(i)[l] = problem_.q[from][i];
  for (std::size_t i = 0; i < static_cast<std::size_t>(d_.exogenous); ++i)
    s_.shared &= lane.drive[i] == first_.drive[i];
}

/// A lane that stopped goes on as a copy of one that runs, whose numbers stay sound.
void BundleRun::repeat_lane(int from, int to) {
  const auto copy = [&](double* row) { row[to] = row[from]; };
  for (int i = 0; i < n_; ++i) {
    copy(s_.states[0] + width_ * i);
    copy(k_ + width_ * i);
  }
  for (double* row : {t0_, dt_, h_, bound_}) copy(row);
  for (int i = 0; i < d_.p; ++i) copy(s_.place[d_.inputs() - d_.p + i]);
  if (force_) force_->repeat_lane(from, to);
  source_[static_cast<std::size_t>(to)] = source_[static_cast<std::size_t>(from)];
}

bool BundleRun::beyond(int lane) const {
  for (int i = 0; i < d_.degrees; ++i)
    if (std::abs(s_.states[0][width_ * 2 * i + lane]) > bound_[lane]) return true;
  return false;
}

/// A displacement is beyond the bound that the lane was given: beyond its true one as well?
bool BundleRun::passes_bound(int lane) {
  char& known = bound_known_[static_cast<std::size_t>(lane)];
  if (problem_.true_bound && !known) {
    const double bound = problem_.true_bound(lane);
    bound_[lane] = bound > 0 ? bound : std::numeric_limits<double>::max();
    known = true;
  }
  return beyond(lane);
}

/// Lanes that exploded within the row's interval stop; false when none is left.
bool BundleRun::keep_going(Index row, std::span<FixedOutcome> outcomes) {
  if (all_sound(s_.states[0], n_, d_.degrees, width_, bound_)) return true;
  int sound = -1;
  for (int l = 0; l < count_; ++l) {
    if (!alive_[static_cast<std::size_t>(l)]) continue;
    double sum = 0;
    for (int i = 0; i < n_; ++i) sum += s_.states[0][width_ * i + l] * 0.0;
    if (sum == 0 && !(beyond(l) && passes_bound(l)))
      sound = l;
    else
      stop_lane(row, l, outcomes[static_cast<std::size_t>(l)]);
  }
  if (sound < 0) return false;
  for (int l = 0; l < width_; ++l)
    if (!alive_[static_cast<std::size_t>(l)]) repeat_lane(sound, l);
  return true;
}

void BundleRun::stop_lane(Index row, int l, FixedOutcome& outcome) {
  const FixedProblem& lane = problem_.lanes[static_cast<std::size_t>(l)];
  alive_[static_cast<std::size_t>(l)] = false;
  outcome.stop = Stop::exploded;
  outcome.stopped_at = lane.t0 + static_cast<double>(row + 1) * lane.dt;
  outcome.last.resize(n_);
  for (int i = 0; i < n_; ++i) outcome.last[i] = previous_[width_ * i + l];
  outcome.steps = static_cast<long>(row + 1) * lane.substeps;
}

void BundleRun::run(LaneSink& sink, std::span<FixedOutcome> outcomes) {
  const int substeps = first_.substeps;
  const bool hold = first_.hold;
  for (int l = 0; l < count_; ++l) {
    outcomes[static_cast<std::size_t>(l)] = {};
    outcomes[static_cast<std::size_t>(l)].steps = static_cast<long>(first_.rows - 1) * substeps;
  }
  start(s_, 0, substeps);
  for (Index row = 0; row < first_.rows; ++row) {
    if (hold && row > 0) start(s_, row, substeps);
    sink.row(row, s_.states[0], k_);
    if (row + 1 == first_.rows) break;
    if (!problem_.step) std::copy_n(s_.states[0], width_ * n_, previous_);
    for (int j = 0; j < substeps; ++j)
      problem_.step ? substep_by_tape(row, j) : substep_by_stages(s_, row, j, substeps, hold);
    if (!keep_going(row, outcomes)) break;
    if (row % cancel_rows == 0) check_cancelled(first_.cancelled);
  }
  for (int l = 0; l < count_; ++l) {
    FixedOutcome& outcome = outcomes[static_cast<std::size_t>(l)];
    outcome.evaluations = 1 + dp::stages * outcome.steps;
  }
}

}  // namespace

void run_bundle(const BundleProblem& problem, LaneSink& sink, std::span<FixedOutcome> outcomes) {
  BundleRun(problem).run(sink, outcomes);
}

}  // namespace lunid
