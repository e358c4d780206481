// Savitzky-Golay filters against published weights and exact polynomials; the choice of the window against
// the best window known afterwards; derived motion against analytic motion.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "record/record.hpp"
#include "record/savitzky_golay.hpp"

namespace lunid {
namespace {

std::span<const double> span_of(const Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

double rms(const Eigen::VectorXd& x) { return std::sqrt(x.squaredNorm() / static_cast<double>(x.size())); }

TEST(SavitzkyGolay, HasThePublishedWeights) {
  // Savitzky & Golay 1964, tables I (quadratic, cubic) and IV (first derivative, quadratic).
  const Eigen::VectorXd smooth = 35 * savitzky_golay_weights(0, {2, 3});
  const Eigen::VectorXd slope = 10 * savitzky_golay_weights(1, {2, 2});
  const double five[] = {-3, 12, 17, 12, -3}, line[] = {-2, -1, 0, 1, 2};
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(smooth[i], five[i], 1e-12);
    EXPECT_NEAR(slope[i], line[i], 1e-12);
  }
  const Eigen::VectorXd seven = 252 * savitzky_golay_weights(1, {3, 4});  // cubic, 7 points: 22 -67 -58 0 58 67 -22
  const double cubic[] = {22, -67, -58, 0, 58, 67, -22};
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(seven[i], cubic[i], 1e-11);
}

TEST(SavitzkyGolay, IsExactForPolynomialsUpToTheEnds) {
  const int n = 900;
  const double dt = 0.1;
  Eigen::VectorXd x(n), d0(n), d1(n), d2(n);
  for (int i = 0; i < n; ++i) {
    const double s = dt * i / 30 - 1;
    x[i] = d0[i] = 2 - s + 0.5 * s * s + 3 * s * s * s;
    d1[i] = (-1 + s + 9 * s * s) / 30;
    d2[i] = (1 + 18 * s) / 900;
  }
  for (const SavitzkyGolay& options : {SavitzkyGolay{3, 3}, {20, 3}, {20, 5}, {150, 5}}) {  // the last by transforms
    const double scale = d0.cwiseAbs().maxCoeff();
    EXPECT_LT((savitzky_golay(span_of(x), dt, 0, options) - d0).cwiseAbs().maxCoeff(), 1e-12 * scale);
    EXPECT_LT((savitzky_golay(span_of(x), dt, 1, options) - d1).cwiseAbs().maxCoeff(), 1e-12 * scale / dt);
    EXPECT_LT((savitzky_golay(span_of(x), dt, 2, options) - d2).cwiseAbs().maxCoeff(), 1e-11 * scale / dt / dt);
  }
}

TEST(SavitzkyGolay, WideWindowsAreTheSameBySumAndByTransform) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Eigen::VectorXd x(10000);
  for (double& value : x) value = 1e6 + normal(random);
  const SavitzkyGolay options{300, 3};
  const Eigen::VectorXd weights = savitzky_golay_weights(1, options), d = savitzky_golay(span_of(x), 1, 1, options);
  for (int i = 300; i < 9700; ++i) ASSERT_NEAR(d[i], weights.dot(x.segment(i - 300, 601)), 1e-9);
}

TEST(SavitzkyGolay, RefusesWindowsThatDoNotFit) {
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(9);
  EXPECT_NO_THROW(savitzky_golay(span_of(x), 1, 1, {4, 3}));
  EXPECT_THROW(savitzky_golay(span_of(x), 1, 1, {5, 3}), InputError);
  EXPECT_THROW(savitzky_golay(span_of(x), 1, 1, {1, 3}), InputError);
  EXPECT_THROW(savitzky_golay(span_of(x), 1, 2, {4, 1}), InputError);
  EXPECT_THROW(savitzky_golay(span_of(x), 1, -1, {4, 1}), InputError);
}

/// A motion with known derivatives: two tones, or a decay.
struct Motion {
  Eigen::VectorXd d[3], noisy;
};
Motion motion(bool decay, double per_cycle, double noise, unsigned seed) {
  const int n = 6400;
  const double w = 2 * M_PI / per_cycle, b = decay ? 1.0 / 1500 : 0;
  Motion m;
  for (auto& d : m.d) d.resize(n);
  m.noisy.resize(n);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, noise);
  for (int i = 0; i < n; ++i) {
    const double e = std::exp(-b * i), c = std::cos(w * i), s = std::sin(w * i);
    m.d[0][i] = e * c;
    m.d[1][i] = e * (-b * c - w * s);
    m.d[2][i] = e * ((b * b - w * w) * c + 2 * b * w * s);
    if (!decay) {
      const double u = 3 * w, p = 0.3 * std::cos(u * i + 1), q = -0.3 * u * std::sin(u * i + 1);
      m.d[0][i] += p;
      m.d[1][i] += q;
      m.d[2][i] -= u * u * p;
    }
    m.noisy[i] = m.d[0][i] + normal(random);
  }
  return m;
}

