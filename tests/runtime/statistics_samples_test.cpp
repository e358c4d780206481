// Designs over the unit cube.
#include "statistics/samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "message.hpp"

namespace lunid {
namespace {

using Eigen::Index;

/// The points of one dimension, by intervals of 1/count: each must be met once.
bool one_in_each(const Eigen::VectorXd& x, Index count) {
  std::set<Index> met;
  for (const double value : x) met.insert(static_cast<Index>(value * static_cast<double>(count)));
  return static_cast<Index>(met.size()) == count && *met.rbegin() == count - 1;
}

TEST(Samples, LieWithinTheCubeAndRepeat) {
  for (const Sampling sampling : {Sampling::random, Sampling::latin_hypercube, Sampling::sobol}) {
    const Eigen::MatrixXd a = unit_samples(sampling, 1000, 5, 7);
    EXPECT_GT(a.minCoeff(), 0);
    EXPECT_LT(a.maxCoeff(), 1);
    EXPECT_EQ((a - unit_samples(sampling, 1000, 5, 7)).cwiseAbs().maxCoeff(), 0);
    EXPECT_GT((a - unit_samples(sampling, 1000, 5, 8)).cwiseAbs().maxCoeff(), 0);
    for (Index i = 0; i < 5; ++i)
      for (Index j = 0; j < i; ++j) {
        const auto x = a.row(i).array() - 0.5, y = a.row(j).array() - 0.5;
        EXPECT_LT(std::abs((x * y).mean()) * 12, 0.12);  // correlation: 4 standard deviations of chance
      }
  }
}

TEST(Samples, LatinHypercubeMeetsEachIntervalOnce) {
  const Eigen::MatrixXd a = unit_samples(Sampling::latin_hypercube, 37, 4, 3);
  for (Index i = 0; i < 4; ++i) EXPECT_TRUE(one_in_each(a.row(i), 37));
}

TEST(Samples, SobolMeetsEachIntervalOnceInEveryDimension) {
  const Eigen::MatrixXd a = unit_samples(Sampling::sobol, 4096, sobol_dimensions, 3);
  for (Index i = 0; i < sobol_dimensions; ++i)
    for (const Index count : {64, 4096}) EXPECT_TRUE(one_in_each(a.row(i).head(count), count)) << i;
}

// Dimensions 1 and 2 are a (0, m, 2)-net: each of the 2^m boxes of any shape 2^-i x 2^(i-m) holds one point. A digital
// shift keeps that.
TEST(Samples, SobolsFirstTwoDimensionsAreANet) {
  const int m = 10;
  const Eigen::MatrixXd a = unit_samples(Sampling::sobol, 1 << m, 2, 11);
  for (int i = 0; i <= m; ++i) {
    std::set<long> boxes;
    for (Index k = 0; k < a.cols(); ++k)
      boxes.insert((static_cast<long>(a(0, k) * (1 << i)) << (m - i)) + static_cast<long>(a(1, k) * (1 << (m - i))));
    EXPECT_EQ(boxes.size(), 1u << m) << i;
  }
}

// The integral of prod (1 + (x_i - 0.5) / i) over the cube is 1; at random its error would be about 1e-2.
TEST(Samples, SobolIntegratesBetterThanChance) {
  for (const int dimensions : {5, 12, 21}) {
    const Eigen::MatrixXd a = unit_samples(Sampling::sobol, 4096, dimensions, 5);
    double sum = 0;
    for (Index k = 0; k < a.cols(); ++k) {
      double product = 1;
      for (Index i = 0; i < dimensions; ++i) product *= 1 + (a(i, k) - 0.5) / static_cast<double>(i + 1);
      sum += product;
    }
    EXPECT_NEAR(sum / 4096, 1, 5e-4) << dimensions;
  }
}

TEST(Samples, RefusesWhatCannotBe) {
  EXPECT_EQ(message([] { unit_samples(Sampling::random, 0, 1, 1); }), "samples: expected >= 1, got 0");
  EXPECT_EQ(message([] { unit_samples(Sampling::sobol, 10, 22, 1); }),
            "method: sobol: expected at most 21 quantities, got 22; take latin_hypercube");
  EXPECT_EQ(message([] { sampling_from("sobl"); }),
            "method: expected random, latin_hypercube or sobol, got 'sobl', did you mean 'sobol'?");
}

}  // namespace
}  // namespace lunid
