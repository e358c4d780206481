// Which sets are fitted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "discover/baseline.hpp"
#include "discover/grow.hpp"
#include "discover/offers.hpp"
#include "discover/proposal_fits.hpp"
#include "discover_catalogue.hpp"
#include "truth/law.hpp"

namespace lunid {
namespace {

using testing::entry;
using testing::row;

Candidate fitted_baseline(const Study& study, const Model& model) {
  Candidate baseline = compile(study, model, {});
  find_starts(study, baseline, {}, {});
  fit(study, baseline, full_fit(study, 20));
  return baseline;
}

/// A cubic spring and drag beside k*y + c*v, and the baseline fitted to it.
struct SpringAndDrag {
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  DiscoverOptions options;
  Study study;
  Candidate baseline;

  explicit SpringAndDrag(const truth::Signal& force = truth::multisine(0.2, 2.2, 20, 5)) {
    truth::Physics physics;
    physics.k3 = 0.5;
    physics.drag = 0.2;
    const truth::Motion motion = truth::integrate(physics, force, 0.2, {}, 1500, testing::spacing, 16);
    study = prepare(model, {testing::noisy_record(motion, "y", motion.x, 1e-3, 5)}, {}, options);
    baseline = fitted_baseline(study, model);
  }
};

void silent(const std::string&, double) {}

/// A friction contact that lifts off, whose normal load grows with y as its own spring does: but for where it begins it
/// is a stop. Its fit has not converged; where it does, far above the noise, short runs lead nowhere.
TEST(Grow, ShortRunsBeginWhereAFitHadNotConvergedToo) {
  constexpr double k = 0.31, load = 0.1, noise = 0.01;
  truth::Physics physics;
  physics.zeta = 0.006;
  physics.law = std::make_shared<const truth::Law>(
      truth::laws::slip(k, [](double x, double, double) { return std::max(load + k * x, 0.0); }));
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 60, 7), 0.2, {}, 1500, testing::spacing, 64);
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  Pool& pool = *model.pool;
  std::vector<Effect> catalogue{
      entry(pool, "stop", "stop_k*max(y - stop_g, 0)", {row("stop_k", 0), row("stop_g")}),
      testing::entry_with_state(pool, "lift", "z", "lift_k*v", {row("lift_k", 0), row("lift_N", 0), row("lift_s")},
                                "max(lift_N + lift_s*y, 0)")};
  catalogue[0].guess = [](const RecordScales& s, int) {
    std::vector<Guess> guesses;
    for (int i = 1; i < 8; ++i) guesses.push_back({{"stop_g", s.y_min + i * (s.y_max - s.y_min) / 8}});
    return guesses;
  };
  catalogue[1].guess = [](const RecordScales& s, int) {
    std::vector<Guess> guesses;
    const double N = 0.4 * s.force_std, range = s.y_max - s.y_min;
    for (const double part : {0.03, 0.2})
      for (const double slope : {-0.5, 0.0, 0.5, 1.5})
        guesses.push_back({{"lift_N", N}, {"lift_k", N / (part * range)}, {"lift_s", slope * N / range}});
    return guesses;
  };
  DiscoverOptions options;
  const Study study = prepare(model, {testing::noisy_record(motion, "v", motion.v, noise, 5)}, {}, options);
  const Candidate baseline = fitted_baseline(study, model);
  const Grown found = grow(study, model, baseline, catalogue, {}, false, silent);
  ASSERT_FALSE(found.sets.empty());
  EXPECT_EQ(found.sets.front().name(), "lift");
  EXPECT_LT(rms(found.sets.front()), 1.1 * noise);
}

/// One entry with three parameters comes down to the noise: two with one each may be the simpler words, but nothing
/// beside it, nor three of the others, can be.
TEST(Grow, SeeksFewerParametersThanThoseOfAnEffectThatLeavesTheNoise) {
  const SpringAndDrag given;
  Pool& pool = *given.model.pool;
  const std::vector<Effect> catalogue{
      entry(pool, "cubic", "cubic_a*y^3", {row("cubic_a")}), entry(pool, "drag", "drag_c*abs(v)*v", {row("drag_c", 0)}),
      entry(pool, "even", "even_a*y^2", {row("even_a")}),
      entry(pool, "all", "all_a*y^3 + all_b*y^5 + all_c*abs(v)*v", {row("all_a"), row("all_b"), row("all_c", 0)})};
  const Grown found = grow(given.study, given.model, given.baseline, catalogue, {}, false, silent);
  EXPECT_TRUE(find_in(found.sets, {{&catalogue[0], 0}, {&catalogue[1], 0}}));
  EXPECT_TRUE(find_in(found.sets, {{&catalogue[3], 0}}));
  for (const Candidate& c : found.sets) EXPECT_TRUE(c.added() < 3 || c.choices.size() == 1) << c.name();
}

