// Long records: the search looks at pieces of them, what it finds is fitted to all rows.
#include <gtest/gtest.h>

#include <cmath>

#include "discover/baseline.hpp"
#include "discover/ground.hpp"
#include "discover/study.hpp"
#include "discover_catalogue.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::small_catalogue;
using testing::spacing;

constexpr int rows = 40000, burst = 23300;

/// A motion (mass 1, k = 1, zeta = 0.03) under a weak random force that is ten times as strong once, for some 30
/// periods.
Record seldom_strong(double k3, std::uint64_t seed) {
  truth::Physics physics;
  physics.k3 = k3;
  const truth::Signal random = truth::multisine(0.2, 2.2, 40, seed);
  const auto signal = [random](double t) {
    const double off = (t / spacing - burst) / 350;
    return random(t) * (0.1 + 0.9 * std::exp(-off * off));
  };
  const truth::Motion motion = truth::integrate(physics, signal, 0.1, {}, rows, spacing, 8);
  return testing::noisy_record(motion, "y", motion.x, 2e-3, seed, 10);
}

TEST(Pieces, OfALongRecordHoldItsLargestMotionAndSpreadOverIt) {
  const Record record = seldom_strong(0, 1);
  const Model model = baseline("k*y + c*v", 1);
  const DiscoverOptions options;
  const Study whole = prepare(model, {record}, {record}, options), part = shortened(whole, Searched::again);
  const Record& all = whole.train.front().record;
  ASSERT_GE(part.train.size(), 4u);
  Eigen::Index sum = 0;
  double largest = 0, peak = 0;
  for (const double y : all["y"]) peak = std::max(peak, std::abs(y));
  for (std::size_t i = 0; i < part.train.size(); ++i) {
    const Record& piece = part.train[i].record;
    sum += piece.rows();
    const auto first = static_cast<std::size_t>(std::lround((piece.start() - all.start()) / all.dt()));
    for (std::size_t k = 0; k < static_cast<std::size_t>(piece.rows()); k += 97) {
      EXPECT_EQ(piece["y"][k], all["y"][first + k]);
      EXPECT_EQ(part.smooth[i]["v"][k], whole.smooth.front()["v"][first + k]);
      const double t = piece.dt() * static_cast<double>(k);
      EXPECT_NEAR(part.train[i].excitation[0].at(piece.start() + t), all["F"][first + k], 1e-9);
    }
    for (const double y : piece["y"]) largest = std::max(largest, std::abs(y));
    if (i == 0) continue;
    const Record& before = part.train[i - 1].record;
    EXPECT_GE(piece.start(), before.start() + before.duration());
  }
  EXPECT_LE(sum, 7500);
  EXPECT_EQ(largest, peak);
  EXPECT_LT(part.train.front().record.start(), all.start() + 0.2 * all.duration());
  EXPECT_GT(part.train.back().record.start(), all.start() + 0.7 * all.duration());
  EXPECT_EQ(part.full.front().rows(), rows);
  EXPECT_TRUE(part.in_pieces);
}

TEST(Pieces, OfAShortRecordAreTheRecord) {
  const Record record = seldom_strong(0, 1).slice(0, 6400);
  const Model model = baseline("k*y + c*v", 1);
  const DiscoverOptions options;
  const Study whole = prepare(model, {record}, {record}, options), part = shortened(whole, Searched::again);
  ASSERT_EQ(part.train.size(), 1u);
  EXPECT_EQ(part.train.front().record.rows(), whole.train.front().record.rows());
  EXPECT_FALSE(part.in_pieces);
}

TEST(Pieces, AreFewAtFirstAndMoreOnce) {
  const Model model = baseline("k*y + c*v", 1);
  const DiscoverOptions options;
  const Record all = seldom_strong(0, 1), test = all.slice(0, 500);
  const auto searched = [&](int length) {
    Ground ground;
    ground.whole = prepare(model, {all.slice(0, length)}, {test}, options);
    ground.study = shortened(ground.whole, ground.searched);
    std::vector<Eigen::Index> out{ground.study.rows()};
    EXPECT_EQ(ground.study.most_effects, options.max_effects);
    while (ground.take_more_rows(2)) {
      out.push_back(ground.study.rows());
      EXPECT_EQ(ground.study.most_effects, 2);
    }
    return out;
  };
  EXPECT_EQ(searched(3000), (std::vector<Eigen::Index>{3000}));
  EXPECT_EQ(searched(6400), (std::vector<Eigen::Index>{3000, 6400}));
  EXPECT_EQ(searched(12000), (std::vector<Eigen::Index>{3000, 6000}));
  EXPECT_EQ(searched(rows), (std::vector<Eigen::Index>{6000}));
}

