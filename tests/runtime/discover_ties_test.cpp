// What is said beside a choice, and what the test record leaves of it.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "discover/refute.hpp"
#include "discover/search.hpp"
#include "discover/ties.hpp"
#include "discover_catalogue.hpp"

namespace lunid {
namespace {

constexpr int rows = 1500;

/// White noise, with 50 rows of something else.
Eigen::VectorXd residual(double elsewhere, int first = 300) {
  Philox random(7, 1);
  Eigen::VectorXd out(rows);
  for (int i = 0; i < rows; ++i) {
    out[i] = random.normal();
    if (i >= first && i < first + 50) out[i] += elsewhere * std::sin(0.8 * i);
  }
  return out;
}

struct Field {
  DiscoverOptions options;
  Study study;
  Model model = testing::baseline("k*y", 1);
  std::vector<Effect> effects;  ///< in one block, as a catalogue is: what comes first there is at the lower address
  Candidate baseline;

  Field() {
    study.options = &options;
    effects.reserve(8);  // candidates point at them
    Channel y = testing::channel("y", "m", std::vector<double>(rows, 0.0));
    y.noise = 1;
    study.full.emplace_back("r", 0, 1, std::vector<Channel>{y});
    study.train.push_back({study.full.front(), {}, {}});
    baseline = compile(study, complete(model), {});
    left_by(baseline, 2 * residual(0));
  }

  static void left_by(Candidate& c, const Eigen::VectorXd& e) {
    c.fit.residual = {e};
    c.fit.cost = e.squaredNorm();
    c.fit.rows = rows;
    const Eigen::Index parameters = c.parameters();
    c.fit.theta.setOnes(parameters);
    c.fit.covariance.setIdentity(parameters, parameters);
    c.innovations = e;
    c.likelihood_cost = e.squaredNorm();
  }

