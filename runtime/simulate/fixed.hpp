#pragma once
// The record-locked fixed-step path: the fifth-order method of Dormand and Prince on whole substeps of each sample
// interval (the force at its stages is that of the stage grid).
// Steps are split at the switches of the right-hand side (ModeMachine), so that each piece is smooth and the order
// holds; sensitivities are integrated along with their jumps at the switches.
#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cmath>
#include <span>

#include "simulate/dynamics.hpp"

namespace lunid {

struct MotionSink;

struct FixedProblem {
  const Dynamics* dynamics = nullptr;
  std::span<const double> theta;
  double t0 = 0, dt = 1;
  Eigen::Index rows = 0;
  int substeps = 1;
  std::array<const double*, max_inputs> drive{};  ///< stage grid of each exogenous input (Excitation::stage_grid)
  bool hold = false;                              ///< inputs jump at the samples
  double bound = 0;                               ///< the run stops where a displacement passes it; 0: none
  long max_events = 1000000;
  const std::atomic<bool>* cancelled = nullptr;
  bool sensitivities = false;
  MotionSink* motion = nullptr;  ///< told of every step and jump of a run with switches; not with sensitivities
};

/// Receives the rows of a run. `f` is x'; `s` the sensitivities of x to (theta, x0), n x (p + n) row-major, or null.
struct RowSink {
  virtual ~RowSink() = default;
  virtual void row(Eigen::Index row, const double* x, const double* f, const double* s) = 0;
};

/// True where a displacement has passed the bound of the problem.
inline bool beyond(const FixedProblem& problem, const double* x) noexcept {
  if (!(problem.bound > 0)) return false;
  for (int i = 0; i < problem.dynamics->degrees; ++i)
    if (std::abs(x[2 * i]) > problem.bound) return true;
  return false;
}

enum class Stop { none, exploded, too_many_events };

struct FixedOutcome {
  Stop stop = Stop::none;
  double stopped_at = 0;
  Eigen::VectorXd last;  ///< the last finite state
  int event = -1;        ///< the event at which too many came
  long steps = 0, evaluations = 0, events = 0, grazing = 0;
  double stuck = 0;
};

/// Runs the problem from x0. Throws InputError(Fault::interrupted) when cancelled.
FixedOutcome run_fixed(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink);

// ---- the parts of run_fixed ----
FixedOutcome run_smooth(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink);
FixedOutcome run_smooth_sensitivities(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink);
FixedOutcome run_with_events(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink);

/// Throws InputError(Fault::interrupted) when `cancelled` is set.
void check_cancelled(const std::atomic<bool>* cancelled);
/// Substeps between two looks at `cancelled`.
constexpr long cancel_interval = 4096;

/// rows of s' = J s + (P, 0): n x (p + n), all row-major. The diagonal of J is cut at +-`steepest`.
void sensitivity_rate(int n, int p, const double* jx, const double* jtheta, double steepest, const double* s,
                      double* out) noexcept;

/// A slope dx_i'/dx_i beyond this over the step cannot be carried by an explicit step of the sensitivities. It is that
/// of a root at its zero (a power law below 1 at v = 0), infinite at one point and finite in its integral: cut there.
inline constexpr double steepest = 2;

inline bool all_finite(const double* x, int n) noexcept {
  double sum[4] = {};  // of x * 0, which is NaN for NaN and infinity; one sum would wait for itself
  int i = 0;
  for (; i + 4 <= n; i += 4)
    for (int k = 0; k < 4; ++k) sum[k] += x[i + k] * 0.0;
  for (; i < n; ++i) sum[0] += x[i] * 0.0;
  return sum[0] + sum[1] + (sum[2] + sum[3]) == 0;
}

}  // namespace lunid
