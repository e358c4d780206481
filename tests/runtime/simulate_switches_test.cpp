// Every kind of switch that the catalogue knows, under forces drawn at random: two unrelated integrators agree, and the
// sensitivities are the differences of the run.
#include <ostream>
#include <random>

#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::force_of;
using testing::model_of;
using testing::state;
using testing::StateText;
using testing::with_solver;
using testing::with_substeps;

struct SwitchCase {
  const char* name;
  const char* restoring;
  std::vector<StateText> states;

  friend void PrintTo(const SwitchCase& c, std::ostream* out) { *out << c.restoring; }
};

const SwitchCase cases[] = {
    {"coulomb", "0.5*v + 90*y + Fc*sign(v)", {}},
    {"stribeck", "0.5*v + 90*y + (Fc + 0.5*Fc*exp(-(v/0.1)^2))*sign(v)", {}},
    {"position_dependent", "0.5*v + 90*y + (Fc + 30*abs(y))*sign(v)", {}},
    {"asymmetric_friction", "0.5*v + 90*y + where(v > 0, Fc, -0.5*Fc)", {}},
    {"belt", "40*y + 0.2*v + Fc*sign(v - 0.1)", {}},
    {"oblique_surface", "40*y + 0.4*v + Fc*sign(v + 0.3*y)", {}},
    {"preload", "0.5*v + 90*y + Fc*sign(y)", {}},
    {"preload_and_friction", "0.5*v + 90*y + 0.5*Fc*sign(y) + Fc*sign(v)", {}},
    {"stop", "0.5*v + 90*y + 900*max(y - 0.03*Fc, 0)", {}},
    {"hunt_crossley", "0.5*v + 90*y + 3000*max(y - 0.02*Fc, 0)^1.5*max(1 + 0.3*v, 0)", {}},
    {"moving_stop", "0.5*v + 300*max(y - 0.02 + 0.01*t, 0) + Fc*sign(v)*where(y > 0, 1, 0.5)", {}},
    {"asymmetric_damping", "0.5*v + 90*y + 2*Fc*max(v, 0) + 50*min(y, 0)", {}},
    {"elastic_slip", "0.5*v + 40*y + r", {{"r", "90*v", "-Fc", "Fc"}}},
    {"iwan", "0.5*v + 40*y + r + q", {{"r", "90*v", "-Fc", "Fc"}, {"q", "200*v", "-0.4*Fc", "0.4*Fc"}}},
    {"slip_and_friction", "0.5*v + 40*y + r + 0.6*Fc*sign(v)", {{"r", "90*v", "-Fc", "Fc"}}},
    {"moving_bounds", "0.5*v + 40*y + 90*(y - ys)", {{"ys", "0", "y - Fc/90", "y + Fc/90"}}},
    {"lift_off", "0.5*v + 60*y + 90*(y - ys)", {{"ys", "0", "y - max(Fc + 30*y, 0)/90", "y + max(Fc + 30*y, 0)/90"}}},
    {"toe", "1.5*v + 40*y + min(max(90*(y - ys), 0), Fc)", {{"ys", "0", "y - Fc/90", ""}}},
    {"bouc_wen", "0.5*Fc*v + 60*z", {{"z", "v - 4*abs(v)*abs(z)^0.3*z - 2*v*abs(z)^1.3", "", ""}}},
    {"sliding_state", "40*y + 0.4*v + Fc*z", {{"z", "15*v - 3*sign(z)", "", ""}}},
};

