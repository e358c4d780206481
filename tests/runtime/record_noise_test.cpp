// The noise estimate against noise of known level under known signals.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "record/record.hpp"
#include "record/spectra.hpp"

namespace lunid {
namespace {

using Signal = std::function<double(double)>;  // of the time in samples

std::vector<double> noisy(const Signal& signal, int rows, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, noise);
  std::vector<double> x(static_cast<std::size_t>(rows));
  for (int i = 0; i < rows; ++i) x[static_cast<std::size_t>(i)] = signal(i) + (noise > 0 ? normal(random) : 0.0);
  return x;
}

/// Checks the estimate for 40, 30 and 20 dB (noise over the standard deviation of a unit sine), several seeds
/// each.
void expect_level(const Signal& signal, int rows, double tolerance, const std::string& what) {
  for (int decibel : {40, 30, 20}) {
    const double noise = std::sqrt(0.5) * std::pow(10.0, -decibel / 20.0);
    for (unsigned seed = 1; seed <= 5; ++seed)
      EXPECT_NEAR(noise_level(noisy(signal, rows, noise, seed)) / noise, 1, tolerance)
          << what << ", " << decibel << " dB, seed " << seed;
  }
}

TEST(NoiseLevel, UnderASine) {
  // 6400 samples in 8 bands: a band's level scatters by 4 % in power, so 10 % in the standard deviation is
  // wide.
  for (double ratio : {8.0, 13.7, 50.0, 160.0, 400.0})
    expect_level([=](double i) { return std::sin(2 * M_PI * i / ratio); }, 6400, 0.10,
                 "fs/f = " + std::to_string(ratio));
}

TEST(NoiseLevel, UnderThreeTones) {
  const Signal tones = [](double i) {
    return 0.6 * std::sin(2 * M_PI * i / 9.3) + 0.6 * std::sin(2 * M_PI * i / 31 + 1) +
           0.6 * std::sin(2 * M_PI * i / 120 + 2);
  };
  expect_level(tones, 6400, 0.10, "three tones");
}

TEST(NoiseLevel, UnderADecay) {
  expect_level([](double i) { return 3 * std::exp(-i / 900) * std::cos(2 * M_PI * i / 40); }, 6400, 0.10, "decay");
}

TEST(NoiseLevel, UnderAnOffsetAndADrift) {
  expect_level([](double i) { return 50 + 1e-3 * i + std::sin(2 * M_PI * i / 40); }, 6400, 0.10, "drift");
}

/// White noise of unit deviation behind a moving mean of `width` samples, which leaves the upper bands quiet, of unit
/// deviation again.
std::vector<double> smoothed(int rows, int width, unsigned seed) {
  const std::vector<double> white = noisy([](double) { return 0.0; }, rows + width, 1, seed);
  std::vector<double> x(static_cast<std::size_t>(rows));
  for (int pass = 0; pass < width; ++pass)
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += white[i + static_cast<std::size_t>(pass)] / std::sqrt(width);
  return x;
}

TEST(NoiseBeside, AModelIsAllOfItWhateverItsColour) {
  constexpr int rows = 6400;
  std::vector<double> model(rows);
  for (std::size_t i = 0; i < model.size(); ++i) model[i] = 30 * std::sin(2 * M_PI * static_cast<double>(i) / 400);
  for (int width : {1, 4}) {
    const std::vector<double> left = smoothed(rows, width, 5);
    EXPECT_NEAR(noise_beside(left, model), 1, 0.15) << width;
    if (width > 1) EXPECT_LT(noise_level(left), 0.5) << "the quietest band alone";
  }
}

TEST(NoiseBeside, AModelLeavesOutWhatTheModelMissesInItsOwnBand) {
  constexpr int rows = 6400;
  std::vector<double> model(rows), left = smoothed(rows, 4, 6);
  for (std::size_t i = 0; i < model.size(); ++i) {
    model[i] = 30 * std::sin(2 * M_PI * static_cast<double>(i) / 400);
    left[i] += 5 * std::cos(2 * M_PI * static_cast<double>(i) / 400);
  }
  EXPECT_NEAR(noise_beside(left, model), 1, 0.25);
}

TEST(NoiseBeside, AModelThatFillsAllBandsIsNotKnown) {
  const std::vector<double> left = smoothed(6400, 1, 7);
  EXPECT_EQ(noise_beside(left, smoothed(6400, 1, 8)), 0);
  EXPECT_EQ(noise_beside(std::vector<double>(20, 1.0), std::vector<double>(20, 0.0)), 0) << "too short for a spectrum";
}

TEST(NoiseBeside, AModelIsNotWhatFollowsTheForce) {
  constexpr int rows = 6400;
  std::vector<double> model(rows), left = smoothed(rows, 1, 9);
  const std::vector<double> force = smoothed(rows, 3, 10);
  for (std::size_t i = 0; i < model.size(); ++i) {
    model[i] = 30 * std::sin(2 * M_PI * static_cast<double>(i) / 400);
    left[i] += 3 * force[i];
  }
  EXPECT_GT(noise_beside(left, model), 2.5);
  EXPECT_NEAR(noise_beside(left, model, {force}), 1, 0.1);
  EXPECT_NEAR(driven_part(left, {force}), 0.9, 0.03) << "9 of 10 parts of the power";
}

TEST(DrivenPart, OfUnrelatedSignalsIsNothing) {
  for (const int rows : {100, 1000, 6400})
    EXPECT_NEAR(driven_part(smoothed(rows, 1, 11), {smoothed(rows, 1, 12)}), 0, 4 / std::sqrt(rows)) << rows;
  EXPECT_EQ(driven_part(smoothed(1000, 1, 11), {}), 0);
  EXPECT_EQ(driven_part(std::vector<double>(20, 1.0), {std::vector<double>(20, 0.5)}), 0);
  EXPECT_EQ(driven_part(smoothed(1000, 1, 11), {std::vector<double>(1000, 2.0)}), 0) << "a force that does not vary";
}

TEST(NoiseBetweenJumps, IsNotRaisedByThem) {
  const auto wave = [](double i) { return std::sin(2 * M_PI * i / 90); };
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const std::vector<double> x =
        noisy([&](double i) { return wave(i) + 0.6 * std::copysign(1, wave(i + 3)); }, 3600, 0.03, seed);
    EXPECT_GT(noise_level(x), 0.045);
    EXPECT_NEAR(noise_between_jumps(x), 0.03, 0.004) << seed;
  }
}

