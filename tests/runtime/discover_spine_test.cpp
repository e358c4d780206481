// The whole spine on records of the independent generator, and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "discover_catalogue.hpp"
#include "record/random.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::record_of;
using testing::small_catalogue;

struct Found {
  Discovery discovery;
  double truth = NAN;
};

Found find(const std::string& name, const std::string& scale_name, double noise_db, int rows = 2500) {
  const truth::Case& which = truth::case_named(name);
  const truth::Scale& scale = truth::scale_named(scale_name);
  truth::RecordOptions options;
  options.rows = rows;
  options.noise_db = noise_db;
  options.seed = 11;
  const auto records = truth::make_records(which, scale, options);
  const Model model = baseline(which.baseline, scale.mass);
  const auto catalogue = small_catalogue(*model.pool);
  Found out;
  out.discovery = discover(model, catalogue, {record_of(records.train, "train")}, {record_of(records.test, "test")});
  if (!which.parameters.empty()) out.truth = which.parameters.front().in(scale);
  return out;
}

void expect_named(const Found& found, const std::string& name) {
  const Discovery& d = found.discovery;
  ASSERT_EQ(d.effects.size(), 1u) << to_string(d.verdict) << ": " << d.sentence;
  EXPECT_EQ(d.effects[0].name, name);
  EXPECT_EQ(d.verdict, Verdict::explained);
  const Parameter& p = d.effects[0].parameters.front();
  // Four standard deviations: one false alarm in 16 000 draws.
  EXPECT_NEAR(p.value, found.truth, 4 * p.std) << p.name;
  EXPECT_LT(d.final_test.value, 1.3 * d.final_test.floor);
  EXPECT_LT(d.final_test.value, 0.5 * d.baseline_test.value);
}

TEST(Discovery, NamesCubicStiffnessAtThreeScales) {
  for (const char* scale : {"micro", "milli", "metre"})
    expect_named(find("cubic_hardening", scale, 30), "cubic_stiffness");
}

TEST(Discovery, NamesCoulombFriction) { expect_named(find("coulomb_friction", "milli", 40), "coulomb_friction"); }

TEST(Discovery, NamesFrictionThatIsRoundedAtRestByTheFormThatIs) {
  for (const char* scale : {"micro", "metre"}) {
    const Found rounded = find("rounded_friction", scale, 40);
    expect_named(rounded, "coulomb_friction");
    ASSERT_EQ(rounded.discovery.effects[0].parameters.size(), 2u);
    const Parameter& vr = rounded.discovery.effects[0].parameters[1];
    const truth::TrueParameter& known = truth::case_named("rounded_friction").parameters[1];
    EXPECT_EQ(vr.name, "vr");
    EXPECT_NEAR(vr.value, known.in(truth::scale_named(scale)), 4 * vr.std);
    EXPECT_EQ(rounded.discovery.effects[0].formula, "Fc*tanh(v/vr)");
  }
}

/// The sharp form has the parameter of the rounded one neither in the model nor in what is reported.
TEST(Discovery, ASharpFormKeepsItsOneParameter) {
  const Found sharp = find("coulomb_friction", "milli", 30);
  expect_named(sharp, "coulomb_friction");
  ASSERT_EQ(sharp.discovery.effects[0].parameters.size(), 1u);
  EXPECT_EQ(sharp.discovery.final.find("coulomb_friction_vr"), nullptr);
}

TEST(Discovery, NamesConstantForceInMuchNoise) { expect_named(find("constant_force", "metre", 20), "constant_force"); }
TEST(Discovery, NamesViscousDamping) { expect_named(find("viscous_damping", "milli", 30), "viscous_damping"); }

TEST(Discovery, NamesNothingWhereNothingIsMissing) {
  for (const char* name : {"null_linear", "null_duffing", "null_friction"}) {
    const Discovery d = find(name, "milli", 30).discovery;
    EXPECT_EQ(d.verdict, Verdict::nothing_missing) << name << ": " << d.sentence;
    EXPECT_TRUE(d.effects.empty());
    EXPECT_NEAR(d.baseline_test.value, d.baseline_test.floor, 0.15 * d.baseline_test.floor) << name;
  }
}

