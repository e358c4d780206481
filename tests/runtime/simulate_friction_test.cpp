// Dry friction: sliding, stopping, sticking and break-away against closed forms, by every solver.
#include "simulate/regularise.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::force_of;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_solver;
using testing::with_substeps;
using testing::zero_force;

class EverySolver : public ::testing::TestWithParam<Solver> {
 protected:
  SimulateOptions options() const {
    SimulateOptions o = with_solver(GetParam(), 1e-10);
    if (GetParam() == Solver::fixed) o.substeps = 1;
    return o;
  }
};
INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver,
                         ::testing::Values(Solver::fixed, Solver::bdf, Solver::adams, Solver::rk45),
                         [](const auto& info) { return to_string(info.param); });

// A block thrown over a rough table stops after v0 / (mu g) at v0^2 / (2 mu g), and stays.
TEST_P(EverySolver, ABlockOnARoughTableStopsAndStays) {
  const System system(model_of("m", "mu*m*9.81*sign(v)"));
  const auto theta = theta_of(system, {{"m", 2.5}, {"mu", 0.3}});
  const double deceleration = 0.3 * 9.81, v0 = 2;
  const lunid::Run run = simulate(system, theta, zero_force(2, 0.01), state({0, v0}), options());
  ASSERT_TRUE(run.summary.completed) << run.summary.cause;
  const double stop = v0 / deceleration, distance = v0 * v0 / (2 * deceleration);
  for (Eigen::Index i = 0; i < run.x.rows(); ++i) {
    const double t = 0.01 * static_cast<double>(i);
    if (t < stop) {
      EXPECT_NEAR(run.x(i, 1), v0 - deceleration * t, 1e-8);
      EXPECT_NEAR(run.a(i), -deceleration, 1e-12);
    } else {
      EXPECT_EQ(run.x(i, 1), 0) << "at " << t;  // exactly: sticking is a mode
      EXPECT_EQ(run.a(i), 0);
      EXPECT_NEAR(run.x(i, 0), distance, 1e-8);
      EXPECT_EQ(run.x(i, 0), run.x(run.x.rows() - 1, 0));
    }
  }
  EXPECT_NEAR(run.summary.stuck, 2 - stop, 1e-7);
}

// v' = -mu g tanh(v/w) has the solution sinh(v/w) = sinh(v0/w) exp(-mu g t/w); nothing is located.
TEST(Regularised, FrictionHasItsClosedForm) {
  constexpr double w = 0.05, v0 = 0.4;
  const Regularised smooth = regularised(model_of("m", "mu*m*9.81*sign(v)"), w);
  EXPECT_EQ(smooth.replaced, std::vector<std::string>{"sign(v)"});
  const System system(smooth.model);
  const auto theta = theta_of(system, {{"m", 2.5}, {"mu", 0.3}});
  const lunid::Run run =
      simulate(system, theta, zero_force(0.3, 0.01), state({0, v0}), with_solver(Solver::bdf, 1e-10));
  ASSERT_TRUE(run.summary.completed) << run.summary.cause;
  EXPECT_EQ(run.summary.events, 0);
  for (Eigen::Index i = 0; i < run.x.rows(); ++i) {
    const double t = 0.01 * static_cast<double>(i);
    EXPECT_NEAR(run.x(i, 1), w * std::asinh(std::sinh(v0 / w) * std::exp(-0.3 * 9.81 * t / w)), 1e-8) << t;
  }
}

TEST(Regularised, EveryBranchTendsToItsOwn) {
  const char* const branches[] = {"sign(y)",
                                  "abs(y - 1)",
                                  "max(y, v)",
                                  "min(2*y, v)",
                                  "where(y > 1, y^2, v)",
                                  "where(y < v, 3, y)",
                                  "where(v, 1, -1)",
                                  "where(y >= max(v, 0), abs(v), 2)"};
  for (const char* const branch : branches) {
    const Model sharp = model_of("1", branch);
    const Regularised smooth = regularised(sharp, 1e-3);
    EXPECT_FALSE(smooth.replaced.empty()) << branch;
    const Expr inputs[] = {sharp.pool->channel("y"), sharp.pool->channel("v")};
    const Expr both[] = {sharp.restoring, smooth.model.restoring};
    const Tape tape(both, inputs);
    EXPECT_EQ(Tape(std::span(both).subspan(1), inputs).switches(), 0) << branch;
    std::vector<double> scratch(static_cast<std::size_t>(tape.registers()) + 1);
    for (const double y : {-1.7, -0.3, 0.4, 1.2})
      for (const double v : {-1.1, -0.2, 0.7, 1.9}) {  // far from every switch
        const double in[] = {y, v};
        double out[2];
        tape.run_point(in, out, scratch.data());
        EXPECT_NEAR(out[1], out[0], 1e-12) << branch << " at " << y << ", " << v;
      }
  }
}

