#include <cvodes/cvodes.h>

#include <cstdlib>

#include "simulate/sundials_base.hpp"

namespace lunid {
namespace {

struct MemoryDeleter {
  void operator()(void* memory) const noexcept { CVodeFree(&memory); }
};

/// Columns of sensitivities as CVODES holds them.
struct VectorArrayDeleter {
  int count = 0;
  void operator()(N_Vector* v) const noexcept { N_VDestroyVectorArray(v, count); }
};

/// After each step of the state the sensitivities take theirs, all at once (the staggered corrector; Feehery, Tolsma &
/// Barton 1997, Appl. Numer. Math. 25, 41), under the error control of the step.
class Cvode : public SundialsBase {
 public:
  Cvode(Solver method, Ode& ode, double t0, const Eigen::VectorXd& x0, double max_step, const double* s0)
      : SundialsBase(ode, x0) {
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
    if (s0) begin_sensitivities(s0);
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
    if (flag_ >= 0 && behind(t)) flag_ = CV_ERR_FAILURE;
    store(x);
    if (flag_ == CV_TOO_MUCH_WORK) return Result::paused;
    return flag_ == CV_ROOT_RETURN ? Result::event : flag_ >= 0 ? Result::reached : Result::failed;
  }

  void restart(double t, const Eigen::VectorXd& x, const double* s) override {
    steps_ = steps();
    evaluations_ = evaluations();
    load(x);
    check(CVodeReInit(memory_.get(), t, x_.get()), "CVodeReInit");
    if (!s) return;
    load_sensitivities(s);
    check(CVodeSensReInit(memory_.get(), CV_STAGGERED, s_.get()), "CVodeSensReInit");
  }

  void sensitivities(double* s) override {
    double t = 0;
    check(CVodeGetSens(memory_.get(), &t, s_.get()), "CVodeGetSens");
    const int columns = ode_.columns();
    for (int c = 0; c < columns; ++c) {
      const double* column = N_VGetArrayPointer(s_[c]);
      for (int i = 0; i < ode_.states(); ++i) s[i * columns + c] = column[i];
    }
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
    long sensitivities = 0;
    if (s_) check(CVodeGetSensNumRhsEvals(memory_.get(), &sensitivities), "CVodeGetSensNumRhsEvals");
    return evaluations_ + rates + jacobians + sensitivities;
  }

 private:
  /// CVode's test for the end underflows with steps near the smallest number: it then answers for a time that its steps
  /// have not reached.
  bool behind(double t) const {
    double reached = t;
    check(CVodeGetCurrentTime(memory_.get(), &reached), "CVodeGetCurrentTime");
    return reached < t;
  }

  void begin_sensitivities(const double* s0) {
    void* m = memory_.get();
    const int columns = ode_.columns();
    s_ = {N_VCloneVectorArray(columns, x_.get()), VectorArrayDeleter{columns}};
    check(s_.get(), "N_VCloneVectorArray");
    load_sensitivities(s0);
    check(CVodeSensInit(m, columns, CV_STAGGERED, sensitivity_rates, s_.get()), "CVodeSensInit");
    check(CVodeSensEEtolerances(m), "CVodeSensEEtolerances");  // by weights(), as those of the state
    check(CVodeSetSensErrCon(m, SUNTRUE), "CVodeSetSensErrCon");
  }

  void load_sensitivities(const double* s) {
    const int columns = ode_.columns();
    for (int c = 0; c < columns; ++c) {
      double* column = N_VGetArrayPointer(s_[c]);
      for (int i = 0; i < ode_.states(); ++i) column[i] = s[i * columns + c];
    }
  }

  std::unique_ptr<N_Vector[], VectorArrayDeleter> s_;
  // the integrator goes first, before the solver, matrix, vector and context of the base that it uses
  std::unique_ptr<void, MemoryDeleter> memory_;
  int flag_ = 0;
  long steps_ = 0, evaluations_ = 0;  ///< before the last restart
};

}  // namespace

std::unique_ptr<Integrator> make_cvode(Solver method, Ode& ode, double t0, const Eigen::VectorXd& x0, double max_step,
                                       const double* s0) {
  return std::make_unique<Cvode>(method, ode, t0, x0, max_step, s0);
}

}  // namespace lunid
