// Backbone curves against elliptic functions, closed forms and free runs.
#include "simulate/response.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using std::numbers::pi;
using testing::fault_of;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_substeps;
using testing::zero_force;

BackboneOptions amplitudes(double from, double to, int mode = 1) {
  BackboneOptions options;
  options.from = from;
  options.to = to;
  options.mode = mode;
  return options;
}

/// K(m) by the arithmetic-geometric mean; Abramowitz & Stegun 17.6. Also for m < 0.
double complete_elliptic(double m) {
  double a = 1, b = std::sqrt(1 - m);
  for (int i = 0; i < 40 && std::abs(a - b) > 1e-16 * a; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return pi / (2 * a);
}

// Free Duffing (Nayfeh & Mook 1979, section 2.3): period 4 K(M) / sqrt(k + k3 A^2), M = k3 A^2 / (2 (k + k3 A^2)).
TEST(Backbone, OfDuffingIsTheEllipticPeriod) {
  const System system(model_of("1", "k*y + k3*y^3"));
  for (const auto& [k3, harmonics] : {std::pair(1e6, 0), std::pair(-1e6, 0), std::pair(1e6, 25), std::pair(-1e6, 25)}) {
    const std::vector<double> theta = theta_of(system, {{"k", 2e4}, {"k3", k3}});
    const double to = k3 > 0 ? 0.5 : 0.12;  // the softening spring ends at 0.1414
    BackboneOptions options = amplitudes(1e-3, to);
    options.harmonics = harmonics;
    const double tolerance = harmonics == 0 ? options.accuracy : 1e-11;
    const Backbone backbone = lunid::backbone(system, theta, options);
    EXPECT_TRUE(backbone.complete) << backbone.stopped;
    EXPECT_FALSE(backbone.truncated);
    for (const BackbonePoint& point : backbone.points) {
      const double a = point.motion[0].amplitude(), hard = 2e4 + k3 * a * a;
      const double exact = std::sqrt(hard) / (4 * complete_elliptic(k3 * a * a / (2 * hard)));
      EXPECT_NEAR(point.frequency / exact, 1, tolerance) << "at " << a << " m, " << point.harmonics << " harmonics";
      EXPECT_NEAR(point.damping, 0, 1e-12);
    }
    EXPECT_NEAR(backbone.points.back().motion[0].amplitude() / to, 1, 1e-8);
    EXPECT_GT(backbone.points.size(), 30U);
  }
}

// A spring that is stiffer beyond a gap, without damping: quarter periods of two sines, joined where y = g.
TEST(Backbone, OfAClearanceIsTwoJoinedSines) {
  const System system(model_of("1", "k*y + kc*(max(y - g, 0) + min(y + g, 0))"));
  const double k = 100, kc = 300, g = 0.1;
  const auto theta = theta_of(system, {{"k", k}, {"kc", kc}, {"g", g}});
  const Backbone backbone = lunid::backbone(system, theta, amplitudes(0.05, 0.6));
  EXPECT_TRUE(backbone.complete) << backbone.stopped;
  for (const BackbonePoint& point : backbone.points) {
    const double a = point.motion[0].amplitude();
    double period = 2 * pi / std::sqrt(k);
    if (a > g) {
      const double w1 = std::sqrt(k), w2 = std::sqrt(k + kc), shift = kc * g / (k + kc);
      const double energy = k * a * a + kc * (a - g) * (a - g), v = std::sqrt(energy - k * g * g);
      const double slow = std::atan2(w1 * g, v) / w1, fast = std::atan2(v, w2 * (g - shift)) / w2;
      period = 4 * (slow + fast);
    }
    EXPECT_NEAR(point.frequency * period, 1, 5e-6) << "at " << a << ", " << point.harmonics << " harmonics";
  }
}

// Two equal masses between three springs, the first with a cubic one to the wall: modes sqrt(k/m), sqrt(3 k/m) at rest.
TEST(Backbone, OfADampedOscillatorHasItsDampingRatio) {
  const System system(model_of("m", "c*v + k*y + k3*y^3 + c3*v^3"));
  const double m = 2, c = 3, k = 800;
  const auto theta = theta_of(system, {{"m", m}, {"c", c}, {"k", k}, {"k3", 0}, {"c3", 0.5}});
  const Backbone backbone = lunid::backbone(system, theta, amplitudes(1e-4, 0.02));
  EXPECT_TRUE(backbone.complete) << backbone.stopped;
  const double w0 = std::sqrt(k / m);
  for (const BackbonePoint& point : backbone.points) {
    const double a = point.motion[0].amplitude(), w = 2 * pi * point.frequency;
    EXPECT_NEAR(w / w0, 1, 2e-4);  // damping against damping leaves no shift of first order
    // one harmonic: c v + c3 v^3 works as c + 3/4 c3 (a w)^2
    const double expected = (c + 0.75 * 0.5 * a * w * a * w) / (2 * m * w);
    EXPECT_NEAR(point.damping / expected, 1, 1e-4) << "at " << a;
  }
  EXPECT_NEAR(backbone.points.front().damping, c / (2 * std::sqrt(k * m)), 1e-6);
}

// A mass on a spring in series with a dashpot, a Maxwell element: the internal state takes part in the mode.
TEST(Backbone, OfALinearModelWithAnInternalStateIsItsMode) {
  const System system(model_of("1", "k*y + z", {{"z", "e*v - z/tau", "", ""}}));
  const auto theta = theta_of(system, {{"k", 400}, {"e", 100}, {"tau", 0.05}});
  const Backbone backbone = lunid::backbone(system, theta, amplitudes(0.01, 0.1));
  ASSERT_TRUE(backbone.complete) << backbone.stopped;
  // driven by xi v: -w^2 + k + i w e tau / (1 + i w tau) = i w xi, real part
  for (const BackbonePoint& point : backbone.points) {
    const double w = 2 * pi * point.frequency;
    const std::complex<double> i(0, 1), rest = 400 - w * w + i * w * 100.0 * 0.05 / (1.0 + i * w * 0.05);
    EXPECT_NEAR(rest.real() / 400, 0, 1e-10);
    EXPECT_NEAR(2 * w * point.damping, rest.imag() / w, 1e-9);
  }
}

// A free run that begins on the backbone comes back after the period that it tells.
TEST(Backbone, OfAnAsymmetricSpringIsThatOfFreeRuns) {
  const System system(model_of("1", "k*y + k2*y^2 + k3*y^3 - 30"));
  const auto theta = theta_of(system, {{"k", 2e4}, {"k2", 4e5}, {"k3", 6e6}});
  const Backbone backbone = lunid::backbone(system, theta, amplitudes(1e-3, 0.05));
  ASSERT_TRUE(backbone.complete) << backbone.stopped;
  for (std::size_t i = 0; i < backbone.points.size(); i += 10) {
    const BackbonePoint& point = backbone.points[i];
    double y = 0;
    for (const auto& c : point.motion[0].harmonics) y += c.real();
    const double period = 1 / point.frequency;
    const lunid::Run run = simulate(system, theta, zero_force(period, period / 256), state({y, 0}), with_substeps(4));
    EXPECT_NEAR(run.x(256, 0), y, 1e-6 * point.motion[0].amplitude());
    EXPECT_NEAR(run.x(256, 1), 0, 1e-5 * point.motion[1].amplitude());
  }
}

TEST(Backbone, RefusesWhatItCannotFollow) {
  const System slip(model_of("1", "k*y + r", {{"r", "k2*v", "-R", "R"}}));
  EXPECT_EQ(fault_of([&] {
              backbone(slip, theta_of(slip, {{"k", 1}, {"k2", 1}, {"R", 1}}), amplitudes(1, 2));
            }),
            "backbone: the state 'r' is held at a bound, which harmonic balance cannot follow");
  const System heavy(model_of("1", "c*v + k*y"));
  const auto theta = theta_of(heavy, {{"c", 5}, {"k", 1}});
  EXPECT_EQ(fault_of([&] { backbone(heavy, theta, amplitudes(1, 2)); }),
            "backbone: mode: the model has 0 oscillating modes at rest, got 1");
  EXPECT_EQ(fault_of([&] { backbone(heavy, theta, amplitudes(2, 1)); }),
            "backbone: to: expected > from, which is 2 m, got 1");
  EXPECT_EQ(fault_of([&] { backbone(heavy, theta, amplitudes(0, 1)); }), "backbone: from: expected > 0 m, got 0");
  EXPECT_EQ(fault_of([&] { backbone(heavy, theta, amplitudes(1, 2, 0)); }), "backbone: mode: expected >= 1, got 0");
}

}  // namespace
}  // namespace lunid
