// The fixed path of systems without switches and bounds: nothing stands between the tape and the stages.
#include <limits>
#include <type_traits>

#include "expr/kernel.hpp"
#include "simulate/dormand_prince.hpp"
#include "simulate/rate_in_place.hpp"

namespace lunid {
namespace {

namespace dp = dormand_prince;
using Eigen::Index;
using kernel::quad;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// `Count` values, or as many as are asked for where the compiler does not know them (0).
template <int Count>
using Values =
    std::conditional_t<(Count > 0), std::array<double, static_cast<std::size_t>(Count)>, std::vector<double>>;
template <int Count>
Values<Count> zeros(int count) {
  if constexpr (Count > 0)
    return Values<Count>{};
  else
    return Values<Count>(static_cast<std::size_t>(count));
}

void stop_exploded(FixedOutcome& outcome, double t, const double* x, int n) {
  outcome.stop = Stop::exploded;
  outcome.stopped_at = t;
  outcome.last = Eigen::Map<const Eigen::VectorXd>(x, n);
}

/// Goes from sample to sample. `m` holds the work: start(t, node), stage<S>(h, t, node) and finish(h, t, node), which
/// is the start of the next step; row(row); keep(previous) and sound(), asked at the samples.
template <class Method>
LUNID_INLINE FixedOutcome go(const FixedProblem& problem, Method& m) {
  const int substeps = problem.substeps;
  const double h = problem.dt / substeps;
  std::vector<double> previous(static_cast<std::size_t>(problem.dynamics->n));
  FixedOutcome outcome;
  m.start(problem.t0, 0);
  Index step = 0;
  for (Index row = 0; row < problem.rows; ++row) {
    if (problem.hold && row > 0) m.start(problem.t0 + static_cast<double>(step) * h, dp::nodes * step);
    m.row(row);
    if (row + 1 == problem.rows) break;
    m.keep(previous.data());
    for (int j = 0; j < substeps; ++j, ++step) {
      const double t = problem.t0 + static_cast<double>(step) * h;
      const Index node = dp::nodes * step, end = problem.hold ? node + dp::nodes - 1 : node + dp::nodes;
      m.template stage<1>(h, t + dp::place[1] * h, node + 1);
      m.template stage<2>(h, t + dp::place[2] * h, node + 2);
      m.template stage<3>(h, t + dp::place[3] * h, node + 3);
      m.template stage<4>(h, t + dp::place[4] * h, node + 4);
      m.template stage<5>(h, t + h, end);
      m.finish(h, t + h, end);
    }
    if (!m.sound()) {
      stop_exploded(outcome, problem.t0 + static_cast<double>(row + 1) * problem.dt, previous.data(),
                    problem.dynamics->n);
      break;
    }
    if ((row & (cancel_interval - 1)) == 0) check_cancelled(problem.cancelled);
  }
  outcome.steps = static_cast<long>(step);
  outcome.evaluations = 1 + dp::stages * outcome.steps;
  return outcome;
}

/// The state alone: N states, the first 2 * D of them displacements and their speeds (N = 0: any number). The caller
/// lends the values, so that those of a known number are locals of one function.
template <int N, int D>
struct StateMethod {
  const FixedProblem& problem;
  const RateInPlace& evaluate;
  RowSink& sink;
  int n, degrees;
  double *x, *next, *k;
  double* handed;  ///< what the sink sees: x, then x'