TEST(NoiseBetweenJumps, IsThatOfTheSpectrumWhereNothingJumps) {
  const auto wave = [](double i) { return std::sin(2 * M_PI * i / 90); };
  for (const int rows : {300, 3600})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const std::vector<double> x = noisy(wave, rows, 0.03, seed);
      EXPECT_EQ(noise_between_jumps(x), noise_level(x)) << rows << ' ' << seed;
    }
}

/// A value that stands still most of the time says nothing of its noise meanwhile.
TEST(NoiseBetweenJumps, IsNotZeroWhereValuesAreHeld) {
  std::vector<double> x = noisy([](double) { return 0.0; }, 3600, 1, 1);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = x[i / 8 * 8];
  EXPECT_EQ(noise_between_jumps(x), noise_level(x));
}

TEST(NoiseLevel, OfAShortRecord) {
  // 400 samples: a quarter of the band holds 100 degrees of freedom, 14 % in power, less the median's loss.
  expect_level([](double i) { return std::sin(2 * M_PI * i / 40); }, 400, 0.25, "400 rows");
}

TEST(NoiseLevel, OfAVeryShortRecordIsOfTheRightSize) {
  const auto estimate = noise_level(noisy([](double i) { return std::sin(2 * M_PI * i / 20); }, 40, 0.02, 1));
  EXPECT_GT(estimate, 0.01);
  EXPECT_LT(estimate, 0.03);
}

TEST(NoiseLevel, OfLongWhiteNoiseIsExact) {
  // 2e5 samples: 0.7 % in the level of an eighth of the band; pooled, 1 % is more than three deviations.
  EXPECT_NEAR(noise_level(noisy([](double) { return 0.0; }, 200000, 2.5, 3)), 2.5, 0.025);
}

