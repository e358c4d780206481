// Filters, trends, rates, delays and integrals against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "message.hpp"
#include "record/treat.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::span<const double> span_of(const VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

VectorXd sampled(Index n, const std::function<double(double)>& f) {
  return VectorXd::NullaryExpr(n, [&](Index i) { return f(static_cast<double>(i)); });
}

Channel channel(const std::string& name, const VectorXd& values, double noise = 0) {
  Channel c;
  c.name = name;
  c.values = values;
  c.noise = noise;
  return c;
}

/// |H|^2 of Butterworth's low pass, from its definition, not from poles: 1/(1 + (tan/tan)^2n).
double low_pass_square(double f, double cut, int order, double dt) {
  return 1 / (1 + std::pow(std::tan(M_PI * f * dt) / std::tan(M_PI * cut * dt), 2 * order));
}

TEST(Butterworth, HasTheAmplitudeOfItsDefinition) {
  const double dt = 0.01;
  for (int order = 1; order <= 12; ++order) {
    const auto low = butterworth({0, 9, false}, order, dt), high = butterworth({9, 0, false}, order, dt);
    const auto band = butterworth({6, 14, false}, order, dt), stop = butterworth({6, 14, true}, order, dt);
    EXPECT_EQ(low.size(), static_cast<std::size_t>((order + 1) / 2));
    EXPECT_EQ(band.size(), static_cast<std::size_t>(order));
    for (const double f : {0.5, 3.0, 6.0, 9.0, 14.0, 25.0, 40.0}) {
      const double square = low_pass_square(f, 9, order, dt);
      EXPECT_NEAR(std::pow(amplitude_at(low, f, dt), 2), square, 1e-10) << order << " " << f;
      EXPECT_NEAR(std::pow(amplitude_at(high, f, dt), 2), 1 - square, 1e-10) << order << " " << f;
      const auto t = [&](double g) { return std::tan(M_PI * g * dt); };
      const double s = (t(f) * t(f) - t(6) * t(14)) / (t(f) * (t(14) - t(6)));  // where the low pass of cut-off 1 is
      EXPECT_NEAR(std::pow(amplitude_at(band, f, dt), 2), 1 / (1 + std::pow(s, 2 * order)), 1e-8) << order << " " << f;
      EXPECT_NEAR(std::pow(amplitude_at(stop, f, dt), 2), 1 - 1 / (1 + std::pow(s, 2 * order)), 1e-8)
          << order << " " << f;
    }
  }
}

TEST(Butterworth, HasTheKnownCoefficients) {
  // Second order, cut-off at a quarter of the rate: b = (1, 2, 1)/(2 + sqrt 2), a = (1, 0, (2 - sqrt 2)/(2 + sqrt 2)).
  const Section s = butterworth({0, 0.25, false}, 2, 1).at(0);
  EXPECT_NEAR(s.b0, 1 / (2 + std::sqrt(2)), 1e-15);
  EXPECT_NEAR(s.b1, 2 / (2 + std::sqrt(2)), 1e-15);
  EXPECT_NEAR(s.b2, 1 / (2 + std::sqrt(2)), 1e-15);
  EXPECT_NEAR(s.a1, 0, 1e-15);
  EXPECT_NEAR(s.a2, (2 - std::sqrt(2)) / (2 + std::sqrt(2)), 1e-15);
}

