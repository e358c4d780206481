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

/// A cubic spring and drag. A search has come to both by a general form of the spring, and never tried the two
/// together.
TEST(Grow, TriesASpecialCaseInThePlaceOfItsGeneralForm) {
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  std::vector<Effect> catalogue{entry(*model.pool, "cubic", "cubic_a*y^3", {row("cubic_a")}),
                                entry(*model.pool, "drag", "drag_c*abs(v)*v", {row("drag_c", 0)}),
                                entry(*model.pool, "odd_powers", "odd_powers_a*y^3 + odd_powers_b*y^5",
                                      {row("odd_powers_a"), row("odd_powers_b")})};
  catalogue[0].special_case_of = {"odd_powers"};
  truth::Physics physics;
  physics.k3 = 0.5;
  physics.drag = 0.2;
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 20, 5), 0.2, {}, 1500, testing::spacing, 16);
  DiscoverOptions options;
  const Study study = prepare(model, {testing::noisy_record(motion, "y", motion.x, 1e-3, 5)}, {}, options);
  Candidate baseline = compile(study, model, {});
  find_starts(study, baseline, {}, {});
  fit(study, baseline, full_fit(study, 20));
  Grown known;
  known.sets.push_back(compile(study, model, {{&catalogue[2], 0}, {&catalogue[1], 0}}));
  Candidate& both = known.sets.front();
  both.starts = {values_of(both, {&baseline})};
  both.fit = fit_near(study, both, both.starts.front(), 40, 0);

  const Grown found =
      grow(study, model, baseline, std::span(catalogue).first(1), known, [](const std::string&, double) {});
  const Choices expected{{&catalogue[0], 0}, {&catalogue[1], 0}};
  const auto there = std::ranges::find_if(found.sets, [&](const Candidate& c) { return same(c.choices, expected); });
  ASSERT_NE(there, found.sets.end());
  EXPECT_LT(there->fit.cost, 1.01 * both.fit.cost);
  EXPECT_GT(found.tried, 1);
}

}  // namespace
}  // namespace lunid
