// What a model's free run says of the noise of a channel, and parameters that are one number with the baseline's own.
#include <gtest/gtest.h>

#include <cmath>

#include "discover/baseline.hpp"
#include "discover/between_samples.hpp"
#include "discover/gap.hpp"
#include "discover/judge.hpp"
#include "discover/proposal_fits.hpp"
#include "discover/twins.hpp"
#include "discover_catalogue.hpp"
#include "statistics/moments.hpp"
#include "truth/law.hpp"
#include "truth/oscillator.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::entry;
using testing::row;

/// The acceleration of x'' + 0.08 x' + 0.25 sign(x') + x = F with half a hundredth of noise.
Record with_friction(int rows, double& noise) {
  truth::Physics physics;
  physics.zeta = 0.04;
  const auto friction = [](double, double v) { return 0.25 * std::tanh(400 * v); };
  physics.law =
      std::make_shared<const truth::Law>(truth::laws::of_motion(friction, [](double, double v) { return v; }));
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.3, 1.8, 12, 5), 1.2, {0, 0, 0}, rows, testing::spacing, 48);
  std::vector<double> a = motion.force;
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= motion.restoring[i];
  noise = 0.005 * moments::standard_deviation(a);
  return testing::noisy_record(motion, "a", a, noise, 3);
}

/// A model fitted to that record, which it is tested on too.
struct Fitted {
  double noise = 0;
  DiscoverOptions options;
  Study study;
  Candidate candidate;
  Fitted(const std::string& restoring, int rows) {
    const Record record = with_friction(rows, noise);
    const Model model = complete(baseline(restoring, 1));
    study = prepare(model, {record}, {record}, options);
    std::vector<std::string> warnings;
    candidate = fit_baseline(study, model, warnings);
  }
};

/// Friction that turns round is sharp in an acceleration: its spectrum has no band with noise alone.
TEST(Noise, OfAChannelIsWhatAModelLeaves) {
  Fitted f("k*y + c*v + Fc*sign(v)", 3000);
  EXPECT_GT(f.study.sensor_noise(), 1.8 * f.noise);
  EXPECT_TRUE(lower_noise(f.study, f.candidate));
  EXPECT_NEAR(f.study.sensor_noise(), f.noise, 0.3 * f.noise);
  EXPECT_FALSE(lower_noise(f.study, f.candidate));
  const FitResult& fit = f.candidate.fit;
  const FreeRun run = free_run(f.study, *f.candidate.system, fit.theta, f.study.test.front(), fit.substeps).front();
  EXPECT_NEAR(std::sqrt(run.floor_squares / static_cast<double>(run.rows)), f.noise, 0.3 * f.noise);
}

TEST(Noise, IsNotReadOffAModelThatDoesNotFollow) {
  Fitted f("k*y + c*v", 3000);
  lower_noise(f.study, f.candidate);
  EXPECT_GT(f.study.sensor_noise(), f.noise);  // a bound from above, whatever the model
}

TEST(Noise, OfAShortRecordStays) {
  Fitted f("k*y + c*v + Fc*sign(v)", 600);
  EXPECT_FALSE(lower_noise(f.study, f.candidate));
}

/// The displacement of x'' + 0.08 x' + x = F with noise of a tenth behind a filter of its sensor (means of two
/// rows, four times over).
Record behind_a_filter(double low, double high, std::uint64_t seed, double& noise) {
  constexpr std::size_t rows = 3000;
  truth::Physics physics;
  physics.zeta = 0.04;
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(low, high, 12, seed), 1.2, {0, 0, 0}, rows, testing::spacing, 48);
  Philox random(seed, 3);
  std::vector<double> filtered(rows + 4);
  for (double& value : filtered) value = random.normal();
  for (int pass = 0; pass < 4; ++pass)
    for (std::size_t i = 0; i + 1 < filtered.size(); ++i) filtered[i] = 0.5 * (filtered[i] + filtered[i + 1]);
  filtered.resize(rows);
  noise = 0.1 * moments::standard_deviation(motion.x);
  const double by = noise / moments::standard_deviation(filtered);
  std::vector<double> y = motion.x;
  for (std::size_t i = 0; i < rows; ++i) y[i] += by * filtered[i];
  return Record("filtered", 0, testing::spacing,
                {testing::channel("F", "N", motion.force), testing::channel("y", "m", y)});
}

