// Sets in which an entry stands more than once, and the names of what stands there.
#include <gtest/gtest.h>

#include "discover/choices.hpp"
#include "discover_catalogue.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::entry;
using testing::row;

/// A stop on either side, which repeats, and a spring, which does not.
std::vector<Effect> catalogue(const Model& model) {
  Pool& pool = *model.pool;
  Effect stop = entry(pool, "stop", "stop_k*max(y - stop_g, 0)", {row("stop_k"), row("stop_g")});
  stop.variants.push_back(parse(pool, "stop_k*min(y + stop_g, 0)"));
  stop.guess = [](const RecordScales&, int) { return std::vector{Guess{{"stop_g", 1.0}}}; };
  stop.range = [](const RecordScales&, int) { return Ranges{{"stop_g", {0.0, 2.0}}}; };
  stop.repeats = true;
  return with_repetitions(model, {stop, entry(pool, "cubic", "cubic_k3*y^3", {row("cubic_k3")})});
}

TEST(Repetitions, HaveNamesOfTheirOwnAndTheEntrysName) {
  const Model model = baseline("k*y", 1);
  const std::vector<Effect> all = catalogue(model);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[1].label(), "stop");
  EXPECT_EQ(all[1].number, 2);
  EXPECT_EQ(all[1].parameters[1].name, "stop_g_b");
  EXPECT_EQ(own_name(all[1], "stop_g_b"), "g");
  EXPECT_EQ(to_text(all[1].variants[0].force), "stop_k_b*max(y - stop_g_b, 0)");
  EXPECT_EQ(all[2].parameters[0].name, "stop_k_c");
  EXPECT_EQ(all[1].guess({}, 0)[0].begin()->first, "stop_g_b");
  EXPECT_EQ(all[1].range({}, 0).begin()->first, "stop_g_b");
  EXPECT_EQ(all[3].name, "cubic");
}

TEST(Repetitions, BeginBehindWhatTheModelHas) {
  Model model = baseline("k*y + stop_k*max(y - stop_g, 0)", 1);
  model.parameters = {row("k"), row("stop_k"), row("stop_g")};
  const std::vector<Effect> all = catalogue(model);
  EXPECT_EQ(all[0].parameters[0].name, "stop_k_b");
  EXPECT_EQ(all[0].number, 1);
}

TEST(Repetitions, StandBesideTheOneBefore) {
  const Model model = baseline("k*y", 1);
  const std::vector<Effect> all = catalogue(model);
  const Effect &first = all[0], &second = all[1], &third = all[2], &cubic = all[3];
  EXPECT_TRUE(may_join({}, first));
  EXPECT_FALSE(may_join({}, second));
  EXPECT_TRUE(may_join({{&cubic, 0}, {&first, 1}}, second));
  EXPECT_FALSE(may_join({{&first, 0}}, third));
  EXPECT_FALSE(may_join({{&first, 0}}, first));
}

TEST(Repetitions, MakeSetsThatAreToldByTheirForms) {
  const Model model = baseline("k*y", 1);
  const std::vector<Effect> all = catalogue(model);
  const Effect &first = all[0], &second = all[1];
  const Choices both{{&first, 0}, {&second, 1}};
  EXPECT_TRUE(same(both, {{&first, 1}, {&second, 0}}));
  EXPECT_FALSE(same(both, {{&first, 0}, {&second, 0}}));
  EXPECT_TRUE(within({{&first, 1}}, both));
  EXPECT_FALSE(within({{&first, 0}, {&second, 0}}, both));
  EXPECT_EQ(name_of(both), "stop + stop");
  EXPECT_EQ(beyond(both, {{&first, 1}, {&all[3], 0}}), Choices({{&first, 0}}));
  EXPECT_EQ(beyond(both, {{&first, 1}, {&second, 0}}), Choices());
}

}  // namespace
}  // namespace lunid
