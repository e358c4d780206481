// Spectra, transfer functions, envelopes, cycles and noise reports against what is known of the signals.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "message.hpp"
#include "record/spectra.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::span<const double> span_of(const VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

VectorXd sampled(Index n, const std::function<double(double)>& f) {
  return VectorXd::NullaryExpr(n, [&](Index i) { return f(static_cast<double>(i)); });
}
VectorXd white(Index n, unsigned seed, double deviation = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  return sampled(n, [&](double) { return normal(random); });
}

TEST(PowerSpectrum, HoldsTheVariance) {
  // Parseval: the density integrates to the variance, of noise and of a tone in the middle of a bin.
  const double dt = 0.002;
  const VectorXd noise = white(65536, 1, 3),
                 tone = sampled(8192, [](double i) { return 2 * std::sin(2 * M_PI * i / 64); });
  const PowerSpectrum n = power_spectrum(span_of(noise), dt), t = power_spectrum(span_of(tone), dt, 1024);
  EXPECT_NEAR(n.density.sum() * n.frequency[1], 9, 0.15);
  EXPECT_NEAR(n.density[n.density.size() / 2], 9 * 2 * dt, 0.5 * 9 * 2 * dt);
  EXPECT_NEAR(t.density.sum() * t.frequency[1], 2, 3e-3);  // the line taken off each segment
  Index peak = 0;
  t.density.maxCoeff(&peak);
  EXPECT_NEAR(t.frequency[peak], 1 / (64 * dt), 1e-9);
}

TEST(PowerSpectrum, ItsLimitsHoldTheTruthAsOftenAsTheySay) {
  int held = 0, all = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const VectorXd x = white(4096, seed);
    const PowerSpectrum s = power_spectrum(span_of(x), 1, 256);
    for (Index k = 4; k < 124; k += 4, ++all) held += s.low[k] <= 2 && 2 <= s.high[k];
  }
  EXPECT_NEAR(static_cast<double>(held) / all, 0.95, 0.03);  // 600 of them: 0.9 % of a deviation
}

/// y = x filtered, with noise at both ends: the input that is measured is x + m, the output y + n.
struct Path {
  VectorXd input, output;
  double dt = 1;
};
Path path(double input_noise, double output_noise, unsigned seed) {
  const Index n = 65536;
  const VectorXd x = white(n, seed);
  Path p{x + white(n, seed + 100, std::max(input_noise, 1e-12)), VectorXd(n)};
  for (Index i = 0; i < n; ++i) p.output[i] = x[i] + 0.5 * (i > 0 ? x[i - 1] : 0);  // |H|^2 = 1.25 + cos w
  p.output += white(n, seed + 200, std::max(output_noise, 1e-12));
  return p;
}

TEST(TransferFunction, KnowsWhichEndIsNoisy) {
  const double m = 0.5, n = 0.6;  // deviations: Sxx = 1, so that Smm = 0.25, Snn = 0.36
  for (const bool at_input : {true, false}) {
    const Path p = path(at_input ? m : 0, at_input ? 0 : n, 7);
    const TransferFunction t = transfer_function(span_of(p.input), span_of(p.output), 1, 256);
    double h1 = 0, h2 = 0, phase = 0, coherence = 0, expected = 0;
    int count = 0;
    for (Index k = 8; k < 100; ++k, ++count) {
      const double w = 2 * M_PI * t.frequency[k], square = 1.25 + std::cos(w);
      const std::complex<double> truth = 1.0 + 0.5 * std::polar(1.0, -w);
      h1 += std::abs(t.h1[k]) / std::abs(truth);
      h2 += std::abs(t.h2[k]) / std::abs(truth);
      phase += std::abs(std::arg(t.h1[k] / truth));
      coherence += t.coherence[k];
      // g^2 = 1/(1 + Smm/Sxx) or 1/(1 + Snn/(|H|^2 Sxx)) (Bendat & Piersol 2010, 6.1.4)
      expected += at_input ? 1 / (1 + m * m) : 1 / (1 + n * n / square);
    }
    EXPECT_NEAR(h1 / count, at_input ? 1 / (1 + m * m) : 1, 0.01);
    if (at_input) {
      EXPECT_NEAR(h2 / count, 1, 0.01);
    }
    EXPECT_LT(phase / count, 0.05);
    EXPECT_NEAR(coherence / count, expected / count, 0.01);
    // H1's own scatter is what is stated.
    double square = 0;
    for (Index k = 8; k < 100; ++k) {
      const double truth = std::sqrt(1.25 + std::cos(2 * M_PI * t.frequency[k])) * (at_input ? 1 / (1 + m * m) : 1);
      square += std::pow((std::abs(t.h1[k]) / truth - 1) / t.error[k], 2) / count;
    }
    EXPECT_NEAR(std::sqrt(square), 1, 0.25) << at_input;
  }
}

