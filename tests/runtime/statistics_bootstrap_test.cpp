// Block bootstrap: its indices, and the levels and the power of the tests built on it.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "expr/error.hpp"
#include "statistics/statistics.hpp"
#include "statistics_noise.hpp"

namespace lunid {
namespace {

using test::alarms;
using test::autoregressive;
using test::span_of;

TEST(BlockBootstrap, ResamplesWholeBlocks) {
  const BlockBootstrap bootstrap(103, 10, 5);
  EXPECT_EQ(bootstrap.blocks(), 11);
  const auto indices = bootstrap.indices(3);
  ASSERT_EQ(indices.size(), 103u);
  const auto starts = bootstrap.starts(3);
  for (std::size_t i = 0; i < indices.size(); ++i)
    EXPECT_EQ(indices[i], (starts[i / 10] + static_cast<Eigen::Index>(i % 10)) % 103);
  EXPECT_EQ(bootstrap.indices(3), BlockBootstrap(103, 10, 5).indices(3));
  EXPECT_NE(bootstrap.indices(3), bootstrap.indices(4));
  EXPECT_NE(bootstrap.indices(3), BlockBootstrap(103, 10, 6).indices(3));
  EXPECT_THROW(BlockBootstrap(10, 11, 1), InputError);
  EXPECT_THROW(BlockBootstrap(10, 0, 1), InputError);
}

TEST(BlockBootstrap, UsesEveryRowEquallyOften) {
  const BlockBootstrap bootstrap(20, 4, 1);
  std::vector<double> counts(20);
  const int draws = 5000;
  for (int draw = 0; draw < draws; ++draw)
    for (Eigen::Index i : bootstrap.indices(static_cast<std::uint64_t>(draw))) ++counts[static_cast<std::size_t>(i)];
  // Each count has mean 5000 and a standard deviation of about sqrt(5000 * 4): 140.
  for (double count : counts) EXPECT_NEAR(count, draws, 700);
}

TEST(BlockLength, GrowsWithTheCorrelation) {
  EXPECT_LE(choose_block_length(span_of(autoregressive(4000, {}, 1))), 5);
  const auto some = choose_block_length(span_of(autoregressive(4000, {0.7}, 1)));
  const auto more = choose_block_length(span_of(autoregressive(4000, {0.95}, 1)));
  // For an autoregression of order 1: (2 G^2 / D n)^(1/3) with G = 2 rho s / (1 - rho)^2, D = 4/3 s^2 and
  // s = (1 + rho)/(1 - rho) in units of the variance: 45 for rho = 0.7, 175 for 0.95 at 4000 rows.
  EXPECT_GT(some, 20);
  EXPECT_LT(some, 90);
  EXPECT_GT(more, 80);
  EXPECT_LE(more, 200);  // a twentieth of the rows
  EXPECT_EQ(choose_block_length(std::vector<double>(10, 1.0)), 1);
}

/// Errors of two runs of the same size: common part and two parts of their own.
std::pair<Eigen::VectorXd, Eigen::VectorXd> two_errors(int rows, double first, double second, std::uint64_t draw) {
  const Eigen::VectorXd common = autoregressive(rows, {0.7}, draw);
  return {common + first * autoregressive(rows, {0.7}, draw + 5000),
          common + second * autoregressive(rows, {0.7}, draw + 9000)};
}

TEST(LowerError, HoldsItsLevelUnderColouredErrors) {
  for (int rows : {600, 2000}) {
    const double share = alarms(400, [&](std::uint64_t draw) {
      const auto [before, after] = two_errors(rows, 0.7, 0.7, draw);
      return p_value_of_lower_error(span_of(before), span_of(after), 10, draw);
    });
    EXPECT_GE(share, 0.02) << rows;
    EXPECT_LE(share, 0.09) << rows;
  }
}

TEST(LowerError, SeesADropAndNoRise) {
  const auto [before, after] = two_errors(2000, 1.5, 0.3, 1);
  EXPECT_LT(p_value_of_lower_error(span_of(before), span_of(after), 10, 1), 1e-3);
  EXPECT_GT(p_value_of_lower_error(span_of(after), span_of(before), 10, 1), 0.99);
  EXPECT_EQ(p_value_of_lower_error(span_of(before), span_of(before), 10, 1), 1);
}

/// An error of the same size all along but for the lead-in: resamples without that have no deviation to speak of.
TEST(LowerError, SeesASteadyDropWithOnePassageUnlikeTheRest) {
  Eigen::VectorXd after = 0.01 * autoregressive(2000, {0.0}, 3);
  Eigen::VectorXd before = after.array() + 1;
  before.head(80) = after.head(80);
  EXPECT_LT(p_value_of_lower_error(span_of(before), span_of(after), 100, 1), 1e-3);
}

TEST(LowerError, OfARunThatExploded) {
  const auto [before, after] = two_errors(200, 1, 1, 1);
  Eigen::VectorXd exploded = before;
  exploded[199] = NAN;
  EXPECT_EQ(p_value_of_lower_error(span_of(before), span_of(exploded), 10, 1), 1);
  EXPECT_EQ(p_value_of_lower_error(span_of(exploded), span_of(after), 10, 1), 1e-4);
  EXPECT_THROW(p_value_of_lower_error(span_of(before), span_of(after).first(10), 10, 1), InputError);
}

}  // namespace
}  // namespace lunid
