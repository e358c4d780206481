// Random numbers: the published generator, the distributions made from it, and that they depend on their key alone.
#include "record/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "message.hpp"

namespace lunid {
namespace {

TEST(Philox, GivesTheKnownAnswers) {
  // Random123, tests/kat_vectors, philox4x32 with 10 rounds.
  EXPECT_EQ(Philox::block({0, 0, 0, 0}, {0, 0}), (Philox::Counter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(Philox::block({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Philox::Counter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(Philox::block({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Philox::Counter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Philox, StreamsAreTheirOwn) {
  Philox a(7, 1), b(7, 1), c(7, 2), d(8, 1);
  bool differ = false;
  for (int i = 0; i < 100; ++i) {
    const double x = a.normal();
    EXPECT_EQ(x, b.normal());
    differ = differ || (x != c.normal() && x != d.normal());
  }
  EXPECT_TRUE(differ);
}

TEST(Philox, AnyPlaceOfAStreamIsReachedDirectly) {
  Philox whole(3, 4), later(3, 4, 1000);
  for (int i = 0; i < 4000; ++i) whole.bits();
  for (int i = 0; i < 100; ++i) EXPECT_EQ(whole.bits(), later.bits());
}

TEST(Philox, HasTheMomentsOfItsDistributions) {
  Philox random(1, 0);
  const int n = 200000;
  double u1 = 0, u2 = 0, z1 = 0, z2 = 0, z4 = 0;
  std::vector<int> counts(7);
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform(), z = random.normal();
    ASSERT_GT(u, 0);
    ASSERT_LT(u, 1);
    u1 += u / n;
    u2 += u * u / n;
    z1 += z / n;
    z2 += z * z / n;
    z4 += z * z * z * z / n;
    ++counts[random.below(7)];
  }
  // Four standard deviations of each mean.
  EXPECT_NEAR(u1, 0.5, 4 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(u2, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / n));
  EXPECT_NEAR(z1, 0, 4 / std::sqrt(n));
  EXPECT_NEAR(z2, 1, 4 * std::sqrt(2.0 / n));
  EXPECT_NEAR(z4, 3, 4 * std::sqrt(96.0 / n));
  double chi = 0;
  for (int count : counts) chi += std::pow(count - n / 7.0, 2) / (n / 7.0);
  EXPECT_LT(chi, 27.9);  // chi-square of 6 degrees of freedom: 1e-4 lies beyond
}

TEST(Philox, PoissonHasItsMeanAndVariance) {
  for (const double mean : {0.3, 4.0, 9.9, 10.0, 37.5, 2e4, 1e9}) {
    Philox random(5, static_cast<std::uint64_t>(mean));
    const int n = 100000;
    double first = 0, second = 0;
    for (int i = 0; i < n; ++i) {
      const double d = random.poisson(mean) - mean;
      first += d / n;
      second += d * d / n;
    }
    EXPECT_NEAR(first, 0, 4 * std::sqrt(mean / n)) << mean;
    // the fourth central moment is 3 mean^2 + mean
    EXPECT_NEAR(second, mean, 4 * std::sqrt((2 * mean * mean + mean) / n)) << mean;
  }
  EXPECT_EQ(Philox(1, 1).poisson(0), 0);
}

TEST(Philox, PoissonHasItsProbabilities) {
  for (const double mean : {6.0, 13.0}) {  // either method
    Philox random(9, 2);
    const int n = 200000;
    std::map<int, int> counts;
    for (int i = 0; i < n; ++i) ++counts[static_cast<int>(random.poisson(mean))];
    double chi = 0;
    int cells = 0;
    for (int k = 0; k < 40; ++k) {
      const double expected = n * std::exp(k * std::log(mean) - mean - std::lgamma(k + 1.0));
      if (expected < 20) continue;
      chi += std::pow(counts[k] - expected, 2) / expected;
      ++cells;
    }
    ASSERT_GT(cells, 15);
    EXPECT_LT(chi, cells + 4 * std::sqrt(2.0 * cells)) << mean;
  }
}

TEST(Philox, PoissonRefusesAMeanThatIsNone) {
  EXPECT_EQ(message([] { Philox(1, 1).poisson(-1); }), "poisson: expected a mean of 0 to 1e15, got -1");
}

TEST(Philox, PermutationsAreEquallyLikely) {
  Philox random(2, 0);
  const int n = 60000;
  std::map<std::vector<std::size_t>, int> counts;
  for (int i = 0; i < n; ++i) ++counts[random.permutation(3)];
  ASSERT_EQ(counts.size(), 6u);
  double chi = 0;
  for (const auto& [order, count] : counts) chi += std::pow(count - n / 6.0, 2) / (n / 6.0);
  EXPECT_LT(chi, 25.7);  // 5 degrees of freedom: 1e-4 lies beyond
  EXPECT_TRUE(random.permutation(0).empty());
}

TEST(Philox, LabelsMakeStreams) {
  EXPECT_EQ(stream_of(""), 0xcbf29ce484222325u);  // FNV-1a test vectors (Noll)
  EXPECT_EQ(stream_of("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(stream_of("foobar"), 0x85944171f73967e8u);
}

}  // namespace
}  // namespace lunid
