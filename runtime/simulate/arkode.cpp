#include <arkode/arkode_arkstep.h>

#include <algorithm>
#include <cstdlib>

#include "simulate/sundials_base.hpp"

namespace lunid {
namespace {

/// An explicit stage without a value ends ARKODE's run at once: the part is tried again from its start, with a first
/// step this much shorter each time.
constexpr double shorter = 0.1;
constexpr int shorter_steps = 10;

struct MemoryDeleter {
  void operator()(void* memory) const noexcept { ARKStepFree(&memory); }
};

/// A Butcher table of SUNDIALS and what it is called.
struct Method {
  Solver solver;
  ARKODE_ERKTableID explicit_table;
  ARKODE_DIRKTableID implicit_table;
  const char* name;
};
constexpr Method methods[] = {
    {Solver::rk23, ARKODE_BOGACKI_SHAMPINE_4_2_3, ARKODE_DIRK_NONE, "ARKODE ERK Bogacki-Shampine 3(2)"},
    {Solver::rk45, ARKODE_DORMAND_PRINCE_7_4_5, ARKODE_DIRK_NONE, "ARKODE ERK Dormand-Prince 5(4)"},
    {Solver::rk78, ARKODE_FEHLBERG_13_7_8, ARKODE_DIRK_NONE, "ARKODE ERK Fehlberg 8(7)"},
    {Solver::esdirk, ARKODE_ERK_NONE, ARKODE_ESDIRK547L2SA_7_4_5, "ARKODE ESDIRK5(4)7L[2]SA"},
};

const Method* method_of(Solver solver) {
  const auto found =
      std::find_if(std::begin(methods), std::end(methods), [&](const Method& m) { return m.solver == solver; });
  return found == std::end(methods) ? nullptr : found;
}

/// Every sample is a stop: no step straddles a kink of the force, and the state there is that of a step's end, not of
/// an interpolant.
class Arkode : public SundialsBase {
 public:
  Arkode(Solver solver, Ode& ode, double t0, const Eigen::VectorXd& x0, double max_step)
      : SundialsBase(ode, x0), max_step_(max_step) {
    const Method& method = *method_of(solver);
    implicit_ = method.implicit_table != ARKODE_DIRK_NONE;
    memory_.reset(ARKStepCreate(implicit_ ? nullptr : rate, implicit_ ? rate : nullptr, t0, x_.get(), context_.get()));
    check(memory_.get(), "ARKStepCreate");
    void* m = memory_.get();
    check(ARKStepSetErrHandlerFn(m, silent, this), "ARKStepSetErrHandlerFn");
    check(ARKStepSetUserData(m, static_cast<SundialsBase*>(this)), "ARKStepSetUserData");
    check(ARKStepSetTableNum(m, method.implicit_table, method.explicit_table), "ARKStepSetTableNum");
    if (implicit_) {
      make_newton();
      check(ARKStepSetLinearSolver(m, newton_->solver(), newton_->matrix()), "ARKStepSetLinearSolver");
      check(ARKStepSetJacFn(m, jacobian), "ARKStepSetJacFn");
      // Neither a matrix nor a rate of convergence outlives its step: after a restart those of another step or mode let
      // iterates pass that have not converged (measured: an error of 1e-4 of y at rtol 1e-10 on a held force).
      check(ARKStepSetLSetupFrequency(m, 1), "ARKStepSetLSetupFrequency");
      check(ARKStepSetJacEvalFrequency(m, 1), "ARKStepSetJacEvalFrequency");
      // The rate of a stage follows from the stage equation: evaluated at an iterate it carries the iterate's error
      // times the stiffness, which spoils fast states and the error estimate (measured: 3 to 8 times as many steps).
      check(ARKStepSetDeduceImplicitRhs(m, 1), "ARKStepSetDeduceImplicitRhs");
    }
    check(ARKStepWFtolerances(m, weights), "ARKStepWFtolerances");
    check(ARKStepSetMaxNumSteps(m, steps_per_pause), "ARKStepSetMaxNumSteps");
    check(ARKStepSetMaxStep(m, max_step), "ARKStepSetMaxStep");
    if (ode.events() == 0) return;
    check(ARKStepRootInit(m, 2 * ode.events(), events), "ARKStepRootInit");
    std::vector<int> directions(ode.events(), -1);
    directions.resize(2 * ode.events(), 1);
    check(ARKStepSetRootDirection(m, directions.data()), "ARKStepSetRootDirection");
    check(ARKStepSetNoInactiveRootWarn(m), "ARKStepSetNoInactiveRootWarn");
  }

