// Which baselines and records discovery takes, what it says of them first, and what it offers to take away.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "discover/study.hpp"
#include "discover_catalogue.hpp"
#include "message.hpp"
#include "record/random.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::channel;
using testing::record_of;
using testing::small_catalogue;

/// A free decay of the truth (k = 1, zeta = 0.02, k3 = 0.1) from x0, 1 % noise; y alone, in `unit`.
Record decay(double x0, std::uint64_t seed, const std::string& unit, double zeta = 0.02) {
  truth::Physics physics;
  physics.zeta = zeta;
  physics.k3 = 0.1;
  const double spacing = 2 * M_PI / 30;
  truth::Motion motion = truth::integrate(physics, truth::none(), 0, {x0, 0, 0}, 700, spacing, 24);
  Philox random(seed, 0);
  const double noise = 0.01 * moments::standard_deviation(motion.x);
  for (double& x : motion.x) x += noise * random.normal();
  return Record("decay " + std::to_string(seed), 0, spacing, {channel("y", unit, motion.x)});
}

TEST(DiscoveryTakes, AFreeDecayWithoutAForceInOtherUnits) {
  const Model model = baseline("k*y + c*v", 1);
  std::vector<Effect> catalogue = small_catalogue(*model.pool);
  catalogue[0].parameters[0].unit = "N/m^3";
  const Discovery d = discover(model, catalogue, {decay(2, 1, "rad")}, {decay(1.4, 2, "rad")});
  EXPECT_EQ(d.warnings[0], "decay 1 has no force and its motion dies away: taken for a free decay, F = 0");
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  const Parameter& k3 = d.effects[0].parameters.front();
  EXPECT_NEAR(k3.value, 0.1, 4 * k3.std);
  EXPECT_EQ(k3.unit, "N m/rad^3");  // no force, but an angle: moments
  EXPECT_GE(d.naming.of("cubic_stiffness"), 90);
}

/// Of a light damping half of the motion is left at the end; what never grows is a decay all the same.
TEST(DiscoveryTakes, AFreeDecayOfLightDamping) {
  const Model model = baseline("k*y + c*v", 1);
  const Discovery d =
      discover(model, small_catalogue(*model.pool), {decay(2, 1, "m", 0.003)}, {decay(1.4, 2, "m", 0.003)});
  EXPECT_TRUE(testing::warns(d, "decay 1 has no force and its motion dies away: taken for a free decay, F = 0"));
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
}

/// The last three periods of it, as a test, hardly fall: beside decays that were trained on they are one.
TEST(DiscoveryTakes, AShortTestWithoutAForceBesideFreeDecays) {
  const Model model = baseline("k*y + c*v", 1);
  const Record whole = decay(2, 1, "m", 0.003);
  const Discovery d = discover(model, small_catalogue(*model.pool), {whole.slice(0, 600)}, {whole.slice(600, 100)});
  EXPECT_TRUE(testing::warns(
      d, "decay 1 has no force and the training records are free decays: taken for a free decay, F = 0"));
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
}

/// 400 rows to a period, of a strong cubic spring and a noise of a ten-thousandth.
struct FastDecay {
  static constexpr int rows = 16000;
  static constexpr double noise = 1e-4;
  truth::Motion fine;  ///< twice as often
  Record record;
};

FastDecay fast_decay() {
  truth::Physics physics;
  physics.zeta = 0.005;
  physics.k3 = 0.5;
  const double spacing = 2 * M_PI / 400;
  const truth::Motion fine =
      truth::integrate(physics, truth::none(), 0, {1.5, 0, 0}, 2 * FastDecay::rows, spacing / 2, 8);
  std::vector<double> y(FastDecay::rows);
  Philox random(4, 0);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = fine.x[2 * i] + FastDecay::noise * random.normal();
  return {fine, Record("fast", 0, spacing, {channel("y", "m", y)})};
}

TEST(DiscoveryTakes, OfAFastRecordTheValuesInTheMiddleOfItsMeans) {
  const FastDecay fast = fast_decay();
  const DiscoverOptions options;
  const Study study = prepare(baseline("k*y + c*v", 1), {fast.record}, {fast.record.slice(0, 4000)}, options);
  const Record& thin = study.train.front().record;
  const auto mean_of = static_cast<std::size_t>(std::lround(thin.dt() / fast.record.dt()));
  ASSERT_GT(mean_of, 4u);
  double squares = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(thin.rows()); ++i)
    squares += std::pow(thin["y"][i] - fast.fine.x[2 * i * mean_of + mean_of - 1], 2);
  const double expected = thin.channel("y").noise;
  EXPECT_NEAR(expected, FastDecay::noise / std::sqrt(static_cast<double>(mean_of)), 0.2 * expected);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(thin.rows())), 1.1 * expected);
}

