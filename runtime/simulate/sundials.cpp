// Free runs by SUNDIALS: from event to event in frozen modes, by the same ModeMachine as the fixed path.
#include <cmath>

#include "simulate/integrator.hpp"
#include "simulate/modes.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A sample nearer than this part of the interval is reached.
constexpr double reached_fraction = 1e-10;
/// A slope within this part of the greatest one is none: a watch on it never rests on zero.
constexpr double rest_speed = 1e-12;
/// |y| beyond this many times its largest value on the samples counts as an explosion when the integrator gives up.
constexpr double runaway = 100;

/// Thrown out of the integrator when the displacement passes the bound.
struct Exploded {
  double t;
  VectorXd x;
};

/// A model in its present mode.
class ModalOde : public Ode {
 public:
  ModalOde(const System& system, std::span<const double> theta, const Excitations& excitation, const VectorXd& x0,
           const SimulateOptions& options)
      : modes(system.dynamics(), theta, excitation.dt()),
        excitation_(excitation),
        options_(options),
        n_(system.states()),
        observation_(modes.observation()),
        scale_(n_, 0.0),
        in_(system.dynamics().inputs()),
        scratch_(system.dynamics().jacobian.registers() + 1) {
    std::copy(theta.begin(), theta.end(), in_.end() - static_cast<std::ptrdiff_t>(theta.size()));
    first_scales(x0);
  }

  int states() const override { return n_; }
  int events() const override { return modes.events(); }

  Drive drive(double t) const {
    Drive d(t, excitation_.count());
    for (int i = 0; i < excitation_.count(); ++i) {
      const Excitation& input = excitation_[i];
      d.u[i] = input.at(std::min(t, hold_until));
      if (!modes.dynamics().input_rates) continue;
      const double step = 1e-6 * excitation_.dt();
      d.rate[i] = (input.at(t + step) - input.at(t - step)) / (2 * step);
    }
    return d;
  }

  void rate(double t, const double* x, double* f) override {
    if ((++calls_ & (cancel_interval - 1)) == 0) check_cancelled(options_.cancelled);
    for (int i = 0; bound > 0 && i < modes.dynamics().degrees; ++i)
      if (!(std::abs(x[2 * i]) <= bound)) throw Exploded{t, Eigen::Map<const VectorXd>(x, n_)};
    modes.rate(drive(t), x, f);
  }

  const std::vector<Dynamics::Entry>* pattern() const override {
    return modes.dynamics().dense() ? nullptr : &modes.dynamics().pattern;
  }

  /// With many states that of the side on which each switch stands: in sliding it is an approximation, which costs
  /// iterations and no accuracy.
  void jacobian(double t, const double* x, double* j) override {
    if (modes.dynamics().dense()) {
      std::copy_n(modes.derivatives(drive(t), x).jx, n_ * n_, j);
      return;
    }
    const Dynamics& d = modes.dynamics();
    const Drive now = drive(t);
    in_[0] = t;
    std::copy_n(now.u, d.exogenous, in_.begin() + 1);
    std::copy_n(x, d.n, in_.begin() + 1 + d.exogenous);
    d.jacobian.run_point(in_.data(), j, scratch_.data());
  }

  void event_functions(double t, const double* x, double* g) override {
    modes.observe(drive(t), x, observation_);
    std::copy(observation_.event.begin(), observation_.event.end(), g);
    for (int i = 0; i < events(); ++i)
      g[events() + i] = std::isfinite(observation_.slope[i]) ? observation_.slope[i] + rest_speed * modes.speed(i) : 1;
  }

  /// 1 / (rtol |x| + atol), atol being rtol times the largest |x| so far where none is given.
  void error_weights(const double* x, double* w) override {
    for (int i = 0; i < n_; ++i) scale_[i] = std::max(scale_[i], std::abs(x[i]));
    share_scales();
    for (int i = 0; i < n_; ++i) {
      w[i] = 1 / (options_.rtol * std::abs(x[i]) + (options_.atol > 0 ? options_.atol : options_.rtol * scale_[i]));
    }
  }

  ModeMachine modes;
  double bound = 0;                                             ///< on |y|; 0: none
  double hold_until = std::numeric_limits<double>::infinity();  ///< no sample of a held force is used beyond this

 private:
  /// A coordinate that hardly moves is not held to a precision of its own: it counts a thousandth of the largest.
  void share_scales() {
    const int degrees = modes.dynamics().degrees;
    for (const int quantity : {0, 1}) {
      double largest = 0;
      for (int i = 0; i < degrees; ++i) largest = std::max(largest, scale_[2 * i + quantity]);
      for (int i = 0; i < degrees; ++i) scale_[2 * i + quantity] = std::max(scale_[2 * i + quantity], 1e-3 * largest);
    }
  }

  /// The size of each state before there is motion to read it off: what a sample's time makes of the first rates.
  void first_scales(const VectorXd& x0) {
    const int degrees = modes.dynamics().degrees;
    Drive d(excitation_.t0(), excitation_.count());
    const double dt = excitation_.dt();
    VectorXd x = x0, reach(n_);
    for (const double side : {0.0, 1.0, -1.0}) {
      for (int i = 0; i < excitation_.count(); ++i) d.u[i] = side * excitation_[i].peak();
      modes.rate(d, x.data(), reach.data());
      for (int i = 0; i < n_; ++i)
        if (std::isfinite(reach[i])) scale_[i] = std::max({scale_[i], std::abs(x0[i]), std::abs(reach[i]) * dt});
    }
    for (int i = 0; i < degrees; ++i) {
      scale_[2 * i] = std::max(scale_[2 * i], scale_[2 * i + 1] * dt);
      x[2 * i] += scale_[2 * i];
      x[2 * i + 1] += scale_[2 * i + 1];
    }
    modes.rate(d, x.data(), reach.data());
    for (int i = 0; i < n_; ++i) {
      if (std::isfinite(reach[i])) scale_[i] = std::max(scale_[i], std::abs(reach[i]) * dt);
      if (!(scale_[i] > 0)) scale_[i] = 1e-9;
    }
  }

