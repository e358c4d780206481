// Runs that cannot be, and runs that stop: messages in full.
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::force_of;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_solver;
using testing::with_substeps;
using testing::zero_force;

TEST(SimulateFaults, NameTheArgument) {
  const System system(model_of("m", "k*y"));
  const Excitation force = zero_force(1, 0.01);
  const auto fault = [&](std::vector<double> theta, Eigen::VectorXd x0, SimulateOptions options = {}) {
    return fault_of([&] { simulate(system, theta, force, x0, options); });
  };
  EXPECT_EQ(fault({1, 2}, state({0, 0})), "");
  EXPECT_EQ(fault({1}, state({0, 0})), "simulate: theta: expected 2 values (m, k), got 1");
  EXPECT_EQ(fault({1, std::nan("")}, state({0, 0})), "simulate: parameter 'k': expected a finite value, got nan");
  EXPECT_EQ(fault({1, 2}, state({0, 0, 0})), "simulate: x0: expected 2 values (y, v), got 3");
  EXPECT_EQ(fault({1, 2}, state({0, std::nan("")})), "simulate: x0: v: expected a finite value, got nan");
  SimulateOptions options;
  options.rtol = 0;
  EXPECT_EQ(fault({1, 2}, state({0, 0}), options), "simulate: rtol: expected > 0 and < 1, got 0");
  options = {};
  options.atol = -1;
  EXPECT_EQ(fault({1, 2}, state({0, 0}), options), "simulate: atol: expected >= 0, got -1");
  options = {};
  options.substeps = -2;
  EXPECT_EQ(fault({1, 2}, state({0, 0}), options), "simulate: substeps: expected >= 0, got -2");
  options = {};
  options.bound = -2;
  EXPECT_EQ(fault({1, 2}, state({0, 0}), options), "simulate: bound: expected >= 0, got -2");
  options = {};
  options.max_events = 0;
  EXPECT_EQ(fault({1, 2}, state({0, 0}), options), "simulate: max_events: expected >= 1, got 0");

  const std::vector<double> theta{1, 2};
  EXPECT_EQ(fault_of([&] {
              simulate(system, theta, Excitation(), state({0, 0}));
            }),
            "simulate: the excitation is empty");
  EXPECT_EQ(fault_of([&] {
              simulate_sensitivities(system, theta, force, state({0, 0}), with_solver(Solver::rk45));
            }),
            "simulate_sensitivities: solver: 'fixed', 'bdf' and 'adams' carry sensitivities, 'rk45' does not");
  EXPECT_EQ(fault_of([&] {
              choose_substeps(system, theta, force, state({0, 0}), 0);
            }),
            "choose_substeps: tolerance: expected > 0, got 0");
  EXPECT_EQ(fault_of([&] { solver_from("bfd"); }),
            "solver: expected auto, fixed, bdf, adams, rk23, rk45, rk78 or esdirk, got 'bfd', did you mean 'bdf'?");
  EXPECT_EQ(solver_from("rk45"), Solver::rk45);
  const System imposed(model_of("m", "k*y", {}, true));
  EXPECT_EQ(fault_of([&] {
              simulate(imposed, theta, force, state({0, 0}));
            }),
            "simulate: the motion of this model is imposed: there is no free run, only its force");
}

// Softening by y^2: the well of k y + k2 y^2 ends at y = -k / k2 = -0.08.
TEST(Explosion, OfASofteningSpringNamesWhereAndWhichTerm) {
  const System system(model_of("1", "k*y + k2*y^2"));
  const auto theta = theta_of(system, {{"k", 100}, {"k2", 1250}});
  const Excitation push = force_of(4, 0.01, [](double t) { return -1.2 * std::sin(9 * t); });
  double stopped = 0;
  for (const Solver solver : {Solver::automatic, Solver::fixed, Solver::bdf, Solver::adams, Solver::rk45}) {
    const lunid::Run run = simulate(system, theta, push, state({0, 0}), with_solver(solver));
    ASSERT_FALSE(run.summary.completed) << run.summary.solver;
    EXPECT_EQ(run.summary.cause, "the restoring force grows without bound beyond |y| = 0.08 m (term k2*y^2)")
        << run.summary.solver;
    if (stopped > 0) {
      EXPECT_NEAR(run.summary.stopped_at, stopped, 0.02) << run.summary.solver;
    }
    stopped = run.summary.stopped_at;
    const auto last = static_cast<Eigen::Index>(std::floor(stopped / 0.01 + 1e-9));
    EXPECT_TRUE(std::isfinite(run.x(last - 1, 0))) << run.summary.solver;
    EXPECT_TRUE(run.x.bottomRows(run.x.rows() - last - 2).array().isNaN().all()) << run.summary.solver;
    EXPECT_TRUE(run.a.col(0).tail(run.x.rows() - last - 2).array().isNaN().all()) << run.summary.solver;
  }
}

