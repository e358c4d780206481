// Motions that forget where they came from: a run over the whole record is lost to noise, whatever the model.
#include <gtest/gtest.h>

#include "discover_catalogue.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::small_catalogue;

/// A mass between two wells, -x + x^3, under several tones: it changes wells at no period (Holmes 1979).
Record between_wells(double level, std::uint64_t seed, int rows, double share = 0.01) {
  truth::Physics physics;
  physics.zeta = 0.1;
  physics.k = -1;
  physics.k3 = 1;
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.3, 2.2, 40, seed), level, {1, 0, 0}, rows, testing::spacing, 12);
  const double noise = share * moments::standard_deviation(motion.x);
  const Record record = testing::noisy_record(motion, "y", motion.x, noise, seed);
  return derive_motion(Record("wells", 0, testing::spacing, {record.channel("F"), record.channel("y")}));
}

Discovery found_between(const Record& train, const Record& test) {
  const Model model = baseline("k*y + c*v", 1);
  return discover(model, small_catalogue(*model.pool), {train}, {test});
}

TEST(DiscoveryOfChaos, NamesACubicSpringByShortRuns) {
  const Discovery d = found_between(between_wells(0.1, 5, 2500), between_wells(0.1, 6, 1500));
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  EXPECT_NEAR(d.effects[0].parameters[0].value, 1, 0.02);
  EXPECT_TRUE(testing::warns(d, "runs over whole records are lost to noise"));
  EXPECT_GT(d.run_length, 0);
  EXPECT_LT(d.final_test.value, 0.15);
  ASSERT_EQ(d.records.size(), 2u);  // each once, however many its runs
  EXPECT_GT(d.records[0].runs, 10);
  EXPECT_GT(d.records[0].rows, 2400);
  EXPECT_EQ(d.records[1].role, "test");
  EXPECT_NE(to_terminal(d).find("wells: train, "), std::string::npos);
  EXPECT_NE(to_terminal(d).find(" runs of "), std::string::npos);
  EXPECT_EQ(d.where.find("drifting sensor"), std::string::npos) << d.where;
}

/// A fit that knows all rows follows a good way, and a run no more than noise lets it.
TEST(DiscoveryOfChaos, IsSeenWhereAFitFollowsAGoodWay) {
  const Discovery d = found_between(between_wells(0.2, 11, 1200, 0.003), between_wells(0.2, 12, 1000, 0.003));
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  EXPECT_NEAR(d.effects[0].parameters[0].value, 1, 0.01);
  EXPECT_GT(d.run_length, 0);
}

TEST(DiscoveryOfChaos, NamesNothingBesideACubicSpringThatIsKnown) {
  const Model model = baseline("k*y + c*v + k3*y^3", 1);
  std::vector<Effect> catalogue = small_catalogue(*model.pool);
  catalogue.erase(catalogue.begin());
  const Discovery d = discover(model, catalogue, {between_wells(0.4, 3, 3000)}, {between_wells(0.4, 4, 1500)});
  EXPECT_TRUE(d.effects.empty()) << d.sentence;
  EXPECT_EQ(d.verdict, Verdict::nothing_missing);
  EXPECT_LT(d.final_train.value, 0.1);
}

/// A name may be found beside a fit that is lost itself: over short runs its coefficient is right.
TEST(DiscoveryOfChaos, ANameWhoseFitIsLostIsHeardAgainInShortRuns) {
  const Discovery d = found_between(between_wells(0.4, 1, 3000), between_wells(0.4, 2, 1500));
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  EXPECT_NEAR(d.effects[0].parameters[0].value, 1, 0.01);
  EXPECT_GT(d.run_length, 0);
  EXPECT_LT(d.final_test.value, 1.5 * d.final_test.floor);
}