TEST(TransferFunction, CoherenceOfUnrelatedNoiseIsChance) {
  int above = 0, all = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const VectorXd x = white(4096, seed), y = white(4096, seed + 50);
    const TransferFunction t = transfer_function(span_of(x), span_of(y), 1, 256);
    for (Index k = 4; k < 124; k += 2, ++all) above += t.coherence[k] > t.chance;
  }
  EXPECT_NEAR(static_cast<double>(above) / all, 0.05, 0.03);
}

TEST(Spectra, RefuseWhatCannotBe) {
  const VectorXd x = white(100, 1);
  EXPECT_EQ(message([&] { power_spectrum(span_of(x), 1, 100); }),
            "spectrum: length: expected a power of two from 16 to the record's 100 rows, got 100");
  EXPECT_EQ(message([&] { power_spectrum(span_of(x), 1, 128); }),
            "spectrum: length: expected a power of two from 16 to the record's 100 rows, got 128");
  EXPECT_EQ(message([&] { transfer_function(span_of(x), span_of(x), 1, 64).h1; }), "no error");
  const VectorXd shorter = x.head(70);
  EXPECT_EQ(message([&] { transfer_function(span_of(shorter), span_of(shorter), 1, 64); }),
            "transfer: length: expected segments of at most 32 rows, so that there are two or more to average, got 64");
  EXPECT_EQ(message([&] { spectrogram(span_of(x), 1, 32, 40); }),
            "spectrogram: hop: expected 1 to the segment's 32 rows, got 40");
  EXPECT_EQ(message([&] { noise_report(span_of(VectorXd(x.head(20))), 1); }),
            "noise: expected at least 64 rows, got 20");
}

TEST(Spectrogram, FollowsASweep) {
  const double dt = 0.001, rate = 20;  // Hz per second from 50 Hz
  const VectorXd x = sampled(8000, [&](double i) { return std::sin(2 * M_PI * (50 + 0.5 * rate * dt * i) * dt * i); });
  const Spectrogram s = spectrogram(span_of(x), dt, 512, 0);
  for (Index i = 0; i < s.time.size(); ++i) EXPECT_NEAR(s.ridge[i], 50 + rate * s.time[i], 0.5) << i;
}

TEST(Envelope, OfADecay) {
  const double dt = 0.001, f = 20, b = 3;
  const VectorXd clean =
      sampled(2000, [&](double i) { return 0.3 + std::exp(-b * dt * i) * std::cos(2 * M_PI * f * dt * i); });
  for (const double noise : {0.0, 0.005}) {
    const VectorXd x = clean + white(2000, 3, std::max(noise, 1e-12));
    const Envelope e = envelope(span_of(x), dt, noise);
    for (Index i = 100; i < 760; ++i) {  // to a tenth of the first amplitude
      const double amplitude = std::exp(-b * dt * static_cast<double>(i));
      EXPECT_NEAR(e.amplitude[i] / amplitude, 1, noise > 0 ? 0.12 : 0.02) << i;
      EXPECT_NEAR(e.frequency[i], f, noise > 0 ? 2 : 0.3) << i;
    }
    EXPECT_NEAR((e.phase[700] - e.phase[100]) / (2 * M_PI), 0.6 * f, 0.05);
  }
}

