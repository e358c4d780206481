// Channels that do not show what they are named after: what a run shows, its slopes, fits, and the force undone.
#include "simulate/fit.hpp"
#include "simulate/measures.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::model_of;
using testing::state;
using testing::theta_of;
using Maps = std::vector<std::pair<std::string, std::string>>;

Model measuring(Model model, const Maps& measures, const Maps& acts = {}) {
  for (const auto& [channel, map] : measures) model.measures.push_back({channel, parse(*model.pool, map)});
  for (const auto& [channel, map] : acts) model.acts.push_back({channel, parse(*model.pool, map)});
  return model;
}

Excitation drive(double dt = 0.02, int rows = 400) {
  return Excitation(0, dt, rows,
                    std::function<double(double)>([](double t) { return 3 * std::cos(1.7 * t) + std::sin(0.6 * t); }));
}

Channel channel(const char* name, Eigen::VectorXd values) {
  Channel c;
  c.name = c.source = name;
  c.values = std::move(values);
  return c;
}

TEST(Measures, EquationSaysThem) {
  EXPECT_EQ(measuring(model_of("2", "k*y"), {{"y", "y + b"}}, {{"F", "g*F"}}).equation(),
            "2*a + k*y = g*F\ny measured = y + b");
}

/// Slopes against central differences of what the runs show: an offset, a gain, a trend, a lag and a limit.
TEST(Measures, SlopesAreThoseOfWhatIsShown) {
  const std::vector<std::pair<Model, std::vector<double>>> cases = {
      {measuring(model_of("1", "k*y + c*v"), {{"y", "g*y + b + d*t^2"}}), {4, 0.3, 1.2, 0.1, 0.02}},
      {measuring(model_of("1", "k*y + c*v", {{"x", "(y - x)/tau", "", ""}}), {{"y", "x"}}), {4, 0.3, 0.2}},
      {measuring(model_of("1", "k*y + c*v"), {{"y", "min(max(y, -level), level)"}}), {4, 0.3, 0.5}},
      {measuring(model_of("1", "k*y + c*v + q*y^3"), {{"a", "g*a + b + h*y*v"}}), {4, 0.3, 0.4, 1.2, 0.1, 0.2}},
      {measuring(model_of("1", "k*y + c*v", {{"x", "(a - x)/tau", "", ""}}), {{"a", "x"}}), {4, 0.3, 0.2}},
      {measuring(model_of("1", "k*y + c*v"), {}, {{"F", "g*F + tau*force_rate"}}), {4, 0.3, 1.1, 0.15}},
      {measuring(model_of("1", "k*y + c*v"), {}, {{"F", "F*(1 - b*y^2 + h*v)"}}), {4, 0.3, 0.2, 0.1}},
  };
  for (const auto& [model, theta] : cases) {
    const System system(model);
    ASSERT_EQ(system.parameters(), static_cast<int>(theta.size()));
    SimulateOptions options;
    options.solver = Solver::fixed;
    options.substeps = 2;
    Eigen::VectorXd x0 = Eigen::VectorXd::Zero(system.states());
    x0[0] = 0.2;
    const std::string channel = model.measures.empty() ? "y" : model.measures.front().channel;
    const auto at = [&](const std::vector<double>& values) {
      return shown(system, values, simulate(system, values, drive(), x0, options), channel);
    };
    const SensitivityRun run = simulate_sensitivities(system, theta, drive(), x0, options);
    const Eigen::MatrixXd slopes = shown_slopes(system, theta, drive(), run, channel);
    for (std::size_t i = 0; i < theta.size(); ++i) {
      std::vector<double> up = theta, down = theta;
      up[i] += 1e-6;
      down[i] -= 1e-6;
      const Eigen::VectorXd difference = (at(up) - at(down)) / 2e-6;
      const Eigen::VectorXd error = difference - slopes.col(static_cast<Eigen::Index>(i));
      // A row on which the limit is just reached has two slopes: one of the 400 may differ.
      EXPECT_LE((error.array().abs() > 1e-5 * (1 + difference.cwiseAbs().maxCoeff())).count(), 1)
          << system.model().equation() << " by " << system.model().parameters[i].name;
    }
  }
}

