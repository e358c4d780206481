// Imposed motion: the force along a measured motion, with its derivatives.
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::model_of;
using testing::theta_of;

/// y = sin(3t) + 0.3 sin(7t) with its exact derivatives.
Record motion(int rows, double dt) {
  Eigen::VectorXd y(rows), v(rows), a(rows);
  for (int i = 0; i < rows; ++i) {
    const double t = dt * i;
    y[i] = std::sin(3 * t) + 0.3 * std::sin(7 * t);
    v[i] = 3 * std::cos(3 * t) + 2.1 * std::cos(7 * t);
    a[i] = -9 * std::sin(3 * t) - 14.7 * std::sin(7 * t);
  }
  Channel cy, cv, ca;
  cy.name = "y";
  cy.values = y;
  cv.name = "v";
  cv.values = v;
  ca.name = "a";
  ca.values = a;
  return Record("motion", 0, dt, {cy, cv, ca});
}

/// The same of two coordinates: y1 is that motion, y2 half of it.
Record two_motions(int rows, double dt) {
  std::vector<Channel> channels;
  const Record one = motion(rows, dt);
  for (const int i : {1, 2})
    for (const char* quantity : {"y", "v", "a"}) {
      channels.push_back(one.channel(quantity));
      channels.back().name += std::to_string(i);
      channels.back().values = one.channel(quantity).values / i;
    }
  return Record("motions", 0, dt, std::move(channels));
}

TEST(ImposedForce, WithoutStatesIsTheEquation) {
  const System system(model_of("m", "c*v + k*y + b*v*a", {}, true));
  const auto theta = theta_of(system, {{"m", 2}, {"c", 0.5}, {"k", 7}, {"b", 0.1}});
  const Record record = motion(200, 0.01);
  Eigen::MatrixXd slope;
  const Eigen::VectorXd force = imposed_force(system, theta, record, &slope);
  for (Eigen::Index i = 0; i < 200; ++i) {
    const double y = record["y"][i], v = record["v"][i], a = record["a"][i];
    EXPECT_NEAR(force[i], 2 * a + 0.5 * v + 7 * y + 0.1 * v * a, 1e-12);
    EXPECT_DOUBLE_EQ(slope(i, 0), a);
    EXPECT_DOUBLE_EQ(slope(i, 1), v);
    EXPECT_DOUBLE_EQ(slope(i, 2), y);
    EXPECT_DOUBLE_EQ(slope(i, 3), v * a);
  }
}

// A relaxation in the joint of two masses: that of one coordinate at half the motion, on both with either sign.
TEST(ImposedForce, OfTwoCoordinatesIsThatOnEachOneAfterAnother) {
  Model joined = testing::model_of_many({{"m1", "k*y1 + s"}, {"m2", "-s"}}, {{"s", "e*(v1 - v2) - s/tau", "", ""}});
  joined.imposed_motion = true;
  const System system(joined), alone(model_of("0", "s", {{"s", "e*v/2 - s/tau", "", ""}}, true));
  const auto theta = theta_of(system, {{"m1", 2}, {"m2", 3}, {"k", 5}, {"e", 20}, {"tau", 0.3}});
  const Record record = two_motions(400, 0.005);
  Eigen::MatrixXd slope;
  const Eigen::VectorXd force = imposed_force(system, theta, record, &slope);
  const Eigen::VectorXd s = imposed_force(alone, theta_of(alone, {{"e", 20}, {"tau", 0.3}}), motion(400, 0.005));
  ASSERT_EQ(force.size(), 800);
  ASSERT_EQ(slope.rows(), 800);
  for (Eigen::Index i = 0; i < 400; ++i) {
    const double y = record["y1"][i], a = record["a1"][i];
    EXPECT_NEAR(force[i], 2 * a + 5 * y + s[i], 1e-4);
    EXPECT_NEAR(force[400 + i], 1.5 * a - s[i], 1e-4);
  }
  for (int j = 0; j < system.parameters(); ++j) {
    std::vector<double> up = theta, down = theta;
    const double h = 1e-5 * theta[static_cast<std::size_t>(j)];
    up[static_cast<std::size_t>(j)] += h;
    down[static_cast<std::size_t>(j)] -= h;
    const Eigen::VectorXd difference =
        (imposed_force(system, up, record) - imposed_force(system, down, record)) / (2 * h);
    EXPECT_LT((slope.col(j) - difference).cwiseAbs().maxCoeff(), 1e-5 * (1 + difference.cwiseAbs().maxCoeff()))
        << system.model().parameters[static_cast<std::size_t>(j)].name;
  }
}