  /// The rates at `next`, as those of stage S.
  template <int S>
  LUNID_INLINE void rate(double t, Index node) noexcept {
    const int size = N > 0 ? N : n, speeds = N > 0 ? D : degrees;
    double *const state = evaluate.state(), *const to = k + S * size;
    for (int i = 0; i < size; ++i) state[i] = next[i];
    if constexpr (N == 2) {
      to[0] = next[1];
      to[1] = evaluate.acceleration(t, node);
      return;
    }
    evaluate.run(t, node);
    const double* const results = evaluate.results();
    for (int i = 0; i < speeds; ++i) {
      to[2 * i] = next[2 * i + 1];
      to[2 * i + 1] = results[2 * i + 1];
    }
    for (int i = 2 * speeds; i < size; ++i) to[i] = results[i];
  }
  LUNID_INLINE void start(double t, Index node) noexcept {
    for (int i = 0; i < (N > 0 ? N : n); ++i) next[i] = x[i];
    rate<0>(t, node);
  }
  template <int S>
  LUNID_INLINE void stage(double h, double t, Index node) noexcept {
    dp::stage_state<S, N>(n, h, x, k, next);
    rate<S>(t, node);
  }
  LUNID_INLINE void finish(double h, double t, Index node) noexcept {
    dp::stage_state<6, N>(n, h, x, k, next);
    for (int i = 0; i < (N > 0 ? N : n); ++i) x[i] = next[i];
    rate<0>(t, node);
  }
  LUNID_INLINE void row(Index row) {
    keep(handed);
    for (int i = 0; i < (N > 0 ? N : n); ++i) handed[n + i] = k[i];
    sink.row(row, handed, handed + n, nullptr);
  }
  LUNID_INLINE void keep(double* to) const noexcept {
    for (int i = 0; i < (N > 0 ? N : n); ++i) to[i] = x[i];
  }
  LUNID_INLINE bool sound() const noexcept { return all_finite(x, N > 0 ? N : n) && !beyond(problem, x); }
};

template <int N, int D>
LUNID_INLINE FixedOutcome run_state(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  const int n = N > 0 ? N : problem.dynamics->n;
  const RateInPlace evaluate(problem, problem.dynamics->rate);
  Values<N> x = zeros<N>(n), next = x;
  Values<dp::stages* N> k = zeros<dp::stages * N>(dp::stages * n);
  std::vector<double> handed(static_cast<std::size_t>(2 * n));
  for (int i = 0; i < n; ++i) x[static_cast<std::size_t>(i)] = x0[i];
  StateMethod<N, D> method{problem,     evaluate, sink,         n, problem.dynamics->degrees, x.data(),
                           next.data(), k.data(), handed.data()};
  return go(problem, method);
}

}  // namespace

FixedOutcome run_smooth(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  if (problem.dynamics->degrees == 1 && problem.dynamics->n == 2) return run_state<2, 1>(problem, x0, sink);
  if (problem.dynamics->degrees == 1 && problem.dynamics->n == 3) return run_state<3, 1>(problem, x0, sink);
  return run_state<0, 0>(problem, x0, sink);
}

namespace {

/// State and sensitivities of one displacement and its speed, their columns in Q quads. The rate of a displacement's
/// sensitivity is that of the speed, which stands among the stages.
template <int Q>
struct OscillatorMethod {
  static constexpr int width = 4 * Q;
  const FixedProblem& problem;
  const RateInPlace& evaluate;
  RowSink& sink;
  int p;
  double *x, *next, *k;       ///< as in StateMethod<2, 1>
  double* sy;                 ///< d y / d (theta, x0)
  double* sv[dp::stages];     ///< d v, at each stage; the first are those of the run
  double* rates[dp::stages];  ///< of d v
  const double* is_theta;     ///< bits that are all set in the columns of theta
  double* handed;

