// The fixed path of systems without switches and bounds: nothing stands between the tape and the stages.
#include <array>
#include <limits>
#include <vector>

#include "simulate/dormand_prince.hpp"
#include "simulate/fixed.hpp"

namespace lunid {
namespace {

namespace dp = dormand_prince;
using Eigen::Index;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The registers of a tape that is run in place: its inputs come first, the parameters last among them.
std::vector<double> registers(const FixedProblem& problem, const Tape& tape) {
  std::vector<double> r(std::max(tape.registers(), tape.inputs()) + 1, 0.0);
  const Dynamics& d = *problem.dynamics;
  std::copy(problem.theta.begin(), problem.theta.end(), r.begin() + (d.inputs() - d.p));
  tape.prepare(r.data());
  return r;
}

/// Inputs at the nodes of the stage grid, counted from the start of the record.
struct Inputs {
  explicit Inputs(const FixedProblem& problem) : count(problem.dynamics->exogenous), drive(problem.drive) {}
  void load(Index node, double* r) const noexcept {
    for (int i = 0; i < count; ++i) r[1 + i] = drive[i][node];
  }
  int count;
  std::array<const double*, max_inputs> drive;
};

void stop_exploded(FixedOutcome& outcome, double t, const double* x, int n) {
  outcome.stop = Stop::exploded;
  outcome.stopped_at = t;
  outcome.last = Eigen::Map<const Eigen::VectorXd>(x, n);
}

/// Steps a vector of `size` values X with a rate(t, node, X, K) from sample to sample; N is the size where the compiler
/// knows it. The first n values are the state, the rest its sensitivities.
template <int N, class Rate>
FixedOutcome integrate(const FixedProblem& problem, int size, std::vector<double>& start, Rate&& rate, RowSink& sink) {
  constexpr auto& place = dp::place;
  const int n = problem.dynamics->n, substeps = problem.substeps;
  const double h = problem.dt / substeps;
  std::vector<double> work(8 * size), previous(n);
  double *const X = start.data(), *const at = work.data(), *const k = at + size;
  double* const last = k + 6 * size;
  const auto stage = [&]<int S>(double t, Index node) {
    dp::stage_state<S, N>(size, h, X, k, at);
    rate(t + place[S] * h, node + S, at, k + S * size);
  };
  FixedOutcome outcome;
  rate(problem.t0, 0, X, k);
  Index step = 0;
  for (Index row = 0; row < problem.rows; ++row) {
    if (problem.hold && row > 0) rate(problem.t0 + static_cast<double>(step) * h, dp::nodes * step, X, k);
    sink.row(row, X, k, size > n ? X + n : nullptr);
    if (row + 1 == problem.rows) break;
    for (int i = 0; i < n; ++i) previous[i] = X[i];
    for (int j = 0; j < substeps; ++j, ++step) {
      const double t = problem.t0 + static_cast<double>(step) * h;
      const Index node = dp::nodes * step, end = problem.hold ? node + dp::nodes - 1 : node + dp::nodes;
      stage.template operator()<1>(t, node);
      stage.template operator()<2>(t, node);
      stage.template operator()<3>(t, node);
      stage.template operator()<4>(t, node);
      dp::stage_state<5, N>(size, h, X, k, at);
      rate(t + h, end, at, k + 5 * size);
      dp::stage_state<6, N>(size, h, X, k, X);
      rate(t + h, end, X, last);
      for (int i = 0; i < size; ++i) k[i] = last[i];
    }
    if (!all_finite(X, size) || beyond(problem, X)) {
      stop_exploded(outcome, problem.t0 + static_cast<double>(row + 1) * problem.dt, previous.data(), n);
      break;
    }
    if ((row & (cancel_interval - 1)) == 0) check_cancelled(problem.cancelled);
  }
  outcome.steps = static_cast<long>(step);
  outcome.evaluations = 1 + dp::stages * outcome.steps;
  return outcome;
}

/// A run of the state alone, with N states known to the compiler (0: not known).
template <int N>
FixedOutcome integrate_state(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  const Tape& tape = problem.dynamics->rate;
  const int n = N > 0 ? N : problem.dynamics->n;
  std::vector<double> r = registers(problem, tape), start(x0.data(), x0.data() + n);
  double* const state = r.data() + 1 + problem.dynamics->exogenous;
  const double* const results = r.data() + tape.output_place();
  const Inputs inputs(problem);
  const auto rate = [&tape, inputs, state, results, n, r = r.data()](double t, Index node, const double* x, double* k) {
    r[0] = t;
    inputs.load(node, r);
    for (int i = 0; i < (N > 0 ? N : n); ++i) state[i] = x[i];
    tape.run_prepared(r);
    for (int i = 0; i < (N > 0 ? N : n); ++i) k[i] = results[i];
  };
  return integrate<N>(problem, n, start, rate, sink);
}

}  // namespace

FixedOutcome run_smooth(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  switch (problem.dynamics->n) {
    case 2: return integrate_state<2>(problem, x0, sink);
    case 3: return integrate_state<3>(problem, x0, sink);
    default: return integrate_state<0>(problem, x0, sink);
  }
}

namespace {

/// s' = J s + (P, 0) of two states, with P parameters known to the compiler; rows as in sensitivity_rate().
template <int P>
void sensitivities_of_two(const double* __restrict jx, const double* __restrict jtheta, const double* __restrict s,
                          double* __restrict out) noexcept {
  constexpr int columns = P + 2;
  for (int c = 0; c < columns; ++c) {
    out[c] = jx[0] * s[c] + jx[1] * s[columns + c];
    out[columns + c] = jx[2] * s[c] + jx[3] * s[columns + c];
  }
  for (int c = 0; c < P; ++c) {
    out[c] += jtheta[c];
    out[columns + c] += jtheta[P + c];
  }
}

/// A run with sensitivities; P parameters of a system of two states where the compiler knows them, else P = -1.
template <int P>
FixedOutcome integrate_sensitivities(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  const Dynamics& d = *problem.dynamics;
  const int n = P < 0 ? d.n : 2, p = P < 0 ? d.p : P, size = n * (1 + p + n);
  std::vector<double> r = registers(problem, d.derivatives), start(size, 0.0);
  std::copy_n(x0.data(), n, start.data());
  for (int i = 0; i < n; ++i) start[n + i * (p + n) + p + i] = 1;
  const double* const f = r.data() + d.derivatives.output_place();
  const double *const jx = f + n, *const jtheta = jx + n * n;
  double* const state = r.data() + 1 + d.exogenous;
  const Inputs inputs(problem);
  const auto rate = [&](double t, Index node, const double* X, double* K) {
    r[0] = t;
    inputs.load(node, r.data());
    for (int i = 0; i < n; ++i) state[i] = X[i];
    d.derivatives.run_prepared(r.data());
    for (int i = 0; i < n; ++i) K[i] = f[i];
    if constexpr (P < 0)
      sensitivity_rate(n, p, jx, jtheta, infinity, X + n, K + n);
    else
      sensitivities_of_two<P>(jx, jtheta, X + n, K + n);
  };
  return integrate<(P < 0 ? 0 : 2 * (3 + P))>(problem, size, start, rate, sink);
}

}  // namespace

FixedOutcome run_smooth_sensitivities(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  if (problem.dynamics->n == 2) switch (problem.dynamics->p) {
      case 1: return integrate_sensitivities<1>(problem, x0, sink);
      case 2: return integrate_sensitivities<2>(problem, x0, sink);
      case 3: return integrate_sensitivities<3>(problem, x0, sink);
      case 4: return integrate_sensitivities<4>(problem, x0, sink);
      case 5: return integrate_sensitivities<5>(problem, x0, sink);
      default: break;
    }
  return integrate_sensitivities<-1>(problem, x0, sink);
}

}  // namespace lunid