/// A spring that has to be pulled off its seat, under a force that leaves it there again and again. A smooth spring
/// comes nearer over the whole record than the jump, whose run noise leads astray.
TEST(DiscoveryOfChaos, AJumpThatIsLostToNoiseIsFoundBesideASmoothForce) {
  const auto seated = [](std::uint64_t seed, int rows) {
    truth::Physics physics;
    physics.zeta = 0.13;
    const auto seat = [](double x, double) { return std::copysign(0.6, x); };
    physics.law = std::make_shared<truth::Law>(truth::laws::of_motion(seat, [](double x, double) { return x; }));
    const truth::Signal tones = truth::multisine(0.1, 2.4, 60, seed);
    const auto uneven = [=](double t) { return (t < 0.5 * rows * testing::spacing ? 0.45 : 1.3) * tones(t); };
    const truth::Motion motion = truth::integrate(physics, uneven, 0.18, {}, rows, testing::spacing, 60);
    const double noise = 0.0056 * moments::standard_deviation(motion.x);
    const Record record = testing::noisy_record(motion, "y", motion.x, noise, seed);
    return derive_motion(Record("seat", 0, testing::spacing, {record.channel("F"), record.channel("y")}));
  };
  const Model model = baseline("k*y + c*v", 1);
  Effect smooth = testing::entry(*model.pool, "saturating_stiffness", "smooth_Fy*tanh(smooth_k*y/smooth_Fy)",
                                 {testing::row("smooth_k", 0), testing::row("smooth_Fy", 0)});
  smooth.guess = [](const RecordScales& s, int) {
    std::vector<Guess> out;
    for (const double stiffer : {0.3, 1.0, 3.0, 30.0})
      for (const double part : {0.3, 1.0})
        out.push_back({{"smooth_k", stiffer * s.stiffness}, {"smooth_Fy", part * s.force_std}});
    return out;
  };
  smooth.range = [](const RecordScales& s, int) {
    return Ranges{{"smooth_k", {1e-3 * s.stiffness, 1e3 * s.stiffness}},
                  {"smooth_Fy", {1e-3 * s.force_std, 30 * s.force_std}}};
  };
  const Effect jump = testing::entry(*model.pool, "preload", "preload_F0*sign(y)", {testing::row("preload_F0")});
  const Discovery d = discover(model, {smooth, jump}, {seated(1, 1900)}, {seated(2, 900)});
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "preload");
  EXPECT_NEAR(d.effects[0].parameters[0].value, 0.6, 0.01);
  EXPECT_LT(d.final_test.value, 1.5 * d.final_test.floor);
}

/// An entry with a memory has one more value in each of some hundred runs, which follow noise.
TEST(DiscoveryOfChaos, ValuesInEveryShortRunAreNoBetterName) {
  const Model model = baseline("k*y + c*v", 1);
  std::vector<Effect> catalogue = small_catalogue(*model.pool);
  Effect other = testing::entry(*model.pool, "cubic_and_memory", "memory_k3*y^3", {testing::row("memory_k3")});
  const Expr z = model.pool->state("memory_z");
  other.variants = {model.pool->parameter("memory_k3") * pow(model.pool->channel("y"), 3) + z};
  other.states = {{z, parse(*model.pool, "-0.3*memory_z"), 0, {}, {}}};
  catalogue.push_back(other);
  const Discovery d = discover(model, catalogue, {between_wells(0.2, 3, 3000)}, {between_wells(0.2, 4, 1500)});
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  EXPECT_GT(d.records[0].runs, 40);
  EXPECT_GE(d.naming.of("cubic_stiffness"), 90);
}