// Below the break-away force nothing moves; a ramp breaks away when it passes Fc, and no earlier.
TEST_P(EverySolver, ABlockAtRestBreaksAwayAtTheFrictionForce) {
  const System system(model_of("2", "Fc*sign(v)"));
  const std::vector<double> theta{5};
  const lunid::Run still = simulate(system, theta, force_of(3, 0.01, [](double t) { return 4.9 * std::sin(5 * t); }),
                                    state({0.3, 0}), options());
  EXPECT_EQ((still.x.col(0).array() - 0.3).abs().maxCoeff(), 0);
  EXPECT_EQ(still.x.col(1).cwiseAbs().maxCoeff(), 0);
  EXPECT_NEAR(still.summary.stuck, 3, 1e-9);

  const Excitation growing = force_of(2, 0.01, [](double t) { return 4 * t; });
  const lunid::Run ramp = simulate(system, theta, growing, state({0, 0}), options());
  ASSERT_TRUE(ramp.summary.completed) << ramp.summary.cause;
  for (Eigen::Index i = 0; i < ramp.x.rows(); ++i) {
    const double s = std::max(0.0, 0.01 * static_cast<double>(i) - 5.0 / 4);  // m dv/dt = 4 (t - 5/4) from there on
    EXPECT_NEAR(ramp.x(i, 1), s * s, 1e-8);
    EXPECT_NEAR(ramp.x(i, 0), s * s * s / 3, 1e-8);
  }
}

// A mass on a spring with dry friction loses 4 Fc / k of amplitude per cycle in straight lines and stops in the dead
// band |y| <= Fc / k (Den Hartog 1956, Mechanical vibrations, section 8.3).
TEST_P(EverySolver, FreeDecayWithDryFrictionFallsInAStraightLine) {
  const System system(model_of("1", "k*y + Fc*sign(v)"));
  const auto theta = theta_of(system, {{"k", 100}, {"Fc", 4}});
  const double y0 = 0.5, half = std::numbers::pi / 10;
  const lunid::Run run = simulate(system, theta, zero_force(3, 0.005), state({y0, 0}), options());
  ASSERT_TRUE(run.summary.completed) << run.summary.cause;
  for (int k = 1; k <= 5; ++k) {
    const double amplitude = y0 - 0.08 * k, t = half * k;  // extreme values at the ends of half cycles
    const auto row = static_cast<Eigen::Index>(std::floor(t / 0.005));
    const double s = 0.005 * static_cast<double>(row) - (t - half), sign = k % 2 == 1 ? 1 : -1;
    const double centre = 0.04, y = sign * (centre + (amplitude + centre) * std::cos(10 * s));
    EXPECT_NEAR(run.x(row, 0), y, 1e-6) << "half cycle " << k;
  }
  // 0.5 -> 0.42 -> 0.34 -> 0.26 -> 0.18 -> 0.10 -> 0.02, inside the band: it stays at +0.02
  EXPECT_NEAR(run.x(run.x.rows() - 1, 0), 0.02, 1e-6);
  EXPECT_EQ(run.x(run.x.rows() - 1, 1), 0);
  EXPECT_NEAR(run.summary.stuck, 3 - 6 * half, 1e-5);
}

// A block on a belt: the surface of sliding is v = speed. It sticks to the belt until the spring pulls it off.
TEST_P(EverySolver, ABlockRidesABeltUntilTheSpringPullsItOff) {
  const System system(model_of("1", "k*y + Fs*sign(v - speed)"));
  const auto theta = theta_of(system, {{"k", 50}, {"Fs", 2}, {"speed", 0.1}});
  const lunid::Run run = simulate(system, theta, zero_force(0.6, 0.01), state({0, 0.1}), options());
  ASSERT_TRUE(run.summary.completed) << run.summary.cause;
  for (Eigen::Index i = 0; 0.01 * static_cast<double>(i) < 0.4; ++i) {  // Fs / k / speed = 0.4 s
    EXPECT_NEAR(run.x(i, 1), 0.1, 1e-9);
    EXPECT_NEAR(run.x(i, 0), 0.001 * static_cast<double>(i), 1e-9);
  }
  // then it oscillates about Fs / k = 0.04 from y = 0.04 with v = speed: y = 0.04 + speed / w sin(w s)
  const double w = std::sqrt(50.0);
  EXPECT_NEAR(run.x(50, 0), 0.04 + 0.1 / w * std::sin(w * 0.1), 1e-6);
  EXPECT_NEAR(run.summary.stuck, 0.4, 1e-5);
}

TEST(Friction, SticksUnderAHeldForceAndBreaksAwayWhereItJumps) {
  const System system(model_of("1", "Fc*sign(v)"));
  std::vector<double> force(101, 0.5);
  for (int i = 50; i < 101; ++i) force[i] = 3;
  const lunid::Run run = simulate(system, std::vector<double>{1}, Excitation(0, 0.01, force, Interpolation::hold),
                                  state({0, 0}), with_substeps(2));
  EXPECT_EQ(run.x(50, 1), 0);
  EXPECT_NEAR(run.x(100, 1), 2 * 0.5, 1e-12);  // (3 - 1) / m for half a second, exact for a quadratic motion
  EXPECT_NEAR(run.x(100, 0), 0.25, 1e-12);
}

}  // namespace
}  // namespace lunid