/// Three springs at one place are no name, nor is what holds them: nothing is added to them.
TEST(Grow, AddsNothingToASeries) {
  truth::Physics physics;
  physics.other = [](double x, double) { return 0.5 * (std::exp(x) - 1 - x); };
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 20, 5), 0.3, {}, 1500, testing::spacing, 16);
  const DiscoverOptions options;
  const Study study = prepare(model, {testing::noisy_record(motion, "y", motion.x, 1e-6, 5)}, {}, options);
  Pool& pool = *model.pool;
  std::vector<Effect> catalogue{
      entry(pool, "second", "second_a*y^2", {row("second_a")}), entry(pool, "third", "third_a*y^3", {row("third_a")}),
      entry(pool, "fourth", "fourth_a*y^4", {row("fourth_a")}), entry(pool, "fifth", "fifth_a*y^5", {row("fifth_a")})};
  const auto largest = [&](const char* family) {
    for (Effect& effect : catalogue) effect.family = family;
    const Grown found = grow(study, model, fitted_baseline(study, model), catalogue, {}, false, silent);
    return std::ranges::max(found.sets, {}, [](const Candidate& c) { return c.choices.size(); }).choices.size();
  };
  EXPECT_EQ(largest("test"), 4u);
  EXPECT_EQ(largest("stiffness"), 3u);
}

/// A search that is made again fits nothing twice, what ended at a limit included: a softening spring that hardens.
TEST(Grow, TakesUpWhatIsKnown) {
  SpringAndDrag given;
  given.study.most_effects = 1;
  Pool& pool = *given.model.pool;
  const std::vector<Effect> catalogue{entry(pool, "cubic", "cubic_a*y^3", {row("cubic_a")}),
                                      entry(pool, "drag", "drag_c*abs(v)*v", {row("drag_c", 0)}),
                                      entry(pool, "soft", "-soft_a*y^3", {row("soft_a", 0)})};
  const auto grown = [&](const Grown& known) {
    return grow(given.study, given.model, given.baseline, catalogue, known, false, silent);
  };
  const Grown found = grown({});
  EXPECT_TRUE(find_in(found.at_limits, {{&catalogue[2], 0}}));
  EXPECT_FALSE(find_in(found.sets, {{&catalogue[2], 0}}));
  const Grown again = grown(found);
  EXPECT_EQ(again.tried, found.tried);
  EXPECT_EQ(again.sets.size(), found.sets.size());
  EXPECT_EQ(again.sets.front().fit.cost, found.sets.front().fit.cost);
}

/// A sensor that is thought to be ten times as good as it is: what two effects leave goes for more, until it is known
/// that generic forces see nothing there.
TEST(Grow, SeeksNoMoreBesideWhatIsSettled) {
  SpringAndDrag given;
  for (FitData& data : given.study.train) {
    Channel channel = data.record.channel("y");
    const auto rows = data.record["y"];  // those of the window
    channel.values = Eigen::Map<const Eigen::VectorXd>(rows.data(), static_cast<Eigen::Index>(rows.size()));
    channel.noise *= 0.1;
    data.record = data.record.with(channel);
  }
  Pool& pool = *given.model.pool;
  const std::vector<Effect> catalogue{
      entry(pool, "cubic", "cubic_a*y^3", {row("cubic_a")}), entry(pool, "drag", "drag_c*abs(v)*v", {row("drag_c", 0)}),
      entry(pool, "even", "even_a*y^2", {row("even_a")}), entry(pool, "fifth", "fifth_a*y^5", {row("fifth_a")})};
  const auto most_effects = [](const Grown& grown) {
    std::size_t most = 0;
    for (const Candidate& c : grown.sets) most = std::max(most, c.choices.size());
    return most;
  };
  const auto grown = [&](std::size_t entries, const Grown& known) {
    return grow(given.study, given.model, given.baseline, std::span(catalogue).first(entries), known, false, silent);
  };
  Grown known = grown(2, {});
  EXPECT_EQ(most_effects(grown(4, known)), 3);
  known.settled = {{&catalogue[0], 0}, {&catalogue[1], 0}};
  EXPECT_EQ(most_effects(grown(4, known)), 2);

  Candidate both = *find_in(known.sets, known.settled), one = *find_in(known.sets, {{&catalogue[0], 0}});
  one.fit.cost = both.fit.cost;
  EXPECT_FALSE(known.is_settled(one));
  EXPECT_TRUE(known.is_settled(both));
  both.fit.cost *= 0.5;
  EXPECT_FALSE(known.is_settled(both));
}

