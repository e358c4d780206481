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

/// Substeps without which the linearisation at x0 is unstable.
double stable_substeps(const System& system, std::span<const double> theta, const Excitation& excitation,
                       const Eigen::VectorXd& x0) {
  const Dynamics& d = system.dynamics();
  std::vector<double> in(d.inputs(), 0.0), out(d.derivatives.outputs()), scratch(d.derivatives.registers() + 1);
  in[0] = excitation.t0();
  in[1] = excitation.at(excitation.t0());
  std::copy(x0.begin(), x0.end(), in.begin() + 2);
  std::copy(theta.begin(), theta.end(), in.end() - d.p);
  d.derivatives.run_point(in.data(), out.data(), scratch.data());
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian(
      out.data() + d.n, d.n, d.n);
  if (!jacobian.allFinite()) return 1;
  return excitation.dt() * Eigen::MatrixXd(jacobian).eigenvalues().cwiseAbs().maxCoeff() / stability;
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
  const auto y = b.x.col(0).array();
  const double change = (a.x.col(0).array() - y).abs().maxCoeff();
  const double spread = std::sqrt((y - y.mean()).square().mean());
  const double scale = spread > 0 ? spread : y.abs().maxCoeff();
  return change == 0 ? 0 : change / scale;
}

StepChoice choose_by_halving(const System& system, std::span<const double> theta, const Excitation& excitation,
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

int choose_substeps(const System& system, std::span<const double> theta, const Excitation& excitation,
                    const Eigen::VectorXd& x0, double tolerance) {
  check_run("choose_substeps", system, theta, excitation, x0, {});
  if (!(tolerance > 0)) throw InputError("choose_substeps: tolerance: expected > 0, got " + number(tolerance));
  return choose_by_halving(system, theta, excitation, x0, tolerance, 64, {}).substeps;
}

}  // namespace lunid