  template <int S>
  LUNID_INLINE void rate(double t, Index node, const double* columns) noexcept {
    double* const state = evaluate.state();
    state[0] = next[0];
    state[1] = next[1];
    evaluate.run(t, node);
    const double* const f = evaluate.results();
    k[2 * S] = next[1];
    k[2 * S + 1] = f[1];
    const double by_y = f[4], by_v = f[5], *const by_theta = f + 6 + p;
    for (int c = 0; c < width; c += 4) {
      const auto slope = by_y * quad(columns + c) + by_v * quad(sv[S] + c);
      const auto direct = kernel::Four::as_bits(quad(by_theta + c)) & kernel::Four::as_bits(quad(is_theta + c));
      quad(rates[S] + c) = slope + kernel::Four::as_number(direct);
    }
  }
  template <int S>
  LUNID_INLINE void step(double h, double* const* from, const double* start, double* to) noexcept {
    using dp::weight;
    for (int c = 0; c < width; c += 4) {
      auto sum = weight[S][0] * quad(from[0] + c);
      if constexpr (S > 1 && weight[S][1] != 0) sum = sum + weight[S][1] * quad(from[1] + c);
      if constexpr (S > 2) sum = sum + weight[S][2] * quad(from[2] + c);
      if constexpr (S > 3) sum = sum + weight[S][3] * quad(from[3] + c);
      if constexpr (S > 4) sum = sum + weight[S][4] * quad(from[4] + c);
      if constexpr (S > 5) sum = sum + weight[S][5] * quad(from[5] + c);
      quad(to + c) = quad(start + c) + h * sum;
    }
  }
  LUNID_INLINE void start(double t, Index node) noexcept {
    next[0] = x[0];
    next[1] = x[1];
    rate<0>(t, node, sy);
  }
  template <int S>
  LUNID_INLINE void stage(double h, double t, Index node) noexcept {
    dp::stage_state<S, 2>(2, h, x, k, next);
    double columns[width];
    step<S>(h, sv, sy, columns);
    step<S>(h, rates, sv[0], sv[S]);
    rate<S>(t, node, columns);
  }
  LUNID_INLINE void finish(double h, double t, Index node) noexcept {
    dp::stage_state<6, 2>(2, h, x, k, next);
    x[0] = next[0];
    x[1] = next[1];
    step<6>(h, sv, sy, sy);
    step<6>(h, rates, sv[0], sv[0]);
    rate<0>(t, node, sy);
  }
  LUNID_INLINE void row(Index row) {
    keep(handed);
    handed[2] = k[0];
    handed[3] = k[1];
    std::copy_n(sy, p + 2, handed + 4);
    std::copy_n(sv[0], p + 2, handed + 4 + p + 2);
    sink.row(row, handed, handed + 2, handed + 4);
  }
  LUNID_INLINE void keep(double* to) const noexcept {
    to[0] = x[0];
    to[1] = x[1];
  }
  LUNID_INLINE bool sound() const noexcept {
    return all_finite(x, 2) && all_finite(sy, p + 2) && all_finite(sv[0], p + 2) && !beyond(problem, x);
  }
};

template <int Q>
LUNID_INLINE FixedOutcome run_oscillator(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  constexpr int width = 4 * Q;
  const int p = problem.dynamics->p;
  const RateInPlace evaluate(problem, problem.dynamics->derivatives);
  double x[2] = {x0[0], x0[1]}, next[2], k[2 * dp::stages];
  alignas(64) double sy[width] = {}, sv[dp::stages][width] = {}, rates[dp::stages][width] = {}, is_theta[width] = {};
  sy[p] = sv[0][p + 1] = 1;
  for (int c = 0; c < p; ++c) is_theta[c] = wave::Single::as_number(-1);
  std::vector<double> handed(static_cast<std::size_t>(2 * (p + 4)));
  OscillatorMethod<Q> method{problem, evaluate, sink, p, x, next, k, sy, {}, {}, is_theta, handed.data()};
  for (int s = 0; s < dp::stages; ++s) {
    method.sv[s] = sv[s];
    method.rates[s] = rates[s];
  }
  return go(problem, method);
}

LUNID_WIDE FixedOutcome run_4_columns(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  return run_oscillator<1>(problem, x0, sink);
}
LUNID_WIDE FixedOutcome run_8_columns(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  return run_oscillator<2>(problem, x0, sink);
}
LUNID_WIDE FixedOutcome run_12_columns(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  return run_oscillator<3>(problem, x0, sink);
}

/// State and sensitivities of any system, one after another in x and its rates.
struct SensitivityMethod {
  const FixedProblem& problem;
  const RateInPlace& evaluate;
  RowSink& sink;
  int n, p, size;
  double *x, *next, *k;

  void rate(const double* at, double t, Index node, double* to) noexcept {
    std::copy_n(at, n, evaluate.state());
    evaluate.run(t, node);
    const double *const f = evaluate.results(), *const jx = f + n;
    std::copy_n(f, n, to);
    for (int i = 0; i < 2 * problem.dynamics->degrees; i += 2) to[i] = at[i + 1];
    sensitivity_rate(n, p, jx, jx + n * n, infinity, at + n, to + n);
  }
  void start(double t, Index node) noexcept { rate(x, t, node, k); }
  template <int S>
  void stage(double h, double t, Index node) noexcept {
    dp::stage_state<S>(size, h, x, k, next);
    rate(next, t, node, k + S * size);
  }
  void finish(double h, double t, Index node) noexcept {
    dp::stage_state<6>(size, h, x, k, x);
    rate(x, t, node, k);
  }
  void row(Index row) { sink.row(row, x, k, x + n); }
  void keep(double* to) const noexcept { std::copy_n(x, n, to); }
  bool sound() const noexcept { return all_finite(x, size) && !beyond(problem, x); }
};

FixedOutcome run_sensitivities(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  const Dynamics& d = *problem.dynamics;
  const int n = d.n, p = d.p, size = n * (1 + p + n);
  const RateInPlace evaluate(problem, d.derivatives);
  std::vector<double> work(static_cast<std::size_t>((2 + dp::stages) * size));
  double* const x = work.data();
  std::copy_n(x0.data(), n, x);
  for (int i = 0; i < n; ++i) x[n + i * (p + n) + p + i] = 1;
  SensitivityMethod method{problem, evaluate, sink, n, p, size, x, x + size, x + 2 * size};
  return go(problem, method);
}

}  // namespace

FixedOutcome run_smooth_sensitivities(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  const int columns = problem.dynamics->degrees == 1 && problem.dynamics->n == 2 ? problem.dynamics->p + 2 : 0;
  if (columns > 12 || columns == 0) return run_sensitivities(problem, x0, sink);
  const auto run = columns <= 4 ? run_4_columns : columns <= 8 ? run_8_columns : run_12_columns;
  return run(problem, x0, sink);
}

}  // namespace lunid
