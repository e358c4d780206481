// Runs between their rows, runs on finer rows than those of their record, ends by a condition between rows, and the
// check of fits by SUNDIALS. Witnesses: closed forms, and runs whose rows lie where the others are asked for.
#include "simulate/dense.hpp"

#include "simulate/fit_check.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using std::numbers::pi;
using testing::fault_of;
using testing::force_of;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_solver;
using testing::with_substeps;
using testing::zero_force;

class BetweenRows : public ::testing::TestWithParam<Solver> {};

// y = cos 20 t on rows that are a third of a period apart.
TEST_P(BetweenRows, IsTheClosedFormBetweenItsRows) {
  const System system(model_of("1", "400*y"));
  const Excitation force = zero_force(2, 0.1);
  const SimulateOptions options = with_solver(GetParam(), 1e-10);
  const lunid::Run run = simulate(system, {}, force, state({1, 0}), options);
  for (const double t : {0.0, 0.013, 0.1, 0.7777, 1.95, 2.0}) {
    const lunid::Run there = run_up_to(system, {}, force, options, run, t);
    const Eigen::Index last = there.x.rows() - 1;
    EXPECT_NEAR(there.x(last, 0), std::cos(20 * t), 1e-5) << t;
    EXPECT_NEAR(there.x(last, 1), -20 * std::sin(20 * t), 2e-4) << t;
    EXPECT_NEAR(there.a(last, 0), -400 * std::cos(20 * t), 4e-3) << t;
  }
  EXPECT_EQ(fault_of([&] { run_up_to(system, {}, force, options, run, 2.1); }),
            "at: t: expected within the run, 0 to 2 s, got 2.1");
}
INSTANTIATE_TEST_SUITE_P(Dense, BetweenRows, ::testing::ValuesIn(all_solvers().begin(), all_solvers().end()),
                         [](const auto& info) { return to_string(info.param); });

// A block that sticks and slips under a sampled force, on straight lines and held.
TEST(Dense, AgreesWithARunThatHasTheRow) {
  const System system(model_of("1", "50*y + 7*sign(v)"));
  std::vector<double> samples;
  for (int i = 0; i <= 40; ++i) samples.push_back(9 * std::sin(0.9 * i) + 3 * std::cos(2.3 * i));
  for (const Interpolation kind : {Interpolation::linear, Interpolation::hold}) {
    const Excitations force(Excitation(0, 0.1, samples, kind));
    const SimulateOptions options = with_substeps(64);
    const lunid::Run run = simulate(system, {}, force, state({0, 0}), options),
                     fine = simulate(system, {}, finer(force, 8), state({0, 0}), with_substeps(8));
    EXPECT_GT(run.summary.stuck, 0.2);
    for (Eigen::Index row = 0; row < fine.x.rows(); row += 5) {
      const lunid::Run there = run_up_to(system, {}, force, options, run, 0.0125 * static_cast<double>(row));
      EXPECT_NEAR(there.x(there.x.rows() - 1, 0), fine.x(row, 0), 1e-7) << to_string(kind) << " row " << row;
    }
  }
}

// Finer rows change nothing of the force: with steps of the same length the motion is the same to rounding.
TEST(FinerRows, KeepTheForceBetweenTheSamples) {
  const System system(model_of("1", "k*y + c*v + 1e4*y^3"));
  const auto theta = theta_of(system, {{"k", 900}, {"c", 3}});
  std::vector<double> samples;
  for (int i = 0; i <= 60; ++i) samples.push_back(20 * std::sin(0.4 * i) + 9 * std::cos(1.1 * i));
  const auto formula = [](std::span<const double> t, std::span<double> out) {
    for (std::size_t i = 0; i < t.size(); ++i) out[i] = 20 * std::sin(40 * t[i]);
  };
  std::vector<Excitation> forces;
  for (const Interpolation kind :
       {Interpolation::hold, Interpolation::linear, Interpolation::cubic, Interpolation::band_limited})
    forces.emplace_back(0, 0.01, samples, kind);
  forces.emplace_back(0, 0.01, samples, Interpolation::linear, TimeFunction(formula));
  for (const Excitation& force : forces) {
    const lunid::Run coarse = simulate(system, theta, force, state({0, 0}), with_substeps(4)),
                     fine = simulate(system, theta, finer(force, 4), state({0, 0}), with_substeps(1));
    ASSERT_EQ(fine.x.rows(), 241);
    const double scale = coarse.x.col(0).cwiseAbs().maxCoeff();
    // of the band-limited force what lies between is read off a finer grid
    const double tolerance = force.interpolation() == Interpolation::band_limited ? 1e-7 : 1e-12;
    for (Eigen::Index row = 0; row < coarse.x.rows(); ++row)
      EXPECT_NEAR(fine.x(4 * row, 0), coarse.x(row, 0), tolerance * scale) << to_string(force.interpolation());
  }
}

// y = sin w t passes 0.99 for a twentieth of a period, between two rows: neither of them shows it.
TEST(StopWhen, IsFoundBetweenRowsThatDoNotShowIt) {
  Model model = model_of("1", "400*y");
  SimulateOptions options;
  options.stop_when = parse(*model.pool, "y - 0.99");
  const System system(model);
  const double w = 20, dt = 0.05;  // rows at sin 1 = 0.84 and sin 2 = 0.91
  for (const Solver solver : {Solver::automatic, Solver::bdf, Solver::rk78}) {
    options.solver = solver;
    options.rtol = 1e-10;
    const lunid::Run run = simulate(system, {}, zero_force(0.3, dt), state({0, w}), options);
    EXPECT_NEAR(run.summary.ended_at, std::asin(0.99) / w, 1e-7) << to_string(solver);
    EXPECT_NEAR(run.summary.ended_in[0], 0.99, 1e-6);
    EXPECT_TRUE(run.x.row(1).allFinite());
    EXPECT_FALSE(run.x.row(2).allFinite());
  }
}

TEST(FitCheck, SeesStepsThatAreTooLong) {
  const System system(model_of("1", "k*y + c*v"));
  const auto theta = theta_of(system, {{"k", 400}, {"c", 1}});
  const Excitations force(force_of(4, 0.05, [](double t) { return 30 * std::sin(11 * t); }));
  const lunid::Run run = simulate(system, theta, force, state({0.01, 0}), with_solver(Solver::bdf, 1e-10));
  Channel y, v;
  y.name = "y";
  y.values = run.x.col(0);
  v.name = "v";
  v.values = run.x.col(1);
  const std::vector<FitData> data{{Record("run", 0, 0.05, {y, v}), force, {}}};
  const FitOptions options;
  FitResult result = fit_trajectory(system, Eigen::Map<const Eigen::VectorXd>(theta.data(), 2), data, options);
  ASSERT_TRUE(result.converged);
  EXPECT_LT(check_by_sundials(system, result, data, options), 1e-5);
  result.substeps = 1;  // three in a radian
  EXPECT_GT(check_by_sundials(system, result, data, options), 1e-4);
  result.solver = "CVODE BDF";
  EXPECT_TRUE(std::isnan(check_by_sundials(system, result, data, options)));
}

}  // namespace
}  // namespace lunid
