// Forces of the motion without a name, beside a model that lacks one.
#include <gtest/gtest.h>

#include "discover/baseline.hpp"
#include "discover/judge.hpp"
#include "discover/verdict.hpp"
#include "discover_catalogue.hpp"
#include "truth/law.hpp"

namespace lunid {
namespace {

/// The baseline beside a motion of the truth that has one force more, or a disturbance, judged on its training record.
struct Beside {
  DiscoverOptions options;
  Model model = testing::baseline("k*y + c*v", 1);
  Study study;
  Candidate baseline;
  Whitening whitening;

  explicit Beside(const truth::Physics& physics) : Beside([&](const auto&) { return physics; }) {}

  /// Of the force that is recorded.
  template <class PhysicsOf>
  requires std::invocable<PhysicsOf, std::function<double(double)>>
  explicit Beside(const PhysicsOf& physics_of) {
    const auto record = [&](double force, int seed) {
      const auto push = truth::multisine(0.2, 2.2, 20, static_cast<std::uint64_t>(seed));
      const truth::Physics physics = physics_of([=](double tau) { return force * push(tau); });
      const truth::Motion motion = truth::integrate(physics, push, force, {}, 2000, testing::spacing, 16);
      return testing::noisy_record(motion, "y", motion.x, 0.02, seed);
    };
    study = prepare(complete(model), {record(0.15, 5)}, {record(0.22, 6)}, options);
    baseline = compile(study, complete(model), {});
    baseline.fit = fit_trajectory(*baseline.system, Eigen::Vector2d(1, 0.06), study.train, full_fit(study, 20));
    whitening = residual_colour(study, baseline);
    judge(study, baseline, whitening);
    run_left_out(study, baseline);
  }

  Left left() const { return look_for_structure(study, baseline, runs(study, baseline, study.full), whitening); }
};

/// All generic forces together follow the training motion, and nothing else.
TEST(Closure, OfFewForcesHoldsForALargerMotion) {
  truth::Physics physics;
  physics.other = [](double x, double v) { return 0.02 * x * v * v; };
  const Beside t(physics);
  const Left left = t.left();
  EXPECT_TRUE(left.material);
  EXPECT_EQ(left.closure.shape, "stiffness that depends on v");
  EXPECT_LE(left.closure.system->parameters(), 2 + 6);
  const auto gap = [&](const System& system, const FitResult& fit) {
    return pool_gap(runs(t.study, system, fit, t.study.test), 0);
  };
  const Gap before = gap(*t.baseline.system, t.baseline.fit), after = gap(*left.closure.system, left.closure.fit);
  ASSERT_GT(before.value, 2 * before.floor);
  EXPECT_GT(closed_share(before.value, after.value, after.floor), 0.9);
}

/// A follower load, a coil that leaves its field: no function of y and v, and what is left may be a small part of the
/// motion, which nothing of the catalogue takes away.
TEST(Closure, SeesADriveWhoseForceDependsOnTheMotion) {
  const Beside t([](const std::function<double(double)>& recorded) {
    truth::Physics physics;
    physics.law = std::make_shared<truth::Law>(
        truth::laws::of_time([=](double tau, double x, double) { return -0.2 * recorded(tau) * x; }));
    return physics;
  });
  const Left left = t.left();
  EXPECT_TRUE(left.material);
  EXPECT_EQ(left.closure.shape, "a drive whose force depends on y");
  const auto gap = [&](const System& system, const FitResult& fit) {
    return pool_gap(runs(t.study, system, fit, t.study.test), 0);
  };
  const Gap before = gap(*t.baseline.system, t.baseline.fit), after = gap(*left.closure.system, left.closure.fit);
  ASSERT_GT(before.value, 2 * before.floor);
  EXPECT_GT(closed_share(before.value, after.value, after.floor), 0.9);
}

/// Its side bands lie beside the band of the motion, and went for noise of a colour.
TEST(Closure, SeesAStiffnessThatGoesUpAndDown) {
  truth::Physics physics;
  physics.law = std::make_shared<const truth::Law>(
      truth::laws::of_time([](double tau, double x, double) { return 0.06 * std::cos(0.7 * tau + 0.4) * x; }));
  const Left left = Beside(physics).left();
  EXPECT_TRUE(left.material);
  const std::string words = "stiffness that goes up and down at ";
  ASSERT_TRUE(left.closure.shape.starts_with(words)) << left.closure.shape;
  EXPECT_NEAR(std::stod(left.closure.shape.substr(words.size())), 0.7, 0.01);
}

TEST(Closure, SeesNothingBesideTheWholeTruth) {
  const Left left = Beside({}).left();
  EXPECT_FALSE(left.seen || left.material);
}

}  // namespace
}  // namespace lunid
