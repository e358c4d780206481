#include "simulate/period_run.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/dormand_prince.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

namespace dp = dormand_prince;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A step times the fastest oscillation [rad], for errors of 1e-7 per period of it; and times the fastest decay, within
/// the stability of the method.
constexpr double oscillation_step = 0.15, decay_step = 2.5;
constexpr Index fewest_rows = 128, most_rows = 1 << 16;
constexpr long most_events = 100000;  ///< per run
constexpr std::size_t most_grids = 8;
/// Samples of a period at which its rates are looked at.
constexpr Index looks = 16;

struct PeriodSink : RowSink {
  explicit PeriodSink(Period& period) : period(period) {}
  void row(Index row, const double* x, const double* f, const double* s) override {
    const Index n = period.x.cols();
    for (Index i = 0; i < n; ++i) {
      period.x(row, i) = x[i];
      period.rate(row, i) = f[i];
    }
    if (!s) return;
    const Index columns = parameters + n;
    Eigen::MatrixXd& slopes = row + 1 == period.x.rows() ? period.monodromy : period.mean_slope;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) slopes(i, j) += s[i * columns + parameters + j];
  }
  Period& period;
  Index parameters = 0;
};

}  // namespace

double Period::dt() const { return 2 * std::numbers::pi * periods / omega / static_cast<double>(x.rows() - 1); }

std::vector<Motion> Period::motions(int harmonics, const std::vector<bool>& kinks) const {
  std::vector<Motion> list;
  for (Index i = 0; i < x.cols(); ++i)
    list.push_back(
        motion_of_samples(x.col(i), kinks[i] ? VectorXd() : VectorXd(rate.col(i)), dt(), harmonics, periods));
  return list;
}

PeriodRun::PeriodRun(const PeriodicProblem& problem) : problem_(problem) {
  for (const HarmonicInput& h : problem.inputs) moving_ |= h.derivative > 0;
  kinks_.assign(problem.dynamics->n, !problem.dynamics->smooth());
  for (const auto& [y, v] : displacement_pairs(*problem.dynamics)) kinks_[y] = false;
}

/// The eigenvalues of df/dx at a state as a number of steps per second.
double PeriodRun::fastest(const VectorXd& x, double phase, double omega) const {
  const Dynamics& d = *problem_.dynamics;
  std::vector<double> in(d.inputs(), 0.0), out(d.derivatives.outputs()), scratch(d.derivatives.registers() + 1);
  const MatrixXd u = input_values(problem_.inputs, d.exogenous, omega, VectorXd::Constant(1, phase));
  for (int i = 0; i < d.exogenous; ++i) in[1 + i] = u(0, i);
  for (int i = 0; i < d.n; ++i) in[1 + d.exogenous + i] = x[i];
  std::copy(problem_.theta.begin(), problem_.theta.end(), in.end() - d.p);
  d.derivatives.run_point(in.data(), out.data(), scratch.data());
  const MatrixXd slopes = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      out.data() + d.n, d.n, d.n);
  if (!slopes.allFinite()) return 0;
  double wanted = 0;
  for (const std::complex<double>& value : slopes.eigenvalues())
    wanted = std::max({wanted, std::abs(value.imag()) / oscillation_step, std::abs(value) / decay_step});
  return wanted;
}

std::string PeriodRun::choose_rows(const Period& period) {
  double wanted = 0;
  const Index step = std::max<Index>(1, (period.x.rows() - 1) / looks);
  for (Index i = 0; i < period.x.rows(); i += step)
    wanted = std::max(wanted, fastest(period.x.row(i).transpose(), period.omega * period.dt() * static_cast<double>(i),
                                      period.omega));
  rows_ = fewest_rows;
  const double all = wanted * 2 * std::numbers::pi / period.omega;
  while (rows_ < most_rows && static_cast<double>(rows_) < all) rows_ *= 2;
  if (static_cast<double>(rows_) >= all) return "";
  return "a period would need more than " + std::to_string(most_rows) +
         " explicit steps: the model is too stiff, or the frequency too low, for this method";
}

std::string PeriodRun::choose_rows(const VectorXd& x, double omega) {
  Period at;
  at.x = x.transpose();
  at.x.conservativeResize(2, Eigen::NoChange);
  at.x.row(1) = at.x.row(0);
  at.omega = omega;
  return choose_rows(at);
}