TEST(Noise, OfAColourIsMoreThanItsQuietestBand) {
  double noise = 0;
  const Record train = behind_a_filter(0.3, 1.8, 5, noise), test = behind_a_filter(0.4, 1.6, 9, noise);
  DiscoverOptions options;
  const Model model = baseline("k*y + c*v", 1);
  const Discovery found = discover(model, testing::small_catalogue(*model.pool), {train}, {test}, options);
  EXPECT_EQ(found.verdict, Verdict::nothing_missing) << found.sentence;
  EXPECT_LT(found.final_test.value, 1.3 * found.final_test.floor);
  EXPECT_GT(found.final_test.value, 0.8 * found.final_test.floor);
  EXPECT_TRUE(found.noise_has_colour);
}

/// The exact force of 4 y + 0.3 v + friction*sign(v) along sums of tones, and a displacement with a hundredth of noise;
/// so many times as fast as others.
Record prescribed(double part, std::uint64_t seed, int faster = 1, double friction = 0) {
  const int rows = 1500 * faster;
  const double dt = testing::spacing / faster;
  std::vector<double> y(rows), force(rows);
  for (int i = 0; i < rows; ++i) {
    const double t = dt * i;
    double v = 0;
    for (int tone = 1; tone <= 7; ++tone) {
      const double w = part * tone, phase = 2.3 * tone * tone + static_cast<double>(seed);
      y[static_cast<std::size_t>(i)] += std::sin(w * t + phase);
      v += w * std::cos(w * t + phase);
    }
    force[static_cast<std::size_t>(i)] = 4 * y[static_cast<std::size_t>(i)] + 0.3 * v + std::copysign(friction, v);
  }
  const double noise = 0.01 * moments::standard_deviation(y);
  Philox random(seed, 7);
  for (double& value : y) value += noise * random.normal();
  return derive_motion(Record("prescribed", 0, dt, {testing::channel("F", "N", force), testing::channel("y", "m", y)}));
}

TEST(Noise, OfAPrescribedMotionIsNoiseOfTheForce) {
  for (const int faster : {1, 12}) {  // what is derived is smoothed as it was, however many rows there are
    SCOPED_TRACE(faster);
    DiscoverOptions options;
    Model model = baseline("k*y + c*v", 0);
    model.imposed_motion = true;
    model = complete(model);
    Study study = prepare(model, {prescribed(0.21, 1, faster)}, {prescribed(0.17, 2, faster)}, options);
    std::vector<std::string> warnings;
    const Candidate candidate = fit_baseline(study, model, warnings);
    EXPECT_LT(study.sensor_noise(), 0.1 * rms_error(candidate.fit)) << "the force itself has none";
    ASSERT_TRUE(learn_motion_noise(study, candidate));
    EXPECT_NEAR(study.sensor_noise(), rms_error(candidate.fit), 0.1 * rms_error(candidate.fit));
    const FreeRun run = free_run(study, *candidate.system, candidate.fit.theta, study.test.front(), 1).front();
    EXPECT_NEAR(std::sqrt(run.floor_squares / run.squares), 1, 0.1);
  }
}

TEST(Noise, OfAForceOfFrictionIsWhatItIsBetweenItsJumps) {
  constexpr double noise = 0.1;
  const Record exact = prescribed(0.05, 1, 1, 2);
  Channel force = exact.channel("F");
  Philox random(1, 8);
  for (double& value : force.values) value += noise * random.normal();
  force.noise = noise_level({force.values.data(), static_cast<std::size_t>(force.values.size())});
  ASSERT_GT(force.noise, 1.5 * noise);
  Model model = baseline("k*y + c*v", 0);
  model.imposed_motion = true;
  const DiscoverOptions options;
  const Record jumps = exact.with(force);
  const Study study = prepare(complete(model), {jumps}, {jumps.slice(300, 1000)}, options);
  for (const Record& record : {study.full[0], study.test[0]})
    EXPECT_NEAR(record.channel("F").noise, noise, 0.2 * noise);
}

TEST(Noise, OfAForceIsNotAskedOfAFreeMotion) {
  Fitted f("k*y + c*v", 600);
  EXPECT_FALSE(learn_motion_noise(f.study, f.candidate));
}

Effect swing(Pool& pool) {
  Effect effect = entry(pool, "swing", "(swing_beta*y^2 - swing_mu)*v", {row("swing_mu"), row("swing_beta")});
  effect.variants[0].formula = "(beta*y^2 - mu)*v";
  return effect;
}