/// Mass 1, k = 1, a cubic spring that moves the motion by a few percent, in noise of 5 %.
Discovery slightly_hard(double minimum_gain, double k3 = 0.01, double alpha = 0.01) {
  truth::Physics physics;
  physics.zeta = 0.05;
  physics.k3 = k3;
  const auto record = [&](std::uint64_t seed) {
    const truth::Motion motion =
        truth::integrate(physics, truth::multisine(0.2, 2.2, 60, seed), 0.03, {}, 1600, testing::spacing, 24);
    return testing::noisy_record(motion, "y", motion.x, 0.05 * moments::standard_deviation(motion.x), seed);
  };
  const Model model = baseline("k*y + c*v", 1);
  DiscoverOptions options;
  options.minimum_gain = minimum_gain;
  options.alpha = alpha;
  return discover(model, small_catalogue(*model.pool), {record(3)}, {record(4)}, options);
}

TEST(Discovery, SaysWhatIsLessThanTheLeastGainAndNamesItWhereLessIsAsked) {
  const Discovery d = slightly_hard(0.05);
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << d.sentence;
  EXPECT_NE(d.sentence.find("cubic_stiffness lowers it beyond chance, but by "), std::string::npos) << d.sentence;
  EXPECT_NE(d.sentence.find("less than the least gain of 5 %"), std::string::npos) << d.sentence;
  const Discovery asked = slightly_hard(0.005);
  ASSERT_EQ(asked.effects.size(), 1u) << asked.sentence;
  EXPECT_EQ(asked.effects[0].name, "cubic_stiffness");
}

/// Of the stiffer spring p is 4e-6, corrected for what was tried, of the softer one between the two levels.
TEST(Discovery, NamesByTheLevelOfFalseAlarmsThatIsAskedFor) {
  const Discovery named = slightly_hard(0, 0.0055), strict = slightly_hard(0, 0.0055, 1e-6);
  ASSERT_EQ(named.effects.size(), 1u) << named.sentence;
  EXPECT_EQ(named.effects[0].name, "cubic_stiffness");
  EXPECT_TRUE(named.effects[0].p_value > 1e-6 && named.effects[0].p_value < 0.01) << named.effects[0].p_value;
  EXPECT_EQ(strict.verdict, Verdict::nothing_missing) << strict.sentence;
  const std::string beyond = "lowers it beyond chance", no = "lowers the left-out gap beyond chance";
  EXPECT_NE(slightly_hard(0, 0.004, 0.01).sentence.find(no), std::string::npos);
  EXPECT_NE(slightly_hard(0, 0.004, 0.2).sentence.find(beyond), std::string::npos);
}

