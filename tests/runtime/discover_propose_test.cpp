// What an entry would explain along the measured motion: the amplitude of a guess, and states that follow at once.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "discover/baseline.hpp"
#include "discover/lines.hpp"
#include "discover/propose.hpp"
#include "discover/receptance.hpp"
#include "discover_catalogue.hpp"
#include "truth/law.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::spacing;

/// A study of mass 1 between k = 1 and zeta = 0.03 with one law beside them, under a random force.
struct Case {
  Model model = baseline("k*y + c*v", 1);
  DiscoverOptions options;
  Study study;
  Candidate known;

  explicit Case(truth::Law law, double least_damping = -INFINITY, double noise = 1e-4) {
    if (std::isfinite(least_damping)) model.parameters = {testing::row("k", 0), testing::row("c", least_damping)};
    truth::Physics physics;
    physics.law = std::make_shared<const truth::Law>(std::move(law));
    const truth::Motion motion =
        truth::integrate(physics, truth::multisine(0.2, 2.2, 60, 5), 0.4, {}, 1500, spacing / 2, 24);
    Record record = testing::noisy_record(motion, "y", motion.x, noise, 3);
    record = derive_motion(Record("half", 0, spacing / 2, {record.channel("F"), record.channel("y")}));
    study = prepare(model, {record}, {record}, options);
    std::vector<std::string> warnings;
    known = fit_baseline(study, model, warnings);
  }

  Standing best(const Effect& effect, Shape& shape) const {
    const Proposer proposer(study, known);
    shape = proposer.shape(model, {&effect, 0}, scales(study, 0));
    proposer.run(shape);
    return proposer.score(shape, proposer.parent(known, known.starts.front()));
  }
};

Parameter in(const std::string& name, const std::string& unit) {
  Parameter p = testing::row(name, 0);
  p.unit = unit;
  return p;
}

Effect dahl(Pool& pool, const std::string& stiffness, const std::string& force) {
  Effect effect =
      testing::entry_with_state(pool, "dahl", "s*z", "v - s*abs(v)*z/Fc", {in("s", stiffness), in("Fc", force)});
  effect.guess = [](const RecordScales&, int) { return std::vector<Guess>{{{"s", 1e6}, {"Fc", 0.3e6}}}; };
  return effect;
}

TEST(Proposer, TakesTheAmplitudeOfAGuessFromTheRecord) {
  const Case dahl_record(truth::laws::dahl(1, 0.3));
  Shape shape;
  const Effect effect = dahl(*dahl_record.model.pool, "N/m", "N");
  const Standing found = dahl_record.best(effect, shape);
  ASSERT_EQ(found.own.size(), 2);
  EXPECT_NEAR(found.own[0], 1, 0.1);
  EXPECT_NEAR(found.own[1], 0.3, 0.03);
}

TEST(Proposer, LeavesAGuessAloneWhoseUnitsDoNotSayHowItScales) {
  const Case dahl_record(truth::laws::dahl(1, 0.3));
  Shape shape;
  const Effect effect = dahl(*dahl_record.model.pool, "", "");
  const Standing found = dahl_record.best(effect, shape);
  ASSERT_EQ(found.own.size(), 2);
  EXPECT_TRUE(shape.force_powers.empty());
  EXPECT_EQ(found.own[0], 1e6);
  EXPECT_EQ(found.own[1], 0.3e6);
}

/// s1 is linear, the rest is scaled; one step to a sample is too long for the bristles.
TEST(Proposer, RunsStiffStatesWithTheirOwnSteps) {
  const Case lugre_record(truth::laws::lugre(3, 0.15, 0.2, 0.4, 0.4));
  Pool& pool = *lugre_record.model.pool;
  const std::string rate = "v - abs(v)*z*s0/(Fc + (Fs - Fc)*exp(-(v/vs)^2))";
  Effect effect =
      testing::entry_with_state(pool, "lugre", "s0*z + s1*(" + rate + ")", rate,
                                {in("s0", "N/m"), in("s1", "N s/m"), in("Fc", "N"), in("Fs", "N"), in("vs", "m/s")});
  effect.guess = [](const RecordScales&, int) {
    return std::vector<Guess>{{{"s0", 300}, {"Fc", 20}, {"Fs", 40}, {"vs", 0.4}}};
  };
  Shape shape;
  const Standing found = lugre_record.best(effect, shape);
  ASSERT_EQ(found.own.size(), 5);
  EXPECT_GT(found.substeps, 1);
  EXPECT_NEAR(found.own[0], 3, 0.3);
  EXPECT_NEAR(found.own[2], 0.2, 0.02);
  EXPECT_NEAR(found.own[3], 0.4, 0.04);
  EXPECT_EQ(found.own[4], 0.4);
}

