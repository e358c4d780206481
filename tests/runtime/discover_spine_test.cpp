// The whole spine on records of the independent generator, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "discover_catalogue.hpp"

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
  ASSERT_EQ(d.effects.size(), 1u) << d.verdict << ": " << d.sentence;
  EXPECT_EQ(d.effects[0].name, name);
  EXPECT_EQ(d.verdict, "explained");
  const Parameter& p = d.effects[0].parameters.front();
  // Four standard deviations: one false alarm in 16 000 draws.
  EXPECT_NEAR(p.value, found.truth, 4 * p.std) << p.name;
  EXPECT_LT(d.final_test.value, 1.3 * d.final_test.floor);
  EXPECT_LT(d.final_test.value, 0.5 * d.baseline_test.value);
}

TEST(Discovery, NamesCubicStiffnessAtThreeScales) {
  for (const char* scale : {"micro", "milli", "metre"}) expect_named(find("cubic_hardening", scale, 30), "cubic_stiffness");
}

TEST(Discovery, NamesCoulombFriction) { expect_named(find("coulomb_friction", "milli", 40), "coulomb_friction"); }
TEST(Discovery, NamesConstantForceInMuchNoise) { expect_named(find("constant_force", "metre", 20), "constant_force"); }
TEST(Discovery, NamesViscousDamping) { expect_named(find("viscous_damping", "milli", 30), "viscous_damping"); }

TEST(Discovery, NamesNothingWhereNothingIsMissing) {
  for (const char* name : {"null_linear", "null_duffing", "null_friction"}) {
    const Discovery d = find(name, "milli", 30).discovery;
    EXPECT_EQ(d.verdict, "nothing-missing") << name << ": " << d.sentence;
    EXPECT_TRUE(d.effects.empty());
    EXPECT_NEAR(d.baseline_test.value, d.baseline_test.floor, 0.15 * d.baseline_test.floor) << name;
  }
}

TEST(Discovery, JsonKeepsItsContract) {
  const auto j = to_json(find("cubic_hardening", "milli", 30).discovery);
  EXPECT_EQ(j.at("schema"), 1);
  EXPECT_EQ(j.at("verdict"), "explained");
  EXPECT_TRUE(j.at("baseline").at("parameters").at("k").contains("std"));
  EXPECT_TRUE(j.at("baseline").at("gap_test").is_number());
  const auto& effect = j.at("effects").at(0);
  for (const char* key : {"name", "family", "formula", "parameters", "indistinguishable", "where", "gap_train", "gap_test"})
    EXPECT_TRUE(effect.contains(key)) << key;
  EXPECT_TRUE(effect.at("parameters").contains("k3"));
  EXPECT_TRUE(j.at("final").contains("equation"));
  EXPECT_TRUE(j.at("noise_floor").at("gap_train").is_number());
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
            "made.csv: discover: the displacement is constant (0.500000 m in every row); nothing can be learned from a "
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
  EXPECT_EQ(refusal(baseline("k*y + q*max(y - 100, 0)", 1), made(y, f)),
            "discover: the data do not excite parameter 'q': its term is zero on every row of the training records; fix "
            "it, leave it out, or use a record that reaches it");
}

TEST(DiscoveryRefuses, OptionsOutOfRange) {
  DiscoverOptions options;
  options.alpha = 0.7;
  EXPECT_EQ(refusal(baseline("k*y", 1), Record(), options),
            "discover: alpha: expected 0 < alpha < 0.5, got 0.700000");
}

TEST(DiscoveryRefuses, ToGoOnWhenCancelled) {
  std::atomic<bool> cancelled{true};
  DiscoverOptions options;
  options.cancelled = &cancelled;
  EXPECT_EQ(refusal(baseline("k*y", 1), Record(), options), "interrupted while: check the data");
}

}  // namespace
}  // namespace lunid