TEST(Cycles, OfADecayWithNoise) {
  const double dt = 0.001, f = 20, b = 2;
  const VectorXd x =
      sampled(1500, [&](double i) { return std::exp(-b * dt * i) * std::sin(2 * M_PI * f * dt * i - 0.3); }) +
      white(1500, 4, 0.02);
  const std::vector<Cycle> list = cycles(span_of(x), dt, 0.02);
  ASSERT_NEAR(static_cast<double>(list.size()), 1.5 * f - 1, 1.01);  // and no false ones near the crossings
  for (const Cycle& c : list) {
    EXPECT_NEAR(c.period, 1 / f, 0.06 / f);
    EXPECT_NEAR(c.amplitude, std::exp(-b * (c.time + 0.5 / f)), 0.06);
    EXPECT_NEAR(c.mean, 0, 0.06);
  }
}

TEST(NoiseReport, OfWhiteNoiseUnderATone) {
  const VectorXd x = sampled(8192, [](double i) { return std::sin(2 * M_PI * i / 37); }) + white(8192, 5, 0.05);
  const NoiseReport r = noise_report(span_of(x), 0.01);
  EXPECT_NEAR(r.white, 0.05, 0.004);
  EXPECT_NEAR(r.robust, 0.05, 0.004);
  EXPECT_NEAR(r.exponent, 0, 0.12);
  EXPECT_NEAR(r.background, 0.05, 0.006);
  EXPECT_LE(r.outliers, 0);
}

TEST(WildRows, AreSingleRowsOffTheirNeighbours) {
  const VectorXd clean = sampled(4096, [](double i) { return std::sin(2 * M_PI * i / 50); }) + white(4096, 6, 0.01);
  VectorXd x = clean;
  for (Index i = 50; i < 4096; i += 200) x[i] += i % 400 == 50 ? 2 : -2;
  const std::vector<WildRow> wild = wild_rows(span_of(x));
  ASSERT_EQ(wild.size(), 21u);
  for (const auto& [row, value] : wild) {
    EXPECT_EQ(row % 200, 50);
    EXPECT_NEAR(value, clean[row], 0.06);
  }
}

/// What a motion may do: its velocity jumps at a stop, it jumps itself (of a velocity, an acceleration), it is noise.
TEST(WildRows, AreNoKinksJumpsOrNoise) {
  const auto none = [](const VectorXd& x) { return wild_rows(span_of(x)).empty(); };
  for (const double noise : {0.0, 1e-4, 1e-3, 1e-2}) {
    EXPECT_TRUE(
        none(sampled(4096, [](double i) { return std::abs(std::sin(M_PI * i / 61.7)); }) + white(4096, 2, noise)));
    EXPECT_TRUE(none(sampled(4096, [](double i) { return std::sin(i / 9) < 0 ? -1.0 : 1.0; }) + white(4096, 3, noise)));
    EXPECT_TRUE(none(sampled(4096, [](double i) { return std::max(std::sin(i / 9), -0.7); }) + white(4096, 4, noise)));
  }
  EXPECT_TRUE(none(white(4096, 1, 1)));
}

TEST(NoiseReport, OutliersAreCountedAndDoNotCount) {
  VectorXd x = sampled(4096, [](double i) { return std::sin(2 * M_PI * i / 50); }) + white(4096, 6, 0.01);
  for (Index i = 50; i < 4096; i += 200) x[i] += i % 400 == 50 ? 2 : -2;
  const NoiseReport r = noise_report(span_of(x), 1);
  EXPECT_EQ(r.outliers, 21);
  EXPECT_NEAR(r.robust, 0.01, 0.002);
  EXPECT_GT(r.white, 0.05);  // spikes are white
}

