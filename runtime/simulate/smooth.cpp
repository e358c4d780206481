// The fixed path of systems without switches and bounds: nothing stands between the tape and the stages.
#include <limits>
#include <vector>

#include "simulate/fixed.hpp"

namespace lunid {
namespace {

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

void set_drive(const FixedProblem& problem, Index grid, double* r) noexcept {
  for (int i = 0; i < problem.dynamics->exogenous; ++i) r[1 + i] = problem.drive[i][grid];
}

void stop_exploded(FixedOutcome& outcome, double t, const double* x, int n) {
  outcome.stop = Stop::exploded;
  outcome.stopped_at = t;
  outcome.last = Eigen::Map<const Eigen::VectorXd>(x, n);
}

bool exploded(const FixedProblem& problem, const double* x, int n) noexcept {
  return !all_finite(x, n) || (problem.bound > 0 && n > 0 && std::abs(x[0]) > problem.bound);
}

/// One Runge-Kutta run with N states known to the compiler (0: not known).
template <int N>
FixedOutcome integrate(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  const Tape& tape = problem.dynamics->rate;
  const int n = N > 0 ? N : problem.dynamics->n, substeps = problem.substeps;
  const double h = problem.dt / substeps, half = 0.5 * h, sixth = h / 6;
  std::vector<double> r = registers(problem, tape), work(4 * n);
  double* const stage = r.data() + 1 + problem.dynamics->exogenous;
  const double* const k = r.data() + tape.output_place();
  double *const x = work.data(), *const k1 = x + n, *const sum = k1 + n, *const previous = sum + n;
  std::copy_n(x0.data(), n, x);
  FixedOutcome outcome;

  Index grid = 0;
  for (Index row = 0; row < problem.rows; ++row) {
    for (int j = 0; j < substeps; ++j, grid += 2) {
      const double t = problem.t0 + static_cast<double>(grid / 2) * h;
      r[0] = t;
      set_drive(problem, grid, r.data());
      for (int i = 0; i < n; ++i) stage[i] = x[i];
      tape.run_prepared(r.data());
      for (int i = 0; i < n; ++i) sum[i] = k1[i] = k[i];
      if (j == 0) {
        sink.row(row, x, k1, nullptr);
        if (row + 1 == problem.rows) break;
      }
      r[0] = t + half;
      set_drive(problem, grid + 1, r.data());
      for (int i = 0; i < n; ++i) stage[i] = x[i] + half * k1[i];
      tape.run_prepared(r.data());
      for (int i = 0; i < n; ++i) {
        sum[i] += 2 * k[i];
        stage[i] = x[i] + half * k[i];
      }
      tape.run_prepared(r.data());
      r[0] = t + h;
      if (!problem.hold) set_drive(problem, grid + 2, r.data());
      for (int i = 0; i < n; ++i) {
        sum[i] += 2 * k[i];
        stage[i] = x[i] + h * k[i];
      }
      tape.run_prepared(r.data());
      for (int i = 0; i < n; ++i) {
        previous[i] = x[i];
        x[i] += sixth * (sum[i] + k[i]);
      }
    }
    if (row + 1 < problem.rows && exploded(problem, x, n)) {
      stop_exploded(outcome, problem.t0 + static_cast<double>(row + 1) * problem.dt, previous, n);
      break;
    }
    if ((row & (cancel_interval - 1)) == 0) check_cancelled(problem.cancelled);
  }
  outcome.steps = static_cast<long>(grid / 2);
  outcome.evaluations = 4 * outcome.steps;
  return outcome;
}

/// The state with its sensitivities, and one stage of both.
class SensitivityStage {
 public:
  explicit SensitivityStage(const FixedProblem& problem)
      : problem_(problem), d_(*problem.dynamics), n_(d_.n), p_(d_.p), r_(registers(problem, d_.derivatives)),
        out_(r_.data() + d_.derivatives.output_place()) {}

  int size() const { return n_ * (1 + p_ + n_); }

  /// X = (x, s) -> X'.
  void operator()(double t, Index grid, const double* X, double* K) noexcept {
    r_[0] = t;
    set_drive(problem_, grid, r_.data());
    std::copy_n(X, n_, r_.data() + 1 + d_.exogenous);
    d_.derivatives.run_prepared(r_.data());
    std::copy_n(out_, n_, K);
    const double* jx = out_ + n_;
    sensitivity_rate(n_, p_, jx, jx + n_ * n_, infinity, X + n_, K + n_);
  }

 private:
  const FixedProblem& problem_;
  const Dynamics& d_;
  int n_, p_;
  std::vector<double> r_;
  const double* out_;
};

}  // namespace

FixedOutcome run_smooth(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  switch (problem.dynamics->n) {
    case 2: return integrate<2>(problem, x0, sink);
    case 3: return integrate<3>(problem, x0, sink);
    default: return integrate<0>(problem, x0, sink);
  }
}

FixedOutcome run_smooth_sensitivities(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  SensitivityStage stage(problem);
  const int n = problem.dynamics->n, p = problem.dynamics->p, size = stage.size(), substeps = problem.substeps;
  const double h = problem.dt / substeps, half = 0.5 * h, sixth = h / 6;
  std::vector<double> work(6 * size, 0.0);
  double *X = work.data(), *k1 = X + size, *k2 = k1 + size, *k3 = k2 + size, *k4 = k3 + size, *at = k4 + size;
  std::copy_n(x0.data(), n, X);
  for (int i = 0; i < n; ++i) X[n + i * (p + n) + p + i] = 1;
  std::vector<double> previous(n);
  FixedOutcome outcome;

  Index grid = 0;
  for (Index row = 0; row < problem.rows; ++row) {
    for (int j = 0; j < substeps; ++j, grid += 2) {
      const double t = problem.t0 + static_cast<double>(grid / 2) * h;
      stage(t, grid, X, k1);
      if (j == 0) {
        sink.row(row, X, k1, X + n);
        if (row + 1 == problem.rows) break;
      }
      for (int i = 0; i < size; ++i) at[i] = X[i] + half * k1[i];
      stage(t + half, grid + 1, at, k2);
      for (int i = 0; i < size; ++i) at[i] = X[i] + half * k2[i];
      stage(t + half, grid + 1, at, k3);
      for (int i = 0; i < size; ++i) at[i] = X[i] + h * k3[i];
      stage(t + h, problem.hold ? grid + 1 : grid + 2, at, k4);
      std::copy_n(X, n, previous.data());
      for (int i = 0; i < size; ++i) X[i] += sixth * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]);
    }
    if (row + 1 < problem.rows && (exploded(problem, X, n) || !all_finite(X, size))) {
      stop_exploded(outcome, problem.t0 + static_cast<double>(row + 1) * problem.dt, previous.data(), n);
      break;
    }
    if ((row & (cancel_interval - 1)) == 0) check_cancelled(problem.cancelled);
  }
  outcome.steps = static_cast<long>(grid / 2);
  outcome.evaluations = 4 * outcome.steps;
  return outcome;
}

}  // namespace lunid