/// A multisine looks band-limited. Put out by straight lines between its samples it is weaker where it is fast, which a
/// set that nearly follows the motion shows: growing ends there, before more names are put on that.
TEST(Grow, EndsWhereASetShowsHowTheForceIsToBeRead) {
  const truth::Signal smooth = truth::multisine(0.2, 2.2, 20, 5);
  const truth::Signal straight = [&](double tau) {
    const double row = std::floor(tau / testing::spacing), part = tau / testing::spacing - row;
    return (1 - part) * smooth(row * testing::spacing) + part * smooth((row + 1) * testing::spacing);
  };
  const auto grown = [](const SpringAndDrag& given, bool ask_reading) {
    EXPECT_EQ(given.study.between.kind, Interpolation::band_limited);
    Pool& pool = *given.model.pool;
    const std::vector<Effect> catalogue{entry(pool, "cubic", "cubic_a*y^3", {row("cubic_a")}),
                                        entry(pool, "drag", "drag_c*abs(v)*v", {row("drag_c", 0)})};
    return grow(given.study, given.model, given.baseline, catalogue, {}, ask_reading, silent);
  };
  const Grown ended = grown(SpringAndDrag(straight), true);
  ASSERT_TRUE(ended.reading.has_value());
  EXPECT_EQ(ended.reading->kind, Interpolation::linear);
  EXPECT_FALSE(grown(SpringAndDrag(straight), false).reading);
  EXPECT_FALSE(grown(SpringAndDrag(smooth), true).reading);
}

/// What a baseline leaves of a lightly damped motion has the colour of the resonance, in which little of a damping
/// shows: to first order it gains 3 % there, and where it is fitted nine tenths. Beside a common entry that follows the
/// motion nearly as well it has to be heard all the same.
TEST(Offers, HearsWhatTheColourOfTheResidualHides) {
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  DiscoverOptions options;
  truth::Physics physics;
  physics.zeta = 0.003;
  physics.law =
      std::make_shared<const truth::Law>(truth::laws::of_motion([](double, double v) { return 0.25 * v * v * v; }));
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 20, 5), 0.002, {}, 3000, testing::spacing, 16);
  Study study = prepare(model, {testing::noisy_record(motion, "y", motion.x, 2e-4, 5)}, {}, options);
  Candidate baseline = fitted_baseline(study, model);
  const std::vector<Effect> catalogue{
      entry(*model.pool, "cubic", "cubic_a*y^3", {row("cubic_a")}),
      entry(*model.pool, "cubic_damping", "cubic_damping_c3*v^3", {row("cubic_damping_c3", 0)})};
  const Grown known;
  Grown out;
  Offers offers(study, model, baseline, catalogue, known, out);
  offers.run_along_the_motion();
  const std::vector<Candidate> parents{baseline};
  const Offers::Round round = offers.beside(parents, SIZE_MAX);
  std::vector<std::string> heard;
  for (const std::size_t i : offers.best_on_motion(round.all, {}, parents.front(), false))
    heard.push_back(name_of(round.all[i].set()));
  EXPECT_EQ(heard, std::vector<std::string>{"cubic_damping"});
}

/// A spring that softens and then hardens: its two powers hide each other, and drag follows what is left of them.
TEST(Offers, SeekTheHalfOfAPairThatHidesItself) {
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  DiscoverOptions options;
  truth::Physics physics;
  physics.zeta = 0.03;
  const auto softens = [](double x, double) { return -0.35 * x * x * x + 0.05 * std::pow(x, 5); };
  physics.law = std::make_shared<const truth::Law>(truth::laws::of_motion(softens, [](double, double) { return 0.0; }));
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 20, 5), 0.4, {}, 1500, testing::spacing, 16);
  const Study study = prepare(model, {testing::noisy_record(motion, "y", motion.x, 1e-3, 5)}, {}, options);
  Candidate baseline = fitted_baseline(study, model);
  const std::vector<Effect> catalogue{entry(*model.pool, "drag", "drag_c*abs(v)*v", {row("drag_c", 0)}),
                                      entry(*model.pool, "third", "third_k*y^3", {row("third_k")}),
                                      entry(*model.pool, "fifth", "fifth_k*y^5", {row("fifth_k")})};
  const Grown known;
  Grown out;
  Offers offers(study, model, baseline, catalogue, known, out);
  offers.run_along_the_motion();
  const Proposer::Parent space = offers.space_of(baseline, baseline.best_theta());
  const auto half_beside = [&](std::size_t parent) {
    return offers.half_of_a_masked_pair(space, {compile(study, model, {{&catalogue[parent], 0}})});
  };
  const Shape* half = half_beside(0);
  ASSERT_NE(half, nullptr);
  EXPECT_NE(half->choice.effect->name, "drag");
  EXPECT_EQ(half_beside(1), nullptr) << "it leads to the pair by itself";
}

