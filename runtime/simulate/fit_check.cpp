#include "simulate/fit_check.hpp"

#include <algorithm>
#include <limits>

#include "simulate/run.hpp"

namespace lunid {
namespace {

/// Steps of SUNDIALS on a sampled force cost a hundred of ours.
constexpr Eigen::Index most_rows = 10000;

}  // namespace

double check_by_sundials(const System& system, const FitResult& result, const std::vector<FitData>& data,
                         const FitOptions& options) {
  double worst = std::numeric_limits<double>::quiet_NaN();
  if (system.model().imposed_motion || !result.solver.starts_with("fixed") || !std::isfinite(result.cost)) return worst;
  const FitLayout layout(system.parameters(), static_cast<int>(data.size()), options.separate);
  SimulateOptions fixed, sundials;
  fixed.solver = Solver::fixed;
  fixed.substeps = result.substeps;
  sundials.solver = Solver::rk78;
  fixed.cancelled = sundials.cancelled = options.cancelled;
  for (const FitSegment& segment : result.segments) {
    const Eigen::VectorXd theta = layout.of_record(result.theta, segment.record);
    const std::span<const double> values(theta.data(), static_cast<std::size_t>(theta.size()));
    const Excitations excitation = data[static_cast<std::size_t>(segment.record)].excitation.part(
        segment.first, std::min(segment.count, most_rows));
    const Run ours = simulate(system, values, excitation, segment.x0, fixed),
              theirs = simulate(system, values, excitation, segment.x0, sundials);
    worst = std::max(std::isnan(worst) ? 0 : worst, relative_change(ours, theirs));
  }
  return worst;
}

}  // namespace lunid
