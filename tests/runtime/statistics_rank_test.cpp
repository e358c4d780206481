// Rank correlations and principal components: tables, all pairs, the singular values of the whole matrix.
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <random>

#include "expr/error.hpp"
#include "statistics/statistics.hpp"
#include "statistics_noise.hpp"

namespace lunid {
namespace {

using test::alarms;
using test::autoregressive;
using test::message_of;
using test::span_of;

TEST(Ranks, ShareTheirMeanWhereValuesAreEqual) {
  const Eigen::VectorXd want = (Eigen::VectorXd(6) << 1, 3, 5.5, 3, 5.5, 3).finished();
  EXPECT_EQ(ranks(std::vector<double>{-1, 2, 7, 2, 7, 2}), want);
}

TEST(Spearman, FollowsItsFormulaWithoutTies) {
  // 1 - 6 sum d^2 / (n (n^2 - 1)), the thesis' form.
  const Eigen::VectorXd a = autoregressive(50, {}, 1), b = a + autoregressive(50, {}, 2);
  const double squares = (ranks(span_of(a)) - ranks(span_of(b))).squaredNorm();
  EXPECT_NEAR(spearman(span_of(a), span_of(b)).coefficient, 1 - 6 * squares / (50 * (2500 - 1.0)), 1e-14);
}

TEST(Spearman, WithTiesIsTheCorrelationOfMeanRanks) {
  // Ranks 1 2.5 2.5 4 5 and 1 3 2 4.5 4.5: sum of products about the mean 9, of squares 9.5 and 9.5.
  const Correlation found = spearman(std::vector<double>{1, 2, 2, 3, 4}, std::vector<double>{0, 2, 1, 5, 5});
  EXPECT_NEAR(found.coefficient, 9 / 9.5, 1e-14);
  EXPECT_NEAR(found.p_value, 2 * t_tail(found.coefficient * std::sqrt(3 / (1 - std::pow(found.coefficient, 2))), 3),
              1e-14);
  EXPECT_EQ(spearman(std::vector<double>{1, 2, 3}, std::vector<double>{3, 2, 1}).coefficient, -1);
}

/// tau-b by all pairs.
double all_pairs(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  double score = 0, in_a = 0, in_b = 0;
  const auto sign = [](double x) { return (x > 0) - (x < 0); };
  for (int i = 0; i < a.size(); ++i)
    for (int j = 0; j < i; ++j) {
      const int s = sign(a[i] - a[j]), t = sign(b[i] - b[j]);
      score += s * t;
      in_a += s * s;
      in_b += t * t;
    }
  return score / std::sqrt(in_a * in_b);
}

TEST(Kendall, IsThatOfAllPairs) {
  for (std::uint64_t draw = 0; draw < 20; ++draw) {
    Eigen::VectorXd a = autoregressive(97, {0.5}, draw), b = 0.5 * a + autoregressive(97, {}, draw + 50);
    if (draw % 2 == 1) a = (2 * a).array().round();  // ties in one, in both
    if (draw % 4 == 3) b = b.array().round();
    EXPECT_NEAR(kendall(span_of(a), span_of(b)).coefficient, all_pairs(a, b), 1e-14) << draw;
  }
  EXPECT_EQ(kendall(std::vector<double>{1, 2, 3, 4}, std::vector<double>{8, 6, 4, 2}).coefficient, -1);
}

TEST(Kendall, VarianceWithoutTiesIsThatOfTheTextbook) {
  // 2 (2n + 5) / (9 n (n - 1)): tau 1/3 of 4 rows, one exchange of neighbours in two places: S = 2.
  const Correlation found = kendall(std::vector<double>{1, 2, 3, 4}, std::vector<double>{2, 1, 4, 3});
  EXPECT_NEAR(found.coefficient, 1 / 3.0, 1e-15);
  EXPECT_NEAR(found.p_value, 2 * normal_tail(1 / 3.0 / std::sqrt(2 * 13 / (9 * 4 * 3.0))), 1e-14);
}

TEST(RankCorrelations, HoldTheirLevelOnIndependentRowsWithTies) {
  // 400 draws of a 5 % test: three deviations are 3.3 %.
  for (auto measure : {spearman, kendall}) {
    const double share = alarms(400, [&](std::uint64_t draw) {
      const Eigen::VectorXd a = (2 * autoregressive(60, {}, draw)).array().round(),
                            b = autoregressive(60, {}, draw + 999);
      return measure(span_of(a), span_of(b)).p_value;
    });
    EXPECT_GE(share, 0.02);
    EXPECT_LE(share, 0.09);
  }
}

TEST(RankCorrelations, RefuseWhatTheyCannotTake) {
  EXPECT_EQ(message_of([] {
              kendall(std::vector<double>{1, 2}, std::vector<double>{1, 2});
            }),
            "kendall: column 1: expected 3 rows or more, got 2");
  EXPECT_EQ(message_of([] {
              spearman(std::vector<double>{1, 2, INFINITY}, std::vector<double>{1, 2, 3});
            }),
            "spearman: column 1 is infinite at row 3 of 3: leave such rows out of the window");
}

TEST(PrincipalComponents, AreTheSingularVectorsOfTheWholeMatrix) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd columns = Eigen::MatrixXd::NullaryExpr(200, 5, [&] { return normal(random); });
  columns.col(4) = columns.col(0) - 2 * columns.col(1) + 1e-5 * columns.col(4);  // nearly of rank 4
  columns.col(2) *= 1e3;
  for (bool standardise : {false, true}) {
    Eigen::MatrixXd x = columns.rowwise() - columns.colwise().mean();
    if (standardise)
      for (int c = 0; c < 5; ++c) x.col(c) /= x.col(c).norm() / std::sqrt(199.0);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(x, Eigen::ComputeThinV);
    const PrincipalComponents found = principal_components(columns, standardise);
    for (int c = 0; c < 5; ++c) {
      EXPECT_NEAR(std::sqrt(found.variances[c] * 199) / svd.singularValues()[c], 1, 1e-8);
      EXPECT_NEAR(std::abs(found.directions.col(c).dot(svd.matrixV().col(c))), 1, 1e-12);
      EXPECT_NEAR(found.scores.col(c).squaredNorm() / 199 / found.variances[c], 1, 1e-8);
      EXPECT_GT(found.directions.col(c).cwiseAbs().maxCoeff(), 0);
    }
    EXPECT_NEAR(found.shares.sum(), 1, 1e-14);
    EXPECT_LT(found.shares[4], 1e-9);
  }
  EXPECT_EQ(message_of([] { principal_components(Eigen::MatrixXd::Random(2, 3)); }),
            "principal_components: column 1: expected 3 rows or more, got 2");
}

}  // namespace
}  // namespace lunid
