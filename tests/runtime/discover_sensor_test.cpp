// Faulty sensors and inputs among the entries, on records of the independent generator; what is read off the data.
#include "discover/lines.hpp"
#include "discover/sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "discover/places.hpp"
#include "discover_catalogue.hpp"
#include "truth/faults.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::record_of;
using testing::sensor;

/// A record of the generator with its further channel.
Record record_with(const truth::FaultyColumns& made, const char* name) {
  const Record record = record_of(made.columns, name);
  if (made.extra_name.empty()) return record;
  Channel extra;
  extra.name = extra.source = made.extra_name;
  extra.unit = made.extra_unit;
  extra.values = Eigen::Map<const Eigen::VectorXd>(made.extra.data(), static_cast<Eigen::Index>(made.extra.size()));
  return record.with(extra);
}

TEST(Shaft, AnglesFromSpeedsAndFromCountersThatWrap) {
  const Eigen::Index rows = 400;
  const double dt = 0.01;
  Eigen::VectorXd angle(rows), speed(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = dt * static_cast<double>(i);
    angle[i] = 20 * t + 3 * t * t;
    speed[i] = 20 + 6 * t;
  }
  const auto with = [&](const char* name, const char* unit, Eigen::VectorXd values) {
    Channel c;
    c.name = c.source = name;
    c.unit = unit;
    c.values = std::move(values);
    return with_shaft(Record("r", 0, dt, {c}));
  };
  Eigen::VectorXd wrapped = angle;
  for (auto& x : wrapped) x = std::fmod(x, 2 * M_PI);
  for (const Record& r :
       {with("phase", "rad", wrapped), with("shaft_angle", "rad", angle), with("speed", "rad/s", speed),
        with("shaft_speed", "rad/s", speed), with("speed", "Hz", speed / (2 * M_PI))})
    for (Eigen::Index i = 0; i < rows; i += 57) {
      EXPECT_NEAR(r["shaft_angle"][static_cast<std::size_t>(i)], angle[i], 1e-6);
      EXPECT_NEAR(r["shaft_speed"][static_cast<std::size_t>(i)], speed[i], 1e-6);
      EXPECT_NEAR(r["shaft_rate"][static_cast<std::size_t>(i)], 6, 1e-4);
    }
}

/// A force that is held needs others that are: a smooth one would come half a sample late if its samples were held.
TEST(Shaft, SignalsBesideAHeldForceAreHeldAtTheirMiddles) {
  const Eigen::Index rows = 600;
  const double dt = 0.05;
  std::vector<double> force, motion, base, steps;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = dt * static_cast<double>(i);
    force.push_back((i / 7 * 37) % 5 > 2 ? 1 : -1);
    motion.push_back(std::sin(t));
    base.push_back(std::sin(2 * t));
    steps.push_back(force.back() > 0 ? 3 : 1);
  }
  DiscoverOptions options;
  const auto with = [&](const std::vector<double>& beside) {
    const Record record("r", 0, dt,
                        {testing::channel("F", "N", force), testing::channel("y", "m", motion),
                         testing::channel("ab", "m/s^2", beside)});
    const Study study = prepare(baseline("k*y + c*v", 1), {record}, {record}, options);
    EXPECT_EQ(study.between.kind, Interpolation::hold);
    int at = 0;
    while (study.train[0].excitation.channel(at) != "ab") ++at;
    return study.train[0].excitation[at];
  };
  const Excitation smooth = with(base), held = with(steps);
  for (Eigen::Index i = 10; i + 10 < rows; i += 31) {
    const double t = dt * static_cast<double>(i);
    EXPECT_NEAR(smooth.at(t + 0.3 * dt), std::sin(2 * t + dt), 1e-5);
    EXPECT_EQ(held.at(t + 0.3 * dt), steps[static_cast<std::size_t>(i)]);
  }
}

/// One after another: the gain of a channel that is off already.
TEST(Sensor, FaultsOfOneChannelAreComposed) {
  Model model = baseline("k*y", 2);
  Pool& pool = *model.pool;
  const Effect offset = sensor(pool, "offset", "y + offset_b", {testing::row("offset_b")});
  const Effect gain = sensor(pool, "gain", "gain_g*y", {testing::row("gain_g")});
  add_variant(model, offset, 0);
  add_variant(model, gain, 0);
  EXPECT_EQ(model.equation(), "2*a + k*y = F\ny measured = gain_g*(y + offset_b)");
  EXPECT_FALSE(is_physics(offset));
  EXPECT_EQ(physics_in({{&offset, 0}, {&gain, 0}}), 0);
}

