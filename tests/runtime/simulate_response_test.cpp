// Frequency responses against closed forms, by harmonic balance and by shooting.
#include "simulate/response.hpp"

#include "simulate/floquet.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using std::numbers::pi;
using testing::fault_of;
using testing::force_of;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_substeps;

std::vector<HarmonicInput> cosine(double amplitude) { return {{0, 1, amplitude, 0}}; }

ResponseOptions range(double from, double to, ResponseMethod method = ResponseMethod::automatic, int harmonics = 0) {
  ResponseOptions options;
  options.from = from;
  options.to = to;
  options.method = method;
  options.harmonics = harmonics;
  return options;
}

ResponseCurve response(const System& system, const std::vector<double>& theta, double amplitude,
                       const ResponseOptions& options) {
  return frequency_response(system, theta, cosine(amplitude), options);
}

std::vector<ResponsePoint> marked(const ResponseCurve& curve, const std::string& kind) {
  std::vector<ResponsePoint> list;
  for (const ResponsePoint& point : curve.points)
    if (point.mark == kind) list.push_back(point);
  return list;
}

/// Case 1 of the thesis.
struct Duffing {
  double m = 1, c = 10, k = 2e4, k3 = 1e6;
  System system{model_of("m", "c*v + k*y + k3*y^3")};
  std::vector<double> theta = theta_of(system, {{"m", m}, {"c", c}, {"k", k}, {"k3", k3}});

  /// Thesis (B.10), squared: zero on the curve of one harmonic.
  double one_harmonic(double frequency, double a, double force) const {
    const double w = 2 * pi * frequency, spring = k - m * w * w + 0.75 * k3 * a * a;
    return a * a * (spring * spring + c * w * c * w) / (force * force) - 1;
  }
};

// m a + c v + k y = F: the answer is F / (k - m w^2 + i c w), and the multipliers are exp(lambda T).
TEST(Response, OfALinearOscillatorIsItsTransferFunction) {
  const System system(model_of("m", "c*v + k*y"));
  const double m = 1.3, c = 7, k = 9e3;
  const auto theta = theta_of(system, {{"m", m}, {"c", c}, {"k", k}});
  for (const auto method : {ResponseMethod::harmonic_balance, ResponseMethod::shooting}) {
    const ResponseCurve curve = response(system, theta, 20, range(0.5, 60, method));
    EXPECT_TRUE(curve.complete) << curve.stopped.front();
    EXPECT_GT(curve.points.size(), 60U);
    const bool balance = method == ResponseMethod::harmonic_balance;
    for (const ResponsePoint& point : curve.points) {
      const double w = 2 * pi * point.frequency;
      const std::complex<double> exact = 20.0 / std::complex<double>(k - m * w * w, c * w);
      EXPECT_LT(std::abs(point.motion[0].harmonics[1] - exact), (balance ? 1e-11 : 3e-6) * std::abs(exact));
      EXPECT_NEAR(point.motion[0].amplitude() / std::abs(exact), 1, balance ? 1e-11 : 3e-6);
      EXPECT_LT(std::abs(point.motion[1].harmonics[1] - std::complex<double>(0, w) * exact),
                (balance ? 1e-11 : 3e-6) * w * std::abs(exact));
      EXPECT_TRUE(point.stable);
      const std::complex<double> root(-c / (2 * m), std::sqrt(k / m - c * c / (4 * m * m)));
      const std::complex<double> multiplier = std::exp(root * (2 * pi / w));
      ASSERT_EQ(point.multipliers.size(), 2U);
      // which of the pair comes first is open
      const auto found =
          point.multipliers[0].imag() * multiplier.imag() > 0 ? point.multipliers[0] : std::conj(point.multipliers[0]);
      EXPECT_LT(std::abs(found - multiplier), balance ? 1e-11 : 1e-5) << "at " << point.frequency << " Hz";
    }
    const auto peaks = marked(curve, "peak");
    ASSERT_EQ(peaks.size(), 1U);
    EXPECT_NEAR(peaks[0].frequency, std::sqrt(k / m - c * c / (2 * m * m)) / (2 * pi), balance ? 1e-4 : 1e-2);
  }
}