/// A search has come to both by a general form of the spring, and never tried the two together.
TEST(Grow, TriesASpecialCaseInThePlaceOfItsGeneralForm) {
  const SpringAndDrag given;
  const auto& [model, options, study, baseline] = given;
  std::vector<Effect> catalogue{entry(*model.pool, "cubic", "cubic_a*y^3", {row("cubic_a")}),
                                entry(*model.pool, "drag", "drag_c*abs(v)*v", {row("drag_c", 0)}),
                                entry(*model.pool, "odd_powers", "odd_powers_a*y^3 + odd_powers_b*y^5",
                                      {row("odd_powers_a"), row("odd_powers_b")})};
  catalogue[0].special_case_of = {"odd_powers"};
  Grown known;
  known.sets.push_back(compile(study, model, {{&catalogue[2], 0}, {&catalogue[1], 0}}));
  Candidate& both = known.sets.front();
  both.starts = {values_of(both, {&baseline})};
  both.fit = fit_near(study, both, both.starts.front(), 40, 0);

  const Grown found = grow(study, model, baseline, std::span(catalogue).first(1), known, false, silent);
  const Choices expected{{&catalogue[0], 0}, {&catalogue[1], 0}};
  const auto there = std::ranges::find_if(found.sets, [&](const Candidate& c) { return same(c.choices, expected); });
  ASSERT_NE(there, found.sets.end());
  EXPECT_LT(there->fit.cost, 1.01 * both.fit.cost);
  EXPECT_GT(found.tried, 1);
}

/// Of a decay a mass that takes all of the model's own leaves nothing open, k and c at zero, and what an entry of many
/// states leaves is never near that.
TEST(Offers, AMassThatTakesAllWithItIsNoneOfThem) {
  truth::Physics physics;
  physics.k3 = 0.5;
  const truth::Motion motion = truth::integrate(
      physics, [](double) { return 0.0; }, 0, {1, 0}, 800, testing::spacing, 16);
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  DiscoverOptions options;
  const Study study = prepare(model, {testing::noisy_record(motion, "y", motion.x, 1e-3, 5)}, {}, options);
  Candidate baseline = fitted_baseline(study, model);
  ASSERT_TRUE(baseline.ran());
  const std::vector<Effect> catalogue{entry(*model.pool, "cubic", "cubic_a*y^3", {row("cubic_a")}),
                                      entry(*model.pool, "mass", "mass_m*a", {row("mass_m")})};
  const Grown known;
  Grown out;
  Offers offers(study, model, baseline, catalogue, known, out);
  offers.run_along_the_motion();
  const std::vector<Candidate> parents{baseline};
  const Offers::Round round = offers.beside(parents, SIZE_MAX);
  ASSERT_EQ(round.worth_runs.size(), 1u);
  EXPECT_EQ(round.all[round.worth_runs.front()].standing.shape->choice.effect->name, "cubic");
  EXPECT_EQ(out.left_aside, std::vector<std::string>{"mass"});
}

/// What the force foretells of a motion is held against what a run leaves, in what was measured: of an accelerometer in
/// m/s^2, at 160 Hz a million times the displacement.
TEST(ProposalFits, PromiseWhatWasMeasured) {
  constexpr double tau = 1e-3;  // [s] to one unit of time
  truth::Physics physics;
  physics.k3 = 0.5;
  physics.drag = 0.2;
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 20, 5), 0.2, {}, 1500, testing::spacing, 16);
  std::vector<double> acceleration;
  for (std::size_t i = 0; i < motion.x.size(); ++i)
    acceleration.push_back((motion.force[i] - motion.restoring[i]) / (tau * tau));
  const Model model = complete(testing::baseline("k*y + c*v", tau * tau));
  const std::vector<Effect> catalogue{entry(*model.pool, "cubic", "cubic_a*y^3", {row("cubic_a")})};
  const auto promised_to_left = [&](const std::string& channel, const std::vector<double>& values, double noise) {
    Record record = testing::noisy_record(motion, channel, values, noise, 5);
    record = derive_motion(Record("fast", 0, tau * testing::spacing, {record.channel("F"), record.channel(channel)}));
    DiscoverOptions options;
    Study study = prepare(model, {record}, {}, options);
    const Candidate baseline = fitted_baseline(study, model);
    const Grown found = grow(study, model, baseline, catalogue, {}, false, silent);
    const Grown known;
    Grown out;
    const Offers offers(study, model, baseline, catalogue, known, out);
    const Candidate& cubic = found.sets.front();  // the drag is left
    return ProposalFits(study, baseline, offers.rows()).promised(cubic) / rms(cubic);
  };
  for (const double ratio :
       {promised_to_left("y", motion.x, 1e-3), promised_to_left("a", acceleration, 1e-3 / (tau * tau))}) {
    EXPECT_GT(ratio, 0.2);
    EXPECT_LT(ratio, 3);
  }
}

}  // namespace
}  // namespace lunid