/// The displacement of x'' + c x' + x = F under steps of a force, whose channel has this much noise [of m omega0^2 L].
Record stepped(double c, double force_noise, std::uint64_t seed) {
  constexpr int rows = 6000;
  constexpr double dt = 0.1;
  truth::Physics physics;
  physics.zeta = 0.5 * c;
  const truth::Signal steps = [](double t) {
    double force = 0;
    for (int k = 0; k < 12; ++k) force += (k % 2 ? -1.0 : 1.0) / (1 + std::exp(-(t - 20 - 47 * k) / 0.2));
    return force;
  };
  const truth::Motion motion = truth::integrate(physics, steps, 1, {}, rows, dt, 24);
  Philox random(seed, 3);
  std::vector<double> force = motion.force, y = motion.x;
  for (double& value : force) value += force_noise * random.normal();
  for (double& value : y) value += 1e-3 * random.normal();
  return Record("stepped", 0, dt, {testing::channel("F", "N", force), testing::channel("y", "m", y)});
}

/// White noise of a force of density S moves a mass on a spring by S/(2 c k) (Crandall & Mark 1963, 2.2): here by twice
/// what the sensor of the motion has, which a set that is right leaves.
TEST(Noise, OfAForceIsWhatARightSetLeavesToo) {
  constexpr double c = 0.02, noise = 1.2e-3;
  const DiscoverOptions options;
  const Model model = complete(baseline("k*y + c*v", 1));
  const Study study = prepare(model, {stepped(c, noise, 1)}, {stepped(c, noise, 2)}, options);
  ASSERT_EQ(study.train.front().record.rows(), 6000);
  std::vector<std::string> warnings;
  const Candidate candidate = fit_baseline(study, model, warnings);
  const double of_force = noise * std::sqrt(0.1 / (2 * c)), expected = std::hypot(of_force, 1e-3);
  EXPECT_NEAR(noise_alone(study, candidate), expected, 0.15 * expected);
  EXPECT_NEAR(rms_error(candidate.fit), expected, 0.25 * expected);
  EXPECT_GT(rms_error(candidate.fit), 1.5 * study.sensor_noise());
  EXPECT_FALSE(is_above_noise(study, candidate, 0.2));
  EXPECT_LT(part_above_noise(study, candidate), 0.3);
  // under the same noise a spring that is 2 % off leaves more
  const Model stiff = complete(baseline("1.02*y + c*v", 1));
  const Study other = prepare(stiff, {stepped(c, noise, 1)}, {stepped(c, noise, 2)}, options);
  EXPECT_TRUE(is_above_noise(other, fit_baseline(other, stiff, warnings), 0.2));
}

TEST(Twins, AreOneNumberWithTheBaselinesOwn) {
  const Model model = complete(baseline("k*y + c*v", 1));
  const Effect left = without_twins(model, swing(*model.pool));
  EXPECT_EQ(left.twins, (std::vector<Twin>{{"mu", "c"}}));
  ASSERT_EQ(left.parameters.size(), 1u);
  EXPECT_EQ(left.parameters[0].name, "swing_beta");
  EXPECT_EQ(to_text(left.variants[0].force), "swing_beta*y^2*v");
  EXPECT_EQ(left.variants[0].formula, "beta*y^2*v");
}

TEST(Twins, OfACoefficientThatWasFittedWellWithinItsBoundsAreOneNumberToo) {
  Model model = complete(baseline("k*y + c*v", 1));
  Parameter& c = *model.find("c");
  c.min = 0;
  c.value = 1;
  c.std = 0.3;
  EXPECT_EQ(without_twins(model, swing(*model.pool)).parameters.size(), 1u);
  c.std = 0.4;  // its bound may be near: mu may be needed
  EXPECT_EQ(without_twins(model, swing(*model.pool)).parameters.size(), 2u);
}

TEST(Twins, StayWhereTheBaselineHasNone) {
  const Model model = complete(baseline("k*y", 1));
  EXPECT_EQ(without_twins(model, swing(*model.pool)).parameters.size(), 2u);
  Model bounded = complete(baseline("k*y + c*v", 1));
  bounded.find("c")->min = 0;
  EXPECT_EQ(without_twins(bounded, swing(*bounded.pool)).parameters.size(), 2u) << "c >= 0 may need mu";
  Model known = complete(baseline("k*y + c*v", 1));
  known.find("c")->fixed = true;
  EXPECT_EQ(without_twins(known, swing(*known.pool)).parameters.size(), 2u);
}

TEST(Twins, OfAnEntryThatIsTheBaselinesTermStay) {
  const Model model = complete(baseline("k*y + c*v", 1));
  const Effect damper = entry(*model.pool, "damper", "damper_c*v", {row("damper_c")});
  EXPECT_EQ(without_twins(model, damper).parameters.size(), 1u);  // left aside by the record, with its reason
}

}  // namespace
}  // namespace lunid
