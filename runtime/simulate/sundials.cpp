// Free runs by SUNDIALS: from event to event in frozen modes, by the same ModeMachine as the fixed path.
#include <cmath>
#include <optional>

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
/// An explicit method is looked at after this many steps in samples that take more than crowded_sample of them each;
/// after stiff_looks in a row at which stability holds its steps down the run stops. Hairer & Wanner, Solving ODEs II,
/// IV.2, do so in their DOPRI5.
constexpr long crowded_sample = 64, look_after = 4000;
constexpr int stiff_looks = 5;
/// Steps that are longer than this over the fastest decay are not those that accuracy asks for: it has long died away.
constexpr double held_by_stability = 1;

/// Where the integrator asked for the rate at a displacement beyond the bound.
struct Beyond {
  double t;
  VectorXd x;
  int times;
};
/// Steps that were too long are shortened in fewer tries than this; a motion that explodes asks again and again.
constexpr int tries_beyond = 50;

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
        scratch_(std::max(system.dynamics().jacobian.registers(), system.dynamics().rate.registers()) + 1) {
    std::copy(theta.begin(), theta.end(), in_.end() - static_cast<std::ptrdiff_t>(theta.size()));
    const double fastest = fastest_motion(system, theta, excitation, excitation.t0(), x0).rate;
    first_scales(x0, std::min(excitation.dt(), 1 / fastest));
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
      if (!(std::abs(x[2 * i]) <=
            bound)) {  // a step too long, perhaps: no value there, and SUNDIALS tries a shorter one
        beyond = Beyond{t, Eigen::Map<const VectorXd>(x, n_), beyond ? beyond->times + 1 : 1};
        if (beyond->times > tries_beyond) throw *beyond;
        std::fill_n(f, n_, std::numeric_limits<double>::quiet_NaN());
        return;
      }
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
  std::optional<Beyond> beyond;                                 ///< since it was last reset
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

  /// |x'| with every switch on its own side: no mode is known yet, and a contact not made must not count.
  void free_rates(const Drive& d, const VectorXd& x, VectorXd& out) {
    in_[0] = d.t;
    std::copy_n(d.u, modes.dynamics().exogenous, in_.begin() + 1);
    std::copy(x.begin(), x.end(), in_.begin() + 1 + modes.dynamics().exogenous);
    modes.dynamics().rate.run_point(in_.data(), out.data(), scratch_.data());
    out = out.array().isFinite().select(out.cwiseAbs(), 0);
  }

  /// The size of each state before there is motion to read it off: what the first rates make in a time, that of a
  /// sample or of the fastest motion, whichever is less.
  void first_scales(const VectorXd& x0, double time) {
    const int degrees = modes.dynamics().degrees;
    Drive d(excitation_.t0(), excitation_.count());
    VectorXd x = x0, rates(modes.dynamics().rate.outputs());
    for (const double side : {0.0, 1.0, -1.0}) {
      for (int i = 0; i < excitation_.count(); ++i) d.u[i] = side * excitation_[i].peak();
      free_rates(d, x, rates);
      for (int i = 0; i < n_; ++i) scale_[i] = std::max({scale_[i], std::abs(x0[i]), rates[i] * time});
    }
    for (int i = 0; i < degrees; ++i) {
      scale_[2 * i] = std::max(scale_[2 * i], scale_[2 * i + 1] * time);
      x[2 * i] += scale_[2 * i];
      x[2 * i + 1] += scale_[2 * i + 1];
    }
    free_rates(d, x, rates);
    for (int i = 0; i < n_; ++i) {
      scale_[i] = std::max(scale_[i], rates[i] * time);
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
      const double from = t_;
      if (!reach(excitation_.t0() + excitation_.dt() * static_cast<double>(row))) break;
      if (!look_for_stiffness(from)) break;
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
    } catch (const Beyond&) {
      return fail();
    }
  }

  /// Integrates to a sample through all events on the way; false when the run stops.
  bool reach_through_events(double to) {
    while (to - t_ > reached_fraction * excitation_.dt()) {
      const double from = t_;
      const bool sliding = ode_.modes.sliding();
      ode_.beyond.reset();
      const Integrator::Result result = integrator_->advance(to, t_, x_);
      if (sliding) run_.summary.stuck += t_ - from;
      if (result == Integrator::Result::failed) return fail();
      if (result == Integrator::Result::paused) {
        if (!go_on()) return false;
        continue;
      }
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
    if (ode_.beyond) {
      t_ = ode_.beyond->t;
      x_ = ode_.beyond->x;
      return explode();
    }
    if (!x_.allFinite() || displacement() > runaway * largest_) return explode();
    return stop(integrator_->failure());
  }

  /// After many steps within one sample.
  bool go_on() {
    const long taken = integrator_->steps() - steps_;
    if (stability_holds((t_ - sample_) / static_cast<double>(taken))) return stop(stiff_cause());
    if (taken < max_steps_per_sample) return true;
    const bool implicit = options_.solver == Solver::bdf || options_.solver == Solver::esdirk;
    return stop("more than " + std::to_string(max_steps_per_sample) + " steps of " + run_.summary.solver +
                " within one sample; take a shorter dt" + (implicit ? "" : std::string(", or ") + take_implicit));
  }

  /// After each sample; false when the run stops because the method is explicit and the model is not for it.
  bool look_for_stiffness(double from) {
    const long taken = integrator_->steps() - steps_;
    steps_ += taken;
    sample_ = t_;
    if (!is_explicit(options_.solver) || taken <= crowded_sample) return true;
    crowded_ += taken;
    if (crowded_ < look_after) return true;
    crowded_ = 0;
    stiff_ = stability_holds((t_ - from) / static_cast<double>(taken)) ? stiff_ + 1 : 0;
    return stiff_ < stiff_looks || stop(stiff_cause());
  }

  bool stability_holds(double step) {
    if (!is_explicit(options_.solver)) return false;
    fastest_ = fastest_motion(system_, theta_, excitation_, t_, x_);
    step_ = step;
    return fastest_.decays && fastest_.rate * step > held_by_stability;
  }

  std::string stiff_cause() const {
    return "the model is stiff: its fastest decay, " + number(1 / fastest_.rate) + " s, holds the steps of " +
           run_.summary.solver + " down to " + number(step_) + " s; " + take_implicit;
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
  double sample_ = t_;            ///< the last sample reached
  long steps_ = 0, crowded_ = 0;  ///< up to there; of them those not yet looked at
  int stiff_ = 0;                 ///< looks in a row that found stability at work
  Fastest fastest_;               ///< at the last look
  double step_ = 0;
  std::unique_ptr<Integrator> integrator_;
};

}  // namespace

Run run_sundials(const System& system, std::span<const double> theta, const Excitations& excitation, const VectorXd& x0,
                 const SimulateOptions& options) {
  return SundialsRun(system, theta, excitation, x0, options).go();
}

}  // namespace lunid