/// The fastest of many states is too fast for one step to a sample: its numbers grow beyond all squares and stay
/// finite.
TEST(Proposer, RunsManyStatesWithStepsThatAreStable) {
  constexpr int count = 6;
  const auto rate_of = [](int i) { return 27.8 * std::pow(2.0, i + 1 - count); };  // the fastest a little too fast
  truth::Law law;
  law.states = count;
  law.force = [](double, double, double, const double* z) { return 0.3 * std::accumulate(z, z + count, 0.0); };
  law.rate = [=](double, double, double v, const double* z, double* rate) {
    for (int i = 0; i < count; ++i) rate[i] = v - rate_of(i) * z[i];
  };
  const Case relaxations(law);
  Pool& pool = *relaxations.model.pool;
  std::vector<InternalState> states;
  for (int i = 0; i < count; ++i) {
    const Expr z = pool.state("z" + std::to_string(i));
    states.push_back({z, pool.channel("v") - pool.constant(rate_of(i)) * z, 0, {}, {}});
  }
  Effect effect = testing::entry(pool, "relaxations", "q*(z0 + z1 + z2 + z3 + z4 + z5)", {testing::row("q")});
  effect.states = std::move(states);
  Shape shape;
  const Standing found = relaxations.best(effect, shape);
  ASSERT_EQ(found.own.size(), 1);
  EXPECT_TRUE(found.shown);
  EXPECT_GT(found.substeps, 1);
  EXPECT_NEAR(found.own[0], 0.3, 0.03);
}

/// What a baseline cannot have is no company for a guess: the fit would begin at the bound, with the rest as it was
/// solved beside another value.
TEST(Proposer, SolvesForTheBaselineWithinItsBounds) {
  constexpr double least = 0.2;  // the truth is 0.06
  const auto drag = [](double, double v) { return 0.3 * std::abs(v) * v; };
  const Case free_case(truth::laws::of_motion(drag)), bounded(truth::laws::of_motion(drag), least);
  const auto found = [](const Case& c) {
    Shape shape;
    const Effect effect = testing::entry(*c.model.pool, "drag", "c2*abs(v)*v", {in("c2", "N s^2/m^2")});
    return c.best(effect, shape);
  };
  const Standing as_it_likes = found(free_case), within = found(bounded);
  ASSERT_EQ(as_it_likes.parent.size(), 2);
  EXPECT_LT(as_it_likes.parent[1], least);
  EXPECT_EQ(within.parent[1], least);
  EXPECT_LT(within.own[0], as_it_likes.own[0]);  // takes off what the damping has too much
  EXPECT_GT(within.cost, as_it_likes.cost);
}

/// No force acts on a free decay: its size is that of the inertia.
TEST(Scales, OfAFreeDecay) {
  const truth::Motion motion = truth::integrate({}, truth::none(), 0, {1, 0, 0}, 1500, spacing, 24);
  const Record record = testing::noisy_record(motion, "y", motion.x, 1e-4, 3);
  const Model model = baseline("k*y + c*v", 1);
  const DiscoverOptions options;
  const RecordScales s = scales(prepare(model, {record}, {record}, options), 0);
  EXPECT_NEAR(s.stiffness, 1, 0.05);
}

/// A stiffness that goes up and down beside a random force leaves no line in the residual, but one in its product with
/// y.
TEST(Proposer, HearsTheFrequencyOfAModulatedStiffness) {
  const Case modulated(
      truth::laws::of_time([](double tau, double x, double) { return 0.15 * std::cos(1.7 * tau + 0.4) * x; }));
  const RecordScales scale = scales_beside(modulated.study, modulated.known);
  ASSERT_FALSE(scale.modulations.empty());
  EXPECT_NEAR(scale.modulations.front(), 1.7, 0.02);
}

/// Noise that is differentiated twice hides it in the force; behind the receptance it stands out, and nothing does
/// where no stiffness goes up and down.
TEST(Proposer, HearsAModulatedStiffnessInNoise) {
  constexpr double noise = 0.03;  // of a motion of about 1
  const Case modulated(
      truth::laws::of_time([](double tau, double x, double) { return 0.06 * std::cos(0.7 * tau + 0.4) * x; }),
      -INFINITY, noise);
  const std::vector<double> lines = modulation_lines(modulated.study, modulated.known);
  ASSERT_FALSE(lines.empty());
  EXPECT_NEAR(lines.front(), 0.7, 0.02);
  const auto drag = [](double, double v) { return 0.05 * std::abs(v) * v; };
  const Case steady(truth::laws::of_motion(drag), -INFINITY, noise);
  EXPECT_TRUE(modulation_lines(steady.study, steady.known).empty());
}