TEST(Explosion, OfANegativeSpringHasNoWayBackAtAnyDisplacement) {
  const System system(model_of("1", "k*y + c*v"));
  const auto theta = theta_of(system, {{"k", -100}, {"c", 1}});
  const Excitation push = force_of(20, 0.01, [](double t) { return std::sin(9 * t); });
  const lunid::Run run = simulate(system, theta, push, state({0, 0}), with_solver(Solver::fixed));
  ASSERT_FALSE(run.summary.completed);
  EXPECT_EQ(run.summary.cause, "the restoring force drives y away from rest at any displacement (term k*y)");
}

TEST(Explosion, OfNegativeDampingIsSaidToGrow) {
  const System system(model_of("1", "k*y + c*v"));
  const auto theta = theta_of(system, {{"k", 100}, {"c", -20}});
  const lunid::Run run = simulate(system, theta, zero_force(20, 0.01), state({1e-3, 0}), with_substeps(2));
  ASSERT_FALSE(run.summary.completed);
  EXPECT_EQ(run.summary.cause.substr(0, 36), "the motion grows without bound: y = ");
  EXPECT_NE(run.summary.cause.find("(largest driving term c*v)"), std::string::npos) << run.summary.cause;
}

TEST(Explosion, OfATermWithoutAValueNamesTheTerm) {
  const System system(model_of("1", "k*sqrt(y)"));
  const std::vector<double> theta{2};
  const lunid::Run run = simulate(system, theta, zero_force(3, 0.01), state({0.1, -1}), with_substeps(2));
  ASSERT_FALSE(run.summary.completed);
  EXPECT_EQ(run.summary.cause.substr(0, 44), "the term k*sqrt(y) has no finite value at y ") << run.summary.cause;
  EXPECT_NEAR(run.summary.stopped_at, 0.1, 0.03);  // y = 0 after about 0.1 / 1 s
}

TEST(Explosion, OfAMassThatVanishesIsSaid) {
  const System system(model_of("m", "k*y"));
  const lunid::Run run = simulate(system, std::vector<double>{-1, 2}, zero_force(1, 0.01), state({0, 0}));
  EXPECT_FALSE(run.summary.completed);
  EXPECT_EQ(run.summary.cause, "the mass is -1 kg at y = 0 m, v = 0 m/s; it must stay above 0");
  EXPECT_TRUE(run.x.array().isNaN().all());
}

TEST(Explosion, BeyondAGivenBoundStopsTheRun) {
  const System system(model_of("1", "0"));
  SimulateOptions options = with_substeps(1);
  options.bound = 0.5;
  const lunid::Run run = simulate(system, {}, zero_force(2, 0.01), state({0, 1}), options);
  EXPECT_FALSE(run.summary.completed);
  EXPECT_NEAR(run.summary.stopped_at, 0.5, 0.02);
}

TEST(Stops, WhenSwitchesAreTooMany) {
  const System system(model_of("1", "100*y + 0.1*abs(y)*v"));
  SimulateOptions options = with_substeps(4);
  options.max_events = 10;
  const lunid::Run run = simulate(system, {}, zero_force(20, 0.01), state({0.1, 0}), options);
  EXPECT_FALSE(run.summary.completed);
  EXPECT_EQ(run.summary.cause, "more than 10 switches: the motion chatters at y = 0");
  EXPECT_NEAR(run.summary.stopped_at, 10.5 * std::numbers::pi / 10, 0.05);  // the 11th zero of cos(10 t)
}

TEST(Stops, WhenCancelled) {
  const System system(model_of("1", "100*y + sign(v)"));
  const std::atomic<bool> cancelled{true};
  for (const Solver solver : {Solver::fixed, Solver::bdf, Solver::adams, Solver::rk45}) {
    SimulateOptions options = with_solver(solver);
    options.cancelled = &cancelled;
    try {
      simulate(system, {}, zero_force(300, 0.01), state({0.1, 0}), options);
      ADD_FAILURE() << "not interrupted: " << to_string(solver);
    } catch (const InputError& error) {
      EXPECT_EQ(error.message(), "simulate: interrupted");
      EXPECT_EQ(error.fault(), Fault::interrupted);
    }
  }
}

// What a user's force throws comes out as it is, through SUNDIALS' frames.
TEST(Stops, WhenTheForceThrows) {
  const System system(model_of("1", "100*y"));
  int calls = 0;
  const Excitation force(0, 0.01, 101, [&calls](double t) -> double {
    if (++calls > 250) throw InputError("force: no value at this time");
    return std::sin(t);
  });
  for (const Solver solver : {Solver::bdf, Solver::rk45}) {
    calls = 0;
    EXPECT_EQ(fault_of([&] {
                simulate(system, {}, force, state({0.1, 0}), with_solver(solver));
              }),
              "force: no value at this time");
  }
}

}  // namespace
}  // namespace lunid
