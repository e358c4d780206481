// Records that hold the velocity or the acceleration alone: free runs are held against what was measured.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "discover_catalogue.hpp"
#include "message.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::small_catalogue;
using testing::spacing;

/// The truth's motion (mass 1, k = 1, zeta = 0.03) under a random force, with 1 % noise on what is measured.
Record measured(const truth::Physics& physics, const std::string& what, std::uint64_t seed) {
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 60, seed), 0.03, {}, 1200, spacing, 24);
  std::vector<double> shown = what == "v" ? motion.v : motion.force;
  for (std::size_t i = 0; what == "a" && i < shown.size(); ++i) shown[i] -= motion.restoring[i];
  return testing::noisy_record(motion, what, shown, 0.01 * moments::standard_deviation(shown), seed);
}

Discovery find(const truth::Physics& physics, const std::string& what) {
  const Model model = baseline("k*y + c*v", 1);
  return discover(model, small_catalogue(*model.pool), {measured(physics, what, 3)}, {measured(physics, what, 4)});
}

void expect_named(const Discovery& d, const std::string& name, double value) {
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, name);
  const Parameter& found = d.effects[0].parameters.front();
  EXPECT_NEAR(found.value, value, 4 * found.std);
  EXPECT_LT(found.std, 0.05 * value);
  EXPECT_LT(d.final_test.value, 1.5 * d.final_test.floor);
}

TEST(DiscoveryOfAVelocity, NamesACubicSpringAndIsSilentWithoutIt) {
  truth::Physics physics;
  EXPECT_EQ(find(physics, "v").verdict, Verdict::nothing_missing);
  physics.k3 = 0.6;
  const Discovery d = find(physics, "v");
  expect_named(d, "cubic_stiffness", 0.6);
  EXPECT_NEAR(d.final_test.floor, 0.01, 0.003);  // the noise of the measured channel, not of its integral
  EXPECT_EQ(d.output, "v");
  EXPECT_NE(d.warnings[0].find("the records hold the velocity alone"), std::string::npos) << d.warnings[0];
}

TEST(DiscoveryOfAnAcceleration, NamesACubicSpringAndIsSilentWithoutIt) {
  truth::Physics physics;
  EXPECT_EQ(find(physics, "a").verdict, Verdict::nothing_missing);
  physics.k3 = 0.6;
  const Discovery d = find(physics, "a");
  expect_named(d, "cubic_stiffness", 0.6);
  EXPECT_NEAR(d.final_test.floor, 0.01, 0.003);
  EXPECT_EQ(d.output, "a");
  EXPECT_EQ(d.comparisons[0].measured.size(), 1200);
}

/// The acceleration jumps where the motion turns, and is zero where it sticks.
TEST(DiscoveryOfAnAcceleration, NamesACoulombFriction) {
  truth::Physics physics;
  physics.coulomb = 0.02;
  expect_named(find(physics, "a"), "coulomb_friction", 0.02);
}

TEST(DiscoveryOfAnAcceleration, RefusesRecordsThatMeasureDifferentThings) {
  const truth::Physics physics;
  const Model model = baseline("k*y + c*v", 1);
  const auto run = [&] {
    discover(model, small_catalogue(*model.pool), {measured(physics, "v", 3)}, {measured(physics, "a", 4)});
  };
  EXPECT_EQ(message(run),
            "a 4: discover: expected all records to measure one channel of the motion, got v in v 3 and a here");
}

TEST(DiscoveryOfAnAcceleration, RefusesAnImposedMotionWhoseSlowPartIsLost) {
  const truth::Physics physics;
  Model model = baseline("k*y + c*v", 1);
  model.imposed_motion = true;
  const auto run = [&] {
    discover(model, small_catalogue(*model.pool), {measured(physics, "a", 3)}, {measured(physics, "a", 4)});
  };
  EXPECT_EQ(message(run),
            "a 3: discover: imposed motion: the displacement is known from the acceleration alone: its slow part is "
            "lost, and the force needs it; record y too");
}

}  // namespace
}  // namespace lunid
