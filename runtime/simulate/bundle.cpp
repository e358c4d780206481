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
LUNID_INLINE void load_inputs(const Stepper& s, Index node, Index row, int place) {
  if (s.force) return s.force->load(row, place);
  for (int i = 0; i < s.exogenous; ++i) {
    double* in = s.place[1 + i];
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
template <int N>
LUNID_INLINE void rate(const Stepper& s, double step, double part, int stage) {
  if (s.timed) {
    double* time = s.place[0];
    for (int l = 0; l < s.width; l += 4) {
      const auto h = quad(s.h + l), t = quad(s.t0 + l) + step * h;
      quad(time + l) = t + part * h;
    }
  }
  const int n = N > 0 ? N : s.n;
  for (int i = 0; i < n; ++i) {
    s.state_place[i] = s.states[stage] + s.width * i;
    s.rate_place[i] = s.rates[stage * n + i];
  }
  s.tape->run_lanes_without_copies(s.place, s.width);
}

/// out = x + h * (weights of stage S) . k, in the order of dormand_prince::stage_state.
template <int S, int N>
LUNID_INLINE void stage_state(const Stepper& s, double* out) {
  using dp::weight;
  const int n = N > 0 ? N : s.n;
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

/// One substep of all lanes; the rates at its start stand in k, and afterwards those at its end.
template <int N>
LUNID_INLINE void substep(const Stepper& s, Index row, int j, int substeps, bool hold) {
  const Index step = row * substeps + j, node = dp::nodes * step;
  const double at = static_cast<double>(step);
  const auto stage = [&]<int S>() __attribute__((always_inline)) {
    stage_state<S, N>(s, s.states[S]);
    load_inputs(s, node + S, row, dp::nodes * j + S);
    rate<N>(s, at, dp::place[S], S);
  };
  stage.template operator()<1>();
  stage.template operator()<2>();
  stage.template operator()<3>();
  stage.template operator()<4>();
  stage_state<5, N>(s, s.states[5]);
  const bool within = j + 1 < substeps;
  load_inputs(s, hold ? node + dp::nodes - 1 : node + dp::nodes, within ? row : row + 1,
              within ? dp::nodes * (j + 1) : 0);
  rate<N>(s, at, 1, 5);
  stage_state<6, N>(s, s.states[0]);  // y before v, whose old value is the first rate of y
  rate<N>(s, at, 1, 0);
}

// Each works on a copy of its stepper, which no store through a pointer can change.
LUNID_WIDE void substep_of_any(Stepper s, Index row, int j, int substeps, bool hold) {
  substep<0>(s, row, j, substeps, hold);
}
LUNID_WIDE void substep_of_two(Stepper s, Index row, int j, int substeps, bool hold) {
  substep<2>(s, row, j, substeps, hold);
}
LUNID_WIDE void substep_of_three(Stepper s, Index row, int j, int substeps, bool hold) {
  substep<3>(s, row, j, substeps, hold);
}

/// Rates at the samples themselves: the first, and after each jump of a held input.
LUNID_WIDE void start(Stepper s, Index row, int substeps) {
  const Index step = row * substeps;
  load_inputs(s, dp::nodes * step, row, 0);
  rate<0>(s, static_cast<double>(step), 0, 0);
}

/// True when every lane is finite and within its bound.
LUNID_WIDE bool all_sound(const double* x, int n, int degrees, int width, const double* bound) {
  auto sound = quad(x) == quad(x);
  sound = ~(sound ^ sound);
  for (int l = 0; l < width; l += 4) {
    kernel::Quad sum{};
    for (int i = 0; i < n; ++i) sum += quad(x + width * i + l) * 0.0;  // NaN for NaN and infinity
    sound &= sum == 0.0;
    for (int i = 0; i < degrees; ++i) {
      const auto y = quad(x + 2 * i * width + l);
      sound &= (y <= quad(bound + l)) & (-y <= quad(bound + l));
    }
  }
  return (sound[0] & sound[1] & sound[2] & sound[3]) != 0;
}

class BundleRun {
 public:
  explicit BundleRun(const BundleProblem& problem);
  void run(LaneSink& sink, std::span<FixedOutcome> outcomes);

 private:
  void place_registers();
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
  std::vector<double*> place_;
  std::optional<LaneForce> force_;
  std::vector<double*> rates_;
  double *k_, *previous_, *t0_, *dt_, *h_, *bound_;
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
  place_registers();
  for (int l = 0; l < width_; ++l) load_lane(l);
  if (force_) force_->begin(t0_, dt_);
}

void BundleRun::place_registers() {
  place_.resize(static_cast<std::size_t>(std::max(d_.rate.registers(), d_.inputs()) + 1));
  memory_.resize(static_cast<std::size_t>(width_) * (place_.size() + static_cast<std::size_t>(13 * n_ + 4)));
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
  s_.place = place_.data();
  s_.state_place = s_.place + 1 + d_.exogenous;
  s_.rate_place = s_.place + d_.rate.output_place();
  d_.rate.prepare_lanes(s_.place, width_);
  if (!problem_.force) return;
  force_.emplace(*problem_.force, width_, first_.substeps,
                 std::span<double* const>(place_).subspan(1, static_cast<std::size_t>(d_.exogenous)));
  s_.force = &*force_;
}

/// Where the rate of state i at a stage is kept: that of a displacement is a speed, which stands there already.
double* BundleRun::rate_row(int stage, int i) const {
  const int speed = d_.rate.copy_of(i) - 1 - d_.exogenous;
  const bool displacement = i < 2 * d_.degrees && i % 2 == 0;
  if (displacement && speed > i && speed < n_) return s_.states[stage] + width_ * speed;
  return k_ + width_ * (stage * n_ + i);
}

/// Lanes that nobody needs repeat the last one.
void BundleRun::load_lane(int l) {
  const auto from = static_cast<std::size_t>(std::min(l, count_ - 1));
  source_[static_cast<std::size_t>(l)] = static_cast<int>(from);
  const FixedProblem& lane = problem_.lanes[from];
  t0_[l] = lane.t0;
  dt_[l] = lane.dt;
  h_[l] = lane.dt / lane.substeps;
  bound_[l] = lane.bound > 0 ? lane.bound : std::numeric_limits<double>::infinity();
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
    bound_[lane] = bound > 0 ? bound : std::numeric_limits<double>::infinity();
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
  const auto step = n_ == 2 ? substep_of_two : n_ == 3 ? substep_of_three : substep_of_any;
  for (int l = 0; l < count_; ++l) {
    outcomes[static_cast<std::size_t>(l)] = {};
    outcomes[static_cast<std::size_t>(l)].steps = static_cast<long>(first_.rows - 1) * substeps;
  }
  start(s_, 0, substeps);
  for (Index row = 0; row < first_.rows; ++row) {
    if (hold && row > 0) start(s_, row, substeps);
    sink.row(row, s_.states[0], k_);
    if (row + 1 == first_.rows) break;
    std::copy_n(s_.states[0], width_ * n_, previous_);
    for (int j = 0; j < substeps; ++j) step(s_, row, j, substeps, hold);
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
