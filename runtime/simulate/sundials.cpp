// Free runs by SUNDIALS: from event to event in frozen modes, by the same ModeMachine as the fixed path.
#include "simulate/sundials.hpp"

#include <cmath>
#include <optional>

#include "expr/digits.hpp"
#include "simulate/modal_ode.hpp"
#include "simulate/run.hpp"
#include "simulate/saltation.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A sample nearer than this part of the interval is reached.
constexpr double reached_fraction = 1e-10;
/// |y| beyond this many times its largest value on the samples counts as an explosion when the integrator gives up.
constexpr double runaway = 100;
/// An explicit method is looked at after this many steps in samples that take more than crowded_sample of them each;
/// after stiff_looks in a row at which stability holds its steps down the run stops. Hairer & Wanner, Solving ODEs II,
/// IV.2, do so in their DOPRI5.
constexpr long crowded_sample = 64, look_after = 4000;
constexpr int stiff_looks = 5;
/// What a step costs besides its evaluations, in evaluations of a small model (170 ns over 9 ns, measured).
constexpr double step_overhead = 20;
/// Steps that are longer than this over the fastest decay are not those that accuracy asks for: it has long died away.
constexpr double held_by_stability = 1;

}  // namespace

class SundialsRun::Impl {
 public:
  Impl(const System& system, std::span<const double> theta, const Excitations& excitation, const VectorXd& x0,
       const SimulateOptions& options, RowSink& sink, bool sensitivities)
      : system_(system),
        theta_(theta),
        excitation_(excitation),
        options_(options),
        sink_(sink),
        ode_(system, theta, excitation, x0, options_, sensitivities),
        sensitivities_(sensitivities ? std::optional<Sensitivities>(system.dynamics()) : std::nullopt),
        saltation_(ode_.modes, sensitivities_ ? &*sensitivities_ : nullptr),
        x_(x0),
        now_(ode_.modes.observation()),
        t_(excitation.t0()) {
    ode_.bound = options.bound > 0 ? options.bound : default_bound(system, theta, excitation, x0);
    summary_.solver = sundials_name(options.solver);
  }

  bool go(double budget) {
    if (!integrator_) begin();
    for (; row_ < excitation_.rows(); ++row_) {
      if (spent() > budget) return false;
      begin_interval(row_ - 1);
      const double from = t_;
      if (!reach(excitation_.t0() + excitation_.dt() * static_cast<double>(row_))) break;
      if (!look_for_stiffness(from)) break;
      begin_interval(row_);
      put_row(row_);
    }
    return true;
  }

  double spent() const {
    return static_cast<double>(integrator_->evaluations()) + step_overhead * static_cast<double>(integrator_->steps());
  }

  RunSummary summary() const {
    RunSummary summary = summary_;
    summary.steps = integrator_->steps();
    summary.evaluations = integrator_->evaluations();
    summary.grazing = saltation_.grazing;
    return summary;
  }

 private:
  const double* sensitivities() const { return sensitivities_ ? sensitivities_->s.data() : nullptr; }

  void begin() {
    begin_interval(0);
    saltation_.start(ode_.drive(t_), x_.data());
    integrator_ = is_runge_kutta(options_.solver)
                      ? make_arkode(options_.solver, ode_, t_, x_, excitation_.dt())
                      : make_cvode(options_.solver, ode_, t_, x_, excitation_.dt(), sensitivities());
    put_row(0);
  }

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
    integrator_->restart(t_, x_, sensitivities());
  }

  void put_row(Index row) {
    ode_.modes.observe(ode_.drive(t_), x_.data(), now_);
    sink_.row(row, x_.data(), now_.f.data(), sensitivities());
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
      if (sliding) summary_.stuck += t_ - from;
      if (result == Integrator::Result::failed) return fail();
      if (sensitivities_) integrator_->sensitivities(sensitivities_->s.data());
      if (result == Integrator::Result::paused) {
        if (!go_on()) return false;
        continue;
      }
      if (result == Integrator::Result::reached) break;
      if (!happen(integrator_->fired())) return false;
    }
    if (!catch_up()) return false;
    // a state that rests on a surface drifts by rounding in the interpolants of the integrator
    saltation_.project(ode_.drive(t_), x_.data());
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
    ode_.modes.observe(drive, x_.data(), now_);
    for (const int event : fired) {
      saltation_.resolve(event, drive, x_.data(), now_);
      ++summary_.events;
      last = event;
    }
    if (summary_.events > options_.max_events)
      return stop(chatter_cause(system_.dynamics(), last, options_.max_events));
    integrator_->restart(t_, x_, sensitivities());
    return true;
  }

  bool stop(std::string cause) {
    summary_.completed = false;
    summary_.stopped_at = t_;
    summary_.cause = std::move(cause);
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
    return stop("more than " + std::to_string(max_steps_per_sample) + " steps of " + summary_.solver +
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
           summary_.solver + " down to " + number(step_) + " s; " + take_implicit;
  }

  const System& system_;
  std::span<const double> theta_;
  const Excitations& excitation_;
  const SimulateOptions options_;
  RowSink& sink_;
  ModalOde ode_;
  std::optional<Sensitivities> sensitivities_;
  Saltation saltation_;
  VectorXd x_;
  Observation now_;
  RunSummary summary_;
  Index row_ = 1;  ///< the next to be reached
  double t_, largest_ = 0;
  double sample_ = t_;            ///< the last sample reached
  long steps_ = 0, crowded_ = 0;  ///< up to there; of them those not yet looked at
  int stiff_ = 0;                 ///< looks in a row that found stability at work
  Fastest fastest_;               ///< at the last look
  double step_ = 0;
  std::unique_ptr<Integrator> integrator_;
};

SundialsRun::SundialsRun(const System& system, std::span<const double> theta, const Excitations& excitation,
                         const VectorXd& x0, const SimulateOptions& options, RowSink& sink, bool sensitivities)
    : impl_(std::make_unique<Impl>(system, theta, excitation, x0, options, sink, sensitivities)) {}
SundialsRun::~SundialsRun() = default;
bool SundialsRun::go(double budget) { return impl_->go(budget); }
double SundialsRun::spent() const { return impl_->spent(); }
RunSummary SundialsRun::summary() const { return impl_->summary(); }

}  // namespace lunid