/// A lag of a cosine in its steady state is known: amplitude 1/sqrt(1 + (w tau)^2), phase -atan(w tau).
TEST(Measures, ALagIsThatOfItsFrequencyResponse) {
  const System system(measuring(model_of("1", "k*y + c*v", {{"x", "(y - x)/tau", "", ""}}), {{"y", "x"}}));
  const std::vector<double> theta = theta_of(system, {{"k", 4}, {"c", 1.5}, {"tau", 0.3}});
  const double w = 1.3;
  const Excitation force(0, 0.02, 4000, std::function<double(double)>([&](double t) { return std::cos(w * t); }));
  const lunid::Run run = simulate(system, theta, force, state({0, 0, 0}), {});
  const Eigen::VectorXd y = shown(system, theta, run);
  const std::complex<double> i(0, 1), gain = 1.0 / ((4 - w * w + 1.5 * w * i) * (1.0 + 0.3 * w * i));
  for (Eigen::Index row = 3000; row < 4000; row += 37)
    EXPECT_NEAR(y[row], std::real(gain * std::exp(i * w * run.dt * static_cast<double>(row))), 1e-6);
}

/// The physical parameters behind a faulty channel come back, to what the interpolation of the force leaves.
TEST(Measures, AFitFindsThePhysicsBehindAFaultyChannel) {
  const double dt = 0.05;
  const Excitation force = drive(dt, 1500);
  const System truth(model_of("1", "k*y + c*v + q*y^3"));
  const std::vector<double> physics = theta_of(truth, {{"k", 4}, {"c", 0.3}, {"q", 0.5}});
  const lunid::Run run = simulate(truth, physics, force, state({0.1, 0}), {});
  const Record faulty = derive_motion(Record(
      "faulty", 0, dt,
      {channel("F", force.samples() / 1.25), channel("y", (run.x.col(0).array() + 0.3).cwiseMin(0.9).matrix())}));
  const System system(measuring(model_of("1", "k*y + c*v + q*y^3"), {{"y", "min(y + b, level)"}}, {{"F", "g*F"}}));
  const std::vector<double> start =
      theta_of(system, {{"k", 3.5}, {"c", 0.4}, {"q", 0.4}, {"b", 0}, {"level", 0.8}, {"g", 1}});
  FitData data{faulty, Excitation(0, dt, faulty["F"], Interpolation::cubic), {}};
  const FitResult fit = fit_progressively(
      system, Eigen::Map<const Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size())), {data});
  const std::vector<double> expected =
      theta_of(system, {{"k", 4}, {"c", 0.3}, {"q", 0.5}, {"b", 0.3}, {"level", 0.9}, {"g", 1.25}});
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(fit.theta[static_cast<Eigen::Index>(i)], expected[i], 2e-3 * std::abs(expected[i]))
        << system.model().parameters[i].name;
}

/// Where a fit's free run starts: behind an offset and a gain; a lag or a limit does not follow the displacement alone.
TEST(Measures, AreUndoneOfTheStateThatARunStartsFrom) {
  Eigen::VectorXd y(300), none = Eigen::VectorXd::Zero(300);
  for (int i = 0; i < 300; ++i) y[i] = 0.5 + std::sin(0.05 * i);
  const Record record("r", 0, 0.01, {channel("y", y), channel("v", none), channel("a", none), channel("F", none)});
  const auto start = [&](const Model& model, const std::vector<double>& theta) {
    return measured_state(System(model), theta, record, 100)[0];
  };
  const double shown = start(model_of("1", "k*y"), {1});
  EXPECT_NEAR(shown, y[100], 1e-3);
  EXPECT_NEAR(start(measuring(model_of("1", "k*y"), {{"y", "1.25*y + b"}}), {1, 0.3}), (shown - 0.3) / 1.25, 1e-9);
  EXPECT_EQ(start(measuring(model_of("1", "k*y"), {{"y", "min(y, level)"}}), {1, 0.2}), shown);
}

/// With imposed motion the force is that of the true motion, as its channel shows it: against the sum written out.
TEST(Measures, AreUndoneWhereTheMotionIsImposed) {
  const System system(measuring(model_of("2", "k*y^3 + c*v", {}, true), {{"y", "g*y + b + d*t"}}, {{"F", "h*F + f"}}));
  const std::vector<double> theta =
      theta_of(system, {{"k", 5}, {"c", 0.7}, {"g", 1.3}, {"b", 0.2}, {"d", 0.1}, {"h", 0.8}, {"f", 0.4}});
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(50, 0, 4.9);
  const Eigen::VectorXd y = t.array().sin(), v = t.array().cos(), a = -t.array().sin();
  const Record record("r", 0, 0.1,
                      {channel("y", 1.3 * y + Eigen::VectorXd::Constant(50, 0.2) + 0.1 * t),
                       channel("v", 1.3 * v + Eigen::VectorXd::Constant(50, 0.1)), channel("a", 1.3 * a)});
  const Eigen::VectorXd force = imposed_force(system, theta, record);
  for (Eigen::Index i = 0; i < 50; ++i)
    EXPECT_NEAR(force[i], (2 * a[i] + 5 * std::pow(y[i], 3) + 0.7 * v[i] - 0.4) / 0.8, 1e-12);
}

