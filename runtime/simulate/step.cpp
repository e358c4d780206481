// The step of the fixed path, found by halving.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "simulate/run.hpp"

namespace lunid {
namespace {

/// |h * eigenvalue| up to which the method of Dormand and Prince is stable on the negative real axis; Hairer & Wanner,
/// Solving ODEs II, IV.2.
constexpr double stability = 3.3;
/// Halving that leaves more than this part of the change, twice in a row, is no convergence.
constexpr double stalled_ratio = 0.5;

/// Iterations that find the growth of a large Jacobian, and those of them that count.
constexpr int power_iterations = 120, power_counted = 40;

/// The largest |eigenvalue| of a large sparse Jacobian, by the growth of a vector under it.
double spectral_radius(const Dynamics& d, const std::vector<double>& entries) {
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(d.n, 1, 2), next(d.n);
  double growth = 0;
  for (int k = 0; k < power_iterations; ++k) {
    next.setZero();
    for (std::size_t e = 0; e < entries.size(); ++e) next[d.pattern[e].row] += entries[e] * x[d.pattern[e].column];
    const double size = next.norm();
    if (!(size > 0) || !std::isfinite(size)) return 0;
    if (k >= power_iterations - power_counted) growth += std::log(size / x.norm());
    x = next / size;
  }
  return std::exp(growth / power_counted);
}

/// Substeps without which the linearisation at x0 is unstable.
double stable_substeps(const System& system, std::span<const double> theta, const Excitations& excitation,
                       const Eigen::VectorXd& x0) {
  const Dynamics& d = system.dynamics();
  std::vector<double> in(d.inputs(), 0.0), entries(d.jacobian.outputs()), scratch(d.jacobian.registers() + 1);
  in[0] = excitation.t0();
  for (int i = 0; i < d.exogenous; ++i) in[1 + i] = excitation[i].at(excitation.t0());
  std::copy(x0.begin(), x0.end(), in.begin() + 1 + d.exogenous);
  std::copy(theta.begin(), theta.end(), in.end() - d.p);
  d.jacobian.run_point(in.data(), entries.data(), scratch.data());
  for (const double entry : entries)
    if (!std::isfinite(entry)) return 1;
  if (!d.dense()) return excitation.dt() * spectral_radius(d, entries) / stability;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(d.n, d.n);
  for (std::size_t e = 0; e < entries.size(); ++e) jacobian(d.pattern[e].row, d.pattern[e].column) = entries[e];
  return excitation.dt() * jacobian.eigenvalues().cwiseAbs().maxCoeff() / stability;
}

}  // namespace

double relative_change(const Run& a, const Run& b) {
  const auto infinite = std::numeric_limits<double>::infinity();
  const Eigen::Index rows = b.x.rows();
  if (!a.summary.completed || !b.summary.completed) {
    // two runs that stop at one time, to a sample or a thousandth of the record, stop for the same cause
    const double apart = std::abs(a.summary.stopped_at - b.summary.stopped_at);
    const bool both = !a.summary.completed && !b.summary.completed;
    return both && apart <= b.dt * std::max(1.5, 1e-3 * static_cast<double>(rows)) ? 0 : infinite;
  }
  double worst = 0;
  for (Eigen::Index i = 0; i < b.a.cols(); ++i) {
    const auto y = b.x.col(2 * i).array();
    const double change = (a.x.col(2 * i).array() - y).abs().maxCoeff();
    const double spread = std::sqrt((y - y.mean()).square().mean());
    const double scale = spread > 0 ? spread : y.abs().maxCoeff();
    if (change > 0) worst = std::max(worst, change / scale);
  }
  return worst;
}

StepChoice choose_by_halving(const System& system, std::span<const double> theta, const Excitations& excitation,
                             const Eigen::VectorXd& x0, double tolerance, int limit, const SimulateOptions& options) {
  StepChoice choice;
  const double least = stable_substeps(system, theta, excitation, x0);
  if (least > limit) {
    choice.substeps = limit;
    choice.change = std::numeric_limits<double>::infinity();
    choice.finer = empty_run(system, excitation);
    choice.finer.summary.completed = false;
    choice.finer.summary.cause = "steps of 1/" + std::to_string(limit) + " sample are unstable";
    return choice;
  }
  while (choice.substeps < least) choice.substeps *= 2;
  Run coarse = run_free(system, theta, excitation, x0, choice.substeps, options);
  double previous = std::numeric_limits<double>::infinity();
  for (int stalled = 0;;) {
    choice.finer = run_free(system, theta, excitation, x0, 2 * choice.substeps, options);
    choice.change = relative_change(coarse, choice.finer);
    if (std::isfinite(previous) && choice.change > stalled_ratio * previous) ++stalled;
    choice.reached = choice.change < tolerance || stalled == 2;
    if (choice.reached || 2 * choice.substeps > limit) return choice;
    previous = choice.change;
    coarse = std::move(choice.finer);
    choice.substeps *= 2;
  }
}

int choose_substeps(const System& system, std::span<const double> theta, const Excitations& excitation,
                    const Eigen::VectorXd& x0, double tolerance) {
  const Excitations inputs = excitation.of(system);
  check_run("choose_substeps", system, theta, inputs, x0, {});
  if (!(tolerance > 0)) throw InputError("choose_substeps: tolerance: expected > 0, got " + number(tolerance));
  return choose_by_halving(system, theta, inputs, x0, tolerance, 64, {}).substeps;
}

}  // namespace lunid
