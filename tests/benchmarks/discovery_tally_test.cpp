// The matrix's own counting: what an answer is worth, what closure and chance are, which settings a plan holds.
#include "discovery_tally.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

namespace matrix {
namespace {

using nlohmann::json;

Setting setting_of(const char* name) {
  return {&truth::case_named(name), nullptr, &truth::scales()[1], {}, "", true, 0};
}
Setting fault_setting(const char* name) {
  return {nullptr, &truth::fault_named(name), &truth::scales()[1], {}, "", true, 0};
}

json effect(const char* name, std::vector<std::string> others = {}, const char* is = "physics") {
  return {{"name", name}, {"indistinguishable", others}, {"is", is}, {"parameters", json::object()}};
}

json discovery(const char* verdict, std::vector<json> effects) {
  return {{"verdict", verdict},
          {"effects", effects},
          {"baseline", {{"gap_test", 0.4}}},
          {"final", {{"gap_test", 0.012}}},
          {"noise_floor", {{"gap_test", 0.01}}}};
}

Answer answer(const Setting& setting, const char* verdict, std::vector<json> effects) {
  return judge(setting, discovery(verdict, std::move(effects))).answer();
}

TEST(Answers, of_one_hidden_effect) {
  const Setting drag = setting_of("quadratic_drag");
  EXPECT_EQ(answer(drag, "explained", {effect("quadratic_drag")}), Answer::first);
  EXPECT_EQ(answer(drag, "ambiguous", {effect("cubic_damping", {"quadratic_drag"})}), Answer::in_class);
  EXPECT_EQ(answer(drag, "explained", {effect("cubic_damping")}), Answer::wrong);
  EXPECT_EQ(answer(drag, "explained", {effect("quadratic_drag"), effect("preload")}), Answer::wrong);
  EXPECT_EQ(answer(drag, "unknown-effect", {}), Answer::silent);
  EXPECT_EQ(answer(drag, "nothing-missing", {}), Answer::silent);
  EXPECT_EQ(judge(drag, json()).answer(), Answer::failed);
}

TEST(Answers, of_a_pair_ask_for_both) {
  const Setting pair = setting_of("drag+stop");
  EXPECT_EQ(answer(pair, "explained", {effect("one_sided_stop"), effect("quadratic_drag")}), Answer::first);
  EXPECT_EQ(answer(pair, "ambiguous", {effect("one_sided_stop"), effect("cubic_damping", {"quadratic_drag"})}),
            Answer::in_class);
  EXPECT_EQ(answer(pair, "explained", {effect("one_sided_stop")}), Answer::wrong);  // it says that all is explained
  EXPECT_EQ(answer(pair, "unknown-effect", {effect("one_sided_stop")}), Answer::silent);
  EXPECT_EQ(answer(pair, "unknown-effect", {effect("preload")}), Answer::wrong);
}

TEST(Answers, where_no_name_is_right) {
  EXPECT_EQ(answer(setting_of("null_linear"), "nothing-missing", {}), Answer::first);
  EXPECT_EQ(answer(setting_of("null_linear"), "unknown-effect", {}), Answer::silent);
  EXPECT_EQ(answer(setting_of("null_linear"), "explained", {effect("preload")}), Answer::wrong);
  EXPECT_EQ(answer(setting_of("outside_v2y"), "unknown-effect", {}), Answer::first);
  EXPECT_EQ(answer(setting_of("outside_v2y"), "nothing-missing", {}), Answer::silent);
}

TEST(Answers, of_a_fault_tell_physics_from_sensors) {
  const Setting offset = fault_setting("offset");
  const auto judged = [&](std::vector<json> effects) {
    return judge(offset, discovery("explained", std::move(effects)));
  };
  EXPECT_EQ(judged({effect("displacement_offset", {}, "sensor")}).answer(), Answer::first);
  const Outcome tie = judged({effect("constant_force", {"displacement_offset"})});
  EXPECT_EQ(tie.answer(), Answer::in_class);
  EXPECT_FALSE(tie.physics);
  const Outcome physics = judged({effect("constant_force")});
  EXPECT_EQ(physics.answer(), Answer::wrong);
  EXPECT_TRUE(physics.physics);
  EXPECT_FALSE(judged({effect("sensor_drift", {}, "the sensor, not the physics")}).physics);
}

TEST(Answers, of_a_tie_ask_for_the_class) {
  const Setting tie = setting_of("tie_damping");
  const std::vector<std::string> equals{"viscous_damping", "cubic_damping"};
  const auto judged = [&](const char* verdict, std::vector<json> effects, const std::vector<std::string>& same) {
    const json found = discovery(verdict, std::move(effects));
    Outcome outcome = judge(tie, found);
    judge_tie(tie, found, same, outcome);
    return outcome;
  };
  EXPECT_EQ(judged("ambiguous", {effect("viscous_damping", {"quadratic_drag"})}, equals).answer(), Answer::first);
  EXPECT_EQ(judged("ambiguous", {effect("viscous_damping", {"cubic_damping"})}, equals).answer(), Answer::in_class);
  EXPECT_EQ(judged("explained", {effect("quadratic_drag")}, equals).answer(), Answer::wrong);  // it cannot know that
  EXPECT_EQ(judged("nothing-missing", {}, equals).answer(), Answer::silent);
  EXPECT_TRUE(judged("explained", {effect("quadratic_drag")}, {}).tells);
}

Outcome gaps(double before, double after, double noise, int rows) {
  Outcome outcome;
  outcome.before = before, outcome.after = after, outcome.noise = outcome.floor = noise, outcome.rows = rows;
  return outcome;
}

TEST(Closure, is_the_share_of_what_the_noise_allows) {
  EXPECT_DOUBLE_EQ(closure(gaps(0.5, 0.1, 0.1, 900)), 1);
  EXPECT_DOUBLE_EQ(closure(gaps(0.5, 0.3, 0.1, 900)), 0.5);
  EXPECT_DOUBLE_EQ(closure(gaps(0.5, 0.5, 0.1, 900)), 0);
  EXPECT_DOUBLE_EQ(closure(gaps(7, 0.2, 0.2, 900)), 1);  // a baseline that explodes leaves all open
  EXPECT_DOUBLE_EQ(closure(gaps(NAN, 0.2, 0.2, 900)), 1);
  EXPECT_DOUBLE_EQ(closure(gaps(0.5, NAN, 0.2, 900)), (0.5 - 1) / 0.3);
  EXPECT_TRUE(std::isnan(closure(gaps(0.109, 0.1, 0.1, 900))));  // chance(900) is 0.1
}

TEST(Tallies, count_gaps_below_the_floor_by_more_than_chance) {
  Tally tally;
  const Setting drag = setting_of("quadratic_drag");
  Outcome outcome = gaps(0.5, 0.1, 0.1, 900);
  outcome.verdict = "explained", outcome.named = "quadratic_drag", outcome.right = true;
  tally.add(drag, outcome);
  EXPECT_EQ(tally.below_floor(), 0);
  outcome.after = 0.091;  // within chance
  tally.add(drag, outcome);
  EXPECT_EQ(tally.below_floor(), 0);
  outcome.after = 0.089;
  tally.add(drag, outcome);
  EXPECT_EQ(tally.below_floor(), 1);
  EXPECT_TRUE(tally.clean());
}

TEST(Tallies, of_runs_that_are_not_right_are_not_clean) {
  for (const char* name : {"quadratic_drag", "drag+stop", "null_linear", "outside_v2y"}) {
    Tally tally;
    Outcome outcome = gaps(0.5, 0.1, 0.1, 900);
    outcome.verdict = "explained", outcome.named = "preload";
    tally.add(setting_of(name), outcome);
    EXPECT_FALSE(tally.clean()) << name;
  }
}

TEST(Outcomes, are_kept_for_a_run_that_goes_on) {
  Outcome outcome = gaps(0.5, 0.1, NAN, 900);
  outcome.verdict = "explained", outcome.named = "preload";
  outcome.right = outcome.some = true, outcome.class_size = 2, outcome.parameters = 3, outcome.inside = 1;
  outcome.worst = -2.5, outcome.share = 0.3, outcome.seconds = 4;
  const Outcome back = outcome_of(nlohmann::json::parse(kept(outcome).dump()));
  EXPECT_EQ(kept(back).dump(), kept(outcome).dump());
  EXPECT_TRUE(std::isnan(back.floor));
  EXPECT_EQ(back.answer(), Answer::first);
  EXPECT_EQ(back.worst, -2.5);
}

TEST(Limits, are_those_of_clopper_and_pearson) {
  EXPECT_NEAR(upper_limit(0, 100), 1 - std::pow(0.05, 0.01), 1e-12);
  EXPECT_NEAR(upper_limit(1, 20), 0.2161, 1e-4);  // Hahn and Meeker 1991, table A.23
  EXPECT_EQ(upper_limit(3, 3), 1);
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
}

TEST(Settings, of_the_full_matrix_hold_every_excitation_and_level_once) {
  Plan plan;
  plan.full = true;
  std::set<std::string> folders;
  int faults = 0, drags = 0, offsets = 0, gains = 0, liquefied = 0, ties = 0;
  for (const Setting& setting : settings(plan)) {
    EXPECT_TRUE(folders.insert(setting.folder()).second) << setting.folder();
    faults += setting.fault != nullptr;
    drags += setting.name() == "quadratic_drag";
    offsets += setting.name() == "fault offset";
    gains += setting.name() == "fault force_gain";
    liquefied += setting.name() == "vibro_liquefaction";
    ties += setting.is(truth::Kind::tie);
  }
  EXPECT_EQ(drags, 3 * 4 * 5);
  EXPECT_EQ(offsets, 3 * 4 * 5);
  EXPECT_EQ(gains, 3 * 4 * 4);  // a free decay has no force
  EXPECT_EQ(liquefied, 4 * 5);  // at one scale
  EXPECT_EQ(ties, 4 * 3 * 4);   // each under its own excitation
  EXPECT_GT(faults, 500);
}

TEST(Settings, of_nothing_missing_hold_every_combination_once) {
  Plan plan;
  plan.nulls = 1008;
  std::set<std::string> all;
  for (const Setting& setting : settings(plan)) all.insert(setting.folder() + setting.kind);
  EXPECT_EQ(all.size(), 4u * 3 * 3 * 4 * 7);
}

TEST(Settings, come_in_their_turn_and_with_as_many_seeds_as_asked) {
  Plan plan;
  const std::size_t once = settings(plan).size();
  EXPECT_EQ(once, truth::cases().size() + 3 * truth::faults().size());
  plan.seeds = 3;
  const std::vector<Setting> thrice = settings(plan);
  EXPECT_EQ(thrice.size(), 3 * once);
  std::set<std::string> folders;
  std::set<std::uint64_t> seeds;
  for (const Setting& setting : thrice) {
    folders.insert(setting.folder());
    if (setting.name() == "quadratic_drag") seeds.insert(setting.options.seed);
  }
  EXPECT_EQ(folders.size(), thrice.size());
  EXPECT_EQ(seeds.size(), 3u);
  plan.draw = 300;
  const std::vector<Setting> drawn = settings(plan);
  EXPECT_EQ(drawn.size(), 300u);
  EXPECT_GT(std::count_if(drawn.begin(), drawn.end(), [](const Setting& s) { return s.fault != nullptr; }), 20);
}

}  // namespace
}  // namespace matrix
