// The step of the fixed path, found by halving.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "expr/digits.hpp"
#include "simulate/dormand_prince.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

/// |h * eigenvalue| up to which the method of Dormand and Prince is stable on the negative real axis; Hairer & Wanner,
/// Solving ODEs II, IV.2.
constexpr double stability = 3.3;
/// Halving that leaves more than this part of the change, twice in a row, is no convergence.
constexpr double stalled_ratio = 0.5;

/// A coordinate that moves less than this part of the one that moves most is at rest: what a wave has not reached.
constexpr double still = 1e-6;

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

/// The entries of Dynamics::pattern at a state.
std::vector<double> jacobian_at(const System& system, std::span<const double> theta, const Excitations& excitation,
                                double t, const Eigen::VectorXd& x) {
  const Dynamics& d = system.dynamics();
  std::vector<double> in(d.inputs(), 0.0), entries(d.jacobian.outputs()), scratch(d.jacobian.registers() + 1);
  in[0] = t;
  for (int i = 0; i < d.exogenous; ++i) in[1 + i] = excitation[i].at(t);
  std::copy(x.begin(), x.end(), in.begin() + 1 + d.exogenous);
  std::copy(theta.begin(), theta.end(), in.end() - d.p);
  d.jacobian.run_point(in.data(), entries.data(), scratch.data());
  return entries;
}

bool finite(const std::vector<double>& entries) {
  return std::all_of(entries.begin(), entries.end(), [](double entry) { return std::isfinite(entry); });
}

/// Up to this many states eigenvalues cost no more than an estimate of the greatest.
constexpr int small = 8;
/// Rows of a run that are looked at for fast decays.
constexpr Eigen::Index looks = 16;

bool decays_fast(const System& system, std::span<const double> theta, const Excitations& excitation, double t,
                 const Eigen::VectorXd& x) {
  const Dynamics& d = system.dynamics();
  if (d.n > small) {
    const std::vector<double> entries = jacobian_at(system, theta, excitation, t, x);
    if (!finite(entries) || !(excitation.dt() * spectral_radius(d, entries) > stability)) return false;
    if (!d.dense()) return true;
  }
  const Fastest fastest = fastest_motion(system, theta, excitation, t, x);
  return fastest.decays && excitation.dt() * fastest.rate > stability;
}

}  // namespace

bool may_be_stiff(const System& system, std::span<const double> theta, const Excitations& excitation, const Run& run) {
  Eigen::Index rows = run.x.rows();
  while (rows > 0 && !run.x.row(rows - 1).allFinite()) --rows;
  const Eigen::Index stride = std::max<Eigen::Index>(1, rows / looks);
  for (Eigen::Index row = rows - 1; row >= 0; row -= stride)
    if (decays_fast(system, theta, excitation, run.t0 + run.dt * static_cast<double>(row), run.x.row(row).transpose()))
      return true;
  return false;
}

Fastest fastest_motion(const System& system, std::span<const double> theta, const Excitations& excitation, double t,
                       const Eigen::VectorXd& x) {
  const Dynamics& d = system.dynamics();
  const std::vector<double> entries = jacobian_at(system, theta, excitation, t, x);
  if (!finite(entries)) return {};
  if (!d.dense()) return {spectral_radius(d, entries), false};
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(d.n, d.n);
  for (std::size_t e = 0; e < entries.size(); ++e) jacobian(d.pattern[e].row, d.pattern[e].column) = entries[e];
  const Eigen::VectorXcd eigenvalues = jacobian.eigenvalues();
  Eigen::Index place = 0;
  const double rate = eigenvalues.cwiseAbs().maxCoeff(&place);
  return {rate, eigenvalues[place].real() < -std::abs(eigenvalues[place].imag())};
}

double least_substeps(const System& system, std::span<const double> theta, const Excitations& excitation,
                      const Eigen::VectorXd& x0, const StepChoice& choice) {
  const Dynamics& d = system.dynamics();
  if (!d.dense() || d.surfaces.empty() || choice.finer.summary.events == 0) return 1;
  std::vector<double> in(d.inputs(), 0.0), out(d.derivatives.outputs()), scratch(d.derivatives.registers() + 1);
  in[0] = excitation.t0();
  for (int i = 0; i < d.exogenous; ++i) in[1 + i] = excitation[i].at(excitation.t0());
  std::copy(x0.begin(), x0.end(), in.begin() + 1 + d.exogenous);
  std::copy(theta.begin(), theta.end(), in.end() - d.p);
  double fastest = 0;
  const auto& switches = d.derivative_switches;
  std::vector<std::int8_t> mode(switches.surface.size());
  for (std::size_t s = 0; s < d.surfaces.size(); ++s)
    for (const int side : {1, -1}) {
      for (std::size_t i = 0; i < mode.size(); ++i)  // 0: by the sign of the switch itself
        mode[i] =
            static_cast<std::int8_t>(switches.surface[i] == static_cast<int>(s) ? side * switches.orientation[i] : 0);
      d.derivatives.run_frozen(in.data(), mode.data(), out.data(), nullptr, scratch.data());
      using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      const Eigen::Map<const Matrix> jacobian(out.data() + d.n, d.n, d.n);
      if (jacobian.allFinite()) fastest = std::max(fastest, jacobian.eigenvalues().cwiseAbs().maxCoeff());
    }
  return std::max(1.0, excitation.dt() * fastest / stability);
}

