// Sensitivities against central finite differences of the run itself, and jumps at switches included.
#include "simulate/acceleration.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::force_of;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_substeps;
using testing::zero_force;

/// Largest difference between the sensitivities and central differences, over the largest entry of each column.
double worst_difference(const System& system, const std::vector<double>& theta, const Excitation& excitation,
                        const Eigen::VectorXd& x0, int substeps, double step = 1e-6) {
  const SimulateOptions options = with_substeps(substeps);
  const SensitivityRun exact = simulate_sensitivities(system, theta, excitation, x0, options);
  EXPECT_TRUE(exact.run.summary.completed) << exact.run.summary.cause;
  const lunid::Run plain = simulate(system, theta, excitation, x0, options);
  EXPECT_LT((exact.run.x - plain.x).cwiseAbs().maxCoeff(), 1e-9 * plain.x.cwiseAbs().maxCoeff());
  const int p = system.parameters(), n = system.states();
  double worst = 0;
  for (int c = 0; c < p + n; ++c) {
    std::vector<double> up = theta, down = theta;
    Eigen::VectorXd x_up = x0, x_down = x0;
    const double value = c < p ? theta[c] : x0[c - p];
    const double h = step * std::max(std::abs(value), c < p ? 1e-3 : 1e-3 * plain.x.col(c - p).cwiseAbs().maxCoeff());
    (c < p ? up[c] : x_up[c - p]) += h;
    (c < p ? down[c] : x_down[c - p]) -= h;
    const Run a = simulate(system, up, excitation, x_up, options);
    const Run b = simulate(system, down, excitation, x_down, options);
    for (int i = 0; i < 2; ++i) {
      const Eigen::VectorXd difference = (a.x.col(i) - b.x.col(i)) / (2 * h);
      const auto& column = (i == 0 ? exact.dy() : exact.dv()).col(c);
      const double scale = difference.cwiseAbs().maxCoeff();
      if (scale == 0) {
        EXPECT_EQ(column.cwiseAbs().maxCoeff(), 0) << "column " << c;
        continue;
      }
      const double error = (column - difference).cwiseAbs().maxCoeff() / scale;
      worst = std::max(worst, error);
    }
  }
  return worst;
}

double sweep(double t) { return 3 * std::sin(2 * std::numbers::pi * (1 + 0.3 * t) * t) + 1; }

// Central differences with steps of 1e-6 lose 1e-10 to rounding over 1e-6 and 1e-12 to curvature; 1e-5 leaves room for
// long runs, in which sensitivities grow.
TEST(Sensitivities, OfSmoothModelsAreThoseOfTheRun) {
  const System duffing(model_of("m", "c*v + k*y + k3*y^3"));
  EXPECT_LT(worst_difference(duffing, theta_of(duffing, {{"m", 1.3}, {"c", 0.4}, {"k", 40}, {"k3", 90}}),
                             force_of(4, 0.01, sweep), state({0.1, -0.3}), 2),
            1e-5);
  const System relaxation(model_of("1", "k*y + s + c*v", {{"s", "e*v - s/tau", "", ""}}));
  EXPECT_LT(worst_difference(relaxation, theta_of(relaxation, {{"k", 30}, {"c", 0.1}, {"e", 50}, {"tau", 0.2}}),
                             force_of(4, 0.01, sweep), state({0.1, 0, 0.2}), 2),
            1e-5);
}

