// Several coordinates whose channels or force are at fault: which of them, and never physics.
#include <gtest/gtest.h>

#include <cmath>

#include "discover/places.hpp"
#include "discover_chain.hpp"

namespace lunid {
namespace {

using testing::baseline_of;
using testing::entry;
using testing::record_of;
using testing::row;
using testing::sensor;
using testing::small_catalogue;

/// What a channel's column becomes: of its value, and the number of its row.
using Spoil = std::function<double(double value, double row)>;

Effect force_gain(Pool& pool) {
  Effect effect = entry(pool, "force_gain", "force_gain_g*F", {row("force_gain_g")});
  effect.family = "input";
  effect.variants[0].acts = {{"F", effect.variants[0].force}};
  effect.variants[0].force = {};
  effect.guess = [](const RecordScales&, int) { return std::vector<Guess>{{{"force_gain_g", 1}}}; };
  return effect;
}

std::vector<Effect> catalogue_of(Pool& pool) {
  std::vector<Effect> all = small_catalogue(pool);
  all.push_back(sensor(pool, "sensor_gain", "sensor_gain_g*y", {row("sensor_gain_g")}));
  all.back().guess = [](const RecordScales&, int) {
    return std::vector<Guess>{{{"sensor_gain_g", 1}}, {{"sensor_gain_g", -1}}};
  };
  all.push_back(sensor(pool, "sensor_drift", "y + sensor_drift_d*t", {row("sensor_drift_d")}));
  all.back().guess = [](const RecordScales&, int) { return std::vector<Guess>{{{"sensor_drift_d", 0}}}; };
  all.push_back(sensor(pool, "clipping", "min(y, clipping_level)", {row("clipping_level", 0)}));
  all.back().guess = [](const RecordScales& scale, int) {
    return std::vector<Guess>{{{"clipping_level", scale.y_max}}, {{"clipping_level", 0.9 * scale.y_max}}};
  };
  all.push_back(force_gain(pool));
  return all;
}

/// Two masses, a channel of which is spoilt; the model lacks no more than a cubic joint, where there is one.
Discovery find(const std::string& spoilt, const Spoil& spoil, double noise_db = 40, double cubic = 0) {
  const truth::Scale& scale = truth::scale_named("milli");
  truth::Chain chain = truth::in_a_row({1, 0.7}, 1, 0.06);
  chain.links[1].k3 = cubic;
  truth::RecordOptions options;
  options.rows = 2000;
  options.noise_db = noise_db;
  const truth::ChainRecords records = truth::make_chain_records(chain, scale, options);
  const auto spoilt_record = [&](truth::ChainColumns columns, const std::string& name) {
    std::vector<double>& column = spoilt == "F1" ? columns.F[0] : columns.y[spoilt == "y1" ? 0 : 1];
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = spoil(column[i], static_cast<double>(i));
    return record_of(columns, chain.driven, name);
  };
  const Model model = baseline_of(chain, scale);
  return discover(model, catalogue_of(*model.pool), {spoilt_record(records.train, "train")},
                  {spoilt_record(records.test, "test")});
}

void expect_fault(const Discovery& d, const std::string& label, const std::string& parameter, double truth) {
  EXPECT_EQ(d.verdict, Verdict::explained) << to_terminal(d);
  ASSERT_EQ(d.effects.size(), 1u) << to_terminal(d);
  EXPECT_EQ(d.effects[0].label, label) << to_terminal(d);
  const Parameter& found = d.effects[0].parameters.front();
  EXPECT_EQ(found.name, parameter);
  EXPECT_NEAR(found.value, truth, 4 * found.std) << to_terminal(d);
  EXPECT_LT(d.final_test.value, 1.15 * d.final_test.floor) << to_terminal(d);
}

TEST(DegreesFaults, AGainIsThatOfItsChannel) {
  expect_fault(find("y2", [](double y, double) { return 1.2 * y; }), "sensor_gain at y2", "g", 1.2);
  expect_fault(find("y1", [](double y, double) { return -y; }), "sensor_gain at y1", "g", -1);
}

TEST(DegreesFaults, ATrendIsThatOfItsChannel) {
  const double length = truth::scale_named("milli").length;
  constexpr double rate = 800;  // of the records of this scale [Hz]
  expect_fault(find(
                   "y1", [&](double y, double row) { return y + 0.4 * length * row / rate; }, 30),
               "sensor_drift at y1", "d", 0.4 * length);
}

TEST(DegreesFaults, ALimitIsThatOfItsChannel) {
  const double level = 1.1 * truth::scale_named("milli").length;
  expect_fault(find("y2", [&](double y, double) { return std::min(y, level); }), "clipping at y2", "level", level);
}

TEST(DegreesFaults, TheForceIsOffByAFactor) {
  expect_fault(find("F1", [](double f, double) { return f / 1.3; }), "force_gain at y1", "g", 1.3);
}

TEST(DegreesFaults, StandBesidePhysicsAtItsPlace) {
  const Discovery d = find(
      "y2", [](double y, double) { return 1.2 * y; }, 40, 0.15);
  std::vector<std::string> labels;
  for (const NamedEffect& e : d.effects) labels.push_back(e.label);
  std::sort(labels.begin(), labels.end());
  EXPECT_EQ(labels, (std::vector<std::string>{"cubic_stiffness in y1 - y2", "sensor_gain at y2"})) << to_terminal(d);
}

TEST(DegreesFaults, NoneWhereNothingIsWrong) {
  const Discovery d = find(
      "y1", [](double y, double) { return y; }, 30);
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << to_terminal(d);
}

/// A channel of the baseline that is known to show another value is taken as it is.
TEST(DegreesFaults, TheBaselineMayKnowThem) {
  const truth::Scale& scale = truth::scale_named("milli");
  const truth::Chain chain = truth::in_a_row({1, 0.7}, 1, 0.06);
  truth::RecordOptions options;
  options.rows = 2000;
  truth::ChainRecords records = truth::make_chain_records(chain, scale, options);
  for (auto* columns : {&records.train, &records.test})
    for (double& y : columns->y[0]) y *= 2;
  Model model = baseline_of(chain, scale);
  model.measures = {{"y1", 2 * model.pool->channel("y1")}};
  const Discovery d = discover(model, catalogue_of(*model.pool), {record_of(records.train, chain.driven, "train")},
                               {record_of(records.test, chain.driven, "test")});
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << to_terminal(d);
  EXPECT_LT(d.final_test.value, 1.15 * d.final_test.floor) << to_terminal(d);
}

/// A displacement's fault stands at each coordinate, a force's where one drives, and what an entry says of its forms
/// follows those that are left.
TEST(DegreesFaults, StandWhereTheirChannelsAre) {
  const truth::Chain chain = truth::in_a_row({1, 0.7, 0.5}, 1, 0.06);
  Model model = complete(baseline_of(chain, truth::scale_named("milli")));
  Pool& pool = *model.pool;
  Effect both = force_gain(pool);
  both.variants.push_back({});
  both.variants[1].measures = {{"y", pool.parameter("force_gain_g") * pool.channel("y")}};
  both.guess = [](const RecordScales&, int variant) {
    return std::vector<Guess>{{{"force_gain_g", variant == 0 ? 10 : 20}}};
  };
  const std::vector<Effect> placed = at_places(model, {both});
  ASSERT_EQ(placed.size(), 3u);
  EXPECT_EQ(placed[0].variants.size(), 2u);
  EXPECT_EQ(placed[0].variants[0].acts[0].channel, "F1");
  for (const std::size_t i : {1, 2}) {
    ASSERT_EQ(placed[i].variants.size(), 1u);
    EXPECT_EQ(placed[i].variants[0].measures[0].channel, "y" + std::to_string(i + 1));
    EXPECT_EQ(to_text(placed[i].variants[0].measures[0].map),
              "force_gain_g_" + std::to_string(i + 1) + "*y" + std::to_string(i + 1));
    EXPECT_EQ(placed[i].guess({}, 0).front().at("force_gain_g_" + std::to_string(i + 1)), 20);
  }
}

}  // namespace
}  // namespace lunid