/// m*a + c*v + k*y + k3*y^3 = F with m = 1, k = 1, c = 0.06 from rest by RK4 at a 24th of a sample; F(t, row) is the
/// force within the interval after a row. Noise of 1 % is added to y.
Record oscillator(double k3, const std::function<double(double, int)>& force, std::uint64_t seed) {
  constexpr int rows = 2000, steps = 24;
  const double dt = 2 * M_PI / 25, h = dt / steps;
  truth::Columns columns;
  double y = 0, v = 0;
  for (int row = 0; row < rows; ++row) {
    columns.t.push_back(row * dt);
    columns.F.push_back(force(row * dt, row));
    columns.y.push_back(y);
    for (int j = 0; j < steps; ++j) {
      const double t = row * dt + j * h;
      const auto a = [&](double time, double y, double v) { return force(time, row) - 0.06 * v - y - k3 * y * y * y; };
      const double a1 = a(t, y, v), v2 = v + h / 2 * a1, a2 = a(t + h / 2, y + h / 2 * v, v2);
      const double v3 = v + h / 2 * a2, a3 = a(t + h / 2, y + h / 2 * v2, v3);
      const double v4 = v + h * a3, a4 = a(t + h, y + h * v3, v4);
      y += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  }
  Philox random(seed, 0);
  const double noise = 0.01 * moments::standard_deviation(columns.y);
  for (double& y : columns.y) y += noise * random.normal();
  return record_of(columns, "oscillator");
}

/// Trained on a force that is held between its samples, tested on one that is smooth: each is read as what it is.
TEST(Discovery, ReadsTheForceBetweenItsSamplesPerRecord) {
  Philox random(5, 0);
  std::vector<double> held(2000);
  for (double& f : held) f = random.normal();
  const auto stairs = [&](double, int row) { return held[static_cast<std::size_t>(row)]; };
  const auto smooth = [](double t, int) {
    return 0.25 * (std::cos(0.62 * t) + std::cos(0.97 * t + 1) + std::cos(1.31 * t + 2));
  };
  for (const double k3 : {0.0, 0.05}) {
    const Model model = baseline("k*y + c*v", 1);
    const auto catalogue = small_catalogue(*model.pool);
    const Discovery d = discover(model, catalogue, {oscillator(k3, stairs, 1)}, {oscillator(k3, smooth, 2)});
    EXPECT_EQ(d.interpolation, "hold");
    EXPECT_EQ(d.effects.size(), k3 > 0 ? 1u : 0u) << to_string(d.verdict) << ": " << d.sentence;
    for (const auto& effect : d.effects) EXPECT_EQ(effect.name, "cubic_stiffness");
    EXPECT_LT(d.final_test.value, d.final_test.floor + 3 * d.final_test.floor_std + 0.3 * d.final_test.floor);
  }
}

/// A machine that holds whatever it puts out: tones look band-limited then, beside noise that does not, in the test
/// record or among those that train.
TEST(Discovery, ReadsForcesOfOneMachineAlike) {
  Philox random(5, 0);
  std::vector<double> noise(2000);
  for (double& f : noise) f = random.normal();
  const double dt = 2 * M_PI / 25;
  const auto stairs = [&](double, int row) { return noise[static_cast<std::size_t>(row)]; };
  const auto tones = [](double t) {
    return 0.25 * (std::cos(0.62 * t) + std::cos(0.97 * t + 1) + std::cos(1.31 * t + 2));
  };
  const auto held = [&](double, int row) { return tones(row * dt); };
  const auto smooth = [&](double t, int) { return tones(t); };
  const Model model = baseline("k*y + c*v", 1);
  const auto catalogue = small_catalogue(*model.pool);
  const auto is_right = [](const Discovery& d) {
    EXPECT_EQ(d.interpolation, "hold");
    ASSERT_EQ(d.effects.size(), 1u) << to_string(d.verdict) << ": " << d.sentence;
    EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
    EXPECT_LT(d.final_train.value, 1.3 * d.final_train.floor);
    EXPECT_LT(d.final_test.value, 1.3 * d.final_test.floor);
  };
  const auto said = [](const Discovery& d) {
    return std::ranges::any_of(d.warnings, [](const std::string& w) { return w.find("looks otherwise") != w.npos; });
  };
  const Discovery tested = discover(model, catalogue, {oscillator(0.05, stairs, 1)}, {oscillator(0.05, held, 2)});
  is_right(tested);
  EXPECT_TRUE(said(tested));
  const Discovery trained =
      discover(model, catalogue, {oscillator(0.05, stairs, 1), oscillator(0.05, held, 2)}, {oscillator(0.05, held, 3)});
  is_right(trained);
  const Discovery both = discover(model, catalogue, {oscillator(0.05, stairs, 1), oscillator(0.05, smooth, 2)},
                                  {oscillator(0.05, smooth, 3)});
  is_right(both);
  EXPECT_FALSE(said(both));
}

/// Random bits of two rows each are predicted better by straight lines, and are held all the same.
TEST(Discovery, ReadsAForceThatStandsStillBetweenItsJumpsAsHeld) {
  Philox random(6, 0);
  std::vector<double> bits(1000);
  for (double& bit : bits) bit = random.uniform() < 0.5 ? -0.5 : 0.5;
  const auto held = [&](double, int row) { return bits[static_cast<std::size_t>(row / 2)]; };
  const auto smooth = [](double t, int) {
    return 0.25 * (std::cos(0.62 * t) + std::cos(0.97 * t + 1) + std::cos(1.31 * t + 2));
  };
  const Model model = baseline("k*y + c*v", 1);
  const Discovery d =
      discover(model, small_catalogue(*model.pool), {oscillator(0.05, smooth, 1)}, {oscillator(0.05, held, 2)});
  ASSERT_EQ(d.effects.size(), 1u) << to_string(d.verdict) << ": " << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  EXPECT_LT(d.final_test.value, 1.3 * d.final_test.floor);
}

/// A stop may have its gap only where the motion is: a constant force is not a stop that is always in contact.
TEST(Discovery, AShapeParameterStaysWhereTheRecordCanShowIt) {
  const truth::Scale& scale = truth::scale_named("milli");
  truth::RecordOptions options;
  options.rows = 1500;
  options.noise_db = 30;
  options.seed = 7;
  const auto records = truth::make_records(truth::case_named("constant_force"), scale, options);
  const Model model = baseline("k*y + c*v", scale.mass);
  Effect stop = testing::entry(*model.pool, "one_sided_stop", "one_sided_stop_k*max(y - one_sided_stop_g, 0)",
                               {testing::row("one_sided_stop_k", 0), testing::row("one_sided_stop_g")});
  stop.guess = [](const RecordScales& s, int) {
    return std::vector<Guess>{{{"one_sided_stop_g", s.y_min}}, {{"one_sided_stop_g", 0.5 * s.y_max}}};
  };
  stop.range = [](const RecordScales& s, int) { return Ranges{{"one_sided_stop_g", {s.y_min, s.y_max}}}; };
  const Discovery d = discover(model, {stop}, {record_of(records.train, "train")}, {record_of(records.test, "test")});
  EXPECT_TRUE(d.effects.empty()) << d.sentence;
  EXPECT_EQ(d.verdict, Verdict::unknown_effect) << d.sentence;
  EXPECT_GT(d.gap_left_out_before, 0.1);  // measured where no set is left to be judged, too
  EXPECT_EQ(d.gap_left_out_after, d.gap_left_out_before);
}

/// A special case with as many parameters as the general entry is the same force: said, and no doubt.
TEST(Discovery, TheSameForceInOtherWordsIsSaid) {
  const truth::Scale& scale = truth::scale_named("milli");
  const truth::Records records = testing::records_of("cubic_hardening", scale, 30, 7);
  const Model model = baseline("k*y + c*v", scale.mass);
  std::vector<Effect> catalogue = testing::small_catalogue(*model.pool);
  catalogue.push_back(testing::entry(*model.pool, "odd_spring", "odd_spring_p*y^3", {testing::row("odd_spring_p")}));
  catalogue.push_back(testing::entry(*model.pool, "two_springs", "two_springs_p*y^3 + two_springs_q*y^5",
                                     {testing::row("two_springs_p"), testing::row("two_springs_q")}));
  catalogue.front().special_case_of = {"odd_spring", "two_springs"};
  const Discovery d = testing::discover_case(model, catalogue, records);
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  EXPECT_EQ(d.effects[0].indistinguishable, std::vector<std::string>{"odd_spring"});
  EXPECT_EQ(d.verdict, Verdict::explained);
}

TEST(Discovery, JsonKeepsItsContract) {
  const auto j = to_json(find("cubic_hardening", "milli", 30).discovery);
  EXPECT_EQ(j.at("schema"), 1);
  EXPECT_EQ(j.at("verdict"), "explained");
  EXPECT_TRUE(j.at("baseline").at("parameters").at("k").contains("std"));
  EXPECT_TRUE(j.at("baseline").at("gap_test").is_number());
  const auto& effect = j.at("effects").at(0);
  for (const char* key :
       {"name", "family", "formula", "parameters", "indistinguishable", "where", "gap_train", "gap_test"})
    EXPECT_TRUE(effect.contains(key)) << key;
  EXPECT_TRUE(effect.at("parameters").contains("k3"));
  EXPECT_TRUE(j.at("final").contains("equation"));
  EXPECT_TRUE(j.at("noise_floor").at("gap_train").is_number());
}

TEST(Discovery, TheTerminalShowsNoMoreOfAnEquationThanCanBeRead) {
  Discovery d;
  d.final = baseline("k*y + c*v", 1);
  EXPECT_NE(to_terminal(d).find("equation   a + k*y + c*v = F\n"), std::string::npos) << to_terminal(d);
  Pool& pool = *d.final.pool;
  for (int i = 0; i < 10; ++i) {
    const Expr z = pool.state("z" + std::to_string(i));
    d.final.restoring = d.final.restoring + z;
    d.final.states.push_back({z, parse(pool, "v"), 0, Expr(), Expr()});
  }
  const std::string shown = to_terminal(d);
  EXPECT_NE(shown.find("dz2/dt = v"), std::string::npos) << shown;
  EXPECT_EQ(shown.find("dz3/dt"), std::string::npos) << shown;
  EXPECT_NE(shown.find("... (whole in model.lua and the report)"), std::string::npos) << shown;
}

TEST(Discovery, TheTerminalNamesForcesThatAreTooLongToRead) {
  Discovery d;
  d.final = d.baseline = baseline("k*y + c*v", 1);
  for (int i = 0; i < 20; ++i)
    d.final.restoring = d.final.restoring + 0.1234567890123456 * d.final.pool->state("iwan_z" + std::to_string(i));
  d.effects.emplace_back();
  d.effects[0].label = "iwan";
  EXPECT_NE(to_terminal(d).find("equation   a + k*y + c*v + iwan = F (whole in model.lua and the report)\n"),
            std::string::npos)
      << to_terminal(d);
  d.effects[0].family = "input";  // what it changes is no force beside the others
  EXPECT_NE(to_terminal(d).find("... (whole in model.lua and the report)"), std::string::npos) << to_terminal(d);
}

TEST(Discovery, SameBitsForAnyNumberOfThreads) {
  const truth::Case& which = truth::case_named("cubic_hardening");
  const truth::Scale& scale = truth::scale_named("milli");
  truth::RecordOptions options;
  options.rows = 1500;
  const auto records = truth::make_records(which, scale, options);
  std::vector<std::string> texts;
  for (const int threads : {1, 2}) {
    const Model model = baseline(which.baseline, scale.mass);
    DiscoverOptions o;
    o.threads = threads;
    auto d = discover(model, small_catalogue(*model.pool), {record_of(records.train, "train")},
                      {record_of(records.test, "test")}, o);
    d.seconds = 0;
    texts.push_back(to_json(d).dump());
  }
  EXPECT_EQ(texts[0], texts[1]);
}

/// The common entries leave a quadratic spring open, so that the search is made again of all.
TEST(Discovery, ShowsProgressThatNeverFalls) {
  const truth::Scale& scale = truth::scale_named("milli");
  const truth::Records records = testing::records_of("quadratic_stiffness", scale, 40, 12);
  const Model model = baseline("k*y + c*v", scale.mass);
  DiscoverOptions options;
  options.first = 1;
  std::vector<std::pair<std::string, double>> shown;
  options.progress = [&](const std::string& stage, double fraction) { shown.emplace_back(stage, fraction); };
  discover(model, small_catalogue(*model.pool), {record_of(records.train, "train")}, {record_of(records.test, "test")},
           options);
  EXPECT_TRUE(std::ranges::is_sorted(shown, {}, [](const auto& each) { return each.second; }));
  EXPECT_TRUE(std::ranges::any_of(shown, [](const auto& each) { return each.first == "the whole catalogue"; }));
  EXPECT_EQ(shown.front().second, 0);
  EXPECT_EQ(shown.back().second, 1);
}

std::string refusal(const Model& model, const Record& record, const DiscoverOptions& options = {}) {
  try {
    discover(model, small_catalogue(*model.pool), {record}, {}, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

Record made(const std::vector<double>& y, const std::vector<double>& f) {
  truth::Columns columns;
  for (std::size_t i = 0; i < y.size(); ++i) columns.t.push_back(0.01 * static_cast<double>(i));
  columns.y = y;
  columns.F = f;
  return record_of(columns, "made.csv");
}

TEST(DiscoveryRefuses, AConstantDisplacement) {
  EXPECT_EQ(refusal(baseline("k*y", 1), made(std::vector<double>(300, 0.5), std::vector<double>(300, 1.0))),
            "made.csv: discover: the displacement is constant (0.5 m in every row); nothing can be learned from a "
            "record without motion");
}

TEST(DiscoveryRefuses, TooFewRows) {
  EXPECT_EQ(refusal(baseline("k*y", 1), made({1, 2, 3, 2, 1, 0, 1, 2}, {1, 2, 3, 2, 1, 0, 1, 2})),
            "made.csv: discover: expected at least 30 rows in a record, got 8; a motion of a few periods is needed to "
            "tell one effect from another");
}

TEST(DiscoveryRefuses, AParameterThatTheDataDoNotExcite) {
  std::vector<double> y, f;
  for (int i = 0; i < 600; ++i) {
    y.push_back(std::sin(0.1 * i) + 0.3 * std::sin(0.23 * i));
    f.push_back(std::cos(0.1 * i));
  }
  EXPECT_EQ(
      refusal(baseline("k*y + q*max(y - 100, 0)", 1), made(y, f)),
      "discover: the data do not excite parameter 'q': its term is zero on every row of the training records; fix "
      "it, leave it out, or use a record that reaches it");
}

TEST(DiscoveryRefuses, OptionsOutOfRange) {
  DiscoverOptions options;
  options.alpha = 0.7;
  EXPECT_EQ(refusal(baseline("k*y", 1), Record(), options), "discover: alpha: expected 0 < alpha < 0.5, got 0.7");
}

TEST(DiscoveryRefuses, ToGoOnWhenCancelled) {
  std::atomic<bool> cancelled{true};
  DiscoverOptions options;
  options.cancelled = &cancelled;
  EXPECT_EQ(refusal(baseline("k*y", 1), Record(), options), "interrupted while: check the data");
}

/// v^2 y is in no catalogue. A cubic spring follows it at 20 dB so far that less than 5 % of the training records'
/// excess is left, but not on the test record: one and a half floors with a repeatable force left are enough to take it
/// back.
TEST(Discovery, TakesBackANameThatLeavesARepeatableForceOnTheTest) {
  truth::RecordOptions options;
  options.rows = 3200;
  options.noise_db = 20;
  options.excited = truth::Excited::noise;
  options.seed = 121;
  const truth::Scale& scale = truth::scale_named("milli");
  const truth::Records records = truth::make_records(truth::case_named("outside_v2y"), scale, options);
  const Model model = testing::baseline("k*y + c*v", scale.mass);
  const Discovery d =
      discover(model, testing::small_catalogue(*model.pool), {testing::record_of(records.train, "train")},
               {testing::record_of(records.test, "test")});
  EXPECT_EQ(d.verdict, Verdict::unknown_effect) << d.sentence;
  EXPECT_TRUE(d.effects.empty());
  EXPECT_TRUE(testing::warns(d, "left a force that is repeatable: the name is withdrawn"));
  EXPECT_TRUE(testing::warns(d, "train on one like it as well"));
}

}  // namespace
}  // namespace lunid
