#include "simulate/fixed.hpp"

#include <algorithm>

#include "expr/error.hpp"

namespace lunid {

void check_cancelled(const std::atomic<bool>* cancelled) {
  if (cancelled && cancelled->load(std::memory_order_relaxed))
    throw InputError("simulate: interrupted", {}, Fault::interrupted);
}

void sensitivity_rate(int n, int p, const double* jx, const double* jtheta, double steepest, const double* s,
                      double* out) noexcept {
  const int columns = p + n;
  for (int i = 0; i < n; ++i) {
    double* row = out + i * columns;
    for (int c = 0; c < p; ++c) row[c] = jtheta[i * p + c];
    for (int c = p; c < columns; ++c) row[c] = 0;
    for (int j = 0; j < n; ++j) {
      const double slope = i == j ? std::clamp(jx[i * n + j], -steepest, steepest) : jx[i * n + j];
      if (slope == 0) continue;
      const double* from = s + j * columns;
      for (int c = 0; c < columns; ++c) row[c] += slope * from[c];
    }
  }
}

FixedOutcome run_fixed(const FixedProblem& problem, const Eigen::VectorXd& x0, RowSink& sink) {
  if (!problem.dynamics->smooth()) return run_with_events(problem, x0, sink);
  return problem.sensitivities ? run_smooth_sensitivities(problem, x0, sink) : run_smooth(problem, x0, sink);
}

}  // namespace lunid