TEST(NoiseReport, KnowsTheColour) {
  // Brown noise: sums of white, S ~ 1/f^2 well below the Nyquist frequency (4 sin^2(w/2) bends it by 0.3 at the top).
  const VectorXd steps = white(32768, 7);
  VectorXd walk(steps.size());
  double sum = 0;
  for (Index i = 0; i < steps.size(); ++i) walk[i] = sum += steps[i];
  const NoiseReport brown = noise_report(span_of(walk), 1);
  EXPECT_NEAR(brown.exponent, 2, 0.25);
  EXPECT_LT(brown.exponent_std, 0.1);
}

TEST(Summary, CountsWhatIsMissingOrHeld) {
  VectorXd x = sampled(100, [](double i) { return i; });
  x[3] = NAN;
  x.segment(40, 6).setConstant(40);
  const ChannelSummary s = summary(span_of(x));
  EXPECT_EQ(s.missing, 1);
  EXPECT_EQ(s.held, 5);
  EXPECT_EQ(s.least, 0);
  EXPECT_EQ(s.most, 99);
  Channel y;
  y.name = "y", y.unit = "m", y.values = x, y.noise = 0.5;
  Record record("run.csv", 0, 0.01, {y});
  record.note("filter: y");
  record.warn("rounded");
  EXPECT_EQ(describe(record),
            "record run.csv: 100 rows, 0.99 s at 100 Hz; channels y\n"
            "  y  0 to 99 m, deviation 28.67, noise 0.5 (1.7 %), 1 row is missing, in steps of 1 m, up to 6 equal rows "
            "on end\n"
            "  filter: y\n"
            "  warning: rounded");
}

TEST(Summary, SaysInWhichStepsAChannelIsWhereTheyAreCoarse) {
  const auto line = [](double step) {
    Channel y;
    y.name = "y", y.unit = "m";
    y.values = sampled(400, [=](double i) { return step * std::round(std::sin(0.11 * i) / step); });
    return describe(Record("run.csv", 0, 0.01, {y}));
  };
  EXPECT_NE(line(0.05).find(", in steps of 0.05 m"), std::string::npos) << line(0.05);
  EXPECT_EQ(line(0.001).find("steps"), std::string::npos) << line(0.001);
}

std::string line_of(const std::string& name, const VectorXd& values) {
  Channel channel;
  channel.name = name, channel.values = values, channel.noise = noise_level(span_of(values));
  const std::string text = describe(Record("run.csv", 0, 0.01, {channel}));
  return text.substr(text.find('\n') + 1);
}

TEST(Summary, AShaftThatTurnsOnHasTheNoiseOfItsSensorAndNotOfItsJumps) {
  const VectorXd noise = 2e-3 * white(2000, 3);
  const VectorXd turned = sampled(2000, [](double i) { return 0.5 + 0.15 * i + 1e-5 * i * i; }) + noise;
  const VectorXd shown =
      turned.unaryExpr([](double angle) { return angle - 2 * M_PI * std::floor(angle / (2 * M_PI)); });
  for (const char* name : {"shaft_angle", "phase"}) {
    const std::string text = line_of(name, shown);
    EXPECT_NE(text.find(", wraps, 54.08 turns, deviation 98.19"), std::string::npos) << text;
    const double found = std::stod(text.substr(text.find("noise ") + 6));
    EXPECT_NEAR(found, 2e-3, 4e-4) << text;
  }
  EXPECT_EQ(line_of("y", shown).find("wraps"), std::string::npos);
  EXPECT_EQ(line_of("shaft_angle", turned).find("wraps"), std::string::npos);
}