  Candidate with(const std::string& name, const std::string& family, const Eigen::VectorXd& e) {
    effects.push_back(testing::entry(*model.pool, name, name + "_p*y^" + std::to_string(effects.size() + 2),
                                     {testing::row(name + "_p")}));
    effects.back().family = family;
    Candidate c = compile(study, complete(model), {{&effects.back(), 0}});
    left_by(c, e);
    return c;
  }
};

TEST(Ties, AreRivalsAsGoodAndAsSimpleWithOtherRuns) {
  Field f;
  const Candidate chosen = f.with("chosen", "stiffness", residual(0)),
                  elsewhere = f.with("elsewhere", "stiffness", residual(0.3, 900)),
                  worse = f.with("worse", "stiffness", residual(8)),
                  none = f.with("none", "stiffness", 2 * residual(0, 900));
  const Ties ties = find_ties(f.study, f.baseline, chosen, {&chosen, &elsewhere, &worse, &none});
  ASSERT_EQ(ties.rivals.size(), 1u);
  EXPECT_EQ(name_of(ties.rivals[0]), "elsewhere");
  EXPECT_TRUE(ties.aliases.empty());
}

/// The same run is the same force in other words; of a channel's fault it is a tie, for one of the two is to be mended.
TEST(Ties, OfOneRunAreAliasesUnlessOneIsAFault) {
  Field f;
  const Candidate chosen = f.with("chosen", "stiffness", residual(0)),
                  words = f.with("words", "stiffness", residual(0)), fault = f.with("fault", "sensor", residual(0));
  const Ties ties = find_ties(f.study, f.baseline, chosen, {&words, &fault});
  EXPECT_EQ(ties.aliases, std::vector<std::string>{"words"});
  ASSERT_EQ(ties.rivals.size(), 1u);
  EXPECT_EQ(name_of(ties.rivals[0]), "fault");
}

/// Alone or beside the same companion the word that the catalogue has first is taken; not of two sets that differ in
/// more.
TEST(Ties, OfOneRunAreSaidInTheWordsThatTheCatalogueHasFirst) {
  Field f;
  const Candidate usual = f.with("usual", "stiffness", residual(0)), rare = f.with("rare", "stiffness", residual(0)),
                  beside = f.with("beside", "stiffness", residual(0)),
                  other = f.with("other", "stiffness", residual(0));
  const auto both = [&](const Candidate& a, const Candidate& b) {
    Candidate c = compile(f.study, complete(f.model), {a.choices.front(), b.choices.front()});
    Field::left_by(c, residual(0));
    return c;
  };
  EXPECT_EQ(in_the_usual_words(f.baseline, {rare, usual}, {0, 1}), 1u);
  EXPECT_EQ(in_the_usual_words(f.baseline, {both(rare, beside), both(beside, usual)}, {0, 1}), 1u);
  EXPECT_EQ(in_the_usual_words(f.baseline, {both(usual, beside), both(beside, rare)}, {0, 1}), 0u);
  EXPECT_EQ(in_the_usual_words(f.baseline, {both(rare, other), both(beside, usual)}, {0, 1}), 0u);
}

/// A spring that saturates, on one that pushes, runs as the sine of a pendulum does.
TEST(Ties, OfOneRunAreSaidInTheWordsThatLeaveTheBaselineItsSigns) {
  Field f;
  Candidate usual = f.with("usual", "stiffness", residual(0));
  const Candidate rare = f.with("rare", "stiffness", residual(0));
  usual.fit.theta[0] = -10;
  ASSERT_GT(f.baseline.fit.theta[0], 0);
  EXPECT_EQ(in_the_usual_words(f.baseline, {rare, usual}, {0, 1}), 0u);
  EXPECT_EQ(in_the_usual_words(f.baseline, {usual, rare}, {0, 1}), 1u);
}

/// Elastic slip and play: their fits may end in neighbouring minima.
TEST(Ties, OfOneLawInTwoNotationsAreSaidInTheUsualOneWhereTheirFitsEndedApart) {
  Field field;
  const Candidate usual = field.with("slip", "friction", residual(3)),
                  rare = field.with("play", "friction", residual(2));
  EXPECT_EQ(in_the_usual_words(field.baseline, {rare, usual}, {0, 1}), 0u);
  field.effects[0].special_case_of = {"play"};
  field.effects[1].special_case_of = {"slip"};
  EXPECT_EQ(in_the_usual_words(field.baseline, {rare, usual}, {0, 1}), 1u);
}

/// A larger set may reject the fault and the physics that does the same alike: the fault still comes first, and is
/// told.
TEST(Faults, ComeBeforePhysicsOfTheSameRun) {
  Field f;
  const std::vector<Candidate> field{f.with("physics", "stiffness", residual(0)),
                                     f.with("another", "sensor", residual(0.3, 900)),
                                     f.with("fault", "sensor", residual(0))};
  std::vector<std::size_t> alike{0};
  std::size_t pick = 0;
  prefer_the_same_fault(field, alike, pick);
  EXPECT_EQ(field[pick].name(), "fault");
  EXPECT_EQ(alike, (std::vector<std::size_t>{0, 2}));
}

/// A general form with one parameter more, whose error is this part of that of its special case.
bool general_form_taken(double part) {
  Field f;
  const Candidate special = f.with("special", "stiffness", residual(0));
  f.effects.push_back(testing::entry(*f.model.pool, "general", "general_p*y^2 + general_q*y^3",
                                     {testing::row("general_p"), testing::row("general_q")}));
  Candidate general = compile(f.study, complete(f.model), {{&f.effects.back(), 0}});
  Field::left_by(general, part * residual(0));
  general.fit.cost *= 0.5;                               // of a whitened residual: says nothing of the run
  EXPECT_FALSE(outgrows(f.study, general, special, 1));  // as long as neither is said to be a form of the other
  f.effects.front().special_case_of = {"general"};
  return outgrows(f.study, general, special, 1);
}

TEST(GeneralForms, AreTakenWhereTheyLeaveLess) {
  EXPECT_TRUE(general_form_taken(0.9));
  EXPECT_FALSE(general_form_taken(0.97));  // told apart by the likelihood ratio, but worth less than the least gain
  EXPECT_FALSE(general_form_taken(1));
}

/// At 20 dB the noise hides how much better a general form is: its part of what is above the noise tells.
TEST(GeneralForms, AreWorthItWhereTheyTakeMostOfWhatIsAboveTheNoise) {
  const auto is_taken = [](double special_leaves, double noise) {
    Field f;
    Eigen::VectorXd motion = Eigen::VectorXd::LinSpaced(rows, 0, 100).array().sin() * 10;
    Channel y = testing::channel("y", "m", {motion.begin(), motion.end()});
    y.noise = noise;
    f.study.full = {Record("r", 0, 1, {y})};
    f.study.train.front().record = f.study.full.front();
    const Candidate special = f.with("special", "stiffness", special_leaves * residual(0));
    f.effects.push_back(testing::entry(*f.model.pool, "general", "general_p*y^2 + general_q*y^3",
                                       {testing::row("general_p"), testing::row("general_q")}));
    Candidate general = compile(f.study, complete(f.model), {{&f.effects.back(), 0}});
    Field::left_by(general, residual(0));
    f.effects.front().special_case_of = {"general"};
    EXPECT_FALSE(outgrows(f.study, general, special, 1));
    return takes_most(f.study, general, special, 1);
  };
  EXPECT_TRUE(is_taken(1.03, 1));
  EXPECT_FALSE(is_taken(1.03, 0.5)) << "both leave something else";
  EXPECT_FALSE(is_taken(1.0005, 1)) << "by chance";
}

/// A motion with a cubic spring: models of several steps are run over it.
struct Tested {
  DiscoverOptions options;
  Study study;
  Model model = testing::baseline("k*y + c*v", 1);
  std::vector<Effect> catalogue = testing::small_catalogue(*model.pool);

