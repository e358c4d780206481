// Free runs against closed forms and independent integrations.
#include <thread>

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

constexpr Solver all_solvers[] = {Solver::automatic, Solver::fixed, Solver::bdf, Solver::adams, Solver::rk45};
constexpr Solver sundials_solvers[] = {Solver::bdf, Solver::adams, Solver::rk45};

/// m y'' + c y' + k y = A sin(w t) + B from y0, v0 (underdamped), by the sum of steady state and decay.
double linear(double m, double c, double k, double A, double w, double B, double y0, double v0, double t) {
  const double re = k - m * w * w, im = c * w, den = re * re + im * im;
  const double s = A * re / den, q = -A * im / den;  // s sin + q cos
  const double decay = c / (2 * m), wd = std::sqrt(k / m - decay * decay);
  const double C = y0 - q - B / k, D = (v0 - s * w + decay * C) / wd;
  return s * std::sin(w * t) + q * std::cos(w * t) + B / k +
         std::exp(-decay * t) * (C * std::cos(wd * t) + D * std::sin(wd * t));
}

TEST(FreeRun, OfALinearOscillatorIsItsClosedForm) {
  const System system(model_of("m", "c*v + k*y"));
  const auto theta = theta_of(system, {{"m", 2}, {"c", 1.5}, {"k", 800}});
  const Excitation force = force_of(2, 0.002, [](double t) { return 30 * std::sin(15 * t) + 8; });
  for (const Solver solver : all_solvers) {
    SimulateOptions options = with_solver(solver, 1e-10);
    const lunid::Run run = simulate(system, theta, force, state({0.02, -0.3}), options);
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    double worst = 0;
    for (Eigen::Index i = 0; i < run.x.rows(); ++i)
      worst = std::max(worst, std::abs(run.x(i, 0) - linear(2, 1.5, 800, 30, 15, 8, 0.02, -0.3, 0.002 * i)));
    // amplitude 0.1: 1e-10 per step over some thousand steps; the fixed path stops at a change of 1e-5
    EXPECT_LT(worst, solver == Solver::automatic || solver == Solver::fixed ? 1e-6 : 1e-7) << run.summary.solver;
    const Eigen::VectorXd balance =
        2 * run.a + 1.5 * run.x.col(1) + 800 * run.x.col(0) - force.refined(1)(Eigen::seqN(0, run.x.rows(), 2));
    EXPECT_LT(balance.cwiseAbs().maxCoeff(), 1e-9) << run.summary.solver;  // m a + f = F on every row
  }
}

TEST(FreeRun, OfTheFixedPathConvergesInFifthOrder) {
  const System system(model_of("1", "0.5*v + 100*y + 3000*y^3"));
  const Excitation force = force_of(2, 0.02, [](double t) { return 5 * std::sin(9 * t); });
  const Eigen::VectorXd x0 = state({0.05, 0});
  const lunid::Run fine = simulate(system, {}, force, x0, with_substeps(64));
  double previous = 0;
  for (const int substeps : {1, 2, 4}) {
    const double error =
        (simulate(system, {}, force, x0, with_substeps(substeps)).x.col(0) - fine.x.col(0)).cwiseAbs().maxCoeff();
    if (previous > 0) {
      EXPECT_GT(previous / error, 22);  // 32 in the limit
      EXPECT_LT(previous / error, 45);
    }
    previous = error;
  }
}

// y'' + alpha y + beta y^3 = 0 from rest at A: y = A cn(w t | k), w^2 = alpha + beta A^2, k^2 = beta A^2 / (2 w^2),
// period 4 K(k) / w (Kovacic & Brennan 2011, The Duffing equation, section 2).
TEST(FreeRun, OfDuffingHasItsExactPeriod) {
  const System system(model_of("1", "alpha*y + beta*y^3"));
  const double A = 0.7, alpha = 10, beta = 60, w = std::sqrt(alpha + beta * A * A);
  const double period = 4 * std::comp_ellint_1(std::sqrt(beta * A * A / 2) / w) / w;
  const auto theta = theta_of(system, {{"alpha", alpha}, {"beta", beta}});
  for (const Solver solver : all_solvers) {
    SimulateOptions options = with_solver(solver, 1e-11);
    if (solver == Solver::fixed) options.substeps = 8;
    const lunid::Run run = simulate(system, theta, zero_force(10 * period, period / 100), state({A, 0}), options);
    const double tolerance = solver == Solver::automatic ? 1e-5 : 1e-7;
    EXPECT_NEAR(run.x(1000, 0), A, tolerance) << run.summary.solver;       // after ten periods
    EXPECT_NEAR(run.x(1000, 1), 0, 20 * tolerance) << run.summary.solver;  // a phase error shows here first
    const auto y = run.x.col(0).array(), v = run.x.col(1).array();
    const Eigen::ArrayXd energy = 0.5 * v.square() + 0.5 * alpha * y.square() + 0.25 * beta * y.pow(4);
    EXPECT_LT((energy / energy[0] - 1).abs().maxCoeff(), 10 * tolerance) << run.summary.solver;
  }
}