TEST(ChooseSavitzkyGolay, ComesNearTheBestWindowKnownAfterwards) {
  for (const bool decay : {false, true}) {
    for (const double per_cycle : {25.0, 100.0}) {
      for (const double noise : {1e-3, 1e-2, 1e-1}) {
        const Motion m = motion(decay, per_cycle, noise, 11);
        for (int derivative : {1, 2}) {
          const auto error = [&](const SavitzkyGolay& f) {
            return rms(savitzky_golay(span_of(m.noisy), 1, derivative, f) - m.d[derivative]);
          };
          double best = 1e300;
          for (int order : {3, 5})
            for (int h = (order + 1) / 2; h < 300; h += 1 + h / 8) best = std::min(best, error({h, order}));
          const SavitzkyGolay chosen = choose_savitzky_golay(span_of(m.noisy), noise, derivative);
          // The grid of 1.2 in the width, the scatter of the criterion, and the ends, of which it knows
          // nothing.
          EXPECT_LT(error(chosen), 1.35 * best)
              << "decay " << decay << ", " << per_cycle << " rows a cycle, noise " << noise << ", derivative "
              << derivative << ", chosen " << chosen.half_width << " order " << chosen.order;
        }
      }
    }
  }
}

TEST(ChooseSavitzkyGolay, TakesTheNarrowestWindowWithoutNoiseAndAWideOneForNoiseAlone) {
  const Motion clean = motion(false, 25, 0, 1);
  EXPECT_LE(choose_savitzky_golay(span_of(clean.noisy), 0, 1).half_width, 4);
  Eigen::VectorXd noise(6400);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (double& value : noise) value = normal(random);
  EXPECT_GT(choose_savitzky_golay(span_of(noise), 1, 1).half_width, 100);
}

TEST(ChooseSavitzkyGolay, ServesTheShortestRecords) {
  for (int n : {6, 7, 10, 23}) {
    Eigen::VectorXd x(n);
    for (int i = 0; i < n; ++i) x[i] = std::sin(0.3 * i);
    for (int derivative : {0, 1, 2})
      EXPECT_NO_THROW(savitzky_golay(span_of(x), 1, derivative, choose_savitzky_golay(span_of(x), 0.01, derivative)));
  }
}

Record record_of(std::vector<std::pair<std::string, Eigen::VectorXd>> columns, double dt) {
  std::vector<Channel> channels;
  for (auto& [name, values] : columns) {
    Channel channel;
    channel.name = name;
    channel.unit = name == "y" ? "m" : name == "v" ? "m/s" : "m/s^2";
    channel.noise = noise_level(span_of(values));
    channel.values = values;
    channels.push_back(channel);
  }
  return Record("test", 0, dt, channels);
}

