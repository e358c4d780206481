// Sensitivities by CVODES: against the fixed path, differences of runs, closed forms.
#include <Eigen/Dense>

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

double sweep(double t) { return 3 * std::sin(2 * std::numbers::pi * (1 + 0.3 * t) * t) + 1; }

/// Largest difference of two sensitivities, over the largest entry of each column.
double worst_of(const std::vector<Eigen::MatrixXd>& a, const std::vector<Eigen::MatrixXd>& b) {
  double worst = 0;
  for (std::size_t state = 0; state < a.size(); ++state)
    for (Eigen::Index c = 0; c < a[state].cols(); ++c) {
      const double scale = b[state].col(c).cwiseAbs().maxCoeff();
      const double difference = (a[state].col(c) - b[state].col(c)).cwiseAbs().maxCoeff();
      worst = std::max(worst, scale > 0 ? difference / scale : difference);
    }
  return worst;
}

struct Case {
  const char* name;
  Model model;
  std::vector<std::pair<std::string, double>> theta;
  Eigen::VectorXd x0;
  double frequency;  ///< [rad/s] of a force of 3 N; 0: the sweep
  int events;        ///< at least
  double tolerance;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

// The tolerance of runs over many switches is that of their places: each jump moves by the slope times the error there.
std::vector<Case> cases() {
  return {
      {"smooth",
       model_of("m", "c*v + k*y + k3*y^3"),
       {{"m", 1.3}, {"c", 0.4}, {"k", 40}, {"k3", 90}},
       state({0.1, -0.3}),
       0,
       0,
       1e-6},
      {"zero_parameter",
       model_of("m", "c*v + k*y + k3*y^3"),
       {{"m", 1.3}, {"c", 0}, {"k", 40}, {"k3", 0}},
       state({0.1, -0.3}),
       0,
       0,
       1e-6},
      {"state",
       model_of("1", "k*y + s + c*v", {{"s", "e*v - s/tau", "", ""}}),
       {{"k", 30}, {"c", 0.1}, {"e", 50}, {"tau", 0.2}},
       state({0.1, 0, 0.2}),
       0,
       0,
       1e-6},
      {"impact",
       model_of("1", "c*v + k*y + kc*max(y - g, 0)"),
       {{"c", 0.3}, {"k", 30}, {"kc", 4000}, {"g", 0.05}},
       state({0.01, 0.3}),
       0,
       8,
       1e-5},
      {"stop",
       model_of("1", "c*v + k*y + where(y > g, F0, 0)"),
       {{"c", 0.3}, {"k", 30}, {"F0", 2}, {"g", 0.05}},
       state({0.01, 0.3}),
       0,
       8,
       1e-5},
      {"friction",
       model_of("m", "c*v + k*y + Fc*sign(v)"),
       {{"m", 1.1}, {"c", 0.2}, {"k", 30}, {"Fc", 1.2}},
       state({0.05, 0.4}),
       3,
       3,
       1e-5},
      {"slip",
       model_of("m", "c*v + r", {{"r", "k*v", "-R", "R"}}),
       {{"m", 1.1}, {"c", 0.5}, {"k", 60}, {"R", 1.5}},
       state({0.02, 0.1, 0.3}),
       3,
       4,
       1e-5},
      {"moving_bound",
       model_of("m", "c*v + k*(y - ys)", {{"ys", "0", "y - R/k", "y + R/k"}}),
       {{"m", 1.1}, {"c", 0.5}, {"k", 60}, {"R", 1.5}},
       state({0.02, 0.1, 0.015}),
       3,
       4,
       1e-5},
  };
}

class Cvodes : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Models, Cvodes, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(Cvodes, SensitivitiesAreThoseOfTheFixedPath) {
  const Case& c = GetParam();
  const System system(c.model);
  const auto theta = theta_of(system, c.theta);
  const Excitation force = c.frequency > 0 ? force_of(4, 0.01, [&](double t) { return 3 * std::sin(c.frequency * t); })
                                           : force_of(4, 0.01, sweep);
  const SensitivityRun fixed = simulate_sensitivities(system, theta, force, c.x0, with_substeps(8));
  ASSERT_TRUE(fixed.run.summary.completed) << fixed.run.summary.cause;
  EXPECT_GE(fixed.run.summary.events, c.events);
  for (const Solver solver : {Solver::bdf, Solver::adams}) {
    const SensitivityRun run = simulate_sensitivities(system, theta, force, c.x0, with_solver(solver, 1e-9));
    ASSERT_TRUE(run.run.summary.completed) << run.run.summary.cause;
    EXPECT_EQ(run.run.summary.solver, solver == Solver::bdf ? "CVODE BDF" : "CVODE Adams");
    EXPECT_LT(worst_of(run.dx, fixed.dx), c.tolerance) << run.run.summary.solver;
    const lunid::Run plain = simulate(system, theta, force, c.x0, with_solver(solver, 1e-9));
    EXPECT_LT((run.run.x - plain.x).cwiseAbs().maxCoeff(), 1e-5) << run.run.summary.solver;  // other steps
    EXPECT_EQ(run.run.summary.events, plain.summary.events);
  }
}

// x' = A x: dx/dx0 = exp(A t) by its eigenvectors, dx/dtheta = int exp(A (t - s)) dA/dtheta x(s) ds, which is the upper
// right block of the exponential of [[A, dA], [0, A]] (Van Loan 1978, IEEE TAC 23, 395).
TEST(CvodesSensitivities, OfALinearModelAreItsClosedForm) {
  const System system(model_of("1", "k*y + c*v"));
  const double k = 400, c = 3;
  const auto theta = theta_of(system, {{"k", k}, {"c", c}});
  const auto column = [&](const std::string& name) { return system.model().parameters[0].name == name ? 0 : 1; };
  const Eigen::Vector2d x0(0.1, 0.4);
  Eigen::Matrix2d A;
  A << 0, 1, -k, -c;
  for (const Solver solver : {Solver::bdf, Solver::adams}) {
    const SensitivityRun run =
        simulate_sensitivities(system, theta, zero_force(2, 0.01), x0, with_solver(solver, 1e-10));
    double worst = 0;
    for (const auto& [name, slope] : {std::pair("k", Eigen::Vector2d(1, 0)), std::pair("c", Eigen::Vector2d(0, 1))})
      for (Eigen::Index row = 0; row < run.run.x.rows(); row += 20) {
        Eigen::Matrix4d block = Eigen::Matrix4d::Zero();
        block.topLeftCorner<2, 2>() = block.bottomRightCorner<2, 2>() = A;
        block.block<1, 2>(1, 2) = -slope.transpose();
        // exp by scaling and squaring of a long Taylor series
        const double t = 0.01 * static_cast<double>(row);
        Eigen::Matrix4d step = block * std::ldexp(t, -12), e = Eigen::Matrix4d::Identity(), term = e;
        for (int i = 1; i < 12; ++i) e += term = term * step / i;
        for (int i = 0; i < 12; ++i) e = e * e;
        const Eigen::Vector2d exact = e.topRightCorner<2, 2>() * x0;
        const double scale = name[0] == 'k' ? 1e-3 : 1e-1;
        worst = std::max(worst, std::abs(run.dy()(row, column(name)) - exact[0]) / (0.1 * scale));
        for (int i = 0; i < 2; ++i)
          worst = std::max(worst, std::abs(run.dv()(row, 2 + i) - e(1, i)) / (i == 0 ? 20 : 1));
      }
    EXPECT_LT(worst, 1e-6) << run.run.summary.solver;
  }
}

/// Central differences of runs of a tighter tolerance, at a row, over the largest entry of each column.
double worst_difference(const System& system, const std::vector<double>& theta, const Excitation& force,
                        const Eigen::VectorXd& x0, Solver solver, double step) {
  const SensitivityRun exact = simulate_sensitivities(system, theta, force, x0, with_solver(solver, 1e-8));
  EXPECT_TRUE(exact.run.summary.completed) << exact.run.summary.cause;
  double worst = 0;
  for (int c = 0; c < system.parameters(); ++c) {
    std::vector<double> up = theta, down = theta;
    const double h = step * std::abs(theta[c]);
    up[c] += h;
    down[c] -= h;
    const auto tight = with_solver(solver, 1e-12);
    const Eigen::MatrixXd difference =
        (simulate(system, up, force, x0, tight).x - simulate(system, down, force, x0, tight).x) / (2 * h);
    for (int i = 0; i < system.states(); ++i) {
      const double scale = difference.col(i).cwiseAbs().maxCoeff();
      if (scale == 0) continue;
      worst = std::max(worst, (exact.dx[i].col(c) - difference.col(i)).cwiseAbs().maxCoeff() / scale);
    }
  }
  return worst;
}

// Robertson's kinetics over 12 decades of rates (Hairer & Wanner, Solving ODEs II, IV.1), and the relaxation
// oscillation: no explicit method carries their sensitivities.
TEST(CvodesSensitivities, OfStiffModelsAreThoseOfTheRun) {
  const System robertson(model_of("1", "y",
                                  {{"z1", "-p1*z1 + p2*z2*z3", "", "", 1},
                                   {"z2", "p1*z1 - p2*z2*z3 - p3*z2^2", "", "", 0},
                                   {"z3", "p3*z2^2", "", "", 0}}));
  const auto rates = theta_of(robertson, {{"p1", 0.04}, {"p2", 1e4}, {"p3", 3e7}});
  // codes end Robertson at 2000 times their tolerance (simulate_stiff_test.cpp): 2e-9 of the runs over steps of 1e-4
  EXPECT_LT(worst_difference(robertson, rates, zero_force(40, 2), state({0, 0, 1, 0, 0}), Solver::bdf, 1e-4), 5e-5);
  const System van_der_pol(model_of("1", "y - mu*(1 - y^2)*v"));
  EXPECT_LT(worst_difference(van_der_pol, theta_of(van_der_pol, {{"mu", 1000}}), zero_force(700, 1), state({2, 0}),
                             Solver::bdf, 1e-4),
            1e-5);
}

// d period / d mu of the relaxation oscillation, by Dorodnitsyn's series for the period (simulate_stiff_test.cpp): on
// the limit cycle a change of mu moves the time of each zero by as much as it has lengthened the periods before.
TEST(CvodesSensitivities, OfTheRelaxationOscillationGiveTheSlopeOfItsPeriod) {
  const System system(model_of("1", "y - mu*(1 - y^2)*v"));
  const double mu = 20;
  const SensitivityRun run = simulate_sensitivities(system, std::vector<double>{mu}, zero_force(150, 0.01),
                                                    state({2, 0}), with_solver(Solver::bdf, 1e-9));
  ASSERT_TRUE(run.run.summary.completed) << run.run.summary.cause;
  std::vector<double> moved;  // dt/dmu of each rise through y = 1, where the motion is fast
  for (Eigen::Index i = 0; i + 1 < run.run.x.rows(); ++i) {
    if (!(run.run.x(i, 0) < 1 && run.run.x(i + 1, 0) >= 1)) continue;
    const double part = (1 - run.run.x(i, 0)) / (run.run.x(i + 1, 0) - run.run.x(i, 0));
    const auto shift = [&](Eigen::Index row) { return -run.dy()(row, 0) / run.run.x(row, 1); };
    moved.push_back(shift(i) + part * (shift(i + 1) - shift(i)));
  }
  ASSERT_GE(moved.size(), 3);
  const auto period = [](double m) {
    return (3 - 2 * std::log(2.0)) * m + 7.01432 * std::pow(m, -1.0 / 3) - 22.0 / 9 * std::log(m) / m + 0.0087 / m;
  };
  const double slope = (period(mu + 0.01) - period(mu - 0.01)) / 0.02;
  // the series itself is good to O(mu^(-4/3)), 2e-2 of the period and less of its slope
  EXPECT_NEAR(moved[2] - moved[1], slope, 0.01 * slope);
}

TEST(CvodesSensitivities, AreTakenByTheAutomaticChoiceWhereAModelIsStiff) {
  const System system(model_of("1", "y - mu*(1 - y^2)*v"));
  const SensitivityRun run =
      simulate_sensitivities(system, std::vector<double>{1000}, zero_force(700, 1), state({2, 0}));
  EXPECT_EQ(run.run.summary.solver, "CVODE BDF (auto: explicit steps would need more than 64 per sample)");
  const SensitivityRun bdf = simulate_sensitivities(system, std::vector<double>{1000}, zero_force(700, 1),
                                                    state({2, 0}), with_solver(Solver::bdf));
  EXPECT_EQ(run.dy(), bdf.dy());
  EXPECT_EQ(simulate_sensitivities(system, std::vector<double>{0.1}, zero_force(7, 0.01), state({2, 0}))
                .run.summary.solver.substr(0, 9),
            "fixed DP5");
}

/// Near rest |v|^0.01 falls ever faster: the steps shrink below the smallest number, where CVode says that it has
/// arrived.
TEST(CvodesSensitivities, OfARunThatEndsBeforeItsTimeAreAFailedRun) {
  const System system(model_of("0.03", "c*v + k*y + d*abs(v)^p*sign(v)"));
  const auto theta = theta_of(system, {{"c", 0.15}, {"k", 30}, {"d", 1.1}, {"p", 0.01}});
  const SensitivityRun run =
      simulate_sensitivities(system, theta, zero_force(0.15, 0.015), state({0.017, 0.5}), with_solver(Solver::bdf));
  EXPECT_FALSE(run.run.summary.completed);
  EXPECT_LT(run.run.summary.stopped_at, 0.15);
}

}  // namespace
}  // namespace lunid