// y'' + sin y = 0 from rest at y0: period 4 K(sin(y0 / 2)).
TEST(FreeRun, OfAPendulumHasItsExactPeriod) {
  const System system(model_of("1", "sin(y)"));
  const double y0 = 2.5, period = 4 * std::comp_ellint_1(std::sin(y0 / 2));
  for (const Solver solver : sundials_solvers) {
    const lunid::Run run =
        simulate(system, {}, zero_force(5 * period, period / 50), state({y0, 0}), with_solver(solver, 1e-11));
    EXPECT_NEAR(run.x(250, 0), y0, 1e-7) << run.summary.solver;
    EXPECT_NEAR(run.x(250, 1), 0, 1e-7) << run.summary.solver;
  }
  EXPECT_NEAR(simulate(system, {}, zero_force(5 * period, period / 50), state({y0, 0}), with_substeps(16)).x(250, 0),
              y0, 1e-7);
}

// A mass flies at v0 onto a spring at g, stays on it for pi sqrt(m / kc) and flies back at -v0.
TEST(FreeRun, AgainstAOneSidedStopBouncesAfterHalfAPeriod) {
  const System system(model_of("2", "kc*max(y - g, 0)"));
  const auto theta = theta_of(system, {{"kc", 5000}, {"g", 0.1}});
  const double v0 = 1.5, w = std::sqrt(5000 / 2.0), hit = 0.1 / v0, leave = hit + std::numbers::pi / w;
  for (const Solver solver : {Solver::fixed, Solver::bdf, Solver::adams, Solver::rk45}) {
    SimulateOptions options = with_solver(solver, 1e-11);
    if (solver == Solver::fixed) options.substeps = 8;
    const lunid::Run run = simulate(system, theta, zero_force(0.3, 0.003), state({0, v0}), options);
    EXPECT_EQ(run.summary.events, 2) << run.summary.solver;
    for (Eigen::Index i = 0; i < run.x.rows(); ++i) {
      const double t = 0.003 * static_cast<double>(i);
      const double y = t < hit ? v0 * t : t < leave ? 0.1 + v0 / w * std::sin(w * (t - hit)) : 0.1 - v0 * (t - leave);
      EXPECT_NEAR(run.x(i, 0), y, 1e-7) << run.summary.solver << " at " << t;
    }
    EXPECT_NEAR(run.x(run.x.rows() - 1, 1), -v0, 2e-6) << run.summary.solver;
  }
}

// Bouc-Wen by a Runge-Kutta loop written here, with steps so small that its kinks do not matter.
TEST(FreeRun, OfBoucWenIsThatOfAFineHandWrittenLoop) {
  const System system(
      model_of("1", "c*v + k*z", {{"z", "v - beta*abs(v)*abs(z)^(n - 1)*z - gamma*v*abs(z)^n", "", ""}}));
  const double c = 0.4, k = 60, beta = 9, gamma = 4, n = 2;
  const auto theta = theta_of(system, {{"c", c}, {"k", k}, {"beta", beta}, {"gamma", gamma}, {"n", n}});
  const auto force = [](double t) { return 8 * std::sin(4 * t) + 3 * std::sin(11 * t); };
  double y = 0.01, v = 0, z = 0.02;
  const auto rate = [&](double t, const double* x, double* f) {
    f[0] = x[1];
    f[1] = force(t) - c * x[1] - k * x[2];
    f[2] = x[1] - beta * std::abs(x[1]) * std::pow(std::abs(x[2]), n - 1) * x[2] -
           gamma * x[1] * std::pow(std::abs(x[2]), n);
  };
  const int rows = 301, parts = 200;
  const double dt = 0.02, h = dt / parts;
  Eigen::MatrixXd fine(rows, 3);
  for (int row = 0; row < rows; ++row) {
    fine.row(row) << y, v, z;
    for (int j = 0; j < parts; ++j) {
      const double t = dt * row + h * j;
      double k1[3], k2[3], k3[3], k4[3], x[3] = {y, v, z}, s[3];
      rate(t, x, k1);
      for (int i = 0; i < 3; ++i) s[i] = x[i] + h / 2 * k1[i];
      rate(t + h / 2, s, k2);
      for (int i = 0; i < 3; ++i) s[i] = x[i] + h / 2 * k2[i];
      rate(t + h / 2, s, k3);
      for (int i = 0; i < 3; ++i) s[i] = x[i] + h * k3[i];
      rate(t + h, s, k4);
      for (int i = 0; i < 3; ++i) x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
      y = x[0];
      v = x[1];
      z = x[2];
    }
  }
  const Excitation excitation = force_of(dt * (rows - 1), dt, force);
  for (const Solver solver : {Solver::fixed, Solver::bdf, Solver::adams, Solver::rk45}) {
    SimulateOptions options = with_solver(solver, 1e-10);
    if (solver == Solver::fixed) options.substeps = 8;
    const lunid::Run run = simulate(system, theta, excitation, state({0.01, 0, 0.02}), options);
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    EXPECT_LT((run.x - fine).cwiseAbs().maxCoeff(), 3e-7) << run.summary.solver;
  }
}