class EverySwitch : public ::testing::TestWithParam<SwitchCase> {};
INSTANTIATE_TEST_SUITE_P(Cases, EverySwitch, ::testing::ValuesIn(cases),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(EverySwitch, IsMetAlikeByBothIntegratorsAndBySensitivities) {
  const System system(model_of("1", GetParam().restoring, GetParam().states));
  ASSERT_EQ(system.parameters(), 1);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 3; ++trial) {
    const double a = 2 + 8 * uniform(random), b = 5 * uniform(random), w1 = 2 + 6 * uniform(random);
    const double w2 = 8 + 15 * uniform(random), phase = 6 * uniform(random);
    const std::vector<double> theta{0.2 + 3 * uniform(random)};
    const Excitation force =
        force_of(5, 0.01, [=](double t) { return a * std::sin(w1 * t) + b * std::sin(w2 * t + phase); });
    Eigen::VectorXd x0 = Eigen::VectorXd::Zero(system.states());
    if (trial > 0) {
      x0[0] = 0.05 * (uniform(random) - 0.5);
      x0[1] = uniform(random) - 0.5;
    }
    const SensitivityRun exact = simulate_sensitivities(system, theta, force, x0, with_substeps(16));
    ASSERT_TRUE(exact.run.summary.completed) << exact.run.summary.cause;
    EXPECT_GT(exact.run.summary.events + exact.run.summary.stuck, 0);  // the switch is met at all
    const double scale = exact.run.x.col(0).cwiseAbs().maxCoeff();

    const lunid::Run other = simulate(system, theta, force, x0, with_solver(Solver::rk45, 1e-10));
    ASSERT_TRUE(other.summary.completed) << other.summary.cause;
    // 8000 steps at 1/400 of the fastest period, and impacts that amplify
    EXPECT_LT((other.x.col(0) - exact.run.x.col(0)).cwiseAbs().maxCoeff(), 1e-5 * scale) << "trial " << trial;
    EXPECT_NEAR(other.summary.stuck, exact.run.summary.stuck, 1e-3) << "trial " << trial;

    const double h = 1e-6 * theta[0];
    const lunid::Run up = simulate(system, std::vector<double>{theta[0] + h}, force, x0, with_substeps(16));
    const lunid::Run down = simulate(system, std::vector<double>{theta[0] - h}, force, x0, with_substeps(16));
    const Eigen::VectorXd difference = (up.x.col(0) - down.x.col(0)) / (2 * h);
    // a contact that grows as y^1.5 has an infinite curvature at its start, for the run as for its differences
    EXPECT_LE((exact.dy().col(0) - difference).cwiseAbs().maxCoeff(), 3e-4 * difference.cwiseAbs().maxCoeff())
        << "trial " << trial;
  }
}

// On a preload the mass rests at y = 0 as long as the force stays below it, and leaves when it grows beyond.
TEST(Preload, HoldsTheMassAtZeroUntilTheForceExceedsIt) {
  const System system(model_of("1", "F0*sign(y)"));
  for (const Solver solver : {Solver::fixed, Solver::bdf, Solver::adams, Solver::rk45}) {
    SimulateOptions options = with_solver(solver, 1e-10);
    if (solver == Solver::fixed) options.substeps = 2;
    const lunid::Run run = simulate(system, std::vector<double>{2}, force_of(2, 0.01, [](double t) { return -3 * t; }),
                                    state({0, 0}), options);
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    for (Eigen::Index i = 0; i < run.x.rows(); ++i) {
      const double s = std::max(0.0, 0.01 * static_cast<double>(i) - 2.0 / 3);  // a = -3 s from there on
      EXPECT_NEAR(run.x(i, 0), -0.5 * s * s * s, 1e-8) << run.summary.solver;
    }
    EXPECT_NEAR(run.summary.stuck, 2.0 / 3, 1e-6) << run.summary.solver;
    EXPECT_LE(run.summary.events, 3) << run.summary.solver;
  }
}

// Where the motion turns all elements that slip let go at one place. An event takes a few trial steps to find, however
// many fall together: halving the place of each alone took 770 evaluations to an event.
TEST(ElementsThatLetGoTogether, AreFoundInFewEvaluationsAndAlikeByBothIntegrators) {
  std::string restoring = "0.5*v + 40*y";
  std::vector<StateText> states;
  for (int i = 1; i <= 10; ++i) {
    const std::string z = "z" + std::to_string(i), limit = std::to_string(0.2 * i - 0.1);
    restoring += " + " + z;
    states.push_back({z, "9*v", "-" + limit, limit});
  }
  const System system(model_of("1", restoring, states));
  const Excitation force =
      force_of(10, 0.005, [](double t) { return 12 * std::sin(7 * t) + 6 * std::sin(11.3 * t + 1); });
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(system.states());
  const lunid::Run run = simulate(system, std::vector<double>{}, force, rest, with_substeps(1));
  ASSERT_TRUE(run.summary.completed) << run.summary.cause;
  EXPECT_GT(run.summary.events, 200);
  const double steps = 6.0 * static_cast<double>(run.summary.steps);
  EXPECT_LT((static_cast<double>(run.summary.evaluations) - steps) / static_cast<double>(run.summary.events), 100);
  const lunid::Run other = simulate(system, std::vector<double>{}, force, rest, with_solver(Solver::rk45, 1e-10));
  ASSERT_TRUE(other.summary.completed) << other.summary.cause;
  EXPECT_LT((run.x.col(0) - other.x.col(0)).cwiseAbs().maxCoeff(), 1e-6 * run.x.col(0).cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace lunid