// One harmonic is the amplitude equation of Duffing's oscillator (thesis, B.10; Nayfeh & Mook 1979, section 4.1).
TEST(Response, OfOneHarmonicIsTheClosedFormOfDuffing) {
  const Duffing duffing;
  for (const double force : {300.0, 1000.0}) {
    const ResponseCurve curve =
        response(duffing.system, duffing.theta, force, range(0.5, 150, ResponseMethod::harmonic_balance, 1));
    EXPECT_TRUE(curve.complete) << curve.stopped.front();
    EXPECT_EQ(curve.method, "harmonic balance, 1 harmonic");
    for (const ResponsePoint& point : curve.points)
      EXPECT_NEAR(duffing.one_harmonic(point.frequency, std::abs(point.motion[0].harmonics[1]), force), 0, 1e-8);
    // Folds: dF^2/dA = 0 along w = const, (k - w^2 + 9/4 k3 A^2)(k - w^2 + 3/4 k3 A^2) + (c w)^2 = 0.
    const auto folds = marked(curve, "fold");
    ASSERT_EQ(folds.size(), 2U);
    for (const ResponsePoint& fold : folds) {
      const double w = 2 * pi * fold.frequency, a = std::abs(fold.motion[0].harmonics[1]);
      const double linear = duffing.k - w * w, cubic = 0.75 * duffing.k3 * a * a, damping = duffing.c * w;
      const double size = (std::abs(linear) + 3 * cubic) * (std::abs(linear) + cubic);
      EXPECT_NEAR(((linear + 3 * cubic) * (linear + cubic) + damping * damping) / size, 0, 1e-8);
    }
    EXPECT_GT(folds[0].frequency, folds[1].frequency);
  }
}

TEST(Response, OfDuffingIsUnstableBetweenItsFoldsAlone) {
  const Duffing duffing;
  const ResponseCurve curve = response(duffing.system, duffing.theta, 300, range(0.5, 150));
  EXPECT_TRUE(curve.complete) << curve.stopped.front();
  EXPECT_FALSE(curve.truncated);
  const auto folds = marked(curve, "fold");
  ASSERT_EQ(folds.size(), 2U);
  int inside = 0;
  bool between = false;
  for (const ResponsePoint& point : curve.points) {
    if (point.mark == "fold") {
      between = !between;
      EXPECT_NEAR(std::abs(point.multipliers[0]), 1, 1e-4);
      continue;
    }
    EXPECT_EQ(point.stable, !between) << "at " << point.frequency << " Hz";
    inside += between ? 1 : 0;
  }
  EXPECT_GT(inside, 10);
}

/// A run over a whole number of periods from the state that the answer has at t = 0: how far its end is from its start
/// and from the answer, over the amplitude.
double worst_of_run(const System& system, const std::vector<double>& theta, const ResponsePoint& point, double force,
                    int periods) {
  Eigen::VectorXd x0(system.states());
  for (Eigen::Index i = 0; i < x0.size(); ++i) {
    x0[i] = 0;
    for (const auto& c : point.motion[static_cast<std::size_t>(i)].harmonics) x0[i] += c.real();
  }
  const double period = 1 / point.frequency, samples = 200;
  const double w = 2 * pi * point.frequency;
  const lunid::Run run = simulate(
      system, theta, force_of(periods * period, period / samples, [&](double t) { return force * std::cos(w * t); }),
      x0, with_substeps(8));
  EXPECT_TRUE(run.summary.completed) << run.summary.cause;
  double worst = 0;
  for (Eigen::Index row = run.x.rows() - 1 - static_cast<Eigen::Index>(samples); row < run.x.rows(); ++row) {
    const double t = run.dt * static_cast<double>(row);
    double y = 0;
    for (std::size_t k = 0; k < point.motion[0].harmonics.size(); ++k)
      y += (point.motion[0].harmonics[k] * std::exp(std::complex<double>(0, static_cast<double>(k) * w * t))).real();
    worst = std::max(worst, std::abs(y - run.x(row, 0)));
  }
  return worst / point.motion[0].amplitude();
}