// An elastic-slip element under a prescribed large motion yields at its limit; a rate bound written as a state's max.
TEST(FreeRun, HoldsAStateAtItsBoundAndLetsItGo) {
  // a soft heavy mass swings freely; the element's force is negligible, so its path is known: r follows k dy within +-R
  const System system(model_of("1e6", "1e6*4*y + r", {{"r", "k*v", "-R", "R"}}));
  const auto theta = theta_of(system, {{"k", 10}, {"R", 3}});
  for (const Solver solver : {Solver::fixed, Solver::bdf, Solver::adams, Solver::rk45}) {
    SimulateOptions options = with_solver(solver, 1e-10);
    if (solver == Solver::fixed) options.substeps = 4;
    const lunid::Run run = simulate(system, theta, zero_force(6, 0.01), state({1, 0, 0}), options);
    double r = 0, y = 1;  // the play operator, exact on y = cos 2t up to 1e-5 of back-action
    for (Eigen::Index i = 1; i < run.x.rows(); ++i) {
      const double t = 0.01 * static_cast<double>(i);
      for (int part = 1; part <= 100; ++part) {
        const double next = std::cos(2 * (t - 0.01 + 0.0001 * part));
        r = std::clamp(r + 10 * (next - y), -3.0, 3.0);
        y = next;
      }
      EXPECT_NEAR(run.x(i, 2), r, 2e-4) << run.summary.solver << " at " << t;
    }
    EXPECT_EQ(run.x.col(2).maxCoeff(), 3) << run.summary.solver;
    EXPECT_EQ(run.x.col(2).minCoeff(), -3) << run.summary.solver;
    EXPECT_EQ(run.summary.events, 7) << run.summary.solver;  // 4 reached (once per half swing), 3 let go
  }
}

TEST(FreeRun, OfAllSolversAgreesOnASampledForce) {
  const System system(model_of("1", "c*v + k*y + k3*y^3 + Fc*sign(v) + kc*max(y - g, 0)"));
  const auto theta = theta_of(system, {{"c", 0.5}, {"k", 90}, {"k3", 400}, {"Fc", 2.5}, {"kc", 900}, {"g", 0.06}});
  std::vector<double> force(401);
  for (int i = 0; i < 401; ++i) force[i] = 6 * std::sin(0.06 * i) + 3 * std::sin(0.231 * i + 1);
  for (const Interpolation kind :
       {Interpolation::hold, Interpolation::linear, Interpolation::cubic, Interpolation::band_limited}) {
    const Excitation excitation(0.5, 0.01, force, kind);
    const lunid::Run fixed = simulate(system, theta, excitation, state({0, 0}), with_substeps(8));
    ASSERT_TRUE(fixed.summary.completed);
    EXPECT_GT(fixed.summary.stuck, 0);
    for (const Solver solver : sundials_solvers) {
      const lunid::Run run = simulate(system, theta, excitation, state({0, 0}), with_solver(solver, 1e-9));
      ASSERT_TRUE(run.summary.completed) << run.summary.cause;
      // both know y (0.1 m) to some 1e-9 per step; impacts and stops amplify that
      EXPECT_LT((run.x.col(0) - fixed.x.col(0)).cwiseAbs().maxCoeff(), 2e-6)
          << run.summary.solver << " " << to_string(kind);
      EXPECT_NEAR(run.summary.stuck, fixed.summary.stuck, 1e-4) << run.summary.solver << " " << to_string(kind);
    }
  }
}

