// Several names that follow a force of another shape over the training motion, as a series follows a curve.
#include <gtest/gtest.h>

#include <cmath>

#include "discover_catalogue.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::small_catalogue;
using testing::spacing;

/// A motion (mass 1, k = 1, zeta = 0.03) under a random force, with 10 % noise in y.
Record moved(const truth::Physics& physics, double level, std::uint64_t seed) {
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 60, seed), level, {}, 4000, spacing, 16);
  return testing::noisy_record(motion, "y", motion.x, 0.1 * moments::standard_deviation(motion.x), seed);
}

/// Trained on small motions, tested on motions `beyond` times as large.
Discovery find(const truth::Physics& physics, double beyond) {
  const Model model = baseline("k*y + c*v", 1);
  return discover(model, small_catalogue(*model.pool), {moved(physics, 0.03, 3)}, {moved(physics, beyond * 0.03, 4)});
}

bool is_taken_back(const Discovery& d) {
  return testing::warns(d, "by several forces, but not the test record: the name is withdrawn");
}

TEST(Patchwork, OfAnExponentialSpringIsTakenBackByALargerMotion) {
  truth::Physics physics;
  physics.other = [](double x, double) { return 0.5 * (std::exp(x) - 1 - x); };
  const Discovery d = find(physics, 1.3);
  EXPECT_TRUE(is_taken_back(d)) << d.sentence;
  EXPECT_TRUE(d.effects.empty());
  EXPECT_EQ(d.verdict, Verdict::unknown_effect);
}

/// Beside an entry that is near y*abs(v).
void expect_unknown(const truth::Scale& scale, const truth::Records& records) {
  const Model model = baseline("k*y + c*v", scale.mass);
  std::vector<Effect> catalogue = small_catalogue(*model.pool);
  catalogue.push_back(testing::entry(*model.pool, "odd_quadratic_stiffness", "odd_quadratic_stiffness_k2*abs(y)*y",
                                     {testing::row("odd_quadratic_stiffness_k2")}));
  const Discovery d = testing::discover_case(model, catalogue, records);
  EXPECT_EQ(d.verdict, Verdict::unknown_effect) << d.sentence;
  EXPECT_TRUE(d.effects.empty());
}

/// One name that is near closes most of the gap; what it leaves is seen, though its slope at the fit is no guide to how
/// large the forces without a name are.
TEST(Patchwork, OfOneNameIsSeenByTheForceItLeaves) {
  for (const std::uint64_t seed : {6122, 6124, 6320}) {
    const truth::Scale& scale = truth::scale_named("micro");
    const truth::Records records = testing::records_of("outside_y_abs_v", scale, 20, seed);
    expect_unknown(scale, records);
  }
}

/// A loop that stiffens as it is loaded is followed by a spring that does and a friction that yields, down to a fifth
/// of the gap.
TEST(Patchwork, OfTwoNamesFarAboveTheNoiseIsNoExplanation) {
  const truth::Scale& scale = truth::scale_named("milli");
  const Model model = baseline("k*y + c*v", scale.mass);
  Pool& pool = *model.pool;
  std::vector<Effect> catalogue = small_catalogue(pool);
  Effect dahl = testing::entry_with_state(pool, "dahl_friction", "s*z", "v - s*abs(v)*z/Fc",
                                          {testing::row("s", 0), testing::row("Fc", 0)});
  dahl.guess = [](const RecordScales& scales, int) {
    return std::vector<Guess>{{{"s", scales.stiffness}, {"Fc", scales.force_std}}};
  };
  catalogue.push_back(dahl);
  truth::Case loop = truth::case_named("bouc_wen_stiffening");
  loop.physics.bouc_k = 0.5;
  truth::RecordOptions options;
  options.seed = 61000;
  const Discovery d = testing::discover_case(model, catalogue, truth::make_records(loop, scale, options));
  EXPECT_EQ(d.verdict, Verdict::unknown_effect) << d.sentence;
  EXPECT_TRUE(d.effects.empty());
}

