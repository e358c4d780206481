#include <cvode/cvode.h>

#include <cstdlib>

#include "simulate/sundials_base.hpp"

namespace lunid {
namespace {

struct MemoryDeleter {
  void operator()(void* memory) const noexcept { CVodeFree(&memory); }
};

class Cvode : public SundialsBase {
 public:
  Cvode(Solver method, Ode& ode, double t0, const Eigen::VectorXd& x0, double max_step) : SundialsBase(ode, x0) {
    memory_.reset(CVodeCreate(method == Solver::adams ? CV_ADAMS : CV_BDF, context_.get()));
    check(memory_.get(), "CVodeCreate");
    void* m = memory_.get();
    check(CVodeSetErrHandlerFn(m, silent, this), "CVodeSetErrHandlerFn");
    check(CVodeInit(m, rate, t0, x_.get()), "CVodeInit");
    check(CVodeSetUserData(m, static_cast<SundialsBase*>(this)), "CVodeSetUserData");
    check(CVodeWFtolerances(m, weights), "CVodeWFtolerances");
    check(CVodeSetMaxNumSteps(m, steps_per_pause), "CVodeSetMaxNumSteps");
    check(CVodeSetMaxStep(m, max_step), "CVodeSetMaxStep");
    make_newton();
    check(CVodeSetLinearSolver(m, newton_->solver(), newton_->matrix()), "CVodeSetLinearSolver");
    check(CVodeSetJacFn(m, jacobian), "CVodeSetJacFn");
    if (ode.events() == 0) return;
    check(CVodeRootInit(m, 2 * ode.events(), events), "CVodeRootInit");
    std::vector<int> directions(ode.events(), -1);
    directions.resize(2 * ode.events(), 1);
    check(CVodeSetRootDirection(m, directions.data()), "CVodeSetRootDirection");
    check(CVodeSetNoInactiveRootWarn(m), "CVodeSetNoInactiveRootWarn");
  }

  Result advance(double to, double& t, Eigen::VectorXd& x) override {
    flag_ = CVode(memory_.get(), to, x_.get(), &t, CV_NORMAL);
    rethrow();
    store(x);
    if (flag_ == CV_TOO_MUCH_WORK) return Result::paused;
    return flag_ == CV_ROOT_RETURN ? Result::event : flag_ >= 0 ? Result::reached : Result::failed;
  }

  void restart(double t, const Eigen::VectorXd& x) override {
    steps_ = steps();
    evaluations_ = evaluations();
    load(x);
    check(CVodeReInit(memory_.get(), t, x_.get()), "CVodeReInit");
  }

  std::vector<int> fired() const override {
    std::vector<int> direction(2 * ode_.events()), found;
    check(CVodeGetRootInfo(memory_.get(), direction.data()), "CVodeGetRootInfo");
    for (int i = 0; i < ode_.events(); ++i)
      if (direction[i] != 0) found.push_back(i);
    return found;
  }

  std::string failure() const override {
    char* name = CVodeGetReturnFlagName(flag_);
    const std::string text = std::string("CVode: ") + (name ? name : "?");
    std::free(name);
    return text;
  }

  long steps() const override {
    long count = 0;
    check(CVodeGetNumSteps(memory_.get(), &count), "CVodeGetNumSteps");
    return steps_ + count;
  }

  long evaluations() const override {
    long rates = 0, jacobians = 0;
    check(CVodeGetNumRhsEvals(memory_.get(), &rates), "CVodeGetNumRhsEvals");
    check(CVodeGetNumJacEvals(memory_.get(), &jacobians), "CVodeGetNumJacEvals");
    return evaluations_ + rates + jacobians;
  }

 private:
  // the integrator goes first, before the solver, matrix, vector and context of the base that it uses
  std::unique_ptr<void, MemoryDeleter> memory_;
  int flag_ = 0;
  long steps_ = 0, evaluations_ = 0;  ///< before the last restart
};

}  // namespace

std::unique_ptr<Integrator> make_cvode(Solver method, Ode& ode, double t0, const Eigen::VectorXd& x0, double max_step) {
  return std::make_unique<Cvode>(method, ode, t0, x0, max_step);
}

}  // namespace lunid