TEST(FilterZeroPhase, PassesAToneWithTheSquaredAmplitudeAndNoDelayUpToTheEnds) {
  const double dt = 0.01;
  const VectorXd x = sampled(900, [&](double i) { return std::sin(2 * M_PI * 3 * dt * i + 0.4); });
  const VectorXd y = filter_zero_phase(span_of(x), {0, 5, false}, 4, dt);
  EXPECT_LT((y - low_pass_square(3, 5, 4, dt) * x).cwiseAbs().maxCoeff(), 2e-3);  // the ends: linear prediction
  EXPECT_LT((y - low_pass_square(3, 5, 4, dt) * x).segment(200, 500).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(FilterZeroPhase, LinesPassOrVanishExactly) {
  const VectorXd line = sampled(400, [](double i) { return 7 - 0.03 * i; });
  EXPECT_LT((filter_zero_phase(span_of(line), {0, 0.1, false}, 5, 1) - line).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT((filter_zero_phase(span_of(line), {0.1, 0.2, true}, 3, 1) - line).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT(filter_zero_phase(span_of(line), {0.1, 0, false}, 5, 1).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT(filter_zero_phase(span_of(line), {0.1, 0.2, false}, 3, 1).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Filter, ChangesTheChannelsAskedForAndTheirNoise) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const VectorXd noise = sampled(20000, [&](double) { return normal(random); });
  const Record record("run", 1, 0.01, {channel("F", noise, 1), channel("y", noise, 1)});
  const Record filtered = filter(record, {{0, 10, false}, 4, {"y"}});
  EXPECT_EQ(filtered.channel("F").values, noise);
  const double left = std::sqrt(filtered.channel("y").values.squaredNorm() / 20000);
  EXPECT_NEAR(filtered.channel("y").noise / left, 1, 0.03);  // a fifth of the band: 4000 independent rows
  EXPECT_EQ(filtered.history().back(), "filter: y below 10 Hz, Butterworth of order 4 forwards and backwards");
  EXPECT_EQ(filtered.start(), 1);
}

TEST(Filter, RefusesWhatCannotBe) {
  const Record record("run", 0, 0.01, {channel("y", VectorXd::LinSpaced(100, 0, 1))});
  const auto said = [&](Band band, int order = 4, std::vector<std::string> names = {}) {
    return message([&] { filter(record, {band, order, names}); });
  };
  EXPECT_EQ(said({0, 50, false}), "filter: to: expected < 50 Hz, the Nyquist frequency, got 50");
  EXPECT_EQ(said({60, 0, false}), "filter: from: expected < 50 Hz, the Nyquist frequency, got 60");
  EXPECT_EQ(said({20, 10, false}), "filter: to: expected > from, which is 20, got 10");
  EXPECT_EQ(said({0, 0, false}), "filter: give from, to or both");
  EXPECT_EQ(said({0, 10, false}, 13), "filter: order: expected 1 to 12, got 13");
  EXPECT_EQ(said({0, 10, false}, 4, {"z"}), "filter: the record has no channel 'z' (it has y)");
}

TEST(Detrend, TakesOffPolynomialsAndNothingElse) {
  const VectorXd cubic = sampled(300, [](double i) { return 3 - i + 0.02 * i * i - 1e-4 * i * i * i; });
  EXPECT_LT(without_polynomial(span_of(cubic), 3).cwiseAbs().maxCoeff(), 1e-10 * cubic.cwiseAbs().maxCoeff());
  EXPECT_NEAR(without_polynomial(span_of(cubic), 0).mean(), 0, 1e-9);
  const VectorXd rest = without_polynomial(span_of(cubic), 2);
  EXPECT_LT((without_polynomial(span_of(rest), 2) - rest).cwiseAbs().maxCoeff(), 1e-9);
  const Record record("run", 0, 1, {channel("y", cubic)});
  EXPECT_EQ(detrend(record, 1, {}).history().back(), "detrend: y less a line");
  EXPECT_EQ(message([&] { detrend(record, 13, {}); }), "detrend: degree: expected 0 to 12, got 13");
}

TEST(Rates, BandLimitedInterpolationFindsATone) {
  const auto tone = [](double i) { return 3 + 0.01 * i + std::sin(0.9 * i + 0.2) + std::cos(0.11 * i); };
  const VectorXd x = sampled(600, tone), fine = band_limited(span_of(x), 0.37, 0.5, 1190);
  double inside = 0;
  for (Index i = 100; i < 1090; ++i) inside = std::max(inside, std::abs(fine[i] - tone(0.37 + 0.5 * double(i))));
  EXPECT_LT(inside, 1e-4);
  EXPECT_LT((band_limited(span_of(x), 0, 1, 600) - x).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Rates, DecimationKeepsWhatFitsAndDropsWhatWouldFold) {
  const auto slow = [](double i) { return std::sin(2 * M_PI * 0.05 * i); };  // new Nyquist: 0.125 of the old rate
  const VectorXd x = sampled(4000, [&](double i) { return slow(i) + std::sin(2 * M_PI * 0.21 * i); });
  const Record coarse = decimate(Record("run", 2, 0.01, {channel("y", x, 1)}), 4);
  ASSERT_EQ(coarse.rows(), 1000);
  EXPECT_NEAR(coarse.dt(), 0.04, 1e-15);
  for (Index i = 100; i < 900; ++i) EXPECT_NEAR(coarse["y"][static_cast<std::size_t>(i)], slow(4.0 * double(i)), 1e-4);
  EXPECT_NEAR(coarse.channel("y").noise, std::sqrt(0.9 / 4), 1e-12);
  EXPECT_EQ(coarse.history().back(), "decimate: every row of 4, without what lies above 12.5 Hz");
}

TEST(Rates, ResamplingKeepsTheTime) {
  const Record record("run", 1, 0.01, {channel("y", sampled(501, [](double i) { return std::sin(0.2 * i); }))});
  const Record other = resample(record, 64);
  EXPECT_EQ(other.rows(), 321);
  EXPECT_EQ(other.start(), 1);
  for (Index i = 30; i < 290; ++i)
    EXPECT_NEAR(other["y"][static_cast<std::size_t>(i)], std::sin(0.2 * 100 * (other.time(i) - 1)), 1e-4);
}

TEST(Rates, RefuseWhatCannotBe) {
  const Record record("run", 0, 0.01, {channel("y", VectorXd::LinSpaced(101, 0, 1))});
  EXPECT_EQ(message([&] { decimate(record, 30); }), "decimate: factor: expected 1 to 20 for 101 rows, got 30");
  EXPECT_EQ(message([&] { resample(record, 1); }), "resample: rate: expected >= 5 Hz, which leaves 6 rows, got 1");
  EXPECT_EQ(message([&] { resample(record, 1e12); }), "resample: rate: 1e+12 Hz would make 1e+12 rows");
}

/// A broad motion at any time, as a sum of tones.
double broad(double t) {
  double sum = 0;
  for (int k = 1; k <= 12; ++k) sum += std::sin(2 * M_PI * (0.8 * k + 0.013 * k * k) * t + k * k);
  return sum;
}

TEST(Align, FindsAPartOfARow) {
  const double dt = 0.01;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 0.1);
  for (const double delay : {0.0, 0.1337, -0.2512}) {
    const Record one("one", 0, dt,
                     {channel("y", sampled(1500, [&](double i) { return broad(dt * i) + normal(random); }))});
    const Record two("two", 0, dt,
                     {channel("y", sampled(1400, [&](double i) { return broad(dt * i - delay) + normal(random); }))});
    const Aligned moved = align(two, one, {"y", 0});
    EXPECT_NEAR(moved.delay, delay, 0.02 * dt);
    EXPECT_GT(moved.correlation, 0.99);
    double square = 0;
    for (Index i = 50; i + 50 < moved.record.rows(); ++i)
      square += std::pow(moved.record["y"][static_cast<std::size_t>(i)] - broad(moved.record.time(i)), 2);
    EXPECT_LT(std::sqrt(square / static_cast<double>(moved.record.rows() - 100)), 0.15);
  }
}

TEST(Align, CountsByTheClocks) {
  // The same clock, another start: no delay.
  const double dt = 0.01;
  const Record one("one", 0, dt, {channel("F", sampled(1000, [&](double i) { return broad(dt * i); }))});
  const Record two("two", 3, dt, {channel("F", sampled(600, [&](double i) { return broad(3 + dt * i); }))});
  const Aligned moved = align(two, one, {"F", 0});
  EXPECT_NEAR(moved.delay, 0, 1e-6);
  EXPECT_NEAR(moved.record.start(), 3, 0.011);
}

TEST(Align, RefusesWhatCannotBe) {
  const Record one("one", 0, 0.01, {channel("y", sampled(100, broad))}),
      two("two", 0, 0.02, {channel("y", sampled(100, broad))}),
      flat("flat", 0, 0.01, {channel("y", VectorXd::Ones(100))});
  EXPECT_EQ(message([&] { align(one, two, {}); }), "align: the records have 100 and 50 Hz: resample one of them first");
  EXPECT_EQ(message([&] { align(one, flat, {}); }), "align: channel 'y' is constant, 1: there is no motion in it");
  EXPECT_EQ(message([&] { align(one, one, {"F", 0}); }), "align: the record has no channel 'F' (it has y)");
}

TEST(Integrate, ControlsDrift) {
  // 20 cycles with an offset and noise of the accelerometer: an open integral drifts by many amplitudes.
  const double dt = 0.005, w = 2 * M_PI * 2;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, 2);
  const VectorXd a = sampled(2001, [&](double i) { return -w * w * std::sin(w * dt * i) + 4 + normal(random); });
  Channel acceleration = channel("a", a, 2);
  acceleration.unit = "m/s^2";
  const Record record("run", 0, dt, {acceleration});
  const auto error = [&](const Record& r, const char* name, double amplitude, double phase) {
    double square = 0;
    for (Index i = 200; i < 1800; ++i)
      square += std::pow(r[name][static_cast<std::size_t>(i)] - amplitude * std::sin(w * dt * double(i) + phase), 2);
    return std::sqrt(square / 1600) / amplitude;
  };
  const Record passed = integrate(record, {"a", 1, 0.5}), straight = integrate(record, {"", 1, 0});
  EXPECT_LT(error(passed, "y", 1, 0), 0.03);
  EXPECT_LT(error(passed, "v", w, M_PI / 2), 0.03);
  EXPECT_LT(error(straight, "v", w, M_PI / 2), 0.1);
  EXPECT_EQ(passed.channel("y").unit, "m");
  EXPECT_EQ(passed.channel("v").derivation, "of a by integration, less all below 0.5 Hz");
  EXPECT_EQ(straight.channel("y").derivation, "of a by integration, less a polynomial of degree 2");
}

TEST(Integrate, StatesTheNoiseThatIsLeft) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  for (const double below : {0.0, 1.0}) {
    double v = 0, y = 0, stated_v = 0, stated_y = 0;
    const int draws = 60;
    for (int k = 0; k < draws; ++k) {
      const Record record("run", 0, 0.01, {channel("a", sampled(1000, [&](double) { return normal(random); }), 1)});
      const Record done = integrate(record, {"a", 1, below});
      v += done.channel("v").values.squaredNorm() / 1000 / draws;
      y += done.channel("y").values.squaredNorm() / 1000 / draws;
      stated_v = done.channel("v").noise, stated_y = done.channel("y").noise;
    }
    EXPECT_NEAR(std::sqrt(v) / stated_v, 1, 0.12) << below;  // walks differ by half of their size
    EXPECT_NEAR(std::sqrt(y) / stated_y, 1, 0.2) << below;
  }
}

TEST(Integrate, RefusesWhatCannotBe) {
  const Record y("run", 0, 1, {channel("y", sampled(50, broad))});
  EXPECT_EQ(message([&] { integrate(y, {}); }), "integrate: expected a measured acceleration a or velocity v");
  EXPECT_EQ(message([&] {
              integrate(y, {"y", 1, 0});
            }),
            "integrate: from: expected an acceleration or a velocity, got 'y'");
  const Record both("run", 0, 1, {channel("y", sampled(50, broad)), channel("v", sampled(50, broad))});
  EXPECT_EQ(message([&] { integrate(both, {}); }), "integrate: nothing to make: all that lies below 'v' was measured");
}

}  // namespace
}  // namespace lunid
