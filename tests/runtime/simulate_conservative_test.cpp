// Linear and conservative systems against closed forms: Duhamel's integral, elliptic functions, the drift of the energy
// over ten thousand periods.
#include "simulate_models.hpp"
#include "simulate_pieces.hpp"

namespace lunid {
namespace {

using testing::LinearPiece;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_solver;
using testing::with_substeps;
using testing::zero_force;

constexpr double pi = std::numbers::pi;

struct DuhamelCase {
  const char* name;
  double c;
  Interpolation between;
};

class Duhamel : public ::testing::TestWithParam<DuhamelCase> {};
INSTANTIATE_TEST_SUITE_P(Damping, Duhamel,
                         ::testing::Values(DuhamelCase{"none", 0, Interpolation::linear},
                                           DuhamelCase{"light", 1.5, Interpolation::linear},
                                           DuhamelCase{"overcritical", 200, Interpolation::linear},
                                           DuhamelCase{"light_held", 1.5, Interpolation::hold}),
                         [](const auto& info) { return std::string(info.param.name); });

// Duhamel's integral of a force that is straight between its samples is a recursion that is exact (Nigam & Jennings
// 1969, Bull. Seism. Soc. Am. 59, 909). The force is noise: a kink at every sample.
TEST_P(Duhamel, OfASampledForceIsMetByEverySolver) {
  const double m = 2, k = 800, dt = 0.01;
  const auto [name, c, between] = GetParam();
  std::vector<double> force(301);
  for (std::size_t i = 0; i < force.size(); ++i)
    force[i] = 30 * std::sin(15 * dt * static_cast<double>(i)) + 20 * std::sin(12.9898 * static_cast<double>(i * i));
  Eigen::MatrixXd exact(301, 2);
  exact.row(0) << 0.02, -0.3;
  for (int i = 0; i < 300; ++i) {
    const double slope = between == Interpolation::hold ? 0 : (force[i + 1] - force[i]) / dt;
    const LinearPiece piece({.m = m, .c = c, .k = k, .A = force[i], .B = slope}, 0, exact(i, 0), exact(i, 1));
    exact.row(i + 1) << piece.y(dt), piece.v(dt);
  }
  const System system(model_of("m", "c*v + k*y"));
  const auto theta = theta_of(system, {{"m", m}, {"c", c}, {"k", k}});
  const double scale = exact.col(0).cwiseAbs().maxCoeff();
  for (const Solver solver : all_solvers()) {
    const lunid::Run run =
        simulate(system, theta, Excitation(0, dt, force, between), state({0.02, -0.3}), with_solver(solver, 1e-10));
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    // ours stop at a change of 1e-5; Runge-Kutta stops at the kinks, multistep methods run over them and err there
    const double tolerance = solver == Solver::automatic || solver == Solver::fixed ? 1e-5
                             : solver == Solver::bdf || solver == Solver::adams     ? 5e-6
                                                                                    : 1e-8;
    EXPECT_LT((run.x.col(0) - exact.col(0)).cwiseAbs().maxCoeff(), tolerance * scale) << run.summary.solver;
    EXPECT_LT((run.x.col(1) - exact.col(1)).cwiseAbs().maxCoeff(), tolerance * scale * 20) << run.summary.solver;
  }
  EXPECT_LT(
      (simulate(system, theta, Excitation(0, dt, force, between), state({0.02, -0.3}), with_substeps(16)).x - exact)
          .cwiseAbs()
          .maxCoeff(),
      1e-10);
}

struct Jacobi {
  double sn, cn, dn;
};

/// Jacobi's elliptic functions of parameter m = k^2, by the arithmetic-geometric mean (Abramowitz & Stegun 16.4).
Jacobi jacobi(double u, double m) {
  double a[16] = {1}, c[16] = {std::sqrt(m)}, b = std::sqrt(1 - m);
  int n = 0;
  while (n < 15 && std::abs(c[n]) > 1e-17) {
    a[n + 1] = 0.5 * (a[n] + b);
    c[n + 1] = 0.5 * (a[n] - b);
    b = std::sqrt(a[n] * b);
    ++n;
  }
  double phi = std::ldexp(a[n] * u, n);
  for (int i = n; i > 0; --i) phi = 0.5 * (phi + std::asin(c[i] / a[i] * std::sin(phi)));
  const double sn = std::sin(phi);
  return {sn, std::cos(phi), std::sqrt(1 - m * sn * sn)};
}

TEST(Jacobi, MeetsTheCompleteIntegralAndItsOwnDerivative) {
  for (const double m : {0.1, 0.5, 0.93}) {
    const double K = std::comp_ellint_1(std::sqrt(m));
    EXPECT_NEAR(jacobi(K, m).cn, 0, 1e-14);
    EXPECT_NEAR(jacobi(K, m).dn, std::sqrt(1 - m), 1e-14);
    const double h = 1e-4, u = 0.7;
    EXPECT_NEAR((jacobi(u + h, m).sn - jacobi(u - h, m).sn) / (2 * h), jacobi(u, m).cn * jacobi(u, m).dn, 1e-7);
  }
}

struct DuffingCase {
  const char* name;
  double alpha, beta, A;
};

/// y'' + alpha y + beta y^3 = 0 from rest at A (Kovacic & Brennan 2011, The Duffing equation, section 2): cn where it
/// hardens, cd where it softens, dn within one of two wells.
std::pair<double, double> duffing(const DuffingCase& c, double t) {
  const double b = c.beta * c.A * c.A;
  if (c.beta < 0) {
    const double w = std::sqrt(c.alpha + b / 2), m = -b / (2 * c.alpha + b);
    const auto [sn, cn, dn] = jacobi(w * t, m);
    return {c.A * cn / dn, -c.A * w * (1 - m) * sn / (dn * dn)};
  }
  if (c.alpha < 0) {
    const double w = std::sqrt(b / 2), m = 2 + 2 * c.alpha / b;
    const auto [sn, cn, dn] = jacobi(w * t, m);
    return {c.A * dn, -c.A * w * m * sn * cn};
  }
  const double w = std::sqrt(c.alpha + b), m = b / (2 * w * w);
  const auto [sn, cn, dn] = jacobi(w * t, m);
  return {c.A * cn, -c.A * w * sn * dn};
}

class FreeDuffing : public ::testing::TestWithParam<DuffingCase> {};
INSTANTIATE_TEST_SUITE_P(Springs, FreeDuffing,
                         ::testing::Values(DuffingCase{"hardening", 10, 60, 0.7},
                                           DuffingCase{"cubic_alone", 0, 60, 0.7},
                                           DuffingCase{"softening", 10, -12, 0.8},
                                           DuffingCase{"in_a_well", -10, 20, 0.95}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(FreeDuffing, IsItsEllipticFunctionByEverySolver) {
  const DuffingCase& c = GetParam();
  const System system(model_of("1", "alpha*y + beta*y^3"));
  const auto theta = theta_of(system, {{"alpha", c.alpha}, {"beta", c.beta}});
  for (const Solver solver : all_solvers()) {
    SimulateOptions options = with_solver(solver, 1e-11);
    if (solver == Solver::fixed) options.substeps = 16;
    const lunid::Run run = simulate(system, theta, zero_force(20, 0.05), state({c.A, 0}), options);
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    double worst = 0;
    for (Eigen::Index i = 0; i < run.x.rows(); ++i) {
      const auto [y, v] = duffing(c, 0.05 * static_cast<double>(i));
      worst = std::max({worst, std::abs(run.x(i, 0) - y), std::abs(run.x(i, 1) - v) / 5});
    }
    EXPECT_LT(worst, solver == Solver::automatic ? 1e-5 : solver == Solver::bdf ? 2e-6 : 1e-7) << run.summary.solver;
  }
}

/// What Dormand and Prince's fifth-order method does to the energy of a linear oscillator in one step: |R(i w h)|^2
/// with its stability polynomial R (Hairer & Wanner, Solving ODEs II, IV.2).
double energy_factor(double wh) {
  const std::complex<double> z(0, wh);
  const auto R = 1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0 * (1.0 + z / 5.0 * (1.0 + z / 5.0)))));
  return std::norm(R);
}

// The drift is that of the stability polynomial to the last digits: the path adds nothing of its own.
TEST(Energy, OfALinearOscillatorFallsAsTheMethodSaysOverTenThousandPeriods) {
  const System system(model_of("1", "y"));
  const int per_period = 40;
  const double h = 2 * pi / per_period;
  const lunid::Run run =
      simulate(system, {}, zero_force(1e4 * 2 * pi, 2 * pi), state({1, 0}), with_substeps(per_period));
  ASSERT_TRUE(run.summary.completed) << run.summary.cause;
  const Eigen::Index last = run.x.rows() - 1;
  const double energy = run.x.row(last).squaredNorm();
  EXPECT_NEAR(std::log(energy), 1e4 * per_period * std::log(energy_factor(h)), 1e-9);
  EXPECT_LT(energy, 1);
}

struct Conservative {
  const char* name;
  const char* restoring;
  double y0, period, fastest;  ///< fastest: the largest frequency of the linearised motion [rad/s]
  std::function<double(double)> potential;
};

const Conservative conservative[] = {
    {"duffing", "10*y + 60*y^3", 0.7,
     4 * std::comp_ellint_1(std::sqrt(60 * 0.49 / 2 / (10 + 60 * 0.49))) / std::sqrt(10 + 60 * 0.49),
     std::sqrt(10 + 180 * 0.49), [](double y) { return 5 * y * y + 15 * std::pow(y, 4); }},
    {"pendulum", "sin(y)", 2.0, 4 * std::comp_ellint_1(std::sin(1.0)), 1, [](double y) { return 1 - std::cos(y); }},
};

double worst_drift(const Conservative& c, const lunid::Run& run) {
  double worst = 0;
  const double first = c.potential(c.y0);
  for (Eigen::Index i = 0; i < run.x.rows(); ++i)
    worst = std::max(worst, std::abs(c.potential(run.x(i, 0)) + 0.5 * run.x(i, 1) * run.x(i, 1) - first) / first);
  return worst;
}

// The fixed path loses no more than a linear oscillator of the fastest frequency would in as many steps.
TEST(Energy, OfConservativeSystemsOnTheFixedPathOverTenThousandPeriods) {
  for (const Conservative& c : conservative) {
    const System system(model_of("1", c.restoring));
    const int per_period = 128;
    const lunid::Run run =
        simulate(system, {}, zero_force(1e4 * c.period, c.period), state({c.y0, 0}), with_substeps(per_period));
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    const double promised = 1e4 * per_period * std::abs(std::log(energy_factor(c.fastest * c.period / per_period)));
    EXPECT_LT(worst_drift(c, run), promised) << c.name;
    EXPECT_LT(promised, 0.01) << c.name;
  }
}

struct DriftCase {
  Solver solver;
  double rtol;
  int system, periods;
};

// The energy errs by some times the tolerance at each step, all in one direction at worst: twenty for Runge-Kutta (the
// norm over two states, an energy of the fourth power), two hundred for CVODE, whose estimate of the error is loose.
TEST(Energy, OfConservativeSystemsBySundialsIsWithinWhatTheTolerancePromises) {
  const DriftCase table[] = {
      {Solver::rk78, 1e-10, 0, 10000}, {Solver::rk78, 1e-8, 1, 1000}, {Solver::adams, 1e-8, 0, 500},
      {Solver::adams, 1e-10, 1, 500},  {Solver::bdf, 1e-8, 1, 500},   {Solver::bdf, 1e-10, 0, 500},
      {Solver::esdirk, 1e-8, 0, 200},  {Solver::rk45, 1e-8, 1, 500},  {Solver::rk23, 1e-6, 1, 200}};
  for (const auto& [solver, rtol, which, periods] : table) {
    const Conservative& c = conservative[which];
    const System system(model_of("1", c.restoring));
    const lunid::Run run =
        simulate(system, {}, zero_force(periods * c.period, c.period), state({c.y0, 0}), with_solver(solver, rtol));
    ASSERT_TRUE(run.summary.completed) << run.summary.cause;
    const double per_step = solver == Solver::adams || solver == Solver::bdf ? 200 : 20;
    EXPECT_LT(worst_drift(c, run), per_step * rtol * static_cast<double>(run.summary.steps))
        << c.name << " by " << run.summary.solver << " in " << run.summary.steps << " steps";
  }
}

}  // namespace
}  // namespace lunid