struct Sine {
  Eigen::VectorXd y, v, a;
};
Sine sine(int n, double dt, double w) {
  Sine s{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (int i = 0; i < n; ++i) {
    s.y[i] = std::sin(w * dt * i);
    s.v[i] = w * std::cos(w * dt * i);
    s.a[i] = -w * w * std::sin(w * dt * i);
  }
  return s;
}

Eigen::VectorXd column(const Record& record, const char* name) {
  return Eigen::Map<const Eigen::VectorXd>(record[name].data(), record.rows());
}

TEST(DeriveMotion, FromDisplacement) {
  const double dt = 1e-3, w = 30;
  Sine s = sine(4000, dt, w);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, 0.01);
  for (double& value : s.y) value += normal(random);
  const Record record = derive_motion(record_of({{"y", s.y}}, dt));
  const auto error = [&](const char* name, const Eigen::VectorXd& truth) {
    return rms((column(record, name) - truth).segment(200, 3600));
  };
  EXPECT_LT(error("v", s.v), 0.01 * w);
  EXPECT_LT(error("a", s.a), 0.06 * w * w);
  // The noise that is stated is that of the rows within; bias adds to the error, hence one-sided within a
  // factor 2.
  EXPECT_LT(error("v", s.v), 2 * record.channel("v").noise);
  EXPECT_LT(error("a", s.a), 2 * record.channel("a").noise);
  EXPECT_GT(error("v", s.v), 0.5 * record.channel("v").noise);
  EXPECT_TRUE(record.channel("v").derived);
  EXPECT_FALSE(record.channel("y").derived);
}

TEST(DeriveMotion, KeepsWhatWasMeasured) {
  const Sine s = sine(400, 0.01, 6);
  const Eigen::VectorXd odd = s.v.array() + 1;
  const Record record = derive_motion(record_of({{"y", s.y}, {"v", odd}}, 0.01));
  EXPECT_EQ(column(record, "v"), odd);
  EXPECT_FALSE(record.channel("v").derived);
  EXPECT_LT(rms((column(record, "a") - s.a).segment(20, 360)), 0.01 * 36);
}

TEST(DeriveMotion, FromVelocityOrAccelerationByIntegration) {
  // Whole cycles, so that the line taken off is small: for 32 cycles a sine's own line has 3 / (pi * 32) of
  // it.
  const double dt = 0.01, w = 2 * M_PI;
  const Sine s = sine(3200, dt, w);
  const Record from_v = derive_motion(record_of({{"v", s.v}}, dt));
  EXPECT_LT(rms(column(from_v, "y") - s.y), 0.04);
  EXPECT_EQ(from_v.channel("y").unit, "m");
  const Eigen::VectorXd offset = s.a.array() + 0.5;  // an accelerometer's offset must not become a parabola
  const Record from_a = derive_motion(record_of({{"a", offset}}, dt));
  EXPECT_LT(rms(column(from_a, "v") - s.v), 0.04 * w);
  EXPECT_LT(rms(column(from_a, "y") - s.y), 0.08);
  EXPECT_TRUE(from_a.channel("y").derived);
}

TEST(DeriveMotion, NoiseOfAnIntegralIsThatOfADetrendedWalk) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double sum = 0;
  double stated = 0;
  const int n = 2000, draws = 200;
  for (int k = 0; k < draws; ++k) {
    Eigen::VectorXd v(n);
    for (double& value : v) value = normal(random);
    Channel channel{"v", "m/s", "", "", v, 1.0, false, {}, {}, {}};
    const Record record = derive_motion(Record("test", 0, 0.1, {channel}));
    sum += column(record, "y").squaredNorm() / n / draws;
    stated = record.channel("y").noise;
  }
  EXPECT_NEAR(std::sqrt(sum) / stated, 1, 0.1);  // 200 walks: 4 % in the root mean square
}

TEST(DeriveMotion, NeedsAMotion) {
  Channel force{"F", "N", "", "", Eigen::VectorXd::Ones(10), 0, false, {}, {}, {}};
  EXPECT_THROW(derive_motion(Record("test", 0, 1, {force})), InputError);
}

}  // namespace
}  // namespace lunid