TEST(NoiseLevel, OfAQuantisedSignalIsThatOfItsSteps) {
  const double step = 1e-3;
  for (double ratio : {41.37, 413.7, 40000.0}) {
    std::vector<double> x = noisy([=](double i) { return std::sin(2 * M_PI * i / ratio); }, 6400, 0, 1);
    for (double& value : x) value = step * std::round(value / step);
    EXPECT_GE(noise_level(x), 0.499 * step / std::sqrt(12.0)) << ratio;
    EXPECT_LE(noise_level(x), 1.5 * step / std::sqrt(12.0)) << ratio;
  }
}

TEST(NoiseLevel, OfAConstantOrASwitchedSignalIsSmall) {
  EXPECT_EQ(noise_level(std::vector<double>(500, 3.25)), 0);
  EXPECT_EQ(noise_level(std::vector<double>{}), 0);
  EXPECT_EQ(noise_level(std::vector<double>{1}), 0);
  EXPECT_EQ(noise_level(noisy([](double i) { return std::fmod(i, 100) < 50 ? 1.0 : 0.0; }, 2000, 0, 1)), 0);
  // On and off, or between four values, at random: edges are no noise.
  std::mt19937_64 random(1);
  for (const int values : {2, 4}) {
    std::vector<double> x;
    while (x.size() < 2000) x.insert(x.end(), 1 + random() % 9, static_cast<double>(random() % values));
    EXPECT_EQ(noise_level(x), 0) << values;
  }
}

TEST(NoiseLevel, OfASwitchedSignalIsThatOfItsNoise) {
  const auto square = [](double i) { return std::fmod(i, 100) < 50 ? 1.0 : 0.0; };
  EXPECT_NEAR(noise_level(noisy(square, 8000, 0.05, 1)), 0.05, 0.01);
}

TEST(QuantisationStep, IsThatInWhichTheValuesLie) {
  std::vector<double> x = noisy([](double i) { return std::sin(2 * M_PI * i / 41.37); }, 40000, 0.01, 1);
  EXPECT_EQ(quantisation_step(x), 0);
  for (double& value : x) value = 0.02 * std::round(value / 0.02);
  x[7] = NAN;
  EXPECT_NEAR(quantisation_step(x), 0.02, 1e-12);
  EXPECT_EQ(quantisation_step(std::vector<double>{}), 0);
  EXPECT_EQ(quantisation_step(std::vector<double>{NAN, NAN}), 0);
}

TEST(NoiseLevel, OfSmoothDataIsNextToNothing) {
  EXPECT_LT(noise_level(noisy([](double i) { return std::sin(2 * M_PI * i / 40); }, 6400, 0, 1)), 1e-7);
}

TEST(DominantFrequency, OfTonesAndDecays) {
  for (double ratio : {5.0, 33.3, 700.0}) {
    const double dt = 0.002, w = 2 * M_PI / (ratio * dt);
    const auto sine = noisy([=](double i) { return 7 + std::sin(2 * M_PI * i / ratio); }, 5000, 0.05, 1);
    EXPECT_NEAR(dominant_frequency(sine, dt), w, 0.002 * w + 0.02 * 2 * M_PI / (5000 * dt))
        << ratio;  // a fiftieth of a bin
    const auto decay =
        noisy([=](double i) { return std::exp(-i / (4 * ratio)) * std::cos(2 * M_PI * i / ratio); }, 5000, 0.01, 1);
    EXPECT_NEAR(dominant_frequency(decay, dt), w, 0.05 * w) << ratio;
  }
}

TEST(DominantFrequency, LeavesOutOffsetsAndDrifts) {
  const auto x = noisy([](double i) { return 1e3 + 2 * i + std::sin(2 * M_PI * i / 25); }, 3000, 0.1, 1);
  EXPECT_NEAR(dominant_frequency(x, 1), 2 * M_PI / 25, 1e-3);
  EXPECT_EQ(dominant_frequency(std::vector<double>(50, 2.0), 1), 0);
}

}  // namespace
}  // namespace lunid