TEST(FreeRun, TakesTheImplicitMethodWhereTheModelIsStiff) {
  const System system(model_of("1", "k*y + c*v + s", {{"s", "(e*y - s)/tau", "", ""}}));
  const auto theta = theta_of(system, {{"k", 30}, {"c", 0.5}, {"e", 10}, {"tau", 1e-6}});
  const lunid::Run run =
      simulate(system, theta, force_of(2, 0.01, [](double t) { return std::sin(3 * t); }), state({0, 0, 0}));
  ASSERT_TRUE(run.summary.completed) << run.summary.cause;
  EXPECT_EQ(run.summary.solver, "CVODE BDF (auto: explicit steps would need more than 64 per sample)");
  for (Eigen::Index i = 0; i < run.x.rows(); ++i)  // s follows e y at once; k + e is the stiffness
    EXPECT_NEAR(run.x(i, 0), linear(1, 0.5, 40, 1, 3, 0, 0, 0, 0.01 * i), 1e-6);
}

// A state that becomes stiff half-way: at the start nothing tells of it, and explicit steps explode there.
TEST(FreeRun, TakesTheImplicitMethodWhereExplicitStepsExplode) {
  const System system(model_of("1", "4*y + s", {{"s", "rate*(1 + tanh(1000*(t - 0.5)))*(5*y - s)", "", ""}}));
  const auto theta = theta_of(system, {{"rate", 1e7}});
  const lunid::Run run = simulate(system, theta, zero_force(2, 0.01), state({1, 0, 0}));
  ASSERT_TRUE(run.summary.completed) << run.summary.cause;
  EXPECT_EQ(run.summary.solver, "CVODE BDF (auto: explicit steps explode)");
  const double y = std::cos(1), v = -2 * std::sin(1);  // at t = 0.5; from there on the stiffness is 4 + 5
  for (Eigen::Index i = 51; i < run.x.rows(); ++i) {
    const double t = 0.01 * static_cast<double>(i) - 0.5;
    EXPECT_NEAR(run.x(i, 0), y * std::cos(3 * t) + v / 3 * std::sin(3 * t), 0.03);  // it begins 8 ms earlier
  }
}

TEST(FreeRun, IsTheSameInEveryThread) {
  const System system(model_of("1", "k*y + 0.5*v + Fc*sign(v)"));
  std::vector<double> force(301);
  for (int i = 0; i < 301; ++i) force[i] = 6 * std::sin(0.06 * i) + 3 * std::sin(0.231 * i + 1);
  const Excitation excitation(0, 0.01, force, Interpolation::band_limited);
  const auto run_of = [&](int i) {
    return simulate(system, std::vector<double>{90.0 + i, 0.8}, excitation, state({0, 0}), with_substeps(1 + i % 3));
  };
  std::vector<Eigen::MatrixXd> found(12);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = t; i < 12; i += 4) found[i] = run_of(i).x;
    });
  for (std::thread& thread : threads) thread.join();
  for (int i = 0; i < 12; ++i) EXPECT_EQ((found[i] - run_of(i).x).cwiseAbs().maxCoeff(), 0) << i;
}

TEST(FreeRun, ChoosesSubstepsByTheFastestMotion) {
  const System slow(model_of("1", "1*y + 0.01*v")), fast(model_of("1", "1e4*y + 0.01*v"));
  const Excitation force = force_of(5, 0.01, [](double t) { return std::sin(t); });
  EXPECT_EQ(choose_substeps(slow, {}, force, state({0, 0})), 1);
  const int many = choose_substeps(fast, {}, force, state({0.1, 0}));
  EXPECT_GE(many, 8);  // 500 rad at 1 rad per sample: phase error 500 h^4 / 120 < 1e-5 needs h < 0.04
  EXPECT_LE(many, 64);
  const lunid::Run run = simulate(slow, {}, force, state({0, 0}));
  EXPECT_EQ(run.summary.solver, "fixed DP5, 2 substeps");  // the finer of the two runs that were compared
  EXPECT_LT(run.summary.error, 1e-5);
}

/// No number of substeps would do; what is at the limit is run, and says so itself.
TEST(FreeRun, ChoosesTheMostSubstepsForAMotionWithoutBound) {
  const System system(model_of("1", "1e40*y"));
  const Excitation force = force_of(5, 0.01, [](double) { return 0.0; });
  EXPECT_EQ(choose_substeps(system, {}, force, state({0.1, 0})), 64);
}

TEST(FreeRun, RepeatsBitForBit) {
  const System system(model_of("1", "90*y + 0.5*v + 0.8*sign(v)"));
  const Excitation force = force_of(3, 0.01, [](double t) { return 4 * std::sin(6 * t); });
  const lunid::Run a = simulate(system, {}, force, state({0.1, 0})), b = simulate(system, {}, force, state({0.1, 0}));
  EXPECT_EQ((a.x - b.x).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ((a.a - b.a).cwiseAbs().maxCoeff(), 0);
}

}  // namespace
}  // namespace lunid