TEST(DiscoveryTakes, ARecordWithoutNoiseAndSaysSo) {
  const FastDecay fast = fast_decay();
  std::vector<double> y(4000);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = fast.fine.x[2 * i];
  const DiscoverOptions options;
  const auto warnings_of = [&](const Record& record) {
    return prepare(baseline("k*y + c*v", 1), {record}, {fast.record}, options).warnings;
  };
  const auto tells = [](const std::string& w) { return w.find("has no noise to speak of (") != std::string::npos; };
  EXPECT_TRUE(std::ranges::any_of(warnings_of(Record("made", 0, fast.record.dt(), {channel("y", "m", y)})), tells));
  EXPECT_FALSE(std::ranges::any_of(warnings_of(fast.record), tells));
}

/// The force of a mean is not the mean of the force.
TEST(DiscoveryTakes, AFastRecordDownToItsNoise) {
  const FastDecay fast = fast_decay();
  const Model model = baseline("k*y + c*v", 1);
  const Discovery d =
      discover(model, small_catalogue(*model.pool), {fast.record.slice(0, 12000)}, {fast.record.slice(12000, 4000)});
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  const Parameter& k3 = d.effects[0].parameters.front();
  EXPECT_NEAR(k3.value, 0.5, 4 * k3.std);
  EXPECT_LT(d.final_test.value, 1.2 * d.final_test.floor);
  EXPECT_LT(d.final_train.value, 1.2 * d.final_train.floor);
}

/// A cubic spring and Coulomb friction that hold the mass fast after two periods: 40 rows of motion before 1500 of
/// rest, which say nothing but where it rests.
TEST(DiscoveryTakes, OfADecayWhatMoves) {
  const truth::Scale& scale = truth::scale_named("milli");
  const truth::Records records = testing::records_of("cubic+coulomb", scale, 40, 8240, truth::Excited::decay);
  const Model model = baseline("k*y + c*v", scale.mass);
  std::vector<Effect> catalogue = small_catalogue(*model.pool);
  catalogue.push_back(testing::entry(*model.pool, "added_mass", "added_mass_ma*a", {testing::row("added_mass_ma")}));
  const Discovery d = testing::discover_case(model, catalogue, records);
  EXPECT_TRUE(testing::warns(d, "train: a free decay at rest from t = ")) << d.warnings.front();
  // No force: with -m*a added all other terms would vanish, and fit.
  EXPECT_TRUE(testing::warns(d, "added_mass (no force to measure a mass by)"));
  std::vector<std::string> names;
  for (const NamedEffect& effect : d.effects) names.push_back(effect.name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"coulomb_friction", "cubic_stiffness"})) << d.sentence;
}

TEST(DiscoveryTakes, ABaselineThatFollowsNothingAndSaysSo) {
  const Model model = baseline("c*v", 1);
  const std::vector<Effect> catalogue{small_catalogue(*model.pool)[2]};
  const Discovery d = discover(model, catalogue, {decay(2, 1, "m")}, {decay(1.4, 2, "m")});
  EXPECT_EQ(d.verdict, Verdict::unknown_effect) << d.sentence;
  EXPECT_TRUE(testing::warns(d, "the baseline does not follow the motion at all (gap "));
}

/// q's column is zero where p is, and the regression puts p there: its bound holds it off the truth's negative value.
/// From the values that p and q were given both are seen.
TEST(DiscoveryTakes, ATermWhoseFactorTheRegressionPutsAtZero) {
  Model model = baseline("k*y + c*v + p*tanh(q*y)", 1);
  Parameter p, q;
  p.name = "p";
  p.value = 0.1;
  p.min = 0;
  q.name = "q";
  q.value = 3;
  model.parameters = {p, q};
  const Discovery d = discover(model, small_catalogue(*model.pool), {decay(2, 1, "m")}, {decay(1.4, 2, "m")});
  EXPECT_FALSE(d.sentence.empty());
  EXPECT_TRUE(std::isfinite(d.final_test.value));
}

/// Record of a case at the "milli" scale.
truth::Records made(const char* name) {
  truth::RecordOptions options;
  options.rows = 1500;
  options.noise_db = 30;
  options.seed = 4;
  return truth::make_records(truth::case_named(name), truth::scale_named("milli"), options);
}

Discovery find(const Model& model, const truth::Records& records) {
  return discover(model, small_catalogue(*model.pool), {record_of(records.train, "train")},
                  {record_of(records.test, "test")});
}