/// A coil that leaves its field: the current that makes the motion, of a motion that is read with a factor.
TEST(Measures, AForceThatDependsOnTheMotionIsUndoneAlongIt) {
  const System system(measuring(model_of("2", "k*y", {}, true), {{"y", "g*y"}}, {{"F", "F*(1 - b*y^2) + d*v"}}));
  const std::vector<double> theta = theta_of(system, {{"k", 5}, {"g", 1.3}, {"b", 0.3}, {"d", 0.2}});
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(50, 0, 4.9);
  const Eigen::VectorXd y = t.array().sin(), v = t.array().cos(), a = -t.array().sin();
  const Record record("r", 0, 0.1, {channel("y", 1.3 * y), channel("v", 1.3 * v), channel("a", 1.3 * a)});
  const Eigen::VectorXd force = imposed_force(system, theta, record);
  for (Eigen::Index i = 0; i < 50; ++i)
    EXPECT_NEAR(force[i], (2 * a[i] + 5 * y[i] - 0.2 * v[i]) / (1 - 0.3 * y[i] * y[i]), 1e-12);
}

/// With 1 + b*y as the force's factor the motion is that of a spring k - b*F.
TEST(Measures, AForceThatDependsOnTheMotionDrivesIt) {
  const System acting(measuring(model_of("1", "k*y + c*v"), {}, {{"F", "F*(1 + b*y)"}}));
  SimulateOptions options;
  options.solver = Solver::fixed;
  options.substeps = 4;
  const std::vector<double> theta = theta_of(acting, {{"k", 4}, {"c", 0.3}, {"b", 0.4}});
  const lunid::Run run = simulate(acting, theta, drive(), Eigen::Vector2d(0.2, 0), options);
  const auto rate = [](double t, const Eigen::Vector2d& x) {
    const double force = 3 * std::cos(1.7 * t) + std::sin(0.6 * t);
    return Eigen::Vector2d(x[1], force * (1 + 0.4 * x[0]) - 4 * x[0] - 0.3 * x[1]);
  };
  Eigen::Vector2d x(0.2, 0);
  const double dt = 0.001;
  for (int i = 0; i < 4000; ++i) {  // Runge and Kutta's steps, with the force's formula
    const double t = i * dt;
    const Eigen::Vector2d a = rate(t, x), b = rate(t + dt / 2, x + dt / 2 * a), c = rate(t + dt / 2, x + dt / 2 * b),
                          d = rate(t + dt, x + dt * c);
    x += dt / 6 * (a + 2 * b + 2 * c + d);
  }
  EXPECT_NEAR(shown(acting, theta, run, "y")[200], x[0], 2e-6);
}

/// An accelerometer's factor is that of its integrals, its offset is not: they have lost their slow part.
TEST(Measures, AreUndoneOfAnAccelerometer) {
  const System system(measuring(model_of("2", "k*y + c*v", {}, true), {{"a", "g*a + b"}}));
  const std::vector<double> theta = theta_of(system, {{"k", 5}, {"c", 0.7}, {"g", -1.3}, {"b", 0.2}});
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(50, 0, 4.9);
  const Eigen::VectorXd y = t.array().sin(), v = t.array().cos(), a = -t.array().sin();
  const Record record(
      "r", 0, 0.1,
      {channel("y", -1.3 * y), channel("v", -1.3 * v), channel("a", -1.3 * a + Eigen::VectorXd::Constant(50, 0.2))});
  const Eigen::VectorXd force = imposed_force(system, theta, record);
  for (Eigen::Index i = 0; i < 50; ++i) EXPECT_NEAR(force[i], 2 * a[i] + 5 * y[i] + 0.7 * v[i], 1e-12);
}

