// The adjoint: the gradient of a cost against forward sensitivities, through switches, at a cost that does not grow
// with the number of parameters.
#include "simulate/gradient.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::force_of;
using testing::model_of;
using testing::model_of_many;
using testing::state;
using testing::theta_of;
using testing::with_solver;
using testing::with_substeps;
using testing::zero_force;

double sweep(double t) { return 3 * std::sin(2 * std::numbers::pi * (1 + 0.3 * t) * t) + 1; }

/// Half the sum of squares of y and v against a motion that is none of the model's.
double residual(const Run& run, Eigen::MatrixXd& slope) {
  double cost = 0;
  for (Eigen::Index row = 0; row < run.x.rows(); ++row)
    for (int i = 0; i < 2; ++i) {
      const double error = run.x(row, i) - (i == 0 ? 0.02 : 0.3) * std::sin(0.07 * static_cast<double>(row));
      cost += 0.5 * error * error;
      slope(row, i) = error;
    }
  return cost;
}

/// The same gradient by forward sensitivities of the same steps.
Eigen::VectorXd by_sensitivities(const System& system, const std::vector<double>& theta, const Excitations& force,
                                 const Eigen::VectorXd& x0, const SimulateOptions& options) {
  const SensitivityRun run = simulate_sensitivities(system, theta, force, x0, options);
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(run.run.x.rows(), run.run.x.cols());
  residual(run.run, slope);
  return run.dy().transpose() * slope.col(0) + run.dv().transpose() * slope.col(1);
}

double worst(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return ((a - b).array() / b.array().abs().max(1e-12 * b.cwiseAbs().maxCoeff())).abs().maxCoeff();
}

struct Case {
  const char* name;
  Model model;
  std::vector<std::pair<std::string, double>> theta;
  Eigen::VectorXd x0;
  bool slow;  ///< forced at 3 rad/s, so that it sticks or slips
  Interpolation interpolation = Interpolation::linear;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  const std::vector<std::pair<std::string, double>> duffing{{"m", 1.3}, {"c", 0.4}, {"k", 40}, {"k3", 90}};
  return {
      {"smooth", model_of("m", "c*v + k*y + k3*y^3"), duffing, state({0.1, -0.3}), false},
      {"held", model_of("m", "c*v + k*y + k3*y^3"), duffing, state({0.1, -0.3}), false, Interpolation::hold},
      {"state",
       model_of("1", "k*y + s + c*v", {{"s", "e*v - s/tau", "", ""}}),
       {{"k", 30}, {"c", 0.1}, {"e", 50}, {"tau", 0.2}},
       state({0.1, 0, 0.2}),
       false},
      {"impact",
       model_of("1", "c*v + k*y + kc*max(y - g, 0)"),
       {{"c", 0.3}, {"k", 30}, {"kc", 400}, {"g", 0.05}},
       state({0.01, 0.3}),
       false},
      {"jump",
       model_of("1", "c*v + k*y + where(y > g, F0, 0)"),
       {{"c", 0.3}, {"k", 30}, {"F0", 2}, {"g", 0.05}},
       state({0.01, 0.3}),
       false},
      {"friction",
       model_of("m", "c*v + k*y + Fc*sign(v)"),
       {{"m", 1.1}, {"c", 0.2}, {"k", 30}, {"Fc", 1.2}},
       state({0.05, 0.4}),
       true},
      {"slip",
       model_of("m", "c*v + r", {{"r", "k*v", "-R", "R"}}),
       {{"m", 1.1}, {"c", 0.5}, {"k", 60}, {"R", 1.5}},
       state({0.02, 0.1, 0.3}),
       true},
      {"moving_bound",
       model_of("m", "c*v + k*(y - ys)", {{"ys", "0", "y - R/k", "y + R/k"}}),
       {{"m", 1.1}, {"c", 0.5}, {"k", 60}, {"R", 1.5}},
       state({0.02, 0.1, 0.015}),
       true},
      {"preload",
       model_of("m", "c*v + P*sign(y) + k*y"),
       {{"m", 1.1}, {"c", 2}, {"k", 30}, {"P", 4}},
       state({0.05, 0.1}),
       true},
  };
}

class OfModels : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Gradient, OfModels, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return std::string(info.param.name); });

// Both are the derivative of the same steps, so that they differ by rounding alone.
TEST_P(OfModels, IsThatOfForwardSensitivities) {
  const Case& c = GetParam();
  const System system(c.model);
  const auto theta = theta_of(system, c.theta);
  std::vector<double> force;
  for (int i = 0; i <= 500; ++i) force.push_back(c.slow ? 3 * std::sin(0.03 * i) : sweep(0.01 * i));
  const Excitation excitation(0, 0.01, force, c.interpolation);
  const Adjoint adjoint(system);
  const GradientRun run = adjoint.run(theta, excitation, c.x0, with_substeps(3), residual);
  ASSERT_TRUE(run.run.summary.completed) << run.run.summary.cause;
  EXPECT_EQ(run.run.summary.events > 0, !system.dynamics().smooth());
  EXPECT_LT(worst(run.gradient, by_sensitivities(system, theta, excitation, c.x0, with_substeps(3))), 1e-8);
}