/// What was fitted on the trajectory has memory that follows at once along a given motion: its run there is made in as
/// many steps as that takes, or nothing could be proposed beside it.
TEST(Proposer, RunsAFittedMemoryThatIsStiffAlongTheMotion) {
  const Case slips(truth::laws::dahl(1, 0.3));
  const Effect effect = dahl(*slips.model.pool, "N/m", "N");
  const Candidate set = compile(slips.study, slips.model, {{&effect, 0}});
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(set.parameters());
  const auto& table = set.system->model().parameters;
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    const std::string& name = table[static_cast<std::size_t>(j)].name;
    if (name == "s") theta[j] = 10;
    if (name == "Fc") theta[j] = 0.3;
    if (name == "k") theta[j] = 1;
    if (name == "c") theta[j] = 0.06;
  }
  const Proposer::Parent space = Proposer(slips.study, slips.known).parent(set, theta);
  EXPECT_LT(space.open.norm(),
            10 * Proposer(slips.study, slips.known).parent(slips.known, slips.known.fit.theta).open.norm());
}

/// A spring that softens and then hardens: each of its two powers takes back most of what the other does.
TEST(Proposer, SeesWhatTwoEffectsLeaveTogether) {
  const auto softens = [](double x, double) { return -0.35 * x * x * x + 0.05 * std::pow(x, 5); };
  const Case springs(truth::laws::of_motion(softens, [](double, double) { return 0.0; }));
  Pool& pool = *springs.model.pool;
  const Effect effects[] = {testing::entry(pool, "third", "k3*y^3", {testing::row("k3")}),
                            testing::entry(pool, "fifth", "k5*y^5", {testing::row("k5")}),
                            testing::entry(pool, "drag", "c2*abs(v)*v", {testing::row("c2", 0)})};
  const Proposer proposer(springs.study, springs.known);
  std::vector<Shape> shapes;
  for (const Effect& effect : effects) {
    shapes.push_back(proposer.shape(springs.model, {&effect, 0}, scales(springs.study, 0)));
    proposer.run(shapes.back());
  }
  const Proposer::Parent space = proposer.parent(springs.known, springs.known.starts.front());
  const Eigen::MatrixXd costs = proposer.pair_costs({&shapes[0], &shapes[1], &shapes[2]}, space);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(costs(i, i), proposer.score(shapes[static_cast<std::size_t>(i)], space).cost, 1e-9 * space.cost);
    for (int j = 0; j < 3; ++j) EXPECT_EQ(costs(i, j), costs(j, i));
  }
  EXPECT_LT(costs(0, 1), 0.05 * std::min(costs(0, 0), costs(1, 1)));
  EXPECT_GT(costs(0, 2), 0.9 * costs(0, 0));
}

/// A force beside resonance makes w^n/|k - m*w^2| of what was measured: to the displacement behind an accelerometer a
/// force at low frequencies, its drift, would be most of all.
TEST(Receptance, TellsAForceByTheQuantityThatWasMeasured) {
  const truth::Motion motion = truth::integrate({}, truth::multisine(0.3, 2, 20, 3), 1, {}, 1500, testing::spacing, 16);
  std::vector<double> acceleration;
  for (std::size_t i = 0; i < motion.x.size(); ++i) acceleration.push_back(motion.force[i] - motion.restoring[i]);
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  const auto sizes = [&](const std::string& channel, const std::vector<double>& values, int order) {
    const DiscoverOptions options;
    const Study study = prepare(model, {testing::noisy_record(motion, channel, values, 1e-3, 5)}, {}, options);
    Candidate baseline = compile(study, model, {});
    find_starts(study, baseline, {}, {});
    fit(study, baseline, full_fit(study, 20));
    const Receptance receptance(study, baseline, study.force);
    const Eigen::Index rows = study.force.front().record.rows(), part = rows / 2;
    for (const double w : {0.4, 2.0}) {
      Eigen::VectorXd force(rows);
      for (Eigen::Index i = 0; i < rows; ++i) force[i] = std::sin(w * testing::spacing * static_cast<double>(i));
      const Eigen::VectorXd out = receptance.motion_of(force, study.force, 1).segment(part - 300, 600);
      const double size = std::sqrt(2 * out.squaredNorm() / 600);
      EXPECT_NEAR(size / (std::pow(w, order) / std::abs(1 - w * w)), 1, 0.07) << channel << " " << w;
    }
  };
  sizes("y", motion.x, 0);
  sizes("a", acceleration, 2);
}

}  // namespace
}  // namespace lunid
