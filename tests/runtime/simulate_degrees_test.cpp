// Several degrees of freedom: modes in closed form, coupled masses, a moving base, switches between coordinates,
// chains.
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::force_of;
using testing::model_of;
using testing::model_of_many;
using testing::state;
using testing::StateText;
using testing::theta_of;
using testing::with_solver;
using testing::with_substeps;
using testing::zero_force;

constexpr double pi = std::numbers::pi;

/// n equal masses between two walls, each spring k.
Model chain_of(int n, const std::string& extra = "") {
  std::vector<std::pair<std::string, std::string>> rows;
  for (int i = 1; i <= n; ++i) {
    const auto y = [&](int j) { return j < 1 || j > n ? std::string("0") : "y" + std::to_string(j); };
    rows.emplace_back("m", "k*(" + y(i) + " - " + y(i - 1) + ") + k*(" + y(i) + " - " + y(i + 1) + ")" + extra);
  }
  Model model = model_of_many(rows);
  model.driven = {0};
  return model;
}

/// Frequency of mode j of such a chain [rad/s].
double chain_frequency(int n, int j, double k, double m) {
  return 2 * std::sqrt(k / m) * std::sin(j * pi / (2 * (n + 1)));
}

// A chain that starts in the shape of a mode swings in it: y_i = sin(i j pi / (n + 1)) cos(w_j t), exactly.
TEST(Chain, SwingsInItsModesByEverySolver) {
  const int n = 3, j = 2;
  const System system(chain_of(n));
  const std::vector<double> theta = theta_of(system, {{"m", 2}, {"k", 800}});
  const double w = chain_frequency(n, j, 800, 2);
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(2 * n);
  for (int i = 0; i < n; ++i) x0[2 * i] = 0.01 * std::sin((i + 1) * j * pi / (n + 1));
  for (const Solver solver : all_solvers()) {
    const lunid::Run run = simulate(system, theta, zero_force(2, 0.005), x0, with_solver(solver, 1e-10));
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    for (Eigen::Index row = 0; row < run.x.rows(); ++row)
      for (int i = 0; i < n; ++i) {
        const double expected = x0[2 * i] * std::cos(w * 0.005 * static_cast<double>(row));
        ASSERT_NEAR(run.x(row, 2 * i), expected, 2e-7) << run.summary.solver;
        ASSERT_NEAR(run.a(row, i), -w * w * expected, 2e-7 * w * w) << run.summary.solver;
      }
  }
}

