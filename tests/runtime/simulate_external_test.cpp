// External functions in models: the same motion as the formula that they compute, and errors that pass no library.
#include <atomic>
#include <set>
#include <thread>

#include "expr_external.hpp"
#include "simulate/ensemble.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using namespace lunid::testing;

/// 1e4*y + c*v*(1 + y^2), all of it or its damping by a call.
double damping(const double* x) { return x[2] * x[1] * (1 + x[0] * x[0]); }
void damping_gradient(const double* x, double* d) {
  d[0] = x[2] * x[1] * 2 * x[0];
  d[1] = x[2] * (1 + x[0] * x[0]);
  d[2] = x[1] * (1 + x[0] * x[0]);
}

Model with_call(const std::shared_ptr<const ExternalFunction>& f) {
  Model model = model_of("1", "1e4*y");
  Pool& pool = *model.pool;
  const Expr arguments[] = {pool.channel("y"), pool.channel("v"), pool.parameter("c")};
  model.restoring = model.restoring + pool.call(f, arguments);
  return model;
}

Excitation tone() {
  return force_of(0.5, 1e-3, [](double t) { return 100 * std::sin(90 * t); });
}

TEST(SimulateExternal, every_solver_gives_the_motion_of_the_formula) {
  const System formula(model_of("1", "1e4*y + c*v*(1 + y^2)"));
  for (const bool with_gradient : {true, false}) {
    const System called(with_call(std::make_shared<Given>(
        "damping", 3, damping, with_gradient ? Given::Gradient(damping_gradient) : Given::Gradient{})));
    for (const Solver solver : all_solvers()) {
      const auto a = simulate(formula, theta_of(formula, {{"c", 20}}), tone(), state({0, 0.5}), with_solver(solver));
      const auto b = simulate(called, theta_of(called, {{"c", 20}}), tone(), state({0, 0.5}), with_solver(solver));
      ASSERT_TRUE(b.summary.completed) << to_string(solver);
      // An inexact Jacobian changes the path of Newton's method, not what it converges to.
      EXPECT_LT((a.x - b.x).cwiseAbs().maxCoeff(), 1e-6 * a.x.cwiseAbs().maxCoeff()) << to_string(solver);
    }
  }
}

TEST(SimulateExternal, sensitivities_are_those_of_the_formula) {
  const System formula(model_of("1", "1e4*y + c*v*(1 + y^2)"));
  const System exact(with_call(std::make_shared<Given>("damping", 3, damping, damping_gradient)));
  const System differences(with_call(std::make_shared<Given>("damping", 3, damping)));
  const auto run = [&](const System& system) {
    return simulate_sensitivities(system, theta_of(system, {{"c", 20}}), tone(), state({0, 0.5}), with_substeps(2));
  };
  const SensitivityRun a = run(formula), b = run(exact), c = run(differences);
  EXPECT_LT((a.dy() - b.dy()).cwiseAbs().maxCoeff(), 1e-12 * a.dy().cwiseAbs().maxCoeff());
  EXPECT_LT((a.dy() - c.dy()).cwiseAbs().maxCoeff(), 1e-7 * a.dy().cwiseAbs().maxCoeff());
  ASSERT_EQ(c.run.summary.notes.size(), 1u);
  EXPECT_NE(c.run.summary.notes[0].find("derivatives by central differences"), std::string::npos);
  EXPECT_TRUE(b.run.summary.notes.empty());
}

TEST(SimulateExternal, an_error_comes_out_whole_of_every_solver) {
  for (const Solver solver : all_solvers()) {
    const System system(with_call(std::make_shared<Given>("damping", 3, [](const double* x) -> double {
      if (x[0] > 1e-3) throw InputError("the damper tears at 1 mm");
      return damping(x);
    })));
    EXPECT_EQ(fault_of([&] {
                simulate(system, theta_of(system, {{"c", 20}}), tone(), state({0, 0.5}), with_solver(solver));
              }),
              "the damper tears at 1 mm")
        << to_string(solver);
  }
}

TEST(SimulateExternal, members_stay_on_one_thread_where_the_function_must) {
  for (const bool safe : {true, false}) {
    std::mutex guard;
    std::set<std::thread::id> threads;
    const System system(with_call(std::make_shared<Given>(
        "damping", 3,
        [&](const double* x) {
          const std::lock_guard lock(guard);
          threads.insert(std::this_thread::get_id());
          return damping(x);
        },
        damping_gradient, safe)));
    Ensemble e;
    e.system = &system;
    e.theta = Eigen::MatrixXd::Constant(1, 64, 20);
    e.x0 = Eigen::MatrixXd::Zero(2, 64);
    e.force = MemberForce::of(tone());
    EnsembleOptions options;
    options.outputs.push_back(output_from("rms_y", system));
    options.substeps = 1;
    options.threads = 2;
    const EnsembleResult result = run_ensemble(e, options);
    const auto alone = simulate(system, theta_of(system, {{"c", 20}}), tone(), state({0, 0}), with_substeps(1));
    EXPECT_NEAR(result.values(63, 0), std::sqrt(alone.x.col(0).squaredNorm() / alone.x.rows()), 1e-15);
    if (safe) continue;
    EXPECT_EQ(threads, std::set{std::this_thread::get_id()});
  }
}

TEST(SimulateExternal, an_error_ends_an_ensemble) {
  const System system(with_call(std::make_shared<Given>("damping", 3, [](const double* x) -> double {
    if (x[2] > 30) throw InputError("no such damper");
    return damping(x);
  })));
  Ensemble e;
  e.system = &system;
  e.theta = Eigen::RowVectorXd::LinSpaced(16, 10, 40);
  e.x0 = Eigen::MatrixXd::Zero(2, 16);
  e.force = MemberForce::of(tone());
  EnsembleOptions options;
  options.outputs.push_back(output_from("rms_y", system));
  options.substeps = 1;
  EXPECT_EQ(fault_of([&] { run_ensemble(e, options); }), "no such damper");
}

TEST(SimulateExternal, there_is_no_c_for_it) {
  EXPECT_EQ(fault_of([] { c_code(System(with_call(std::make_shared<Given>("damping", 3, damping)))); }),
            "export: the rates call the function 'damping', which has no text in C");
}

}  // namespace
}  // namespace lunid
