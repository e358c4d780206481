// Several coordinates: which effect is missing, and where; on chains that code of their own integrates (tests/truth).
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "discover/study.hpp"
#include "discover_chain.hpp"
#include "message.hpp"
#include "record/derive.hpp"
#include "record/random.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using testing::baseline_of;
using testing::channel;
using testing::entry;
using testing::record_of;
using testing::row;
using testing::small_catalogue;

std::vector<Effect> catalogue_of(Pool& pool) {
  std::vector<Effect> all = small_catalogue(pool);
  Effect maxwell =
      entry(pool, "maxwell_relaxation", "0", {row("maxwell_relaxation_k", 0), row("maxwell_relaxation_tau", 0)});
  const Expr s = pool.state("maxwell_relaxation_s");
  maxwell.variants = {EffectVariant(s)};
  maxwell.states = {
      {s,
       pool.parameter("maxwell_relaxation_k") * pool.channel("v") - s / pool.parameter("maxwell_relaxation_tau"),
       0,
       {},
       {}}};
  maxwell.guess = [](const RecordScales& scale, int) {
    std::vector<Guess> guesses;
    for (const double part : {0.1, 1.0, 10.0})
      guesses.push_back({{"maxwell_relaxation_k", scale.stiffness}, {"maxwell_relaxation_tau", part / scale.omega}});
    return guesses;
  };
  maxwell.range = [](const RecordScales& scale, int) {
    return Ranges{{"maxwell_relaxation_k", {1e-4 * scale.stiffness, 1e5 * scale.stiffness}},
                  {"maxwell_relaxation_tau", {1e-3 / scale.omega, 1e3 / scale.omega}}};
  };
  all.push_back(std::move(maxwell));
  return all;
}

Discovery find(const truth::Chain& chain, const std::string& scale_name, double noise_db,
               const std::vector<std::string>& extra = {}, std::uint64_t seed = 5) {
  const truth::Scale& scale = truth::scale_named(scale_name);
  truth::RecordOptions options;
  options.rows = 2500;
  options.noise_db = noise_db;
  options.seed = seed;
  const truth::ChainRecords records = truth::make_chain_records(chain, scale, options);
  const Model model = baseline_of(chain, scale, extra);
  return discover(model, catalogue_of(*model.pool), {record_of(records.train, chain.driven, "train")},
                  {record_of(records.test, chain.driven, "test")});
}

