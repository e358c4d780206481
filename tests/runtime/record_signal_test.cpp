// Random signals of a given spectrum, and what sensors do to a signal.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "message.hpp"
#include "record/random_signal.hpp"
#include "record/sensor.hpp"
#include "record/spectrum.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Kind = SensorFault::Kind;

double rms(const VectorXd& x) { return std::sqrt(x.squaredNorm() / static_cast<double>(x.size())); }
double deviation(const VectorXd& x) { return std::sqrt((x.array() - x.mean()).square().mean()); }

/// Slope of log(power) over log(frequency) between two bins.
double spectral_slope(const VectorXd& x, Index from, Index to) {
  const Spectrum s = welch({x.data(), static_cast<std::size_t>(x.size())}, 4096);
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (Index k = from; k <= to; ++k) {
    const double u = std::log(static_cast<double>(k)), w = std::log(s.density[k]);
    n += 1;
    sx += u;
    sy += w;
    sxx += u * u;
    sxy += u * w;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(RandomSignal, ColouredNoiseFallsAsPromised) {
  for (const double exponent : {-1.0, 0.0, 1.0, 2.0}) {
    Philox random(3, 0);
    const VectorXd x = coloured_noise(200000, exponent, random);
    EXPECT_NEAR(rms(x), 1, 1e-12);
    EXPECT_NEAR(x.mean(), 0, 1e-12);
    // some 100 half-overlapping segments, 1000 bins: the slope is known to a hundredth; leakage adds its own
    EXPECT_NEAR(spectral_slope(x, 20, 1000), -exponent, 0.03) << exponent;
  }
}

TEST(RandomSignal, BandLimitedNoiseHasNoPowerOutside) {
  Philox random(4, 0);
  const double dt = 1e-3;
  const VectorXd x = band_limited_noise(100000, dt, 50, 120, random);
  EXPECT_NEAR(rms(x), 1, 1e-12);
  const Spectrum s = welch({x.data(), static_cast<std::size_t>(x.size())}, 4096);
  double inside = 0, outside = 0, quarter[2] = {0, 0};
  for (Index k = 0; k < s.density.size(); ++k) {
    const double f = static_cast<double>(k) / (4096 * dt);
    if (f > 49 && f < 121)
      inside += s.density[k];
    else
      outside += s.density[k];
    if (f > 55 && f < 80) quarter[0] += s.density[k];
    if (f > 90 && f < 115) quarter[1] += s.density[k];
  }
  EXPECT_LT(outside, 1e-4 * inside);
  EXPECT_NEAR(quarter[0] / quarter[1], 1, 0.1);  // even within; 100 bins of some 40 independent segments each: 2 %
}

TEST(RandomSignal, AutoregressionHasItsCorrelation) {
  Philox random(5, 0);
  const double ar[] = {1.5, -0.8};  // rho1 = 1.5 / 1.8, rho2 = 1.5 rho1 - 0.8 (Yule-Walker)
  const VectorXd x = autoregressive_noise(200000, ar, random);
  const Index n = x.size();
  const auto correlation = [&](Index lag) { return x.head(n - lag).dot(x.tail(n - lag)) / x.squaredNorm(); };
  EXPECT_NEAR(correlation(1), 1.5 / 1.8, 0.01);
  EXPECT_NEAR(correlation(2), 1.5 * 1.5 / 1.8 - 0.8, 0.02);
}

TEST(RandomSignal, RefusesWhatCannotBe) {
  Philox random(1, 0);
  EXPECT_EQ(message([&] { band_limited_noise(1000, 1e-3, 100, 600, random); }),
            "band_limited_noise: expected 0 <= from < to <= 500 Hz (the Nyquist frequency), got 100 to 600");
  EXPECT_EQ(message([&] { band_limited_noise(1000, 1e-3, 100.1, 100.2, random); }),
            "band_limited_noise: 100.1 to 100.2 Hz is too narrow for 1 s: expected a band of at least 1 Hz");
  const double grows[] = {1.01};
  EXPECT_EQ(message([&] { autoregressive_noise(10, grows, random); }),
            "autoregressive_noise: the series grows by a factor of 1.01 per row; expected less than 1");
  EXPECT_EQ(message([&] { coloured_noise(10, 9, random); }), "coloured_noise: exponent: expected -4 to 4, got 9");
}

/// A slow sine of amplitude 2 with 20000 rows.
VectorXd signal() {
  return VectorXd::NullaryExpr(20000, [](Index i) { return 2 * std::sin(0.01 * static_cast<double>(i)); });
}

VectorXd faulty(const SensorFault& fault, Index* hit = nullptr) {
  Philox random(11, 0);
  VectorXd x = signal();
  const Index count = apply(fault, x, random);
  if (hit) *hit = count;
  return x;
}

SensorFault of(Kind kind, double size) {
  SensorFault fault;
  fault.kind = kind;
  fault.size = size;
  return fault;
}

TEST(SensorFault, NoiseHasItsSize) {
  const double n = 20000;
  EXPECT_NEAR(deviation(faulty(of(Kind::gaussian, 0.1)) - signal()), 0.1, 4 * 0.1 / std::sqrt(2 * n));
  SensorFault relative = of(Kind::gaussian, 0.05);
  relative.relative = true;
  EXPECT_NEAR(deviation(faulty(relative) - signal()), 0.05 * deviation(signal()), 4 * 0.1 / std::sqrt(2 * n));
  const VectorXd uniform = faulty(of(Kind::uniform, 0.3)) - signal();
  EXPECT_LT(uniform.cwiseAbs().maxCoeff(), 0.3);
  EXPECT_NEAR(deviation(uniform), 0.3 / std::sqrt(3), 0.002);
  SensorFault pink = of(Kind::coloured, 0.2);
  pink.exponent = 1;
  EXPECT_NEAR(rms(faulty(pink) - signal()), 0.2, 1e-9);
}

TEST(SensorFault, MultiplicativeNoiseGrowsWithTheSignal) {
  const VectorXd x = signal(), gain = (faulty(of(Kind::multiplicative, 0.1)).array() / x.array()).matrix().tail(19999);
  EXPECT_NEAR(deviation(gain), 0.1, 0.002);
  EXPECT_NEAR(gain.mean(), 1, 0.003);
}

TEST(SensorFault, PoissonNoiseHasTheVarianceOfItsCounts) {
  Philox random(3, 0);
  VectorXd x = VectorXd::Constant(50000, -2);
  apply(of(Kind::poisson, 0.01), x, random);
  EXPECT_NEAR(x.mean(), -2, 4 * std::sqrt(0.02 / 50000));
  EXPECT_NEAR(deviation(x), std::sqrt(0.02), 4 * std::sqrt(0.02 / 2 / 50000));
  for (const double value : x) EXPECT_NEAR(value / 0.01, std::round(value / 0.01), 1e-6);
}

TEST(SensorFault, OutliersAreFewAndFar) {
  SensorFault fault = of(Kind::outliers, 7);
  fault.fraction = 0.01;
  Index hit = 0;
  const VectorXd off = faulty(fault, &hit) - signal();
  Index found = 0;
  for (const double value : off) {
    if (value == 0) continue;
    EXPECT_NEAR(std::abs(value), 7, 1e-12);
    ++found;
  }
  EXPECT_EQ(found, hit);
  EXPECT_NEAR(static_cast<double>(hit), 200, 4 * std::sqrt(200 * 0.99));
}

TEST(SensorFault, LostRowsAreFilled) {
  SensorFault fault = of(Kind::dropped, 0);
  fault.fraction = 0.3;
  Index lost = 0;
  const VectorXd x = signal(), held = faulty(fault, &lost);
  EXPECT_NEAR(static_cast<double>(lost), 6000, 4 * std::sqrt(20000 * 0.3 * 0.7));
  Index repeated = 0;
  for (Index i = 1; i < x.size(); ++i) {
    if (held[i] == x[i]) continue;
    EXPECT_EQ(held[i], held[i - 1]);
    ++repeated;
  }
  EXPECT_NEAR(static_cast<double>(repeated), static_cast<double>(lost), 1);
  fault.fill = SensorFault::Fill::linear;
  const double curvature = 2 * 1e-4;  // of the sine, per row^2: straight lines over the longest gaps stay within
  EXPECT_LT((faulty(fault) - x).cwiseAbs().maxCoeff(), curvature * 15 * 15 / 8);
  fault.fill = SensorFault::Fill::gap;
  EXPECT_EQ(faulty(fault).array().isNaN().count(), lost);
  fault.fraction = 1;
  fault.fill = SensorFault::Fill::hold;
  EXPECT_TRUE(faulty(fault).array().isNaN().all());  // nothing to repeat
}

TEST(SensorFault, ConverterHasItsLevels) {
  const VectorXd stepped = faulty(of(Kind::quantised, 0.25));
  for (const double value : stepped) EXPECT_EQ(value * 4, std::round(value * 4));
  EXPECT_LE((stepped - signal()).cwiseAbs().maxCoeff(), 0.125);
  SensorFault converter = of(Kind::quantised, 1.5);
  converter.bits = 3;
  Index beyond = 0;
  const VectorXd coarse = faulty(converter, &beyond);
  const std::set<double> levels(coarse.begin(), coarse.end());
  EXPECT_EQ(levels.size(), 8u);
  EXPECT_EQ(*levels.begin(), -1.5);
  EXPECT_NEAR(*levels.rbegin(), 1.5, 1e-15);
  EXPECT_EQ(beyond, (signal().array().abs() > 1.5).count());
}

TEST(SensorFault, ClippingHoldsTheLevel) {
  SensorFault fault = of(Kind::clipped, 0.5);
  fault.relative = true;  // of the largest magnitude
  Index hit = 0;
  const VectorXd x = faulty(fault, &hit);
  const double level = 0.5 * signal().cwiseAbs().maxCoeff();
  EXPECT_EQ(x.maxCoeff(), level);
  EXPECT_EQ(x.minCoeff(), -level);
  EXPECT_NEAR(static_cast<double>(hit), 20000 * 2.0 / 3, 100);  // |sin| > 1/2 for two thirds of the time
}

TEST(SensorFault, RefusesWhatCannotBe) {
  EXPECT_EQ(message([] { faulty(of(Kind::gaussian, 0)); }), "noise: size: expected > 0, got 0");
  SensorFault fault = of(Kind::dropped, 0);
  fault.fraction = 1.5;
  EXPECT_EQ(message([&] { faulty(fault); }), "noise: fraction: expected 0 to 1, got 1.5");
}

}  // namespace
}  // namespace lunid