// ds/dt = e v - s / tau from s(0) = 0: the convolution of e v with exp(-t / tau), in closed form.
TEST(ImposedForce, OfARelaxationIsItsClosedForm) {
  const System system(model_of("0", "k*y + s", {{"s", "e*v - s/tau", "", ""}}, true));
  const double k = 5, e = 20, tau = 0.3, r = 1 / tau;
  const auto theta = theta_of(system, {{"k", k}, {"e", e}, {"tau", tau}});
  const Record record = motion(400, 0.005);
  const Eigen::VectorXd force = imposed_force(system, theta, record);
  for (Eigen::Index i = 0; i < 400; ++i) {
    const double t = 0.005 * static_cast<double>(i);
    double s = 0;
    for (const auto& [w, amplitude] : {std::pair(3.0, 3.0), std::pair(7.0, 2.1)})
      s += e * amplitude * (r * std::cos(w * t) + w * std::sin(w * t) - r * std::exp(-r * t)) / (r * r + w * w);
    EXPECT_NEAR(force[i], k * record["y"][i] + s, 2e-5);  // of 20: the cubic between samples, (7 * 0.005)^4 * 20
  }
}

/// Largest difference of dforce to central differences, over the largest entry of each column.
double worst_slope(const System& system, const std::vector<double>& theta, const Record& record) {
  Eigen::MatrixXd slope;
  imposed_force(system, theta, record, &slope);
  double worst = 0;
  for (int c = 0; c < system.parameters(); ++c) {
    std::vector<double> up = theta, down = theta;
    const double h = 1e-6 * theta[c];
    up[c] += h;
    down[c] -= h;
    const Eigen::VectorXd difference =
        (imposed_force(system, up, record) - imposed_force(system, down, record)) / (2 * h);
    worst = std::max(worst, (slope.col(c) - difference).cwiseAbs().maxCoeff() / difference.cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(ImposedForce, HasTheDerivativesOfItsDifferences) {
  const Record record = motion(400, 0.01);
  const System bouc_wen(
      model_of("m", "c*v + k*z", {{"z", "v - beta*abs(v)*abs(z)^(n - 1)*z - gamma*v*abs(z)^n", "", ""}}, true));
  EXPECT_LT(
      worst_slope(bouc_wen, theta_of(bouc_wen, {{"m", 1}, {"c", 0.5}, {"k", 40}, {"beta", 2}, {"gamma", 1}, {"n", 2}}),
                  record),
      1e-5);
  const System slip(model_of("0", "r + J*abs(r)*v", {{"r", "k*v", "-R", "R"}}, true));
  EXPECT_LT(worst_slope(slip, theta_of(slip, {{"J", 0.1}, {"k", 40}, {"R", 12}}), record), 1e-5);
  const System play(model_of("0", "k*(y - z)", {{"z", "0", "y - g", "y + g"}}, true));
  EXPECT_LT(worst_slope(play, theta_of(play, {{"k", 40}, {"g", 0.2}}), record), 1e-5);
}

// A play of half-width g: z is carried along at a distance of g, so the force stays within +-k g and reaches both.
TEST(ImposedForce, OfAPlayIsThePlayOperator) {
  const System system(model_of("0", "k*(y - z)", {{"z", "0", "y - g", "y + g"}}, true));
  const auto theta = theta_of(system, {{"k", 10}, {"g", 0.2}});
  const Record record = motion(800, 0.005);
  const Eigen::VectorXd force = imposed_force(system, theta, record);
  double z = 0;
  for (Eigen::Index i = 0; i < 800; ++i) {
    for (int part = i == 0 ? 100 : 1; part <= 100; ++part) {
      const double t = 0.005 * (static_cast<double>(i) - 1 + 0.01 * part);
      const double y = std::sin(3 * t) + 0.3 * std::sin(7 * t);
      z = std::clamp(z, y - 0.2, y + 0.2);
    }
    EXPECT_NEAR(force[i], 10 * (record["y"][i] - z), 1e-4) << i;
  }
}

// A state that goes along a limit of its own slope, where v is not quite the slope of y, meets and leaves it the more
// often the shorter the steps, and there would be no end of these.
TEST(ImposedForce, OfAStateThatGoesAlongItsLimit) {
  constexpr int rows = 8000;
  const std::string limit = "max(N + s*y, 0)";
  const System system(model_of("0", "z", {{"z", "k*v", "-" + limit, limit}}, true));
  const auto theta = theta_of(system, {{"k", 10 * (1 - 1e-5)}, {"s", 10}, {"N", 3}});
  const Record exact = motion(rows, 0.02);
  Channel v = exact.channel("v");
  for (Eigen::Index i = 0; i < rows; ++i) v.values[i] += 0.01 * std::sin(2.1 * static_cast<double>(i));
  const Eigen::VectorXd force = imposed_force(system, theta, exact.with(v));
  ASSERT_TRUE(force.allFinite());
  double z = 0;
  for (Eigen::Index i = 1; i < rows; ++i) {
    const double y = exact["y"][static_cast<std::size_t>(i)], most = std::max(3 + 10 * y, 0.0);
    z = std::clamp(z + 10 * (y - exact["y"][static_cast<std::size_t>(i - 1)]), -most, most);
    ASSERT_NEAR(force[i], z, 0.1) << i;
  }
}

// z' = L (v - z) with L dt = 250: z follows v, but for a lag of 1/L.
TEST(ImposedForce, OfAStateMuchFasterThanTheSamples) {
  const System system(model_of("0", "z", {{"z", "L*(v - z)", "", ""}}, true));
  const Record record = motion(400, 0.005);
  const Eigen::VectorXd force = imposed_force(system, theta_of(system, {{"L", 5e4}}), record);
  for (Eigen::Index i = 1; i < 400; ++i) EXPECT_NEAR(force[i], record["v"][i] - record["a"][i] / 5e4, 1e-4) << i;
}

// u' = -ab: a mass that is left behind by its base.
TEST(ImposedForce, OfStatesThatFollowTheBase) {
  const System system(model_of("0", "k*u", {{"u", "-ab", "", ""}}, true));
  Channel base;
  base.name = "ab";
  base.values = Eigen::VectorXd::NullaryExpr(400, [](auto i) { return std::cos(2 * 0.005 * static_cast<double>(i)); });
  const Record record = motion(400, 0.005).with(base);
  Eigen::MatrixXd slopes;
  const Eigen::VectorXd force = imposed_force(system, theta_of(system, {{"k", 10}}), record, &slopes);
  for (Eigen::Index i = 0; i < 400; ++i) {
    EXPECT_NEAR(force[i], -5 * std::sin(2 * 0.005 * static_cast<double>(i)), 1e-6) << i;
    EXPECT_NEAR(slopes(i, 0), force[i] / 10, 1e-9) << i;
  }
}

TEST(ImposedForce, OfStatesThatDivergeIsNoNumber) {
  const System system(model_of("0", "z", {{"z", "1 + z^2*L", "", ""}}, true));
  EXPECT_TRUE(imposed_force(system, theta_of(system, {{"L", 50}}), motion(200, 0.005)).array().isNaN().all());
}

TEST(ImposedForce, FaultsNameTheArgument) {
  const System system(model_of("0", "k*y", {}, true));
  EXPECT_EQ(fault_of([&] { imposed_force(system, {}, motion(50, 0.01)); }),
            "imposed_force: theta: expected 1 values, got 0");
  EXPECT_EQ(fault_of([&] { imposed_force(system, std::vector<double>{std::nan("")}, motion(50, 0.01)); }),
            "imposed_force: parameter 'k': expected a finite value, got nan");
  const System driven(model_of("1", "z", {{"z", "F - z", "", ""}}));
  EXPECT_EQ(fault_of([&] { imposed_force(driven, {}, motion(50, 0.01)); }),
            "imposed_force: the rate of a state holds F, which is the output where the motion is imposed");
}

}  // namespace
}  // namespace lunid