/// The same of two coordinates, of which one is shown as it is and one is driven.
TEST(Measures, AreUndoneOfSeveralCoordinates) {
  Model model = model_of("2", "k*(y1 - y2)", {}, true);
  model.further.push_back({parse(*model.pool, "3"), parse(*model.pool, "k*(y2 - y1) + c*v2")});
  model.driven = {0};
  const System system(measuring(std::move(model), {{"y2", "g*y2 + d*t"}}, {{"F1", "h*F1"}}));
  EXPECT_TRUE(can_be_undone(system.model()));
  const std::vector<double> theta = theta_of(system, {{"k", 5}, {"c", 0.7}, {"g", 1.3}, {"d", 0.1}, {"h", 0.8}});
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(50, 0, 4.9);
  const Eigen::VectorXd y1 = t.array().cos(), y2 = t.array().sin(), v2 = t.array().cos();
  const Record record("r", 0, 0.1,
                      {channel("y1", y1), channel("v1", -y2), channel("a1", -y1), channel("y2", 1.3 * y2 + 0.1 * t),
                       channel("v2", 1.3 * v2 + Eigen::VectorXd::Constant(50, 0.1)), channel("a2", -1.3 * y2)});
  Eigen::MatrixXd slopes;
  const Eigen::VectorXd force = imposed_force(system, theta, record, &slopes);
  ASSERT_EQ(force.size(), 100);
  for (Eigen::Index i = 0; i < 50; ++i) {
    EXPECT_NEAR(force[i], (-2 * y1[i] + 5 * (y1[i] - y2[i])) / 0.8, 1e-12);
    EXPECT_NEAR(force[50 + i], -3 * y2[i] + 5 * (y2[i] - y1[i]) + 0.7 * v2[i], 1e-12);
  }
  for (std::size_t j = 0; j < theta.size(); ++j) {
    std::vector<double> up = theta, down = theta;
    up[j] += 1e-6;
    down[j] -= 1e-6;
    const Eigen::VectorXd difference = (imposed_force(system, up, record) - imposed_force(system, down, record)) / 2e-6;
    EXPECT_LT((difference - slopes.col(static_cast<Eigen::Index>(j))).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(Measures, SaysWhatCanBeUndone) {
  EXPECT_TRUE(can_be_undone(measuring(model_of("1", "y"), {{"y", "g*y + b*t"}}, {{"F", "g*F"}})));
  EXPECT_TRUE(can_be_undone(measuring(model_of("1", "y"), {{"a", "g*a + b*t"}})));
  EXPECT_FALSE(can_be_undone(measuring(model_of("1", "y"), {{"a", "(1 + g*t)*a"}})));
  EXPECT_FALSE(can_be_undone(measuring(model_of("1", "y"), {{"y", "min(y, b)"}})));
  EXPECT_FALSE(can_be_undone(measuring(model_of("1", "y", {{"x", "y - x", "", ""}}), {{"y", "x"}})));
  EXPECT_FALSE(can_be_undone(measuring(model_of("1", "y"), {}, {{"F", "F + g*force_rate"}})));
  EXPECT_TRUE(can_be_undone(measuring(model_of("1", "y"), {}, {{"F", "F*(1 - b*y^2)"}})));
  EXPECT_FALSE(can_be_undone(measuring(model_of("1", "y"), {{"y", "y*(1 + b*v)"}})));
  EXPECT_FALSE(can_be_undone(measuring(model_of("1", "y", {{"tz", "y - tz", "", ""}}), {{"y", "y + tz"}})));
}

/// The motion of a base drives the force of an imposed motion too.
TEST(Measures, ABaseDrivesAnImposedMotion) {
  const System system(model_of("2", "k*y + 2*ab", {}, true));
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(10);
  const Record record("r", 0, 0.1,
                      {channel("y", one), channel("v", 0 * one), channel("a", 3 * one), channel("ab", 4 * one)});
  Eigen::MatrixXd slope;
  EXPECT_EQ(imposed_force(system, std::vector<double>{7}, record, &slope)[5], 2 * 3 + 7 + 2 * 4);
  EXPECT_EQ(slope(5, 0), 1);
}

TEST(Measures, Faults) {
  const auto fault_in = [](const Model& model) { return fault_of([&] { complete(model); }); };
  EXPECT_EQ(fault_in(measuring(model_of("1", "y"), {{"F", "y"}})),
            "model: measures: expected a displacement, velocity or acceleration of the model, got 'F'");
  EXPECT_EQ(fault_in(measuring(model_of("1", "y"), {{"y", "y"}, {"y", "2*y"}})),
            "model: measures: channel 'y' is given twice");
  EXPECT_EQ(fault_in(measuring(model_of("1", "y"), {{"y", "y + F"}})),
            "model: measures: y: cannot hold the channel 'F' (it may hold y v a t)");
  EXPECT_EQ(fault_in(measuring(model_of("1", "y"), {}, {{"F", "F^2"}})),
            "model: acts: F: expected a force that is affine in F, got F^2");
  EXPECT_EQ(fault_in(measuring(model_of("1", "y"), {}, {{"F", "F + a"}})),
            "model: acts: F: cannot hold the channel 'a' (it may hold F t force_rate y v)");
  EXPECT_EQ(fault_in(measuring(model_of("1", "y"), {}, {{"y", "y"}})),
            "model: acts: expected a force of the model, got 'y'");
}

}  // namespace
}  // namespace lunid