TEST(Response, OfDuffingIsThatOfFreeRunsOnItsStableBranches) {
  const Duffing duffing;
  for (const double force : {300.0, 1000.0}) {
    const ResponseCurve curve = response(duffing.system, duffing.theta, force, range(8, 80));
    ASSERT_TRUE(curve.complete) << curve.stopped.front();
    int compared = 0;
    for (std::size_t i = 0; i < curve.points.size(); i += 8) {
      if (!curve.points[i].stable || !curve.points[i].mark.empty()) continue;
      EXPECT_LT(worst_of_run(duffing.system, duffing.theta, curve.points[i], force, 40), 1e-5)
          << force << " N at " << curve.points[i].frequency << " Hz, " << curve.points[i].harmonics << " harmonics";
      ++compared;
    }
    EXPECT_GT(compared, 8);
  }
}

TEST(Response, OfNineHarmonicsIsThatOfFreeRuns) {
  const Duffing duffing;
  const ResponseCurve curve =
      response(duffing.system, duffing.theta, 300, range(10, 60, ResponseMethod::harmonic_balance, 9));
  for (std::size_t i = 0; i < curve.points.size(); i += 12) {
    if (!curve.points[i].stable || !curve.points[i].mark.empty()) continue;
    EXPECT_LT(worst_of_run(duffing.system, duffing.theta, curve.points[i], 300, 40), 1e-5)
        << "at " << curve.points[i].frequency << " Hz";
  }
}

// Both methods follow the same branch, folds and multipliers included.
TEST(Response, ByShootingIsThatByHarmonicBalance) {
  const Duffing duffing;
  const ResponseCurve a = response(duffing.system, duffing.theta, 300, range(5, 80, ResponseMethod::shooting));
  const ResponseCurve b = response(duffing.system, duffing.theta, 300, range(5, 80, ResponseMethod::harmonic_balance));
  ASSERT_TRUE(a.complete) << a.stopped.front();
  EXPECT_EQ(a.method, "shooting");
  for (const char* kind : {"fold", "peak"}) {
    const auto in_a = marked(a, kind), in_b = marked(b, kind);
    ASSERT_EQ(in_a.size(), in_b.size()) << kind;
    for (std::size_t i = 0; i < in_a.size(); ++i) {
      EXPECT_NEAR(in_a[i].frequency / in_b[i].frequency, 1, 1e-5);
      EXPECT_NEAR(in_a[i].motion[0].amplitude() / in_b[i].motion[0].amplitude(), 1, 1e-4);
      EXPECT_NEAR(std::abs(in_a[i].multipliers[1]), std::abs(in_b[i].multipliers[1]), 1e-4);
    }
  }
}

// Den Hartog 1931 (Trans. ASME 53, APM-53-9): harmonic force on a mass with dry friction, without stops. With r = w/wn,
// U = sin(pi/r) / (r (1 + cos(pi/r))), V = 1 / (1 - r^2): amplitude = (F/k) sqrt(V^2 - (Fc/F)^2 U^2).
TEST(Response, OfDryFrictionIsDenHartogsClosedForm) {
  const System system(model_of("m", "k*y + Fc*sign(v)"));
  const double m = 2, k = 800, force = 10;
  for (const double ratio : {0.2, 0.5}) {
    const auto theta = theta_of(system, {{"m", m}, {"k", k}, {"Fc", ratio * force}});
    const double natural = std::sqrt(k / m) / (2 * pi);
    int compared = 0;
    for (const auto& [from, to] : {std::pair(0.7, 0.95), std::pair(1.05, 1.6)}) {
      const ResponseCurve curve = response(system, theta, force, range(from * natural, to * natural));
      EXPECT_EQ(curve.method, "shooting (the model has switches)");
      EXPECT_TRUE(curve.complete) << curve.stopped.front();
      for (const ResponsePoint& point : curve.points) {
        const double r = point.frequency / natural;
        const double u = std::sin(pi / r) / (r * (1 + std::cos(pi / r))), v = 1 / (1 - r * r);
        const double exact = force / k * std::sqrt(v * v - ratio * ratio * u * u);
        EXPECT_NEAR(point.motion[0].amplitude() / exact, 1, 2e-6) << "r = " << r << ", Fc/F = " << ratio;
        EXPECT_TRUE(point.stable);
        ++compared;
      }
    }
    EXPECT_GT(compared, 10);
  }
}

}  // namespace
}  // namespace lunid