TEST(Sensitivities, OfContinuousSwitchesAreThoseOfTheRun) {
  const System stop(model_of("1", "c*v + k*y + kc*max(y - g, 0)"));
  EXPECT_LT(worst_difference(stop, theta_of(stop, {{"c", 0.3}, {"k", 30}, {"kc", 400}, {"g", 0.05}}),
                             force_of(4, 0.01, sweep), state({0.01, 0.3}), 4),
            1e-5);
  const System bouc_wen(
      model_of("1", "c*v + k*z", {{"z", "v - beta*abs(v)*abs(z)^(n - 1)*z - gamma*v*abs(z)^n", "", ""}}));
  // abs(z)^(n - 1) z is smooth on either side of z = 0 for n = 2; for n = 1.5 its curvature is infinite there, and both
  // the run and its differences lose a digit
  for (const auto& [n, tolerance] : {std::pair(2.0, 1e-5), std::pair(1.5, 1e-4)})
    EXPECT_LT(
        worst_difference(bouc_wen, theta_of(bouc_wen, {{"c", 0.5}, {"k", 40}, {"beta", 8}, {"gamma", 3}, {"n", n}}),
                         force_of(4, 0.01, sweep), state({0.01, 0.3, 0.02}), 4),
        tolerance)
        << n;
}

TEST(Sensitivities, JumpWithDryFriction) {
  const System coulomb(model_of("m", "c*v + k*y + Fc*sign(v)"));
  const auto theta = theta_of(coulomb, {{"m", 1.1}, {"c", 0.2}, {"k", 30}, {"Fc", 1.2}});
  EXPECT_LT(worst_difference(coulomb, theta, force_of(4, 0.01, sweep), state({0.05, 0.4}), 4), 1e-5);
  // with sticking phases in it
  const Excitation slow = force_of(6, 0.01, [](double t) { return 3 * std::sin(3 * t); });
  const lunid::Run run = simulate(coulomb, theta, slow, state({0.05, 0.4}), with_substeps(4));
  EXPECT_GT(run.summary.stuck, 0.3);
  EXPECT_LT(worst_difference(coulomb, theta, slow, state({0.05, 0.4}), 4), 1e-5);
}

TEST(Sensitivities, JumpWhereAStateReachesItsBound) {
  const System slip(model_of("m", "c*v + r", {{"r", "k*v", "-R", "R"}}));
  const auto theta = theta_of(slip, {{"m", 1.1}, {"c", 0.5}, {"k", 60}, {"R", 1.5}});
  const Excitation slow = force_of(5, 0.01, [](double t) { return 3 * std::sin(3 * t); });
  EXPECT_GT(simulate(slip, theta, slow, state({0, 0, 0}), with_substeps(4)).summary.events, 4);
  EXPECT_LT(worst_difference(slip, theta, slow, state({0.02, 0.1, 0.3}), 4), 1e-5);
  // the same element written with its slip: the bounds follow the motion
  const System moving(model_of("m", "c*v + k*(y - ys)", {{"ys", "0", "y - R/k", "y + R/k"}}));
  const auto same = theta_of(moving, {{"m", 1.1}, {"c", 0.5}, {"k", 60}, {"R", 1.5}});
  EXPECT_LT(worst_difference(moving, same, slow, state({0.02, 0.1, 0.015}), 4), 1e-5);
}

/// Steps of +-2 that hold for three rows, 90 rows at 0.01 s in parts of a row, behind ten that are known.
Excitation held_steps(int parts) {
  std::vector<double> force;
  unsigned bits = 0x2d5b91e7;
  for (int row = 0; row < 100; ++row) {
    if (row % 3 == 0) bits = bits >> 1 | (bits & 1) << 31;
    force.insert(force.end(), static_cast<std::size_t>(parts), bits & 1 ? 2.0 : -2.0);
  }
  return Excitation(-0.1, 0.01 / parts, force, Interpolation::hold).part(10 * parts, 90 * parts);
}