/// The inputs at the stages of so many periods, kept for the next runs.
const MatrixXd& PeriodRun::grid(double omega, int periods) {
  if (moving_ && omega != grid_omega_) grids_.clear();
  grid_omega_ = omega;
  if (grids_.size() > most_grids) grids_.clear();
  MatrixXd& u = grids_[{rows_, periods}];
  if (u.size() > 0) return u;
  VectorXd phase(rows_ * periods * dp::nodes + 1);
  for (Index i = 0; i < phase.size(); ++i)
    phase[i] = 2 * std::numbers::pi * (static_cast<double>(i / dp::nodes) + dp::place[i % dp::nodes]) /
               static_cast<double>(rows_);
  return u = input_values(problem_.inputs, problem_.dynamics->exogenous, omega, phase);
}

Period PeriodRun::run(const VectorXd& x0, double omega, bool sensitivities, int periods) {
  const Dynamics& d = *problem_.dynamics;
  const Index rows = rows_ * periods;
  const MatrixXd& u = grid(omega, periods);
  Period period;
  period.omega = omega;
  period.periods = periods;
  period.x.setConstant(rows + 1, d.n, std::nan(""));
  period.rate = period.x;
  if (sensitivities) period.monodromy = period.mean_slope = MatrixXd::Zero(d.n, d.n);
  FixedProblem problem;
  problem.dynamics = &d;
  problem.theta = problem_.theta;
  problem.dt = period.dt();
  problem.rows = rows + 1;
  for (int i = 0; i < d.exogenous; ++i) problem.drive[i] = u.col(i).data();
  problem.max_events = most_events;
  problem.cancelled = problem_.cancelled;
  problem.sensitivities = sensitivities;
  PeriodSink sink(period);
  sink.parameters = d.p;
  const FixedOutcome outcome = run_fixed(problem, x0, sink);
  steps_ += outcome.steps;
  if (sensitivities) period.mean_slope /= static_cast<double>(rows);
  period.stuck = outcome.stuck;
  period.events = outcome.events;
  if (outcome.stop == Stop::too_many_events) period.fault = chatter_cause(d, outcome.event, most_events);
  if (outcome.stop == Stop::exploded) period.fault = "the motion grows without bound";
  return period;
}

Period PeriodRun::run_fine(const VectorXd& x0, double omega, int refinement) {
  const Index usual = rows_;
  rows_ *= refinement;
  Period period = run(x0, omega, false);
  rows_ = usual;
  return period;
}

Settled settle(PeriodRun& run, VectorXd x0, double omega, long max_periods, double tolerance) {
  constexpr int longest = 4;        // periods of a subharmonic
  constexpr double distinct = 1e3;  // that differ by so many tolerances: a slow spiral is none
  Settled settled;
  std::vector<VectorXd> ends{x0};
  VectorXd size = VectorXd::Zero(x0.size());
  int found = 0;
  while (settled.periods < max_periods && found == 0) {
    Period period = run.run(ends.back(), omega, false);
    ++settled.periods;
    if (period.fault.empty() && (settled.periods & (settled.periods - 1)) == 0) {  // the motion grows: look again
      const Index before = run.rows();
      period.fault = run.choose_rows(period);
      if (run.rows() != before) ends.assign(1, period.end());
    }
    settled.period = std::move(period);
    if (!settled.period.fault.empty()) return settled;
    ends.push_back(settled.period.end());
    size = settled.period.x.colwise().maxCoeff() - settled.period.x.colwise().minCoeff();
    const auto change = [&](int m) {  // over m periods, in sizes of the motion
      return ((ends.back() - ends[ends.size() - 1 - m]).cwiseAbs().array() / size.array().max(1e-300)).maxCoeff();
    };
    for (int m = 1; m <= longest && m < static_cast<int>(ends.size()) && found == 0; ++m)
      if (change(m) <= tolerance && (m == 1 || change(1) > distinct * tolerance)) found = m;
    if (ends.size() > longest + 1) ends.erase(ends.begin());
  }
  settled.steady = found > 0;
  const int last = found > 0 ? found : 16;
  if (last > 1) settled.period = run.run(ends.back(), omega, false, last);
  return settled;
}

}  // namespace lunid