// The same physics in other coordinates: z1 = y1, z2 = y2 - y1 has a full mass matrix, written as terms in a1 and a2.
TEST(CoupledMass, IsTheSameMotionInOtherCoordinates) {
  const System apart(model_of_many({{"m1", "k*y1 + h*(y1 - y2)^3 + c*v1"}, {"m2", "h*(y2 - y1)^3 + 2*c*v2"}}));
  // with y2 = z1 + z2: Lagrange's equations in z
  const System joined(
      model_of_many({{"m1 + m2", "m2*a2 + k*y1 + c*v1 + 2*c*(v1 + v2)"}, {"m2", "m2*a1 + h*y2^3 + 2*c*(v1 + v2)"}}));
  const std::vector<std::pair<std::string, double>> values{{"m1", 2}, {"m2", 0.7}, {"k", 90}, {"h", 4e4}, {"c", 0.3}};
  Excitations first, second;
  const Excitation force = force_of(4, 0.01, [](double t) { return 3 * std::sin(5 * t); });
  first.add("F1", force);
  second.add("F1", force);
  const lunid::Run y = simulate(apart, theta_of(apart, values), first, state({0.02, 0, -0.03, 0.1}), with_substeps(4));
  const lunid::Run z =
      simulate(joined, theta_of(joined, values), second, state({0.02, 0, -0.05, 0.1}), with_substeps(4));
  ASSERT_TRUE(y.summary.completed && z.summary.completed);
  EXPECT_LT((y.x.col(0) - z.x.col(0)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((y.x.col(2) - z.x.col(0) - z.x.col(2)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((y.a.col(1) - z.a.col(0) - z.a.col(1)).cwiseAbs().maxCoeff(), 1e-6);
}

// In coordinates relative to the base its motion is the force -m ab.
TEST(BaseMotion, IsAForceInRelativeCoordinates) {
  const System absolute(model_of("2", "90*(y - yb) + 0.4*(v - vb) + 500*(y - yb)^3"));
  const System relative(model_of("2", "90*y + 0.4*v + 500*y^3"));
  ASSERT_EQ(absolute.inputs(), (std::vector<std::string>{"F", "yb", "vb"}));
  const double w = 6, b = 0.1;
  Excitations base;
  base.add("yb", force_of(5, 0.01, [=](double t) { return b * std::sin(w * t); }));
  base.add("vb", force_of(5, 0.01, [=](double t) { return b * w * std::cos(w * t); }));
  const Excitation force = force_of(5, 0.01, [=](double t) { return 2 * b * w * w * std::sin(w * t); });
  for (const Solver solver : all_solvers()) {
    const lunid::Run y = simulate(absolute, {}, base, state({0, 0}), with_solver(solver, 1e-10));
    const lunid::Run u = simulate(relative, {}, force, state({0, -b * w}), with_solver(solver, 1e-10));
    ASSERT_TRUE(y.summary.completed && u.summary.completed);
    for (Eigen::Index i = 0; i < y.x.rows(); ++i)
      ASSERT_NEAR(y.x(i, 0), u.x(i, 0) + b * std::sin(w * 0.01 * static_cast<double>(i)), 1e-7) << y.summary.solver;
  }
}

// tau from the motion: y of a run with a delay tells it, with an exact derivative.
TEST(Delay, ShiftsTheForceAndHasItsSensitivity) {
  Model model = model_of("1", "90*y + 2*v + 500*y^3");
  model.delay = model.pool->parameter("tau");
  const System late(model), now(model_of("1", "90*y + 2*v + 500*y^3"));
  ASSERT_EQ(late.parameters(), 1);
  const auto push = [](double t) { return 3 * std::sin(7 * t) + std::cos(17 * t); };
  const Excitation force = force_of(4, 0.01, push);
  const Excitation shifted = force_of(4, 0.01, [=](double t) { return push(t - 0.023); });
  const std::vector<double> tau{0.023};
  const SensitivityRun run = simulate_sensitivities(late, tau, force, state({0, 0}), with_substeps(4));
  const lunid::Run expected = simulate(now, {}, shifted, state({0, 0}), with_substeps(4));
  EXPECT_LT((run.run.x - expected.x).cwiseAbs().maxCoeff(), 1e-12);
  const double h = 1e-5;
  const lunid::Run up = simulate(late, std::vector<double>{0.023 + h}, force, state({0, 0}), with_substeps(4));
  const lunid::Run down = simulate(late, std::vector<double>{0.023 - h}, force, state({0, 0}), with_substeps(4));
  const Eigen::VectorXd difference = (up.x.col(0) - down.x.col(0)) / (2 * h);
  EXPECT_LT((run.dy().col(0) - difference).cwiseAbs().maxCoeff(), 2e-4 * difference.cwiseAbs().maxCoeff());
  EXPECT_EQ(fault_of([&] {
              simulate(late, std::vector<double>{-0.1}, force, state({0, 0}));
            }),
            "simulate: delay: expected a finite value >= 0, got -0.1");
}

struct PairCase {
  const char* name;
  std::vector<std::pair<std::string, std::string>> rows;
  std::vector<StateText> states;
  friend void PrintTo(const PairCase& c, std::ostream* out) { *out << c.name; }
};

const PairCase pairs[] = {
    {"friction_between", {{"1", "90*y1 + Fc*sign(v1 - v2) + 0.3*v1"}, {"2", "60*y2 + Fc*sign(v2 - v1) + 0.3*v2"}}, {}},
    {"two_sliders", {{"1", "90*y1 + 40*(y1 - y2) + Fc*sign(v1)"}, {"2", "40*(y2 - y1) + 0.4*Fc*sign(v2)"}}, {}},
    {"stop_between",
     {{"1", "90*y1 + 900*max(y1 - y2 - 0.01*Fc, 0) + 0.5*v1"}, {"2", "60*y2 - 900*max(y1 - y2 - 0.01*Fc, 0) + 0.5*v2"}},
     {}},
    {"preload_between", {{"1", "90*y1 + Fc*sign(y1 - y2) + 2*v1"}, {"2", "60*y2 - Fc*sign(y1 - y2) + 2*v2"}}, {}},
    {"slip_between", {{"1", "40*y1 + r + 0.5*v1"}, {"2", "60*y2 - r + 0.5*v2"}}, {{"r", "90*(v1 - v2)", "-Fc", "Fc"}}},
};

class SwitchBetween : public ::testing::TestWithParam<PairCase> {};
INSTANTIATE_TEST_SUITE_P(Cases, SwitchBetween, ::testing::ValuesIn(pairs),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(SwitchBetween, IsMetAlikeByBothIntegratorsAndBySensitivities) {
  const System system(model_of_many(GetParam().rows, GetParam().states));
  Excitations force;
  force.add("F1", force_of(4, 0.01, [](double t) { return 7 * std::sin(5 * t) + 3 * std::sin(13 * t + 1); }));
  force.add("F2", force_of(4, 0.01, [](double t) { return 2 * std::cos(8 * t); }));
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(system.states());
  x0[0] = 0.02;
  x0[3] = -0.3;
  const std::vector<double> theta{1.3};
  const SensitivityRun exact = simulate_sensitivities(system, theta, force, x0, with_substeps(16));
  ASSERT_TRUE(exact.run.summary.completed) << exact.run.summary.cause;
  EXPECT_GT(static_cast<double>(exact.run.summary.events) + exact.run.summary.stuck, 0);
  const double scale = exact.run.x.col(0).cwiseAbs().maxCoeff();
  const lunid::Run other = simulate(system, theta, force, x0, with_solver(Solver::rk45, 1e-10));
  ASSERT_TRUE(other.summary.completed) << other.summary.cause;
  EXPECT_LT((other.x.col(0) - exact.run.x.col(0)).cwiseAbs().maxCoeff(), 1e-5 * scale);
  EXPECT_LT((other.x.col(2) - exact.run.x.col(2)).cwiseAbs().maxCoeff(), 1e-5 * scale);
  EXPECT_NEAR(other.summary.stuck, exact.run.summary.stuck, 1e-3);
  const double h = 1e-6;
  const lunid::Run up = simulate(system, std::vector<double>{1.3 + h}, force, x0, with_substeps(16));
  const lunid::Run down = simulate(system, std::vector<double>{1.3 - h}, force, x0, with_substeps(16));
  for (const int i : {0, 2}) {
    const Eigen::VectorXd difference = (up.x.col(i) - down.x.col(i)) / (2 * h);
    EXPECT_LE((exact.dx[i].col(0) - difference).cwiseAbs().maxCoeff(), 3e-4 * difference.cwiseAbs().maxCoeff()) << i;
  }
}

TEST(Chain, JacobianGrowsWithItsLengthOnly) {
  const System hundred(chain_of(100)), thousand(chain_of(1000));
  EXPECT_EQ(hundred.dynamics().pattern.size(), 100 + 3 * 100 - 2);  // y' = v, and three springs' ends per mass
  EXPECT_EQ(thousand.dynamics().pattern.size(), 1000 + 3 * 1000 - 2);
  EXPECT_LT(thousand.dynamics().jacobian.instructions(), 11 * hundred.dynamics().jacobian.instructions());
}

// 1000 masses in their slowest mode, by the fixed path and by BDF with a sparse Jacobian.
TEST(Chain, OfAThousandMassesRuns) {
  const int n = 1000;
  const System system(chain_of(n));
  const std::vector<double> theta = theta_of(system, {{"m", 1}, {"k", 1e6}});
  const double w = chain_frequency(n, 1, 1e6, 1);
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(2 * n);
  for (int i = 0; i < n; ++i) x0[2 * i] = std::sin((i + 1) * pi / (n + 1));
  for (const Solver solver : {Solver::fixed, Solver::bdf}) {
    const lunid::Run run = simulate(system, theta, zero_force(0.2, 0.002), x0, with_solver(solver, 1e-7));
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    const Eigen::Index last = run.x.rows() - 1;
    for (int i = 0; i < n; i += 37)
      EXPECT_NEAR(run.x(last, 2 * i), x0[2 * i] * std::cos(w * 0.2), 1e-4) << run.summary.solver;
  }
}

std::string fault_in(const Model& model) {
  return fault_of([&] { System{model}; });
}

TEST(Degrees, FaultsNameTheCoordinate) {
  EXPECT_EQ(fault_in(model_of_many({{"1", "k*y1"}, {"1", "k*y3"}})),
            "model: restoring of y2: cannot hold the channel 'y3' (it may hold y1 y2 v1 v2 a1 a2 t yb vb ab)");
  EXPECT_EQ(fault_in(model_of_many({{"1", "k*y1"}, {"1", "k*y"}})),
            "model: restoring of y2: cannot hold the channel 'y' (it may hold y1 y2 v1 v2 a1 a2 t yb vb ab)");
  EXPECT_EQ(fault_in(model_of_many({{"1", "k*y1"}, {"0", "k*y2"}})), "model: mass of y2: expected > 0, got 0");
  EXPECT_EQ(fault_in(model_of_many({{"1", "k*y1 + a1*a2"}, {"1", "k*y2"}})),
            "model: restoring: terms in a must be a times something without a, got (1 + a2)*a1");
  Model driven = model_of_many({{"1", "k*y1"}, {"1", "k*y2"}});
  driven.driven = {2};
  EXPECT_EQ(fault_in(driven), "model: forces: expected coordinates from 1 to 2, got 3");
  Model many = chain_of(20);
  many.driven.clear();
  EXPECT_EQ(fault_in(many),
            "model: 20 coordinates with a force each: at most 13 can be driven; name them, as in forces = { 1 }");
}

TEST(Degrees, FaultsNameTheInput) {
  const System system(model_of_many({{"1", "90*y1"}, {"1", "90*y2"}}));
  Excitations force;
  force.add("F3", zero_force(1, 0.01));
  EXPECT_EQ(fault_of([&] { simulate(system, {}, force, Eigen::VectorXd::Zero(4)); }),
            "excitation: F3: drives nothing in this model; its inputs are F1, F2");
  force = {};
  force.add("F1", zero_force(1, 0.01));
  EXPECT_EQ(fault_of([&] { force.add("F1", zero_force(1, 0.01)); }), "excitation: F1: given twice");
  EXPECT_EQ(
      fault_of([&] { force.add("F2", zero_force(2, 0.01)); }),
      "excitation: F2: expected the time base of F1 (101 rows from 0 s by 0.01 s), got 201 rows from 0 s by 0.01 s");
}

TEST(Degrees, OneMayBeNumberedToo) {
  const System numbered(model_of("2", "90*y1 + 0.3*v1")), plain(model_of("2", "90*y + 0.3*v"));
  EXPECT_EQ(numbered.model().equation(), plain.model().equation());
}

TEST(Degrees, EquationHasALineForEach) {
  Model model = model_of_many({{"m1", "k*y1 + m12*a2"}, {"m2", "0"}});
  model.driven = {0};
  EXPECT_EQ(model.equation(), "m1*a1 + k*y1 + m12*a2 = F1\nm2*a2 = 0");
}

}  // namespace
}  // namespace lunid