void expect_named(const Discovery& d, const std::string& name, const std::string& place, double truth) {
  ASSERT_EQ(d.effects.size(), 1u) << to_terminal(d);
  EXPECT_EQ(d.effects[0].name, name) << to_terminal(d);
  EXPECT_EQ(d.effects[0].place, place) << to_terminal(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << to_terminal(d);
  const Parameter& p = d.effects[0].parameters.front();
  // Four standard deviations: one false alarm in 16 000 draws.
  EXPECT_NEAR(p.value, truth, 4 * p.std) << p.name;
  EXPECT_LT(d.final_test.value, 1.3 * d.final_test.floor);
  EXPECT_LT(d.final_test.value, 0.6 * d.baseline_test.value);
  ASSERT_FALSE(d.outputs.empty());
  for (const OutputGaps& o : d.outputs) EXPECT_LT(o.final_test.value, 1.4 * o.final_test.floor) << o.output;
}

truth::Chain two_masses() { return truth::in_a_row({1, 1}, 1, 0.06); }
truth::Chain three_masses() { return truth::in_a_row({1, 1, 1}, 1, 0.06, true); }

/// Pushed once and left alone: with one mass known the other is a ratio to it that the two modes show.
TEST(Degrees, AMassBesideAKnownOneInAFreeDecay) {
  truth::Chain chain = truth::in_a_row({1, 2.5}, 1, 0.01, true);
  constexpr double spacing = 2 * M_PI / 40;
  const auto push = [](double tau) { return tau < 4 ? std::sin(2 * M_PI * tau / 8) : 0.0; };
  const truth::ChainMotion motion = truth::integrate(chain, {push}, 1, 60, 1200, spacing, 20);
  Philox random(3, 0);
  std::vector<Channel> channels{channel("F1", "N", motion.F[0])};
  for (std::size_t i = 0; i < 2; ++i) {
    std::vector<double> y = motion.x[i];
    for (double& value : y) value += 0.005 * random.normal();
    channels.push_back(channel("y" + std::to_string(i + 1), "m", y));
  }
  const Record free("free", 0, spacing, std::move(channels));
  Model model = baseline_of(chain, truth::scale_named("metre"));
  model.further.front().mass = model.pool->parameter("m2");
  model.mass = model.pool->constant(1);
  model.parameters = {row("m2", 0)};
  const Discovery d = discover(model, small_catalogue(*model.pool), {free.slice(0, 800)}, {free.slice(800, 400)});
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << to_terminal(d);
  const auto m2 = std::ranges::find(d.final.parameters, "m2", &Parameter::name);
  ASSERT_NE(m2, d.final.parameters.end());
  EXPECT_NEAR(m2->value, 2.5, 4 * m2->std);
  EXPECT_LT(m2->std, 0.1);
}

TEST(Degrees, NamesACubicSpringInAJointAtThreeScales) {
  truth::Chain chain = two_masses();
  chain.links[1].k3 = 0.15;
  for (const char* name : {"micro", "milli", "metre"}) {
    const truth::Scale& scale = truth::scale_named(name);
    const double unit = scale.force() / std::pow(scale.length, 3);
    expect_named(find(chain, name, 30), "cubic_stiffness", "y1 - y2", 0.15 * unit);
  }
}

TEST(Degrees, NamesFrictionAgainstTheGround) {
  truth::Chain chain = three_masses();
  truth::Link rubs;
  rubs.of = 1;
  rubs.coulomb = 0.12;
  chain.links.push_back(rubs);
  const truth::Scale& scale = truth::scale_named("milli");
  expect_named(find(chain, "milli", 40), "coulomb_friction", "y2", 0.12 * scale.force());
}

TEST(Degrees, NamesAnEffectWithAStateInAJoint) {
  truth::Chain chain = two_masses();
  chain.links[1].maxwell_k = 0.6;
  chain.links[1].maxwell = 1.5;
  const truth::Scale& scale = truth::scale_named("milli");
  expect_named(find(chain, "milli", 40), "maxwell_relaxation", "y1 - y2", 0.6 * scale.force() / scale.length);
}

TEST(Degrees, NamesTwoEffectsAtTwoPlaces) {
  truth::Chain chain = two_masses();
  chain.links[0].k3 = 0.15;
  truth::Link rubs;
  rubs.of = 1;
  rubs.coulomb = 0.12;
  chain.links.push_back(rubs);
  const Discovery d = find(chain, "milli", 40);
  ASSERT_EQ(d.effects.size(), 2u) << to_terminal(d);
  std::vector<std::string> labels;
  for (const NamedEffect& e : d.effects) labels.push_back(e.label);
  std::sort(labels.begin(), labels.end());
  EXPECT_EQ(labels, (std::vector<std::string>{"coulomb_friction at y2", "cubic_stiffness at y1"})) << to_terminal(d);
}

TEST(Degrees, NamesNothingWhereNothingIsMissing) {
  const Discovery d = find(three_masses(), "milli", 30);
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << to_terminal(d);
  EXPECT_TRUE(d.effects.empty());
  truth::Chain chain = two_masses();
  chain.links[1].k3 = 0.15;
  const Discovery known = find(chain, "metre", 40, {"k3*(y1 - y2)^3", "k3*(y2 - y1)^3"});
  EXPECT_EQ(known.verdict, Verdict::nothing_missing) << to_terminal(known);
  EXPECT_NEAR(known.final_test.value, known.final_test.floor, 0.15 * known.final_test.floor);
}

/// Accelerations in place of the displacements, by differences of clean columns that are as good as the truth.
Record accelerations(const truth::ChainColumns& columns, double noise, std::uint64_t seed) {
  std::vector<Channel> channels{channel("F1", "N", columns.F[0])};
  const double dt = columns.t[1] - columns.t[0];
  for (std::size_t i = 0; i < columns.y.size(); ++i) {
    const Derivative a = differentiate(columns.y[i], dt, 0, 2, FiniteDifferences{10, 1});
    std::vector<double> values(a.values.begin(), a.values.end());
    const double deviation = moments::standard_deviation(values);
    Philox random(seed, i);
    for (double& value : values) value += noise * deviation * random.normal();
    channels.push_back(channel("a" + std::to_string(i + 1), "m/s^2", values));
  }
  return Record("accelerometers", 0, dt, std::move(channels));
}

TEST(Degrees, TakeAccelerometersAlone) {
  truth::Chain chain = two_masses();
  chain.links[1].k3 = 0.15;
  const truth::Scale& scale = truth::scale_named("milli");
  truth::RecordOptions options;
  options.rows = 2500;
  options.noise_db = 200;
  options.force_noise_db = 200;
  const truth::ChainRecords records = truth::make_chain_records(chain, scale, options);
  const Model model = baseline_of(chain, scale);
  const Discovery d = discover(model, catalogue_of(*model.pool), {accelerations(records.train, 0.02, 1)},
                               {accelerations(records.test, 0.02, 2)});
  ASSERT_EQ(d.effects.size(), 1u) << to_terminal(d);
  EXPECT_EQ(d.effects[0].label, "cubic_stiffness in y1 - y2") << to_terminal(d);
  ASSERT_EQ(d.outputs.size(), 2u);
  EXPECT_EQ(d.outputs[1].output, "a2");
}

TEST(Degrees, TakeTwoForcesAndSeveralRecords) {
  truth::Chain chain = two_masses();
  chain.driven = {0, 1};
  chain.links[0].coulomb = 0.12;
  const truth::Scale& scale = truth::scale_named("metre");
  truth::RecordOptions options;
  options.rows = 1200;
  options.noise_db = 40;
  std::vector<Record> train;
  truth::ChainRecords records;
  for (const std::uint64_t seed : {3, 4}) {
    options.seed = seed;
    records = truth::make_chain_records(chain, scale, options);
    train.push_back(record_of(records.train, chain.driven, "train " + std::to_string(seed)));
  }
  const Model model = baseline_of(chain, scale);
  const Discovery d =
      discover(model, catalogue_of(*model.pool), train, {record_of(records.test, chain.driven, "test")});
  expect_named(d, "coulomb_friction", "y1", 0.12 * scale.force());
  EXPECT_EQ(d.comparisons.size(), 6u);  // three records of two outputs
  EXPECT_EQ(d.comparisons[1].output, "y2");
  EXPECT_EQ(d.comparisons[2].record, "train 4");
}

// An entry that stands in the baseline at one place may be missing at another.
TEST(Degrees, NameTheSameEffectAtASecondPlace) {
  truth::Chain chain = two_masses();
  chain.links[0].k3 = 0.1;
  chain.links[1].k3 = 0.15;
  const truth::Scale& scale = truth::scale_named("milli");
  const double unit = scale.force() / std::pow(scale.length, 3);
  expect_named(find(chain, "milli", 40, {"cubic_stiffness_k3_1*y1^3"}), "cubic_stiffness", "y1 - y2", 0.15 * unit);
}

// Of chains with one effect or two the names and the places, no other.
TEST(Degrees, NameNoOtherPlace) {
  for (const char* name : {"two_cubic_first", "two_cubic_last", "three_cubic_joint", "two_friction_joint",
                           "two_dashpot", "two_pair_joint"})
    for (const double noise : {20.0, 30.0}) {
      const truth::ChainCase& which = truth::chain_case(name);
      const Discovery d = find(which.chain, noise > 25 ? "micro" : "metre", noise);
      std::vector<std::string> labels;
      for (const NamedEffect& e : d.effects) labels.push_back(e.label);
      std::sort(labels.begin(), labels.end());
      std::vector<std::string> expected = which.hidden;
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(labels, expected) << name << " at " << noise << " dB\n" << to_terminal(d);
    }
}

// What the catalogue does not hold is said to be there, with its place.
TEST(Degrees, SayWhereAnUnknownForceActs) {
  const Discovery d = find(truth::chain_case("two_outside").chain, "milli", 40);
  EXPECT_EQ(d.verdict, Verdict::unknown_effect) << to_terminal(d);
  EXPECT_NE(d.sentence.find("in y1 - y2"), std::string::npos) << d.sentence;
}

TEST(Degrees, HoldTheSameEffectAtOtherPlacesAgainstIt) {
  truth::Chain chain = two_masses();
  chain.links[1].k3 = 0.15;
  const Discovery d = find(chain, "milli", 40);
  for (const char* name : {"cubic_stiffness at y1", "cubic_stiffness at y2"})
    EXPECT_TRUE(std::any_of(d.rivals.begin(), d.rivals.end(), [&](const Rival& r) { return r.name == name; }))
        << name << "\n"
        << to_terminal(d);
  const nlohmann::json json = to_json(d);
  EXPECT_EQ(json["effects"][0]["place"], "y1 - y2");
  EXPECT_EQ(json["effects"][0]["name"], "cubic_stiffness");
  EXPECT_EQ(json["outputs"][1]["output"], "y2");
}

// ---- what is refused, and what to do ----

/// Records of two masses, of which some columns are left out or renamed.
Record part(const std::vector<std::pair<std::string, std::string>>& names) {
  truth::RecordOptions options;
  options.rows = 400;
  static const truth::ChainRecords records =
      truth::make_chain_records(two_masses(), truth::scale_named("milli"), options);
  const Record whole = record_of(records.train, {0}, "run.csv");
  std::vector<Channel> channels;
  for (const auto& [from, to] : names) {
    channels.push_back(whole.channel(from));
    channels.back().name = to;
  }
  return Record(whole.name(), whole.start(), whole.dt(), std::move(channels));
}

std::string refusal(const Model& model, const Record& record) {
  return message([&] { discover(model, small_catalogue(*model.pool), {record}, {}); });
}

TEST(DegreesRefuse, ACoordinateThatWasNotMeasured) {
  EXPECT_EQ(
      refusal(baseline_of(two_masses(), truth::scale_named("milli")), part({{"F1", "F1"}, {"y1", "y1"}})),
      "run.csv: discover: the record has no channel 'y2' (it has F1, y1); the motion of every coordinate of the model "
      "has to be measured: name its column, e.g. --columns \"y2=header [unit]\" (in a study columns = \"...\"), or "
      "take a "
      "model without it");
}

TEST(DegreesRefuse, AForceThatMayActOnEitherOfTwo) {
  Model model = baseline_of(two_masses(), truth::scale_named("milli"));
  model.driven = {0, 1};
  EXPECT_EQ(refusal(model, part({{"F1", "F"}, {"y1", "y1"}, {"y2", "y2"}})),
            "run.csv: discover: the record has one force F, and the model is driven at 2 coordinates: name the column "
            "F1 or another of them, or give the model forces = { 1 }");
}

TEST(DegreesRefuse, MoreCoordinatesThanFive) {
  const Model model = baseline_of(truth::in_a_row({1, 1, 1, 1, 1, 1}, 1, 0.06), truth::scale_named("milli"));
  EXPECT_EQ(refusal(model, part({{"F1", "F1"}, {"y1", "y1"}})),
            "discover: expected a model of no more than 5 coordinates, got 6: take a part of it, or one of its modes");
}

TEST(Degrees, TakeOneForceOfAWindowToo) {
  const Model model = baseline_of(two_masses(), truth::scale_named("milli"));
  const Record whole = part({{"F1", "F"}, {"y1", "y1"}, {"y2", "y2"}});
  const DiscoverOptions options;
  const Study study = prepare(complete(model), {whole.slice(50, 300)}, {whole}, options);
  ASSERT_EQ(study.full[0].rows(), 300);
  for (const std::size_t i : {0, 299}) EXPECT_EQ(study.full[0]["F1"][i], whole["F"][50 + i]);
}

// F is the force of the only coordinate that is driven.
TEST(Degrees, TakeOneForceForThatOfTheDrivenCoordinate) {
  const Model model = baseline_of(two_masses(), truth::scale_named("milli"));
  const Discovery d =
      discover(model, small_catalogue(*model.pool), {part({{"F1", "F"}, {"y1", "y1"}, {"y2", "y2"}})}, {});
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << to_terminal(d);
}

}  // namespace
}  // namespace lunid