/// Under springs that know their zero an offset is one of the sensor; the physics behind it comes back.
TEST(Sensor, AnOffsetIsNoPhysics) {
  const truth::Scale& scale = truth::scale_named("milli");
  truth::RecordOptions options;
  options.rows = 1500;
  options.noise_db = 30;
  options.seed = 4;
  const auto records = truth::make_faulty(truth::fault_named("offset_duffing"), scale, options);
  const Model model = baseline(records.baseline, scale.mass);
  auto catalogue = testing::small_catalogue(*model.pool);
  catalogue.push_back(
      sensor(*model.pool, "displacement_offset", "y + displacement_offset_b", {testing::row("displacement_offset_b")}));
  catalogue.back().guess = [](const RecordScales&, int) {
    return std::vector<Guess>{{{"displacement_offset_b", 0.0}}};
  };
  Effect base = testing::entry(*model.pool, "base_motion", "base_motion_mb*ab", {testing::row("base_motion_mb")});
  base.channels = {"ab"};
  catalogue.push_back(base);
  const Discovery d =
      discover(model, catalogue, {record_with(records.train, "train")}, {record_with(records.test, "test")});
  ASSERT_EQ(d.effects.size(), 1u) << to_string(d.verdict) << ": " << d.sentence;
  EXPECT_EQ(d.effects[0].name, "displacement_offset");
  EXPECT_EQ(d.effects[0].family, "sensor");
  const Parameter& b = d.effects[0].parameters.front();
  EXPECT_NEAR(b.value, 0.5 * scale.length, 4 * b.std);
  const Parameter& k = *d.final.find("k");
  EXPECT_NEAR(k.value, scale.mass * scale.omega() * scale.omega(), 4 * k.std);
  EXPECT_NE(d.sentence.find("(the sensor, not the physics)"), std::string::npos) << d.sentence;
  EXPECT_LT(d.final_test.value, 1.3 * d.final_test.floor);
  EXPECT_EQ(d.warnings.back(), "not tried: base_motion (no channel ab)");
}

/// Under a linear spring an offset of the displacement is a constant force: the faults of sensors are asked before
/// that is named, even where it leaves nothing open.
TEST(Sensor, IsAskedBeforePhysicsIsNamed) {
  truth::RecordOptions options;
  options.rows = 2000;
  options.noise_db = 40;
  options.seed = 3;
  const truth::Scale& scale = truth::scale_named("milli");
  const auto records = truth::make_faulty(truth::fault_named("offset"), scale, options);
  const Model model = baseline("k*y + c*v", scale.mass);
  std::vector<Effect> catalogue = testing::small_catalogue(*model.pool);
  DiscoverOptions first;
  first.first = static_cast<int>(catalogue.size());
  catalogue.push_back(testing::entry(*model.pool, "quintic_stiffness", "quintic_stiffness_k5*y^5",
                                     {testing::row("quintic_stiffness_k5")}));
  catalogue.push_back(
      sensor(*model.pool, "displacement_offset", "y + displacement_offset_b", {testing::row("displacement_offset_b")}));
  catalogue.back().guess = [](const RecordScales&, int) {
    return std::vector<Guess>{{{"displacement_offset_b", 0.0}}};
  };
  const Discovery d =
      discover(model, catalogue, {record_with(records.train, "train")}, {record_with(records.test, "test")}, first);
  EXPECT_EQ(d.verdict, Verdict::ambiguous) << d.sentence;
  ASSERT_EQ(d.effects.size(), 1u);
  EXPECT_EQ(d.effects[0].name, "displacement_offset");
  EXPECT_EQ(d.effects[0].indistinguishable, std::vector<std::string>{"constant_force"});
}

/// What an accelerometer shows of a linear oscillator (mass 1, k = 1), limited at `level`, with 2 % noise.
Record limited_accelerometer(double level, std::uint64_t seed) {
  truth::Physics physics;
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 60, seed), 0.3, {}, 2500, testing::spacing, 16);
  std::vector<double> a(motion.force.size());
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = std::min(motion.force[i] - motion.restoring[i], level);
  return testing::noisy_record(motion, "a", a, 0.005, seed);
}