TEST(DiscoverySaysFirst, ThatAParameterOfTheBaselineSitsAtABound) {
  Model model = baseline("k*y + c*v", 49);
  model = complete(model);
  const double wanted = 49 * std::pow(2 * M_PI * 20, 2);  // the truth's k
  model.find("k")->max = 0.9 * wanted;
  const Discovery d = find(model, made("null_linear"));
  char text[160];
  std::snprintf(text, sizeof text,
                "the baseline's k sits at its bound %.4g: widen it, or see what the baseline's other terms leave to it",
                0.9 * wanted);
  EXPECT_EQ(d.warnings[0], text);
}

/// Two springs side by side are one column; of two of which one is known the other is seen.
TEST(DiscoveryTakes, ATermThatIsFixedBesideOneLikeIt) {
  const truth::Records records = made("null_linear");
  Model model = complete(baseline("k*y + kh*y + c*v", 49));
  EXPECT_EQ(message([&] { find(model, records); }),
            "discover: the data do not excite parameters 'k' and 'kh' separately: their terms are one column on this "
            "record; fix one of them, or use a record with another frequency or amplitude (a name that is no signal, "
            "as y v a t are, "
            "is taken for a parameter)");
  const double wanted = 49 * std::pow(2 * M_PI * 20, 2);  // of both
  Parameter& known = *model.find("kh");
  known.value = 0.25 * wanted;
  known.fixed = true;
  const Discovery d = find(model, records);
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << d.sentence;
  EXPECT_NEAR(d.final.find("k")->value, 0.75 * wanted, 0.01 * wanted);
}

TEST(DiscoverySaysFirst, ThatTheTestHoldsRowsOfTheTrainingRecord) {
  const truth::Records records = made("cubic_hardening");
  const Record whole = record_of(records.train, "train"), other = record_of(records.test, "test");
  const Model model = baseline("k*y + c*v", 49);
  const auto of = [&](const Record& train, const Record& test) {
    return discover(model, small_catalogue(*model.pool), {train}, {test});
  };
  const std::string words = " holds rows of the training record train";
  const Discovery same = of(whole, whole), overlapping = of(whole.slice(0, 1000), whole.slice(500, 1000)),
                  apart = of(whole.slice(0, 900), whole.slice(900, 600)), another = of(whole, other);
  EXPECT_TRUE(testing::warns(same, words));
  EXPECT_TRUE(testing::warns(overlapping, words));
  EXPECT_FALSE(testing::warns(apart, words));
  EXPECT_FALSE(testing::warns(another, words));
  ASSERT_EQ(same.verdict, Verdict::explained);
  EXPECT_NE(same.sentence.find("on data that the fit knows"), std::string::npos) << same.sentence;
  EXPECT_NE(another.sentence.find("on data not used in the fit"), std::string::npos) << another.sentence;
}

/// A displacement that shows an eighth too much, beside a velocity that is right: the fits are of the displacement.
TEST(DiscoverySays, ThatTwoSensorsOfAMotionDoNotGoTogether) {
  truth::Physics physics;
  physics.zeta = 0.05;
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 60, 3), 0.3, {}, 1500, testing::spacing, 16);
  const auto record = [&](double gain, double noise, std::uint64_t seed) {
    Philox random(seed, 0);
    std::vector<double> y, v;
    for (std::size_t i = 0; i < motion.x.size(); ++i) {
      y.push_back(gain * motion.x[i] + noise * moments::standard_deviation(motion.x) * random.normal());
      v.push_back(motion.v[i] + noise * moments::standard_deviation(motion.v) * random.normal());
    }
    return Record("both", 0, testing::spacing,
                  {channel("F", "N", motion.force), channel("y", "m", y), channel("v", "m/s", v)});
  };
  const Model model = baseline("k*y + c*v", 1);
  const auto found = [&](double gain, double noise) {
    return discover(model, small_catalogue(*model.pool), {record(gain, noise, 1)}, {record(gain, noise, 2)});
  };
  for (const double noise : {0.01, 0.1}) {
    EXPECT_TRUE(
        testing::warns(found(1.125, noise), " times the derivative of y: the gain of one of the sensors is off"));
    EXPECT_FALSE(testing::warns(found(1, noise), "the gain of one of the sensors"));
  }
}