  Result advance(double to, double& t, Eigen::VectorXd& x) override {
    const double from = t;
    double step = max_step_;
    evolve(to, t);
    for (int retry = 0; retry < shorter_steps && flag_ == ARK_UNREC_RHSFUNC_ERR; ++retry) {
      restart(from, x, nullptr);
      step *= shorter;
      check(ARKStepSetInitStep(memory_.get(), step), "ARKStepSetInitStep");
      evolve(to, t);
      check(ARKStepSetInitStep(memory_.get(), 0), "ARKStepSetInitStep");
    }
    store(x);
    if (flag_ == ARK_TOO_MUCH_WORK) return Result::paused;
    return flag_ == ARK_ROOT_RETURN ? Result::event : flag_ >= 0 ? Result::reached : Result::failed;
  }

  void sensitivities(double*) override {}

  void restart(double t, const Eigen::VectorXd& x, const double*) override {
    load(x);
    check(ARKStepReset(memory_.get(), t, x_.get()), "ARKStepReset");
  }

  std::vector<int> fired() const override {
    std::vector<int> direction(2 * ode_.events()), found;
    check(ARKStepGetRootInfo(memory_.get(), direction.data()), "ARKStepGetRootInfo");
    for (int i = 0; i < ode_.events(); ++i)
      if (direction[i] != 0) found.push_back(i);
    return found;
  }

  std::string failure() const override {
    char* name = ARKStepGetReturnFlagName(flag_);
    const std::string text = std::string("ARKStepEvolve: ") + (name ? name : "?");
    std::free(name);
    return text;
  }

  long steps() const override {
    long count = 0;
    check(ARKStepGetNumSteps(memory_.get(), &count), "ARKStepGetNumSteps");
    return count;
  }

  long evaluations() const override {
    long explicit_rates = 0, implicit_rates = 0;
    check(ARKStepGetNumRhsEvals(memory_.get(), &explicit_rates, &implicit_rates), "ARKStepGetNumRhsEvals");
    long jacobians = 0;
    if (implicit_) check(ARKStepGetNumJacEvals(memory_.get(), &jacobians), "ARKStepGetNumJacEvals");
    return explicit_rates + implicit_rates + jacobians;
  }

 private:
  void evolve(double to, double& t) {
    check(ARKStepSetStopTime(memory_.get(), to), "ARKStepSetStopTime");
    flag_ = ARKStepEvolve(memory_.get(), to, x_.get(), &t, ARK_NORMAL);
    rethrow();
  }

  std::unique_ptr<void, MemoryDeleter> memory_;
  double max_step_;
  bool implicit_ = false;
  int flag_ = 0;
};

}  // namespace

bool is_runge_kutta(Solver method) { return method_of(method) != nullptr; }

std::string sundials_name(Solver method) {
  if (const Method* found = method_of(method)) return found->name;
  return method == Solver::adams ? "CVODE Adams" : "CVODE BDF";
}

std::unique_ptr<Integrator> make_arkode(Solver method, Ode& ode, double t0, const Eigen::VectorXd& x0,
                                        double max_step) {
  return std::make_unique<Arkode>(method, ode, t0, x0, max_step);
}

}  // namespace lunid
