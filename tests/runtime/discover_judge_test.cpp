// When a set of effects is rejected against another.
#include <gtest/gtest.h>

#include <cmath>

#include "discover/judge.hpp"
#include "discover/verdict.hpp"
#include "discover_catalogue.hpp"

namespace lunid {
namespace {

constexpr int rows = 2000;
constexpr double noise = 0.01;

/// Residuals of white noise of one deviation; a burst of rows may hold more.
Eigen::VectorXd residual(double deviation, double burst) {
  Philox random(5, 1);
  Eigen::VectorXd out(rows);
  for (int i = 0; i < rows; ++i) {
    out[i] = deviation * random.normal();
    if (i >= 900 && i < 940) out[i] += burst * std::sin(0.7 * i);
  }
  return out;
}

struct Compared {
  Study study;
  Candidate best, other;

  Compared(double deviation, double burst) {
    const Model model = testing::baseline("k*y", 1);
    Channel y = testing::channel("y", "m", std::vector<double>(rows, 0.0));
    y.noise = noise;
    study.train.push_back({Record("r", 0, 1, {y}), {}, {}});
    fill(best, model, residual(deviation, 0));
    fill(other, model, residual(deviation, burst));
  }

  void fill(Candidate& c, const Model& model, const Eigen::VectorXd& e) const {
    c = compile(study, model, {});
    c.fit.residual = {e};
    c.innovations = e;
    c.likelihood_cost = e.squaredNorm();
  }
};

/// A passage of forty rows holds all that tells the two apart: one observation to Vuong's test, but beyond the noise.
TEST(Judge, RejectsWhatStaysAboveTheNoiseInOnePassage) {
  const Compared c(noise, 0.05);
  EXPECT_LT(vuong_z(c.best, c.other), vuong_level);
  EXPECT_TRUE(fits_worse(c.study, c.other, c.best));
  EXPECT_FALSE(fits_worse(c.study, c.best, c.other));
}

/// Where the better one is above the noise itself, such a passage may be a disturbance that it happens to follow.
TEST(Judge, KeepsBothWhereTheBetterOneIsAboveTheNoiseToo) {
  const Compared c(3 * noise, 0.15);
  EXPECT_FALSE(fits_worse(c.study, c.other, c.best));
}

TEST(Judge, KeepsBothWhereTheyDifferByLittle) {
  const Compared c(noise, 0.01);
  EXPECT_FALSE(fits_worse(c.study, c.other, c.best));
}

/// The verdict on names whose free run over the test leaves 0.21 of its motion where the baseline left 1.25.
std::string verdict_on(int names) {
  DiscoverOptions options;
  Study study;
  study.options = &options;
  const Model model = testing::baseline("k*y", 1);
  const std::vector<Effect> catalogue = testing::small_catalogue(*model.pool);
  Round round;
  for (int i = 0; i < names; ++i) round.found.chosen.choices.push_back({&catalogue[static_cast<std::size_t>(i)], 0});
  round.left.gap.value = 0.2;
  round.left.gap.floor = 0.01;
  FreeRun before, after;
  before.rows = after.rows = 1000;
  before.variance = after.variance = 1;
  before.floor_squares = after.floor_squares = 0.01 * 0.01;
  before.squares = 1.25 * 1.25;
  after.squares = 0.21 * 0.21;
  return refuted(study, round, 0.001, {before}, {after});
}

TEST(Verdict, AsksMoreOfSeveralNamesThanOfOne) {
  EXPECT_EQ(verdict_on(1), "");
  EXPECT_EQ(verdict_on(2), "left much of the gap on the test record open");
}

}  // namespace
}  // namespace lunid