/// Eight rows of each record five deviations off: a sensor's contact. What is found is what is found without them.
TEST(DiscoveryTakes, WildRowsForWhatTheirNeighboursSay) {
  truth::Records records = made("cubic_hardening");
  const Model model = baseline("k*y + c*v", 49);
  const Discovery clean = find(model, records);
  for (truth::Columns* columns : {&records.train, &records.test}) {
    std::vector<double>& y = columns->y;
    const double size = 5 * moments::standard_deviation(y);
    for (std::size_t i = 0; i < 8; ++i) y[100 + 170 * i] += i % 2 ? size : -size;
  }
  const Discovery d = find(model, records);
  EXPECT_TRUE(testing::warns(d, "train: 8 single rows of y off all neighbours, first at t = ")) << d.warnings.front();
  EXPECT_TRUE(testing::warns(d, "test: 8 single rows of y"));
  EXPECT_FALSE(testing::warns(clean, "off all neighbours"));
  ASSERT_EQ(d.verdict, Verdict::explained) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  for (const char* name : {"k", "c", "cubic_stiffness_k3"}) {
    const Parameter &own = *d.final.find(name), &wanted = *clean.final.find(name);
    EXPECT_NEAR(own.value, wanted.value, 2 * wanted.std) << name;
  }
  EXPECT_LT(d.final_test.value, 1.1 * clean.final_test.value);
}

/// A mass in t for one in kg, a weight in N for a mass.
TEST(DiscoverySays, ThatAMassOfAThousandOrOfGravityIsRatherAUnit) {
  const Model model = baseline("k*y + c*v", 0.049);
  const std::vector<Effect> catalogue{
      testing::entry(*model.pool, "added_mass", "added_mass_ma*a", {testing::row("added_mass_ma")})};
  const truth::Records records = made("null_linear");
  const auto found = [&](double mass) {
    Model own = model;
    own.mass = own.pool->constant(mass);
    return discover(own, catalogue, {record_of(records.train, "train")}, {record_of(records.test, "test")});
  };
  const Discovery slip = found(0.049), half = found(24.5), weight = found(49 * 9.80665);
  ASSERT_EQ(slip.effects.size(), 1u);
  ASSERT_EQ(half.effects.size(), 1u);
  EXPECT_TRUE(testing::warns(slip, "is a unit (mm for m, kN for N, ms for s, g for kg) not said?"));
  EXPECT_FALSE(testing::warns(half, "is a unit"));
  EXPECT_TRUE(testing::warns(weight, "is a unit (g for m/s^2) not said?"));
}

TEST(DiscoveryOffers, AFrictionThatIsNotThereForRemovalAndKeepsIt) {
  const Model model = baseline("k*y + c*v + Fc*sign(v)", 49);
  const Discovery absent = find(model, made("null_linear"));
  ASSERT_EQ(absent.removable.size(), 1u);
  EXPECT_EQ(absent.removable[0].parameter, "Fc");
  EXPECT_EQ(absent.removable[0].term, "Fc*sign(v)");
  EXPECT_TRUE(absent.final.find("Fc") != nullptr);
  const Discovery there = find(baseline("k*y + c*v + Fc*sign(v)", 49), made("coulomb_friction"));
  EXPECT_TRUE(there.removable.empty());
}

/// Two hundred rows of a hysteresis that the baseline knows: its fit ends in a place from which any effect helps, until
/// it is fitted again from there.
TEST(Baseline, IsFittedAgainFromWhatWasFoundBesideIt) {
  truth::RecordOptions options;
  options.rows = 200;
  options.noise_db = 20;
  options.excited = truth::Excited::noise;
  options.seed = 10323;
  const truth::Scale& scale = truth::scale_named("milli");
  const truth::Records records = truth::make_records(truth::case_named("null_hysteresis"), scale, options);
  Model model;
  model.pool = std::make_shared<Pool>();
  Pool& pool = *model.pool;
  const Expr z = pool.state("z");
  model.mass = pool.constant(scale.mass);
  model.restoring = parse(pool, "k*y + c*v + kz*z");
  model.states.push_back({z, parse(pool, "v - abs(z/zy)^n*(rho*abs(v)*sign(z) + (1 - rho)*v)"), 0, {}, {}});
  const auto add = [&](const char* name, double value, double min) {
    Parameter p = testing::row(name, min);
    p.value = value;
    model.parameters.push_back(p);
  };
  add("k", NAN, 0);
  add("c", NAN, 0);
  add("kz", 0.4 * scale.force() / scale.length, 0);
  add("zy", 1.2 * scale.length, 0);
  add("n", 1, 1);
  add("rho", 0.7, -INFINITY);
  const Discovery d = discover(model, testing::small_catalogue(pool), {testing::record_of(records.train, "train")},
                               {testing::record_of(records.test, "test")});
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << d.sentence;
  EXPECT_LT(d.baseline_train.value, 1.5 * d.baseline_train.floor);
}

}  // namespace
}  // namespace lunid
