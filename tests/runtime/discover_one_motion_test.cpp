// Records of one tone at one level.
#include "discover/one_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "discover_catalogue.hpp"
#include "record/random.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::channel;
using testing::small_catalogue;

/// The force of y = level*sin(omega*t): 1 % noise, a cubic spring, an offset and friction beside k = 1 and c = 0.05.
Record driven(double level, double omega, std::uint64_t seed) {
  constexpr int rows = 1200;
  std::vector<double> y(rows), v(rows), force(rows);
  Philox random(seed, 3);
  for (std::size_t i = 0; i < rows; ++i) {
    const double phase = omega * testing::spacing * static_cast<double>(i);
    y[i] = level * std::sin(phase);
    v[i] = level * omega * std::cos(phase);
    force[i] =
        y[i] + 0.05 * v[i] + 0.5 * std::pow(y[i], 3) + 0.3 + 0.2 * std::tanh(v[i] / 0.02) + 0.01 * random.normal();
  }
  return derive_motion(Record("driven " + std::to_string(seed), 0, testing::spacing,
                              {channel("F", "N", force), channel("y", "m", y), channel("v", "m/s", v)}));
}

Model imposed() {
  Model model = baseline("k*y + c*v", 0);
  model.imposed_motion = true;
  return model;
}

TEST(StrongestTone, LiesBetweenTheLinesOfTheSpectrum) {
  std::vector<double> x;
  for (int i = 0; i < 700; ++i)
    x.push_back(4 + 2.5 * std::sin(3.217 * 0.01 * i + 0.3) + 0.1 * std::sin(9.6 * 0.01 * i));
  const Tone tone = strongest_tone(x, 0.01);
  EXPECT_NEAR(tone.omega, 3.217, 0.02);
  EXPECT_NEAR(tone.amplitude, 2.5, 0.03);
  EXPECT_GT(tone.share, 0.99);
  EXPECT_EQ(strongest_tone(std::vector<double>(50, 1.0), 0.01).share, 0);
}

TEST(OneMotion, IsOneToneAtOneLevel) {
  const DiscoverOptions options;
  const Record one = driven(1, 1.3, 1);
  const Study study = prepare(imposed(), {one}, {driven(1, 1.3, 2)}, options);
  EXPECT_NEAR(one_motion(study, study.full), 1.3, 0.01);
  EXPECT_GT(one_motion(study, {one, driven(1.03, 1.31, 2)}), 0);
  EXPECT_EQ(one_motion(study, {one, driven(1.5, 1.3, 2)}), 0);
  EXPECT_EQ(one_motion(study, {one, driven(1, 2, 2)}), 0);
}

/// Any closed curve is followed by enough forces.
TEST(OneMotion, CarriesNoThreeNames) {
  const Model model = imposed();
  const std::vector<Effect> catalogue = small_catalogue(*model.pool);
  const Discovery one = discover(model, catalogue, {driven(1, 1.3, 1)}, {driven(1, 1.3, 2)});
  EXPECT_EQ(one.verdict, Verdict::unknown_effect) << one.sentence;
  EXPECT_TRUE(testing::warns(one, "all records, the test too, hold one tone (0.207 Hz) at one level"));
  const Discovery two = discover(model, catalogue, {driven(1, 1.3, 1), driven(0.4, 2.1, 3)}, {driven(1, 1.3, 2)});
  EXPECT_EQ(two.effects.size(), 3u) << two.sentence;
  EXPECT_FALSE(testing::warns(two, "hold one tone"));
}

}  // namespace
}  // namespace lunid