  explicit Tested(double level = 0.2) {
    truth::Physics physics;
    physics.k3 = 0.5;
    const truth::Motion motion =
        truth::integrate(physics, truth::multisine(0.2, 2.2, 20, 5), level, {}, 1500, testing::spacing, 16);
    const Record record = testing::noisy_record(motion, "y", motion.x, 1e-3, 5);
    study = prepare(complete(model), {record}, {record}, options);
  }

  /// The steps cubic stiffness (k3 as given), and a quadratic one of this size beside.
  SearchResult steps(double k3, double k2) {
    SearchResult found;
    const Choice cubic{&catalogue[0], 0}, quadratic{&catalogue[1], 0};
    found.steps.push_back({cubic, compile(study, complete(model), {cubic})});
    found.steps.push_back({quadratic, compile(study, complete(model), {cubic, quadratic})});
    for (auto& [added, c] : found.steps) {
      c.fit.theta = Eigen::VectorXd::Zero(c.parameters());
      const auto& table = c.system->model().parameters;
      for (std::size_t j = 0; j < table.size(); ++j) {
        const std::string& name = table[j].name;
        c.fit.theta[static_cast<Eigen::Index>(j)] = name == "k"                    ? 1
                                                    : name == "c"                  ? 0.06
                                                    : name == "cubic_stiffness_k3" ? k3
                                                                                   : k2;
      }
    }
    return found;
  }

