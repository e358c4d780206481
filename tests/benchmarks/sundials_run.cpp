// Each method of SUNDIALS on a sampled force, beside the same calls with a right-hand side written by hand: Duffing's
// oscillator, 1601 rows at 800 Hz, rtol 1e-8. What is left over is the tape, the scales of the error and the modes.
#include <arkode/arkode_arkstep.h>
#include <benchmark/benchmark.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "benchmarks/oscillators.hpp"
#include "benchmarks/work.hpp"
#include "simulate/simulate.hpp"

namespace bench {
namespace {

constexpr int rows = 1601;
constexpr double dt = 1 / 800.0, rtol = 1e-8;

struct Forced {
  const std::vector<double>* force;
  Duffing a;
  double scale[2] = {1e-6, 1e-6};

  double at(double t) const {
    const double place = std::min(std::max(t / dt, 0.0), rows - 1.0);
    const int row = std::min(static_cast<int>(place), rows - 2);
    return (*force)[row] + (place - row) * ((*force)[row + 1] - (*force)[row]);
  }
};

int rate(double t, N_Vector x, N_Vector f, void* user) {
  const auto& forced = *static_cast<const Forced*>(user);
  const double* s = N_VGetArrayPointer(x);
  double* out = N_VGetArrayPointer(f);
  out[0] = s[1];
  out[1] = forced.a(s[0], s[1], forced.at(t));
  return 0;
}

int jacobian(double, N_Vector x, N_Vector, SUNMatrix j, void* user, N_Vector, N_Vector, N_Vector) {
  const auto& d = static_cast<const Forced*>(user)->a;
  const double y = N_VGetArrayPointer(x)[0];
  SM_ELEMENT_D(j, 0, 0) = 0;
  SM_ELEMENT_D(j, 0, 1) = 1;
  SM_ELEMENT_D(j, 1, 0) = -d.k - 3 * d.k3 * y * y;
  SM_ELEMENT_D(j, 1, 1) = -d.c;
  return 0;
}

/// Errors relative to the largest value so far, as ours.
int weights(N_Vector x, N_Vector w, void* user) {
  auto& forced = *static_cast<Forced*>(user);
  for (int i = 0; i < 2; ++i) {
    const double size = std::abs(N_VGetArrayPointer(x)[i]);
    forced.scale[i] = std::max(forced.scale[i], size);
    N_VGetArrayPointer(w)[i] = 1 / (rtol * (size + forced.scale[i]));
  }
  return 0;
}

void by_hand(lunid::Solver solver, const std::vector<double>& force, std::vector<double>& y) {
  Forced forced{&force, {}};
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  N_Vector x = N_VNew_Serial(2, context);
  N_VConst(0, x);
  SUNMatrix matrix = SUNDenseMatrix(2, 2, context);
  SUNLinearSolver linear = SUNLinSol_Dense(x, matrix, context);
  const bool multistep = solver == lunid::Solver::bdf || solver == lunid::Solver::adams;
  const bool implicit = solver == lunid::Solver::esdirk;
  void* memory = multistep ? CVodeCreate(solver == lunid::Solver::bdf ? CV_BDF : CV_ADAMS, context)
                           : ARKStepCreate(implicit ? nullptr : rate, implicit ? rate : nullptr, 0, x, context);
  if (multistep) {
    CVodeInit(memory, rate, 0, x);
    CVodeSetUserData(memory, &forced);
    CVodeWFtolerances(memory, weights);
    CVodeSetMaxNumSteps(memory, 200000);
    CVodeSetMaxStep(memory, dt);
    CVodeSetLinearSolver(memory, linear, matrix);
    CVodeSetJacFn(memory, jacobian);
  } else {
    ARKStepSetUserData(memory, &forced);
    ARKStepSetTableNum(memory, implicit ? ARKODE_ESDIRK547L2SA_7_4_5 : ARKODE_DIRK_NONE,
                       implicit                        ? ARKODE_ERK_NONE
                       : solver == lunid::Solver::rk23 ? ARKODE_BOGACKI_SHAMPINE_4_2_3
                       : solver == lunid::Solver::rk45 ? ARKODE_DORMAND_PRINCE_7_4_5
                                                       : ARKODE_FEHLBERG_13_7_8);
    ARKStepWFtolerances(memory, weights);
    ARKStepSetMaxNumSteps(memory, 200000);
    ARKStepSetMaxStep(memory, dt);
    if (implicit) {
      ARKStepSetLinearSolver(memory, linear, matrix);
      ARKStepSetJacFn(memory, jacobian);
      ARKStepSetLSetupFrequency(memory, 1);
      ARKStepSetDeduceImplicitRhs(memory, 1);
    }
  }
  y[0] = 0;
  for (int i = 1; i < rows; ++i) {
    double t = 0;
    if (!multistep) ARKStepSetStopTime(memory, i * dt);
    const int flag =
        multistep ? CVode(memory, i * dt, x, &t, CV_NORMAL) : ARKStepEvolve(memory, i * dt, x, &t, ARK_NORMAL);
    if (flag < 0) std::exit(1);
    y[i] = N_VGetArrayPointer(x)[0];
  }
  multistep ? CVodeFree(&memory) : ARKStepFree(&memory);
  SUNLinSolFree(linear);
  SUNMatDestroy(matrix);
  N_VDestroy(x);
  SUNContext_Free(&context);
}

}  // namespace

std::vector<Work> sundials_works() {
  auto pool = std::make_shared<lunid::Pool>();
  lunid::Model model;
  model.pool = pool;
  model.mass = pool->constant(1);
  model.restoring = lunid::parse(*pool, "k*y + c*v + k3*y^3");
  auto system = std::make_shared<lunid::System>(model);
  auto force = std::make_shared<std::vector<double>>(sampled_force(rows, 100));
  auto y = std::make_shared<std::vector<double>>(rows);
  const lunid::Excitation excitation(0, dt, *force);
  const std::vector<double> theta{2e4, 10, 1e6};
  std::vector<Work> works;
  for (const lunid::Solver solver : lunid::all_solvers()) {
    if (solver == lunid::Solver::automatic || solver == lunid::Solver::fixed) continue;
    lunid::SimulateOptions options;
    options.solver = solver;
    options.rtol = rtol;
    const std::string name = "sundials-" + lunid::to_string(solver);
    const auto ours = [=] { return lunid::simulate(*system, theta, excitation, Eigen::VectorXd::Zero(2), options); };
    by_hand(solver, *force, *y);
    const lunid::Run run = ours();
    for (int i = 0; i < rows; ++i)
      if (!(std::abs(run.x(i, 0) - (*y)[i]) < 1e-4 * 0.01)) {
        std::fprintf(stderr, "%s: ours and the hand-written run differ in row %d: %g and %g\n", name.c_str(), i,
                     run.x(i, 0), (*y)[i]);
        std::exit(1);
      }
    works.push_back({name, 1.3, [=] { benchmark::DoNotOptimize(ours().x.data()); },
                     [=] {
                       by_hand(solver, *force, *y);
                       benchmark::DoNotOptimize(y->data());
                     }});
  }
  return works;
}

}  // namespace bench