double relative_change(const Run& a, const Run& b) {
  const auto infinite = std::numeric_limits<double>::infinity();
  const Eigen::Index rows = b.x.rows();
  if (!a.summary.completed || !b.summary.completed) {
    // two runs that stop at one time, to a sample or a thousandth of the record, stop for the same cause
    const double apart = std::abs(a.summary.stopped_at - b.summary.stopped_at);
    const bool both = !a.summary.completed && !b.summary.completed;
    return both && apart <= b.dt * std::max(1.5, 1e-3 * static_cast<double>(rows)) ? 0 : infinite;
  }
  double worst = 0, widest = 0;
  const auto spread_of = [&](Eigen::Index i) {
    const auto y = b.x.col(2 * i).array();
    return std::sqrt((y - y.mean()).square().mean());
  };
  for (Eigen::Index i = 0; i < b.a.cols(); ++i) widest = std::max(widest, spread_of(i));
  for (Eigen::Index i = 0; i < b.a.cols(); ++i) {
    const auto y = b.x.col(2 * i).array();
    const double change = (a.x.col(2 * i).array() - y).abs().maxCoeff();
    const double spread = std::max(spread_of(i), still * widest);
    const double scale = spread > 0 ? spread : y.abs().maxCoeff();
    if (change > 0) worst = std::max(worst, change / scale);
  }
  return worst;
}

Halving::Halving(const System& system, std::span<const double> theta, const Excitations& excitation,
                 const Eigen::VectorXd& x0, double tolerance, int limit, const SimulateOptions& options,
                 double at_least)
    : system_(system),
      theta_(theta),
      excitation_(excitation),
      x0_(x0),
      options_(options),
      tolerance_(tolerance),
      previous_(std::numeric_limits<double>::infinity()),
      limit_(limit) {
  // substeps without which the linearisation at x0 is unstable
  const double least = std::max(
      at_least, excitation.dt() * fastest_motion(system, theta, excitation, excitation.t0(), x0).rate / stability);
  if (least > limit) {
    choice_.substeps = limit;
    choice_.change = std::numeric_limits<double>::infinity();
    choice_.finer = empty_run(system, excitation);
    choice_.finer.summary.completed = false;
    choice_.finer.summary.cause =
        "steps of 1/" + std::to_string(limit) + " sample are unstable: the model is stiff; " + take_implicit;
    done_ = true;
    return;
  }
  while (choice_.substeps < least) choice_.substeps *= 2;
}

Run Halving::run(int substeps) {
  Run run = run_free(system_, theta_, excitation_, x0_, substeps, options_);
  choice_.spent += run.summary.evaluations;
  return run;
}

double Halving::next_cost() const {
  const double steps = static_cast<double>(excitation_.rows()) * choice_.substeps * (coarse_ ? 2 : 1);
  return dormand_prince::stages * steps;
}

void Halving::next() {
  if (!coarse_) {
    coarse_ = run(choice_.substeps);
    return;
  }
  choice_.finer = run(2 * choice_.substeps);
  choice_.change = relative_change(*coarse_, choice_.finer);
  if (std::isfinite(previous_) && choice_.change > stalled_ratio * previous_) ++stalled_;
  choice_.reached = choice_.change < tolerance_ || stalled_ == 2;
  done_ = choice_.reached || 2 * choice_.substeps > limit_;
  if (done_) return;
  previous_ = choice_.change;
  coarse_ = std::move(choice_.finer);
  choice_.substeps *= 2;
}

StepChoice choose_by_halving(const System& system, std::span<const double> theta, const Excitations& excitation,
                             const Eigen::VectorXd& x0, double tolerance, int limit, const SimulateOptions& options,
                             double at_least) {
  Halving halving(system, theta, excitation, x0, tolerance, limit, options, at_least);
  while (!halving.done()) halving.next();
  return halving.take();
}

int choose_substeps(const System& system, std::span<const double> theta, const Excitations& excitation,
                    const Eigen::VectorXd& x0, double tolerance) {
  const Excitations inputs = excitation.of(system, theta);
  check_run("choose_substeps", system, theta, inputs, x0, {});
  if (!(tolerance > 0)) throw InputError("choose_substeps: tolerance: expected > 0, got " + number(tolerance));
  return choose_by_halving(system, theta, inputs, x0, tolerance, explicit_limit, {}).substeps;
}

}  // namespace lunid