  std::size_t that_help(const SearchResult& found) {
    Round round;
    round.found = found;
    return steps_that_help(study, round, runs(study, found.steps.back().model, study.test));
  }
};

/// The true spring is 1 + 0.5 y^2: what a worse one makes of the training records is none of the test's.
TEST(Left, IsGoneWhereItDoesNotLowerTheGapOnTheTestRecord) {
  Tested t;
  const auto gone = [&](double k3_without, double k3_with) {
    const Candidate without = t.steps(k3_without, 0).steps.front().model,
                    with = t.steps(k3_with, 0).steps.front().model;
    Round round;
    round.found.chosen = without;
    round.left.closure.system = with.system;
    round.left.closure.fit = with.fit;
    return gone_on_test(t.study, round, runs(t.study, without, t.study.test));
  };
  EXPECT_FALSE(gone(0.4, 0.5));
  EXPECT_TRUE(gone(0.5, 0.4));
  EXPECT_FALSE(gone(0.5, -1e3));  // cannot be run: says nothing
  EXPECT_FALSE(gone_on_test(t.study, {}, {}));
}

/// The first of three names, with a spring that is a little too soft: it leaves 3 % of the test motion.
TEST(Steps, OfThreeThatFollowedAnotherForceStandWhereTheyLeaveHardlyAnything) {
  Tested t(0.05);
  const auto standing = [&](double k3, bool material) {
    Round round;
    round.found = t.steps(k3, 0);
    round.found.steps.push_back(round.found.steps.back());
    for (auto& [added, c] : round.found.steps)
      c.fit.covariance = Eigen::VectorXd::Constant(c.parameters(), 1e-8).asDiagonal();
    round.found.chosen = round.found.steps.back().model;
    round.found.baseline = compile(t.study, complete(t.model), {});
    round.found.baseline.fit.theta = Eigen::Vector2d(1, 0.06);
    round.left.material = material;
    const double gap = round.gap(runs(t.study, round.found.steps.front().model, t.study.test)).value;
    return std::pair(gap, steps_that_stand(t.study, round, runs(t.study, round.found.baseline, t.study.test)));
  };
  const auto [gap, stand] = standing(0.494, false);
  EXPECT_GT(gap, 0.02);
  EXPECT_LT(gap, 0.05);
  EXPECT_EQ(stand, 1u);
  EXPECT_EQ(standing(0.494, true).second, 0u);
  EXPECT_EQ(standing(0.5, true).second, 1u);
}

/// Forces of the wrong shape do not hold on the test record, which shows for itself that one is missing there.
TEST(Left, IsNotGoneWhereTheTestRecordShowsItsOwn) {
  Tested t;
  const Candidate with = t.steps(0, 0.3).steps.back().model;
  Round round;
  round.found.chosen = compile(t.study, complete(t.model), {});
  round.found.chosen.fit.theta = with.fit.theta.head(2);
  round.left.closure.system = with.system;
  round.left.closure.fit = with.fit;
  const std::vector<FreeRun> before = runs(t.study, round.found.chosen, t.study.test);
  ASSERT_FALSE(lowers_the_gap(t.study, before, runs(t.study, with, t.study.test)));
  EXPECT_FALSE(gone_on_test(t.study, round, before));
}

/// The fit of a whole set may move a parameter to where its effect is another one, after the sets there were left out.
TEST(Decide, TakesNoNameAtTheEndOfWhatItsEntryCanShow) {
  Tested t;
  const auto fitted = [&](const Choices& choices, double k3) {
    Candidate c = compile(t.study, complete(t.model), choices);
    Eigen::VectorXd start = t.steps(k3, 0).steps.front().model.fit.theta.head(c.parameters());
    c.fit = fit_trajectory(*c.system, start, t.study.train);
    judge(t.study, c, {});
    run_left_out(t.study, c);
    return c;
  };
  for (const bool at_the_end : {false, true}) {
    Round round;
    round.found.baseline = fitted({}, 0);
    round.found.chosen = fitted({{&t.catalogue[0], 0}}, 0.5);
    round.found.steps = {{round.found.chosen.choices.front(), round.found.chosen}};
    const double k3 = round.found.chosen.fit.theta[2];
    if (at_the_end) round.found.chosen.shown.push_back({2, {0, k3}});
    decide(t.study, round);
    EXPECT_EQ(round.verdict, at_the_end ? Verdict::unknown_effect : Verdict::explained);
    EXPECT_EQ(round.names(), !at_the_end);
  }
}

TEST(Steps, OfWhichTheLastRaisesTheGapOnTheTestRecordGo) {
  Tested t;
  EXPECT_EQ(t.that_help(t.steps(0.5, 0.05)), 1u);   // without the second the run is the truth's
  EXPECT_EQ(t.that_help(t.steps(0.45, 1e-4)), 1u);  // most of what is open stays so
  EXPECT_EQ(t.that_help(t.steps(0.5, 1e-7)), 2u);   // no worse: the training records have said what they say
}

}  // namespace
}  // namespace lunid