/// A few swings of a decay do not show that the limit of a slip falls; the long motion of the test does.
TEST(Patchwork, OfOneNameThatFollowsTheTrainingRecordAloneIsTakenBack) {
  const truth::Scale& scale = truth::scale_named("milli");
  const Model model = baseline("k*y + c*v", scale.mass);
  Pool& pool = *model.pool;
  std::vector<Effect> catalogue = small_catalogue(pool);
  Effect slip = testing::entry_with_state(pool, "elastic_slip", "z", "ks*v",
                                          {testing::row("ks", 0), testing::row("Fs", 0)}, "Fs");
  slip.guess = [](const RecordScales& scales, int) {
    std::vector<Guess> guesses;
    for (const double part : {0.03, 0.1, 0.3, 1.0})
      guesses.push_back({{"ks", scales.stiffness}, {"Fs", part * scales.force_std}});
    return guesses;
  };
  catalogue.push_back(slip);
  truth::RecordOptions options;
  options.rows = 1400;
  options.seed = 61000;
  options.excited = truth::Excited::decay;
  const Discovery d = testing::discover_case(model, catalogue,
                                             truth::make_records(truth::case_named("shaft_softening"), scale, options));
  EXPECT_EQ(d.verdict, Verdict::unknown_effect) << d.sentence;
  EXPECT_TRUE(d.effects.empty());
  EXPECT_TRUE(testing::warns(d, "down to their noise, but not the test record"));
}

TEST(Patchwork, IsNotWhatTwoTrueEffectsAre) {
  truth::Physics physics;
  physics.k2 = 0.6;
  physics.k3 = 0.6;
  const Discovery d = find(physics, 2);
  EXPECT_FALSE(is_taken_back(d));
  EXPECT_EQ(d.effects.size(), 2u) << d.sentence;
}

/// Single tones below and above the resonance hardly show its damping, which the sweep of the test hangs on: what one
/// fit to all records takes to their noise is no patchwork.
TEST(Patchwork, IsNotWhatTheTrainingRecordsLeaveOpen) {
  const truth::Scale& scale = truth::scale_named("milli");
  const truth::Records records = testing::records_of("cubic+coulomb", scale, 30, 24002, truth::Excited::tones);
  const Model model = baseline("k*y + c*v", scale.mass);
  const Discovery d =
      discover(model, small_catalogue(*model.pool),
               {testing::record_of(records.train, "one"), testing::record_of(records.more.front(), "two")},
               {testing::record_of(records.test, "test")});
  EXPECT_EQ(d.effects.size(), 2u) << d.sentence;
  EXPECT_GT(d.final_test.value, 3 * d.final_test.floor);
  EXPECT_TRUE(testing::warns(d, "one fit to all records follows these down to their noise"));
}

/// Under a slow sweep v^2*y is nearly a cubic spring, which closes 99 % of the squared gap; what it leaves is ten times
/// the noise, and generic forces explain it.
TEST(Patchwork, OfOneNameFarAboveTheNoiseIsTakenBack) {
  const truth::Scale& scale = truth::scale_named("metre");
  const truth::Records records = testing::records_of("outside_v2y", scale, 40, 8240, truth::Excited::chirp);
  const Model model = baseline("k*y + c*v", scale.mass);
  const Discovery d = testing::discover_case(model, small_catalogue(*model.pool), records);
  EXPECT_TRUE(testing::warns(d, "left a force that is repeatable: the name is withdrawn")) << d.sentence;
  EXPECT_EQ(d.verdict, Verdict::unknown_effect);
}

/// Under a chirp y*abs(v) is nearly abs(y)*y, which closes 99 % of the squared gap. Along that model's run generic
/// forces follow part of what it leaves, along the run with these the rest.
TEST(Patchwork, OfOneNameIsSeenByForcesThatAreAskedForAgain) {
  for (const std::uint64_t seed : {35001, 35002}) {
    const truth::Scale& scale = truth::scale_named("metre");
    const truth::Records records = testing::records_of("outside_y_abs_v", scale, 40, seed, truth::Excited::chirp);
    expect_unknown(scale, records);
  }
}

}  // namespace
}  // namespace lunid