Effect limit(Pool& pool) {
  Effect effect = sensor(pool, "clipping", "min(y, clipping_level)", {testing::row("clipping_level", 0)});
  effect.variants[0].formula = "y measured = min(y, level)";
  effect.parameters.front().unit = "m";
  effect.guess = [](const RecordScales& scale, int) {
    return std::vector<Guess>{{{"clipping_level", scale.y_max}}, {{"clipping_level", 0.9 * scale.y_max}}};
  };
  effect.any_motion = true;
  return effect;
}

TEST(Sensor, AnAccelerometersFaultIsThatOfItsChannel) {
  const double level = 0.35;
  const Model model = baseline("k*y + c*v", 1);
  auto catalogue = testing::small_catalogue(*model.pool);
  catalogue.push_back(limit(*model.pool));
  catalogue.push_back(
      sensor(*model.pool, "displacement_offset", "y + displacement_offset_b", {testing::row("displacement_offset_b")}));
  const Discovery d = discover(model, catalogue, {limited_accelerometer(level, 1)}, {limited_accelerometer(level, 2)});
  ASSERT_EQ(d.effects.size(), 1u) << to_string(d.verdict) << ": " << d.sentence;
  EXPECT_EQ(d.effects[0].name, "clipping");
  EXPECT_EQ(d.effects[0].formula, "a measured = min(a, level)");
  const Parameter& found = d.effects[0].parameters.front();
  EXPECT_EQ(found.unit, "m/s^2");
  EXPECT_NEAR(found.value, level, 4 * found.std);
  const Parameter& k = *d.final.find("k");
  EXPECT_NEAR(k.value, 1, 4 * k.std);
  EXPECT_LT(d.final_test.value, 1.15 * d.final_test.floor);
  EXPECT_EQ(d.warnings.back(), "not tried: displacement_offset (of y, where a was measured)");
}

/// Maps, rates of states and units follow the channel; what is guessed comes from its sizes.
TEST(Sensor, AnEntryOfTheDisplacementSpeaksOfTheChannelThatWasMeasured) {
  const Model model = baseline("k*y", 1);
  Pool& pool = *model.pool;
  Effect effect = limit(pool);
  effect.parameters.push_back(testing::row("clipping_d"));
  effect.parameters.back().unit = "m/s";
  const Expr x = pool.state("clipping_x");
  effect.states = {{x, pool.channel("y") - x, 0, {}, {}}};
  const Effect shown = of_channel(model, effect, 'a');
  EXPECT_EQ(shown.variants[0].measures[0].channel, "a");
  EXPECT_EQ(to_text(shown.variants[0].measures[0].map), "min(a, clipping_level)");
  EXPECT_EQ(to_text(shown.states[0].rate), "a - clipping_x");
  EXPECT_EQ(shown.parameters[1].unit, "m/s^3");
  RecordScales scale{};
  scale.y_max = 1;
  scale.shown_max = 7;
  EXPECT_EQ(shown.guess(scale, 0).front().at("clipping_level"), 7);
  EXPECT_EQ(of_channel(model, effect, 'v').parameters[0].unit, "m/s");
  effect.sentence = "the displacement channel saturates";
  EXPECT_EQ(of_channel(model, effect, 'a').sentence, "the acceleration channel saturates");
}

/// The lines of a residual are found between the bins of its transform, the strongest first.
TEST(Sensor, LinesThatStandOut) {
  Study study;
  Eigen::VectorXd x(1000);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double t = 0.01 * static_cast<double>(i);
    x[i] = std::cos(17.3 * t) + 3 * std::sin(41.9 * t + 0.4);
  }
  Channel y;
  y.name = "y";
  y.values = x;
  study.train.push_back({Record("r", 0, 0.01, {y}), {}, {}});
  Candidate candidate;
  candidate.fit.cost = 1;
  candidate.fit.residual = {x};
  const std::vector<double> lines = residual_lines(study, candidate);
  ASSERT_GE(lines.size(), 2u);
  EXPECT_NEAR(lines[0], 41.9, 0.02);  // a thirtieth of the 2 pi / T that part the lines of the transform
  EXPECT_NEAR(lines[1], 17.3, 0.02);
}

}  // namespace
}  // namespace lunid