// A held force that is late by parts of a row jumps between the rows. The same steps on rows fine enough to hold the
// jumps give the motion, to the third moment of a jump within a row; the motion goes with the delay as steadily as that
// of a smooth force.
TEST(Sensitivities, OfADelayOfHeldStepsAreThoseOfTheRun) {
  Model model = model_of("m", "c*v + k*y");
  const System system(model);
  model.delay = model.pool->parameter("late");
  const System late(complete(model));
  const Eigen::VectorXd at_rest = state({0, 0});
  for (const int parts : {0, 3, 25, 38, 40, 79}) {  // of 40 to a row
    const double delay = 0.01 * parts / 40;
    const std::vector<double> own{1.3, 0.9, 160};
    const auto theta = theta_of(late, {{"m", own[0]}, {"c", own[1]}, {"k", own[2]}, {"late", delay}});
    const lunid::Run run = simulate(late, theta, held_steps(1), at_rest, with_substeps(2));
    const Excitation steps = held_steps(40);
    std::vector<double> moved;
    for (Eigen::Index i = 0; i < steps.rows(); ++i)
      moved.push_back(steps.also_before(0.01 / 40 * (static_cast<double>(i) - parts + 1e-6)));
    const lunid::Run fine = simulate(system, theta_of(system, {{"m", own[0]}, {"c", own[1]}, {"k", own[2]}}),
                                     Excitation(0, 0.01 / 40, moved, Interpolation::hold), at_rest, with_substeps(1));
    const double largest = fine.x.col(0).cwiseAbs().maxCoeff();
    for (Eigen::Index row = 0; row < run.x.rows(); ++row)
      EXPECT_NEAR(run.x(row, 0), fine.x(40 * row, 0), 1e-4 * largest) << delay << " s, row " << row;
  }
  const auto theta = theta_of(late, {{"m", 1.3}, {"c", 0.9}, {"k", 160}, {"late", 0.0173}});
  EXPECT_LT(worst_difference(late, theta, held_steps(1), state({0.01, 0.1}), 2), 1e-5);
}

// With a state, a delayed force and dry friction at which the mass stops: the central differences of the acceleration,
// and 0 while it sticks.
TEST(Sensitivities, OfTheAccelerationAreThoseOfTheRun) {
  Model model = model_of("m", "k*y + c*v + s + Fc*sign(v)", {{"s", "e*v - s/tau", "", ""}});
  model.delay = model.pool->parameter("late");
  const System system(complete(model));
  const std::vector<std::pair<std::string, double>> values{{"m", 1.3}, {"k", 40},    {"c", 0.4},     {"Fc", 2.5},
                                                           {"e", 20},  {"tau", 0.2}, {"late", 0.013}};
  const auto theta = theta_of(system, values);
  const Excitations force(force_of(3, 0.01, sweep));
  const Eigen::VectorXd x0 = state({0.1, 0.3, 0});
  const SensitivityRun run = simulate_sensitivities(system, theta, force, x0, with_substeps(4));
  const std::vector<Eigen::MatrixXd> slopes = acceleration_slopes(system, theta, force, run);
  ASSERT_EQ(slopes.size(), 1U);
  EXPECT_GT(run.run.summary.stuck, 0.05);
  int still = 0, compared = 0;
  for (int c = 0; c < system.parameters() + 3; ++c) {
    const bool parameter = c < system.parameters();
    const double h = 1e-6 * (parameter ? theta[static_cast<std::size_t>(c)] : 0.1);
    const auto moved = [&](double by) {
      auto p = theta;
      Eigen::VectorXd x = x0;
      (parameter ? p[static_cast<std::size_t>(c)] : x[c - system.parameters()]) += by;
      return simulate(system, p, force, x, with_substeps(4)).a.col(0).eval();
    };
    const Eigen::VectorXd difference = (moved(h) - moved(-h)) / (2 * h);
    const double scale = difference.cwiseAbs().maxCoeff();
    for (Eigen::Index row = 0; row < difference.size(); row += 3) {
      if (run.run.a(row, 0) == 0) {
        EXPECT_EQ(slopes[0](row, c), 0);
        ++still;
        continue;
      }
      EXPECT_NEAR(slopes[0](row, c), difference[row], 2e-5 * scale) << "column " << c << ", row " << row;
      ++compared;
    }
  }
  EXPECT_GT(still, 10);
  EXPECT_GT(compared, 300);
}

}  // namespace
}  // namespace lunid