  const Excitations& excitation_;
  const SimulateOptions& options_;
  int n_;
  Observation observation_;
  std::vector<double> scale_, in_, scratch_;
  long calls_ = 0;
};

class SundialsRun {
 public:
  SundialsRun(const System& system, std::span<const double> theta, const Excitations& excitation, const VectorXd& x0,
              const SimulateOptions& options)
      : system_(system),
        theta_(theta),
        excitation_(excitation),
        options_(options),
        ode_(system, theta, excitation, x0, options),
        x_(x0),
        now_(ode_.modes.observation()),
        run_(empty_run(system, excitation)),
        t_(excitation.t0()) {
    ode_.bound = options.bound > 0 ? options.bound : default_bound(system, theta, excitation, x0);
    run_.summary.solver = sundials_name(options.solver);
  }

  Run go() {
    begin_interval(0);
    ode_.modes.start(ode_.drive(t_), x_.data());
    integrator_ = is_runge_kutta(options_.solver) ? make_arkode(options_.solver, ode_, t_, x_, excitation_.dt())
                                                  : make_cvode(options_.solver, ode_, t_, x_, excitation_.dt());
    put_row(0);
    for (Index row = 1; row < excitation_.rows(); ++row) {
      begin_interval(row - 1);
      if (!reach(excitation_.t0() + excitation_.dt() * static_cast<double>(row))) break;
      begin_interval(row);
      put_row(row);
    }
    run_.summary.steps = integrator_->steps();
    run_.summary.evaluations = integrator_->evaluations();
    return std::move(run_);
  }

 private:
  double displacement() const {
    double largest = 0;
    for (int i = 0; i < system_.degrees(); ++i) largest = std::max(largest, std::abs(x_[2 * i]));
    return largest;
  }

  bool holds() const { return excitation_.interpolation() == Interpolation::hold; }

  /// A held force jumps at every sample. The Runge-Kutta methods stop there and never look beyond; the multistep ones
  /// step over it, and their error control finds the jump.
  void begin_interval(Index row) {
    if (!holds() || !is_runge_kutta(options_.solver)) return;
    ode_.hold_until = excitation_.t0() + excitation_.dt() * (static_cast<double>(row) + 0.5);
    if (!integrator_) return;
    ode_.modes.settle(ode_.drive(t_), x_.data());
    integrator_->restart(t_, x_);
  }

  void put_row(Index row) {
    ode_.modes.observe(ode_.drive(t_), x_.data(), now_);
    run_.x.row(row) = x_.transpose();
    for (Index i = 0; i < run_.a.cols(); ++i) run_.a(row, i) = now_.f[2 * i + 1];
    largest_ = std::max(largest_, displacement());
  }

  bool reach(double to) {
    try {
      return reach_through_events(to);
    } catch (const Exploded& place) {
      t_ = place.t;
      x_ = place.x;
      return explode();
    }
  }

  /// Integrates to a sample through all events on the way; false when the run stops.
  bool reach_through_events(double to) {
    while (to - t_ > reached_fraction * excitation_.dt()) {
      const double from = t_;
      const bool sliding = ode_.modes.sliding();
      const Integrator::Result result = integrator_->advance(to, t_, x_);
      if (sliding) run_.summary.stuck += t_ - from;
      if (result == Integrator::Result::failed) return fail();
      if (result == Integrator::Result::reached) break;
      if (!happen(integrator_->fired())) return false;
    }
    if (!catch_up()) return false;
    // a state that rests on a surface drifts by rounding in the interpolants of the integrator
    ode_.modes.project(ode_.drive(t_), x_.data());
    t_ = to;
    return true;
  }

  /// An event function that was zero when its part began can be below zero without a crossing that SUNDIALS has seen.
  bool catch_up() {
    ode_.modes.observe(ode_.drive(t_), x_.data(), now_);
    std::vector<int> missed;
    for (int i = 0; i < ode_.events(); ++i)
      if (now_.event[i] < 0) missed.push_back(i);
    return happen(missed);
  }

  bool happen(const std::vector<int>& fired) {
    const Drive drive = ode_.drive(t_);
    int last = -1;
    if (fired.empty()) return true;
    for (const int event : fired) {
      ode_.modes.resolve(event, drive, x_.data());
      ++run_.summary.events;
      last = event;
    }
    if (run_.summary.events > options_.max_events)
      return stop(chatter_cause(system_.dynamics(), last, options_.max_events));
    integrator_->restart(t_, x_);
    return true;
  }

  bool stop(std::string cause) {
    run_.summary.completed = false;
    run_.summary.stopped_at = t_;
    run_.summary.cause = std::move(cause);
    return false;
  }

  bool explode() { return stop(explosion_cause(system_, theta_, t_, x_, excitation_.dt())); }

  bool fail() {
    if (!x_.allFinite() || displacement() > runaway * largest_) return explode();
    return stop(integrator_->failure());
  }

  const System& system_;
  std::span<const double> theta_;
  const Excitations& excitation_;
  const SimulateOptions& options_;
  ModalOde ode_;
  VectorXd x_;
  Observation now_;
  Run run_;
  double t_, largest_ = 0;
  std::unique_ptr<Integrator> integrator_;
};

}  // namespace

Run run_sundials(const System& system, std::span<const double> theta, const Excitations& excitation, const VectorXd& x0,
                 const SimulateOptions& options) {
  return SundialsRun(system, theta, excitation, x0, options).go();
}

}  // namespace lunid