TEST(Summary, AsksWhetherAMotionThatIsFlatAtItsExtremesIsClipped) {
  const auto clipped = [](const char* name, double most, double least, double step) {
    const auto row = [=](double i) {
      const double x = std::clamp(std::sin(0.11 * i) * std::sin(0.0031 * i), least, most);
      return step > 0 ? step * std::round(x / step) : x;
    };
    return line_of(name, sampled(2000, row));
  };
  for (const char* name : {"y", "v", "a", "a2"}) {
    const std::string text = clipped(name, 0.8, -0.8, 0);
    EXPECT_NE(text.find(", up to 12 equal rows on end at its extremes, 28 times: clipped?"), std::string::npos) << text;
  }
  EXPECT_NE(clipped("a", 0.9, -2, 0).find("clipped?"), std::string::npos);       // on one side
  EXPECT_NE(clipped("a", 0.8, -0.8, 1e-3).find("clipped?"), std::string::npos);  // by a converter of 11 bit
  for (const char* name : {"F", "ab", "y_reference", "accel"})                   // made so by whoever drives
    EXPECT_EQ(clipped(name, 0.8, -0.8, 0).find("clipped?"), std::string::npos) << name;
  EXPECT_EQ(clipped("y", 2, -2, 0).find("clipped?"), std::string::npos);
  for (const double most : {0.1, 0.0, -0.2})  // more than a third of the rows, up to two of three
    EXPECT_NE(clipped("y", most, -2, 0).find("at its extremes"), std::string::npos) << clipped("y", most, -2, 0);
}

TEST(Summary, CoarseStepsRestAndLevelsThatAreMeantAreNoClipping) {
  const auto silent = [](const VectorXd& values) {
    const std::string text = line_of("y", values);
    EXPECT_EQ(text.find("clipped?"), std::string::npos) << text;
  };
  for (const double step : {0.3, 0.1, 0.05, 0.02, 0.004})
    for (const double rate : {0.02, 0.11, 0.4})
      silent(sampled(2000, [=](double i) { return step * std::round(std::sin(rate * i) / step); }));
  for (const double step : {1.0, 0.5, 0.1})  // a sensor that sees little more than its noise
    silent(white(4000, 5).unaryExpr([=](double x) { return step * std::round(x / step); }));
  silent(sampled(2000, [](double i) { return std::sin(0.03 * i) > 0 ? 1.0 : -1.0; }));            // a square wave
  silent(sampled(2000, [](double i) { return std::clamp(3 * std::sin(0.03 * i), -1.0, 1.0); }));  // a trapezoid
  silent(sampled(2000, [](double i) { return std::max(std::sin(0.03 * i), -0.5); }));             // a cam that dwells
  silent(sampled(2000, [](double i) { return std::sin(std::floor(i / 40) * 7) > 0 ? 1.0 : -1.0; }));  // random bits
  silent(sampled(2000, [](double i) { return i < 300 ? 1 : std::exp(-0.002 * i) * std::cos(0.1 * i); }));  // let go
}

TEST(Summary, SaysFromWhichColumnAChannelIsWhereThatIsOfAnotherNameOrUnit) {
  const auto line = [](const std::string& source, const std::string& unit) {
    Channel y;
    y.name = "y", y.unit = "m", y.source = source, y.source_unit = unit;
    y.values = Eigen::Vector2d(0, 1);
    const std::string text = describe(Record("run.csv", 0, 0.01, {y}));
    return text.substr(text.find('\n') + 1);
  };
  EXPECT_EQ(line("y", "m"), "  y  0 to 1 m, deviation 0.5");
  EXPECT_EQ(line("y", ""), "  y  0 to 1 m, deviation 0.5");
  EXPECT_EQ(line("y [m]", "m"), "  y  0 to 1 m, deviation 0.5");
  EXPECT_EQ(line("y [mm]", "mm"), "  y  0 to 1 m, deviation 0.5; from 'y [mm]'");
  EXPECT_EQ(line("Weg", "mm"), "  y  0 to 1 m, deviation 0.5; from 'Weg' [mm]");
  EXPECT_EQ(line("acc_long", "g"), "  y  0 to 1 m, deviation 0.5; from 'acc_long' [g]");
  EXPECT_EQ(line("Weg", ""), "  y  0 to 1 m, deviation 0.5; from 'Weg'");
}

}  // namespace
}  // namespace lunid
