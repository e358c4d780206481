#include "simulate/fixed.hpp"

#include <algorithm>

#include "expr/error.hpp"

namespace lunid {

void check_cancelled(const std::atomic<bool>* cancelled) {
  if (cancelled && cancelled->load(std::memory_order_relaxed))
    throw InputError("simulate: interrupted", {}, Fault::interrupted);
}

namespace {

void sensitivity_rows(int n, int p, const double* jx, const double* jtheta, double steepest, const double* __restrict s,
                      double* __restrict out) noexcept {
  const int columns = p + n;
  for (int i = 0; i < n; ++i) {
    double* __restrict row = out + i * columns;
    for (int c = 0; c < p; ++c) row[c] = jtheta[i * p + c];
    for (int c = p; c < columns; ++c) row[c] = 0;
    for (int j = 0; j < n; ++j) {
      const double slope = i == j ? std::clamp(jx[i * n + j], -steepest, steepest) : jx[i * n + j];
      if (slope == 0) continue;
      const double* __restrict from = s + j * columns;
      for (int c = 0; c < columns; ++c) row[c] += slope * from[c];
    }
  }
}

/// The usual case, in one sweep.
void sensitivity_rows_of_two(int p, const double* jx, const double* jtheta, double steepest, const double* __restrict s,
                             double* __restrict out) noexcept {
  const int columns = p + 2;
  const double* __restrict other = s + columns;
  for (int i = 0; i < 2; ++i) {
    const double a = i == 0 ? std::clamp(jx[0], -steepest, steepest) : jx[2];
    const double b = i == 1 ? std::clamp(jx[3], -steepest, steepest) : jx[1];
    double* __restrict row = out + i * columns;
    for (int c = 0; c < columns; ++c) row[c] = a * s[c] + b * other[c];
    for (int c = 0; c < p; ++c) row[c] += jtheta[i * p + c];
  }
}

}  // namespace

void sensitivity_rate(int n, int p, const double* jx, const double* jtheta, double steepest, const double* s,
                      double* out) noexcept {
  if (n == 2)
    sensitivity_rows_of_two(p, jx, jtheta, steepest, s, out);
  else
    sensitivity_rows(n, p, jx, jtheta, steepest, s, out);
}

FixedOutcome run_fixed(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  if (!problem.dynamics->smooth()) return run_with_events(problem, x0, sink);
  return problem.sensitivities ? run_smooth_sensitivities(problem, x0, sink) : run_smooth(problem, x0, sink);
}

}  // namespace lunid
