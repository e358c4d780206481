// What cannot be simulated is refused or stopped with a message that says what to do.
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::model_of;
using testing::model_of_many;
using testing::state;
using testing::StateText;
using testing::theta_of;
using testing::with_solver;
using testing::zero_force;

TEST(Start, WithoutAFiniteValueIsSaidByEverySolver) {
  struct Case {
    const char* restoring;
    std::vector<StateText> states;
    const char* cause;
  };
  const Case table[] = {
      {"90*y + k/y", {}, "the term k/y has no finite value at the start, t = 0 s, y = 0 m, v = 0 m/s"},
      {"90*y + log(k*y - 1)",
       {},
       "the term log(k*y - 1) has no finite value at the start, t = 0 s, y = 0 m, v = 0 m/s"},
      {"90*y + z",
       {{"z", "k*sqrt(y - 1)", "", ""}},
       "the rate of the state z has no finite value at the start, t = 0 s, y = 0 m, v = 0 m/s"},
      {"90*y - k*a", {}, "the mass is 0 kg at y = 0 m, v = 0 m/s; it must stay above 0"},  // a is on both sides
  };
  for (const auto& [restoring, states, cause] : table) {
    const System system(model_of("1", restoring, states));
    for (const Solver solver : all_solvers()) {
      const lunid::Run run = simulate(system, std::vector<double>{1}, zero_force(1, 0.01),
                                      Eigen::VectorXd::Zero(system.states()), with_solver(solver));
      EXPECT_FALSE(run.summary.completed);
      EXPECT_EQ(run.summary.cause, cause) << to_string(solver);
      EXPECT_EQ(run.summary.stopped_at, 0);
      EXPECT_TRUE(run.x.array().isNaN().all());
    }
  }
}

TEST(Start, NamesTheCoordinate) {
  const System system(model_of_many({{"1", "90*(y1 - y2)"}, {"1", "90*(y2 - y1) + 2/v2"}}));
  const lunid::Run run = simulate(system, {}, zero_force(1, 0.01), state({0.1, 0, 0.2, 0}));
  EXPECT_EQ(run.summary.cause, "the term 2/v2 has no finite value at the start, t = 0 s, y2 = 0.2 m, v2 = 0 m/s");
}

// Infinite slopes at the start are no fault: the value is finite.
TEST(Start, OnARootIsFine) {
  const System system(model_of("1", "90*y + sign(v)*sqrt(abs(v))"));
  for (const Solver solver : all_solvers()) {
    const lunid::Run run = simulate(system, {}, zero_force(1, 0.01), state({0.1, 0}), with_solver(solver, 1e-6));
    EXPECT_TRUE(run.summary.completed) << to_string(solver) << ": " << run.summary.cause;
  }
}

TEST(Tolerance, BelowRoundingIsRefusedWithTheLeast) {
  const System system(model_of("1", "90*y"));
  for (const double rtol : {1e-14, 1e-300})
    EXPECT_EQ(fault_of([&] {
                simulate(system, {}, zero_force(1, 0.01), state({0.1, 0}), with_solver(Solver::bdf, rtol));
              }),
              "simulate: rtol: " + std::string(rtol > 1e-20 ? "1e-14" : "1e-300") +
                  " is below what rounding leaves; the least is 2.22045e-14");
  for (const Solver solver : all_solvers()) {
    const lunid::Run run = simulate(system, {}, zero_force(1, 0.01), state({0.1, 0}), with_solver(solver, 3e-14));
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    if (solver == Solver::rk23) continue;  // a million steps' rounding
    EXPECT_NEAR(run.x(100, 0), 0.1 * std::cos(std::sqrt(90.0)), solver <= Solver::fixed ? 1e-6 : 1e-11)
        << to_string(solver);
  }
}

// The limit is an option with a stated default, whatever the machine has.
TEST(Memory, ThatARunWouldNeedIsSaidBeforeItIsTaken) {
  const auto nothing = [](double) { return 0.0; };
  EXPECT_EQ(
      fault_of([&] { Excitation(0, 1e-9, 1000000000000, nothing); }),
      "excitation: 1e+12 output points need 8000 GB of memory, more than max_memory = 8 GB; take a longer dt or a "
      "shorter duration, or allow more");
  const System system(model_of("1", "90*y + z", {{"z", "v - z", "", ""}}));
  const int values = run_values(system);  // x, a and their copy, F and its grids
  EXPECT_EQ(values, 2 * (3 + 1) + 1 + 3 * 5);
  EXPECT_EQ(fault_of([&] { check_memory("simulate", 1e9, values); }),
            "simulate: 1e+09 output points need 192 GB of memory, more than max_memory = 8 GB; take a longer dt or a "
            "shorter duration, or allow more");
  EXPECT_EQ(fault_of([&] { check_memory("simulate", 1e9, values, 192e9); }), "");
  SimulateOptions options;
  options.max_memory = 101 * 24 * 8;
  const auto run = [&] { simulate(system, {}, zero_force(1, 0.01), state({0.1, 0, 0}), options); };
  EXPECT_EQ(fault_of(run), "");
  options.max_memory -= 1;
  EXPECT_EQ(fault_of(run),
            "simulate: 101 output points need 1.9392e-05 GB of memory, more than max_memory = 1.9391e-05 GB; take a "
            "longer dt or a shorter duration, or allow more");
  options.max_memory = 0;
  EXPECT_EQ(fault_of(run), "simulate: max_memory: expected > 0, got 0");
}

// A rate may hold a, which holds the state: a is the solved acceleration. A loop through a nonlinear a is refused.
TEST(AlgebraicLoop, ThroughTheAccelerationIsSolvedOrRefused) {
  const System system(model_of("2", "30*y + 0.5*z + 0.5*a", {{"z", "0.2*a - z", "", ""}}));
  const System solved(model_of("2.5", "30*y + 0.5*z", {{"z", "-0.2*(30*y + 0.5*z)/2.5 - z", "", ""}}));
  const lunid::Run a = simulate(system, {}, zero_force(2, 0.01), state({0.1, 0, 0.3}), with_solver(Solver::rk45));
  const lunid::Run b = simulate(solved, {}, zero_force(2, 0.01), state({0.1, 0, 0.3}), with_solver(Solver::rk45));
  EXPECT_LT((a.x - b.x).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(fault_of([] { System(model_of("1", "30*y + tanh(a)")); }),
            "model: restoring: terms in a must be a times something without a, got tanh(a)");
}

TEST(Excitation, ShorterThanTheSpanIsRefused) {
  const Excitation force = zero_force(1, 0.01);
  EXPECT_EQ(fault_of([&] { force.part(50, 52); }), "excitation: rows 51 to 102 are not within its 101 rows");
}

}  // namespace
}  // namespace lunid
