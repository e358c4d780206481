// Which sets are fitted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "discover/baseline.hpp"
#include "discover/grow.hpp"
#include "discover/proposal_fits.hpp"
#include "discover_catalogue.hpp"

namespace lunid {
namespace {

using testing::entry;
using testing::row;

/// A cubic spring and drag beside k*y + c*v, and the baseline fitted to it.
struct SpringAndDrag {
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  DiscoverOptions options;
  Study study;
  Candidate baseline;

  SpringAndDrag() {
    truth::Physics physics;
    physics.k3 = 0.5;
    physics.drag = 0.2;
    const truth::Motion motion =
        truth::integrate(physics, truth::multisine(0.2, 2.2, 20, 5), 0.2, {}, 1500, testing::spacing, 16);
    study = prepare(model, {testing::noisy_record(motion, "y", motion.x, 1e-3, 5)}, {}, options);
    baseline = compile(study, model, {});
    find_starts(study, baseline, {}, {});
    fit(study, baseline, full_fit(study, 20));
  }
};

void silent(const std::string&, double) {}

/// One entry with three parameters comes down to the noise: two with one each may be the simpler words, but nothing
/// beside it, nor three of the others, can be.
TEST(Grow, SeeksFewerParametersThanThoseOfAnEffectThatLeavesTheNoise) {
  const SpringAndDrag given;
  Pool& pool = *given.model.pool;
  const std::vector<Effect> catalogue{
      entry(pool, "cubic", "cubic_a*y^3", {row("cubic_a")}), entry(pool, "drag", "drag_c*abs(v)*v", {row("drag_c", 0)}),
      entry(pool, "even", "even_a*y^2", {row("even_a")}),
      entry(pool, "all", "all_a*y^3 + all_b*y^5 + all_c*abs(v)*v", {row("all_a"), row("all_b"), row("all_c", 0)})};
  const Grown found = grow(given.study, given.model, given.baseline, catalogue, {}, silent);
  EXPECT_TRUE(find_in(found.sets, {{&catalogue[0], 0}, {&catalogue[1], 0}}));
  EXPECT_TRUE(find_in(found.sets, {{&catalogue[3], 0}}));
  for (const Candidate& c : found.sets) EXPECT_TRUE(c.added() < 3 || c.choices.size() == 1) << c.name();
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

  const Grown found = grow(study, model, baseline, std::span(catalogue).first(1), known, silent);
  const Choices expected{{&catalogue[0], 0}, {&catalogue[1], 0}};
  const auto there = std::ranges::find_if(found.sets, [&](const Candidate& c) { return same(c.choices, expected); });
  ASSERT_NE(there, found.sets.end());
  EXPECT_LT(there->fit.cost, 1.01 * both.fit.cost);
  EXPECT_GT(found.tried, 1);
}

}  // namespace
}  // namespace lunid