/// Masses in a row, each with a spring, a cubic spring and a dashpot of its own to the one before.
System chain(int masses) {
  std::vector<std::pair<std::string, std::string>> rows;
  const auto link = [](int i) {
    const std::string n = std::to_string(i), before = std::to_string(i - 1);
    const std::string d = i == 1 ? "y1" : "(y" + n + " - y" + before + ")";
    const std::string v = i == 1 ? "v1" : "(v" + n + " - v" + before + ")";
    return "k" + n + "*" + d + " + c" + n + "*" + v + " + q" + n + "*" + d + "^3";
  };
  for (int i = 1; i <= masses; ++i) rows.emplace_back("1", link(i) + (i < masses ? " - (" + link(i + 1) + ")" : ""));
  Model model = model_of_many(rows);
  model.driven = {0};
  return System(model);
}

std::vector<double> chain_parameters(const System& system) {
  std::vector<double> theta;
  for (const Parameter& p : system.model().parameters) {
    const int i = std::stoi(p.name.substr(1));
    theta.push_back(p.name[0] == 'k' ? 900 + 30 * i : p.name[0] == 'c' ? 0.6 + 0.02 * i : 2e3 + 50 * i);
  }
  return theta;
}

TEST(Gradient, OfAChainOfSixtyParametersCostsAFewRuns) {
  const System system = chain(20);
  ASSERT_EQ(system.parameters(), 60);
  const auto theta = chain_parameters(system);
  Excitations force;
  force.add("F1", force_of(2, 0.01, sweep));
  const Eigen::VectorXd x0 = Eigen::VectorXd::LinSpaced(system.states(), 0.01, -0.01);
  const SimulateOptions options = with_substeps(2);
  const Adjoint adjoint(system);
  const GradientRun run = adjoint.run(theta, force, x0, options, residual);
  EXPECT_LT(worst(run.gradient, by_sensitivities(system, theta, force, x0, options)), 1e-7);
  // a run, the run again, and as many products: three evaluations for one, of a tape a few times as long as the rate's
  const long plain = simulate(system, theta, force, x0, options).summary.evaluations;
  EXPECT_LT(run.evaluations + run.run.summary.evaluations, 3 * plain + 10);
  const double backward = static_cast<double>(adjoint.instructions()) / system.rate().instructions();
  EXPECT_LT(backward, 8);
  // forward sensitivities carry 100 columns of 40 states through a Jacobian of four entries a row
  const double forward =
      (system.rate_with_derivatives().instructions() + 100.0 * 40 * 2) / system.rate().instructions();
  EXPECT_GT(forward, 2 * (2 + backward));
}

// Beyond the states for which sensitivities are carried there is still a gradient; differences as the witness.
TEST(Gradient, OfManyStatesIsItsDifference) {
  const System system = chain(40);
  ASSERT_FALSE(system.dynamics().dense());
  const auto theta = chain_parameters(system);
  Excitations force;
  force.add("F1", force_of(1, 0.01, sweep));
  const Eigen::VectorXd x0 = Eigen::VectorXd::LinSpaced(system.states(), 0.01, -0.01);
  const Adjoint adjoint(system);
  const GradientRun run = adjoint.run(theta, force, x0, with_substeps(2), residual);
  for (const int i : {0, 1, 2, 60, 119}) {
    std::vector<double> up = theta, down = theta;
    const double h = 1e-4 * theta[i];
    up[i] += h;
    down[i] -= h;
    const double difference = (adjoint.run(up, force, x0, with_substeps(2), residual).value -
                               adjoint.run(down, force, x0, with_substeps(2), residual).value) /
                              (2 * h);
    EXPECT_NEAR(run.gradient[i], difference, 1e-5 * std::abs(difference) + 1e-13) << i;
  }
}

TEST(Gradient, FaultsNameWhatThereIsNot) {
  const System imposed(model_of("m", "k*y", {}, true));
  EXPECT_EQ(fault_of([&] { Adjoint adjoint(imposed); }),
            "gradient: the motion of this model is imposed: there is no free run");
  const System system(model_of("1", "k*y"));
  const Adjoint adjoint(system);
  EXPECT_EQ(
      fault_of([&] {
        adjoint.run(std::vector<double>{1}, zero_force(1, 0.1), state({0, 0}), with_solver(Solver::bdf), residual);
      }),
      "gradient: solver: the adjoint is that of 'fixed', got 'bdf'");
  std::vector<std::pair<std::string, std::string>> rows;
  for (int i = 1; i <= 33; ++i) rows.emplace_back("1", "y" + std::to_string(i) + (i == 1 ? " + sign(v1)" : ""));
  Model driven_at_one = model_of_many(rows);
  driven_at_one.driven = {0};
  const System many(driven_at_one);
  EXPECT_EQ(fault_of([&] { Adjoint adjoint(many); }),
            "gradient: a model with switches or bounds: expected at most 64 states, got 66");
}

}  // namespace
}  // namespace lunid