/// The test refutes nothing by a run that noise has led astray.
TEST(DiscoveryOfChaos, OfTheTestRecordAloneTakesNoNameBack) {
  const Discovery d = found_between(between_wells(0.4, 1, 700), between_wells(0.4, 2, 3000));
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  EXPECT_GT(d.final_test.value, 0.3);  // how far a run that is lost strays is a matter of rounding
  EXPECT_TRUE(testing::warns(d, "runs over the whole test record are lost to noise"));
  // The sentence counts by the runs that were judged, not by those that are lost.
  EXPECT_GT(d.short_test.seconds, 0);
  EXPECT_GT(d.short_test.baseline.value, 3 * d.short_test.final.value);
  EXPECT_LT(d.short_test.final.value, 1.5 * d.short_test.final.floor);
  EXPECT_NE(d.sentence.find(", in runs of "), std::string::npos) << d.sentence;
  EXPECT_EQ(d.run_length, 0);
}

/// A cubic spring and drag with next to no damping: struck now and then, or under tones that drive it to ten times the
/// motion, through jumps that hang on little.
Record light(bool driven, std::uint64_t seed) {
  constexpr int rows = 4000;
  constexpr double dt = 0.19, length = 6 * dt;
  truth::Physics physics;
  physics.zeta = 0.0025;
  physics.k3 = 0.144;
  physics.drag = 0.0072;
  Philox random(seed, 8);
  std::vector<double> at, size;
  for (double t = 30; t < rows * dt; t += 2 * M_PI * (4 + 5 * random.uniform())) {
    at.push_back(t);
    size.push_back((random.uniform() < 0.5 ? -2.5 : 2.5) * (0.4 + 0.6 * random.uniform()));
  }
  const truth::Signal tones = truth::multisine(0.3, 1.8, 25, seed);
  const truth::Signal blows = [&](double t) {
    double force = 0;
    for (std::size_t i = 0; i < at.size(); ++i)
      if (std::abs(t - at[i]) < 0.5 * length) force += size[i] * std::pow(std::cos(M_PI * (t - at[i]) / length), 2);
    return force;
  };
  const truth::Motion motion = truth::integrate(physics, driven ? tones : blows, driven ? 0.25 : 1, {}, rows, dt, 12);
  std::vector<double> force = motion.force, y = motion.x;
  const double noise_of_force = 0.005 * moments::standard_deviation(force),
               noise = 0.002 * moments::standard_deviation(y);
  for (double& value : force) value += noise_of_force * random.normal();
  for (double& value : y) value += noise * random.normal();
  return Record(driven ? "driven" : "struck", 0, dt,
                {testing::channel("F", "N", force), testing::channel("y", "m", y)});
}

/// That the residual shows little of the noise of the force does not say how far that leads a run which jumps; nor do
/// two draws of it, where the deviations of the parameters lead astray as well.
TEST(DiscoveryOfChaos, WhatParametersLeaveOpenLosesTheTestAsNoiseDoes) {
  const Model model = baseline("k*y + c*v", 1);
  std::vector<Effect> catalogue = small_catalogue(*model.pool);
  catalogue.push_back(testing::entry(*model.pool, "quadratic_drag", "quadratic_drag_c2*abs(v)*v",
                                     {testing::row("quadratic_drag_c2", 0)}));
  const Discovery d = discover(model, catalogue, {light(false, 9)}, {light(true, 10)});
  ASSERT_EQ(d.effects.size(), 2u) << d.sentence;
  EXPECT_GT(d.final_test.value, 0.3);
  EXPECT_TRUE(testing::warns(d, "runs over the whole test record are lost to noise"));
  EXPECT_LT(d.short_test.final.value, 0.1 * d.short_test.baseline.value);
}

/// A motion that runs follow is looked at in whole records, whatever is missing.
TEST(DiscoveryOfChaos, IsNotSeenWhereRunsHold) {
  const Model model = baseline("k*y + c*v", truth::scale_named("milli").mass);
  const Discovery d = testing::discover_case(
      model, small_catalogue(*model.pool), testing::records_of("cubic_hardening", truth::scale_named("milli"), 40, 7));
  EXPECT_EQ(d.run_length, 0);
  EXPECT_EQ(d.records[0].runs, 1);
  EXPECT_FALSE(testing::warns(d, "lost to noise"));
}

}  // namespace
}  // namespace lunid
