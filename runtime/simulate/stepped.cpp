#include "simulate/stepped.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/dormand_prince.hpp"
#include "simulate/response_checks.hpp"

namespace lunid {
namespace {

namespace dp = dormand_prince;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

constexpr int reported_harmonics = 15;
/// Samples in one piece of a sweep: the grid of the force for them is all the memory that it needs.
constexpr Index piece = 1 << 14;

double frequency_of(Index i, const ResponseOptions& o) {
  const double part = static_cast<double>(i) / static_cast<double>(o.points - 1);
  return o.method == ResponseMethod::stepped_up ? o.from + part * (o.to - o.from) : o.to - part * (o.to - o.from);
}

/// A sine whose frequency moves evenly from one end to the other.
struct Sweep {
  double start, rate, duration;
  double frequency(double t) const { return start + rate * t; }
  double turns(double t) const { return t * (start + 0.5 * rate * t); }
};

/// Takes the rows of a sweep's pieces and gathers the ranges of each period.
class SweepSink : public RowSink {
 public:
  SweepSink(const Sweep& sweep, double dt, Index n, ResponseCurve& out)
      : sweep_(sweep), dt_(dt), n_(n), out_(out), low_(n), high_(n), last_x(n), last_rate_(n) {}

  void row(Index row, const double* x, const double* f, const double*) override {
    if (first + row == taken_) return;  // the first row of a piece is the last of the one before
    taken_ = first + row;
    const double t = dt_ * static_cast<double>(taken_);
    const bool started = taken_ > 0;
    for (Index i = 0; i < n_; ++i) {
      if (!started) low_[i] = high_[i] = x[i];
      if (started) widen_by_cubic(last_x[i], x[i], last_rate_[i] * dt_, f[i] * dt_, low_[i], high_[i]);
      low_[i] = std::min(low_[i], x[i]);
      high_[i] = std::max(high_[i], x[i]);
      last_x[i] = x[i];
      last_rate_[i] = f[i];
    }
    if (sweep_.turns(t) < static_cast<double>(turn_ + 1)) return;
    ++turn_;
    ResponsePoint point;
    point.frequency = sweep_.frequency(t);
    for (Index i = 0; i < n_; ++i) {
      Motion motion;
      motion.min = low_[i];
      motion.max = high_[i];
      point.motion.push_back(motion);
    }
    out_.points.push_back(std::move(point));
    low_ = high_ = last_x;
  }

  Index first = 0;  ///< row of the sweep at which the piece begins

 private:
  const Sweep& sweep_;
  double dt_;
  Index n_;
  ResponseCurve& out_;
  Index taken_ = -1;
  long turn_ = 0;
  VectorXd low_, high_;

 public:
  VectorXd last_x;

 private:
  VectorXd last_rate_;
};

/// The inputs at the stages of `count` steps from a row on.
MatrixXd sweep_inputs(const PeriodicProblem& problem, const Sweep& sweep, double dt, Index first, Index count) {
  const Index nodes = count * dp::nodes + 1;
  VectorXd phase(nodes), omega(nodes);
  for (Index i = 0; i < nodes; ++i) {
    const double t = dt * (static_cast<double>(first + i / dp::nodes) + dp::place[i % dp::nodes]);
    phase[i] = 2 * pi * std::fmod(sweep.turns(t), 1.0);
    omega[i] = 2 * pi * sweep.frequency(t);
  }
  MatrixXd u = MatrixXd::Zero(nodes, problem.dynamics->exogenous);
  for (const HarmonicInput& h : problem.inputs) {
    MatrixXd part = input_values(std::span(&h, 1), problem.dynamics->exogenous, 1, phase);
    for (int i = 0; i < h.derivative; ++i) part.col(h.input).array() *= omega.array();
    u += part;
  }
  return u;
}

}  // namespace

void run_stepped(const PeriodicProblem& problem, const ResponseOptions& options, ResponseCurve& out) {
  PeriodRun run(problem);
  VectorXd x = problem.start;
  long unsettled = 0;
  out.method = "stepped sine, " + std::string(options.method == ResponseMethod::stepped_up ? "up" : "down");
  for (Index i = 0; i < options.points; ++i) {
    const double frequency = frequency_of(i, options), omega = 2 * pi * frequency;
    std::string fault = run.choose_rows(x, omega);
    Settled settled;
    if (fault.empty()) settled = settle(run, x, omega, options.max_periods, 0.1 * options.accuracy);
    if (fault.empty()) fault = settled.period.fault;
    if (!fault.empty()) {
      out.stopped.push_back("stopped at " + in_hertz(frequency) + ": " + fault);
      out.complete = false;
      return;
    }
    x = settled.period.end();
    ResponsePoint point;
    point.frequency = frequency;
    point.stable = settled.steady;
    point.periods = settled.steady ? settled.period.periods : 0;
    point.motion = settled.period.motions(reported_harmonics, run.kinks());
    unsettled += settled.steady ? 0 : 1;
    out.points.push_back(std::move(point));
  }
  out.complete = unsettled == 0;
  out.stopped.push_back("reached " + in_hertz(out.points.back().frequency) +
                        (unsettled == 0 ? ""
                                        : "; at " + std::to_string(unsettled) + " frequencies not steady within " +
                                              std::to_string(options.max_periods) + " periods"));
}

void run_swept(const PeriodicProblem& problem, const ResponseOptions& options, ResponseCurve& out) {
  const bool up = options.method == ResponseMethod::swept_up;
  const Sweep sweep{up ? options.from : options.to, up ? options.rate : -options.rate,
                    (options.to - options.from) / options.rate};
  out.method = "swept sine, " + std::string(up ? "up" : "down");
  PeriodRun steps(problem);
  if (const std::string fault = steps.choose_rows(problem.start, 2 * pi * options.to); !fault.empty()) {
    out.complete = false;
    out.stopped.push_back("stopped at the start: " + fault);
    return;
  }
  const double dt = 1 / (options.to * static_cast<double>(steps.rows()));
  const auto rows = static_cast<Index>(sweep.duration / dt);
  SweepSink sink(sweep, dt, problem.dynamics->n, out);
  sink.last_x = problem.start;
  for (Index first = 0; first < rows; first += piece) {
    const Index count = std::min(piece, rows - first);
    const MatrixXd u = sweep_inputs(problem, sweep, dt, first, count);
    FixedProblem part;
    part.dynamics = problem.dynamics;
    part.theta = problem.theta;
    part.t0 = dt * static_cast<double>(first);
    part.dt = dt;
    part.rows = count + 1;
    for (int i = 0; i < problem.dynamics->exogenous; ++i) part.drive[i] = u.col(i).data();
    part.cancelled = problem.cancelled;
    sink.first = first;
    const FixedOutcome outcome = run_fixed(part, VectorXd(sink.last_x), sink);
    if (outcome.stop == Stop::none) continue;
    out.complete = false;
    out.stopped.push_back("stopped at " + in_hertz(sweep.frequency(outcome.stopped_at)) +
                          ": the motion grows without bound");
    return;
  }
  out.stopped.push_back("reached " + in_hertz(up ? options.to : options.from));
}

}  // namespace lunid
