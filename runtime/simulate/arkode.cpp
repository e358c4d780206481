#include <arkode/arkode_arkstep.h>

#include <cstdlib>

#include "simulate/sundials_base.hpp"

namespace lunid {
namespace {

/// Steps within one sample after which the integrator gives up.
constexpr long max_steps_per_sample = 200000;

struct MemoryDeleter {
  void operator()(void* memory) const noexcept { ARKStepFree(&memory); }
};

/// The 5(4) pair of Dormand and Prince. Every sample is a stop: no step straddles a kink of the force, and the state
/// there is that of a step's end, not of an interpolant.
class Arkode : public SundialsBase {
 public:
  Arkode(Ode& ode, double t0, const Eigen::VectorXd& x0, double max_step) : SundialsBase(ode, x0) {
    memory_.reset(ARKStepCreate(rate, nullptr, t0, x_.get(), context_.get()));
    check(memory_.get(), "ARKStepCreate");
    void* m = memory_.get();
    check(ARKStepSetErrHandlerFn(m, silent, this), "ARKStepSetErrHandlerFn");
    check(ARKStepSetUserData(m, static_cast<SundialsBase*>(this)), "ARKStepSetUserData");
    check(ARKStepSetTableNum(m, ARKODE_DIRK_NONE, ARKODE_DORMAND_PRINCE_7_4_5), "ARKStepSetTableNum");
    check(ARKStepWFtolerances(m, weights), "ARKStepWFtolerances");
    check(ARKStepSetMaxNumSteps(m, max_steps_per_sample), "ARKStepSetMaxNumSteps");
    check(ARKStepSetMaxStep(m, max_step), "ARKStepSetMaxStep");
    if (ode.events() == 0) return;
    check(ARKStepRootInit(m, 2 * ode.events(), events), "ARKStepRootInit");
    std::vector<int> directions(ode.events(), -1);
    directions.resize(2 * ode.events(), 1);
    check(ARKStepSetRootDirection(m, directions.data()), "ARKStepSetRootDirection");
    check(ARKStepSetNoInactiveRootWarn(m), "ARKStepSetNoInactiveRootWarn");
  }

  Result advance(double to, double& t, Eigen::VectorXd& x) override {
    check(ARKStepSetStopTime(memory_.get(), to), "ARKStepSetStopTime");
    flag_ = ARKStepEvolve(memory_.get(), to, x_.get(), &t, ARK_NORMAL);
    rethrow();
    store(x);
    return flag_ == ARK_ROOT_RETURN ? Result::event : flag_ >= 0 ? Result::reached : Result::failed;
  }

  void restart(double t, const Eigen::VectorXd& x) override {
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
    return explicit_rates;
  }

 private:
  std::unique_ptr<void, MemoryDeleter> memory_;
  int flag_ = 0;
};

}  // namespace

std::unique_ptr<Integrator> make_arkode(Ode& ode, double t0, const Eigen::VectorXd& x0, double max_step) {
  return std::make_unique<Arkode>(ode, t0, x0, max_step);
}

}  // namespace lunid