/// A burst in rows that are not among the first pieces.
TEST(Pieces, AreMoreWhereTheFirstLeaveAnything) {
  constexpr int length = 6400, at = 2400, width = 300;
  truth::Physics physics;
  const auto burst_at = [](double t) {
    const double off = (t / spacing - at) / width;
    return 0.02 * std::cos(0.6 * t) * std::exp(-off * off);
  };
  const auto measured = [&](std::uint64_t seed) {
    const truth::Signal random = truth::multisine(0.2, 2.2, 40, seed);
    const auto with_burst = [&](double t) { return random(t) + burst_at(t) / 0.1; };
    truth::Motion motion = truth::integrate(physics, with_burst, 0.1, {}, length, spacing, 8);
    for (int i = 0; i < length; ++i) motion.force[static_cast<std::size_t>(i)] -= burst_at(i * spacing);
    return testing::noisy_record(motion, "y", motion.x, 2e-3, seed);
  };
  const Record record = measured(5);
  const Model model = baseline("k*y + c*v", 1);
  const DiscoverOptions options;
  for (const FitData& data : shortened(prepare(model, {record}, {record}, options), Searched::first).train) {
    const double from = data.record.start() / spacing, to = from + static_cast<double>(data.record.rows());
    ASSERT_TRUE(from > at + 2 * width || to < at - 2 * width) << from;
  }
  std::vector<Effect> catalogue = small_catalogue(*model.pool);
  const std::string shape =
      "burst_a*cos(0.6*t)*exp(-((t - " + std::to_string(at * spacing) + ")/" + std::to_string(width * spacing) + ")^2)";
  catalogue.push_back(testing::entry(*model.pool, "burst", shape, {testing::row("burst_a")}));
  const Discovery d = discover(model, catalogue, {record}, {measured(6)}, options);
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "burst");
  EXPECT_NEAR(d.effects[0].parameters.front().value, -0.02, 0.001);
}

/// What pieces preferred gives its place to a rival that follows all rows better; a rival with more parameters does not
/// take it.
TEST(Pieces, LeaveTheirNameForOneThatFollowsAllRowsBetter) {
  truth::Physics physics;
  physics.k3 = 0.3;
  const truth::Motion motion = truth::integrate(physics, truth::multisine(0.2, 2.2, 20, 5), 0.2, {}, 9000, spacing, 8);
  const Record record = testing::noisy_record(motion, "y", motion.x, 2e-3, 5);
  const Model model = complete(baseline("k*y + c*v", 1));
  Pool& pool = *model.pool;
  const std::vector<Effect> catalogue{
      testing::entry(pool, "cubic", "cubic_a*y^3", {testing::row("cubic_a")}),
      testing::entry(pool, "quintic", "quintic_a*y^5", {testing::row("quintic_a")}),
      testing::entry(pool, "both", "both_a*y^3 + both_b*y^5", {testing::row("both_a"), testing::row("both_b")})};
  const DiscoverOptions options;
  const auto named = [&](const std::vector<std::size_t>& chosen_first) {
    Ground ground;
    ground.whole = prepare(model, {record}, {record}, options);
    ground.searched = Searched::again;
    ground.study = shortened(ground.whole, ground.searched);
    EXPECT_TRUE(ground.study.in_pieces);
    Round round;
    SearchResult& found = round.found;
    const auto fitted = [&](Choices set) {
      Candidate c = compile(ground.study, model, std::move(set));
      find_starts(ground.study, c, {}, {});
      fit(ground.study, c, full_fit(ground.study, 20));
      return c;
    };
    found.baseline = ground.baseline = fitted({});
    for (const std::size_t i : chosen_first) {
      const Choice choice{&catalogue[i], 0};
      if (i != chosen_first.front()) {
        found.rivals.push_back({fitted({choice}), Beaten::By::training, {}});
        continue;
      }
      found.chosen = fitted({choice});
      found.steps = {{choice, found.chosen}};
    }
    fit_all_rows(ground, round);
    return found.chosen.name() + " before " + found.rivals.front().model.name();
  };
  EXPECT_EQ(named({1, 2, 0}), "cubic before quintic");
  EXPECT_EQ(named({0, 2, 1}), "cubic before both");
}

/// The spring shows in one part of fifty; the final parameters and gaps are of all rows.
TEST(DiscoveryOfALongRecord, NamesWhatShowsSeldomAndIsSilentWithoutIt) {
  const Model model = baseline("k*y + c*v", 1);
  const auto find = [&](double k3) {
    return discover(model, small_catalogue(*model.pool), {seldom_strong(k3, 3)}, {seldom_strong(k3, 4)});
  };
  EXPECT_EQ(find(0).verdict, Verdict::nothing_missing);
  const Discovery d = find(0.1);
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "cubic_stiffness");
  const Parameter& k3 = d.effects[0].parameters.front();
  EXPECT_NEAR(k3.value, 0.1, 4 * k3.std);
  EXPECT_LT(k3.std, 0.01);
  EXPECT_EQ(d.comparisons.front().measured.size(), rows);
  EXPECT_LT(d.final_test.value, 1.2 * d.final_test.floor);
}

/// As many pieces as records: the final fit is still that of all rows, whose intervals are narrower.
TEST(DiscoveryOfALongRecord, FitsAllRowsOfManyRecordsThatGaveOnePieceEach) {
  truth::Physics physics;
  physics.k3 = 0.4;
  std::vector<Record> records, short_ones;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const truth::Motion motion =
        truth::integrate(physics, truth::multisine(0.2, 2.2, 30, seed), 0.03, {}, 4500, spacing, 8);
    records.push_back(testing::noisy_record(motion, "y", motion.x, 0.05, seed));
    records.back().warn("read with a note");
    short_ones.push_back(records.back().slice(0, 1500));
  }
  const Model model = baseline("k*y + c*v", 1);
  const auto find = [&](const std::vector<Record>& train) {
    return discover(model, small_catalogue(*model.pool), train, {records.front()});
  };
  const Discovery all = find(records), part = find(short_ones);
  ASSERT_EQ(all.effects.size(), 1u) << all.sentence;
  ASSERT_EQ(part.effects.size(), 1u) << part.sentence;
  EXPECT_LT(all.effects[0].parameters[0].std, 0.75 * part.effects[0].parameters[0].std);  // 1/sqrt(3) in the mean
  EXPECT_EQ(std::count(all.warnings.begin(), all.warnings.end(), "read with a note"), 8);
}

}  // namespace
}  // namespace lunid
