// Fits by the adjoint where parameters are many, and by CVODES where the model is stiff. Truth by other methods than
// those of the fit: ESDIRK for the stiff model, the reference to 1e-11 for the chain.
#include <random>

#include "simulate/fit.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::model_of;
using testing::model_of_many;
using testing::with_solver;

constexpr double dt = 0.01;

/// A record of a run's displacements and velocities with noise of a part of their spread.
Record record_of(const System& system, const std::vector<double>& theta, const Excitation& force, Solver solver,
                 const Eigen::VectorXd& x0, double noise, const std::string& channel) {
  const lunid::Run run = simulate(system, theta, Excitations().add(channel, force), x0, with_solver(solver, 1e-11));
  EXPECT_TRUE(run.summary.completed) << run.summary.cause;
  std::mt19937_64 bits(7);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Channel> channels;
  const auto add = [&](const std::string& name, const Eigen::VectorXd& values, double part) {
    Channel c;
    c.name = name;
    const double spread = std::sqrt((values.array() - values.mean()).square().mean());
    c.values = values.unaryExpr([&](double value) { return value + part * spread * normal(bits); });
    c.noise = part * spread;
    channels.push_back(std::move(c));
  };
  add(channel, force.samples(), 0);
  for (int i = 0; i < system.degrees(); ++i) {
    add(system.model().channel('y', i), run.x.col(2 * i), noise);
    add(system.model().channel('v', i), run.x.col(2 * i + 1), noise);
  }
  return Record("truth", 0, force.dt(), std::move(channels));
}

/// A force of many lines, known between its samples.
Excitation lines(int rows) {
  return Excitation(0, dt, rows, [](double t) {
    double sum = 0;
    for (int i = 1; i <= 30; ++i) sum += 3 * std::sin(1.7 * i * t + 0.37 * i * i);
    return sum;
  });
}

TEST(FitByAdjoint, FindsWhatLevenbergMarquardtFinds) {
  Model model = model_of_many({{"1", "k1*y1 + c1*v1 + q1*y1^3 - k2*(y2 - y1) - c2*(v2 - v1)"},
                               {"1", "k2*(y2 - y1) + c2*(v2 - v1) - k3*(y3 - y2) - c3*(v3 - v2)"},
                               {"1", "k3*(y3 - y2) + c3*(v3 - v2)"}});
  model.driven = {0};
  const System system(model);
  std::vector<double> exact, start;
  for (const Parameter& p : system.model().parameters) {
    exact.push_back(p.name[0] == 'k' ? 300 : p.name[0] == 'c' ? 1.5 : 4e3);
    start.push_back(exact.back() * (1 + 0.15 * std::cos(5.0 * static_cast<double>(start.size()))));
  }
  const Excitation force = lines(601);
  const std::vector<FitData> data{{record_of(system, exact, force, Solver::rk78, Eigen::VectorXd::Zero(6), 0.01, "F1"),
                                   Excitations().add("F1", force),
                                   {}}};
  const Eigen::VectorXd theta = Eigen::Map<const Eigen::VectorXd>(start.data(), 7);
  FitOptions options;
  options.channels = {"y1", "y2", "y3", "v1"};
  const FitResult forward = fit_progressively(system, theta, data, options);
  EXPECT_EQ(forward.gradient, Gradient::forward);  // seven parameters: of itself
  options.gradient = Gradient::adjoint;
  const FitResult adjoint = fit_progressively(system, theta, data, options);
  EXPECT_EQ(adjoint.gradient, Gradient::adjoint);
  EXPECT_TRUE(adjoint.converged) << adjoint.stopped;
  EXPECT_LT(adjoint.cost, forward.cost * (1 + 1e-4));
  for (Eigen::Index i = 0; i < 7; ++i) {
    const double std = std::sqrt(forward.covariance(i, i));
    EXPECT_NEAR(adjoint.theta[i], forward.theta[i], 0.1 * std) << i;
    EXPECT_NEAR(adjoint.theta[i], exact[static_cast<std::size_t>(i)], 4 * std) << i;
    EXPECT_NEAR(std::sqrt(adjoint.covariance(i, i)), std, 0.05 * std) << i;
  }
  options.loss = Loss::huber;
  const FitResult huber = fit_progressively(system, theta, data, options);
  EXPECT_TRUE(huber.converged) << huber.stopped;
  EXPECT_GT(huber.outliers, 0);
}

// A relaxation oscillator with mu = 300 on samples of 0.5 s: explicit steps would need thousands of substeps.
TEST(FitOfAStiffModel, GoesByCvodes) {
  const System system(model_of("1", "k*y - mu*(1 - y^2)*v"));
  const std::vector<double> exact{1, 300};
  ASSERT_EQ(system.model().parameters[0].name, "k");
  const Excitation force(0, 0.5, 301, [](double) { return 0.0; });
  const std::vector<FitData> data{
      {record_of(system, exact, force, Solver::esdirk, Eigen::Vector2d(2, 0), 0.002, "F"), Excitations(force), {}}};
  const FitResult fit = fit_trajectory(system, Eigen::Vector2d(1.03, 305), data);
  EXPECT_EQ(fit.solver, "CVODE BDF");
  EXPECT_TRUE(fit.converged) << fit.stopped;
  EXPECT_LT(std::sqrt(fit.cost / 301), 1.1 * data[0].record.channel("y").noise);
  // only k / mu shapes the slow branch: the ratio is what the record knows
  EXPECT_NEAR(fit.theta[0] / fit.theta[1], 1.0 / 300, 2e-3 / 300);
}

TEST(FitMethods, FaultsNameTheChoices) {
  FitOptions options;
  options.solver = Solver::rk45;
  EXPECT_EQ(fault_of([&] { validate(options); }),
            "fit_trajectory: solver: expected auto, fixed, bdf or adams, which carry sensitivities, got 'rk45'");
  options.solver = Solver::bdf;
  options.gradient = Gradient::adjoint;
  EXPECT_EQ(fault_of([&] { validate(options); }),
            "fit_trajectory: gradient: 'adjoint' is that of the fixed path; take 'forward' with solver 'bdf'");
  options.solver = Solver::automatic;
  options.whitening.average = 2;
  EXPECT_EQ(fault_of([&] { validate(options); }),
            "fit_trajectory: gradient: 'adjoint' takes residuals as they are; take 'forward' with a whitening");
}

}  // namespace
}  // namespace lunid
