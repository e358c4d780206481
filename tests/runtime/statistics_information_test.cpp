// Mutual information against the closed forms of the normal distribution, and the tree against brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "expr/error.hpp"
#include "statistics/kd_tree.hpp"
#include "statistics/statistics.hpp"
#include "statistics_noise.hpp"

namespace lunid {
namespace {

using test::message_of;
using test::span_of;

Eigen::MatrixXd normal_matrix(int rows, int columns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

TEST(KdTree, FindsWhatAFullSearchFinds) {
  Eigen::MatrixXd points = normal_matrix(3, 500, 1);
  points.col(7) = points.col(8);  // one point twice
  const KdTree<3> tree(points);
  const KdTree<0> same(points);
  std::vector<double> nearest;
  for (int place = 0; place < tree.size(); ++place) {
    const int i = tree.point(place);
    std::vector<double> all;
    for (int j = 0; j < 500; ++j)
      if (j != i) all.push_back((points.col(i) - points.col(j)).cwiseAbs().maxCoeff());
    std::sort(all.begin(), all.end());
    for (int k : {1, 4}) {
      EXPECT_EQ(tree.kth_distance(place, k, nearest), all[static_cast<std::size_t>(k - 1)]);
      EXPECT_EQ(same.kth_distance(place, k, nearest), all[static_cast<std::size_t>(k - 1)]);
    }
    const auto closer = std::lower_bound(all.begin(), all.end(), 0.4) - all.begin();
    EXPECT_EQ(tree.count_within(points.col(i).data(), 0.4), closer + 1);
  }
}

TEST(MutualInformation, OfNormalColumnsIsItsClosedForm) {
  // -log(1 - rho^2)/2. The scatter of one estimate is about 1.2/sqrt(rows) (Kraskov et al. 2004, figure 4).
  for (int rows : {500, 4000})
    for (double rho : {0.0, 0.3, 0.6, 0.9, 0.99}) {
      const Eigen::MatrixXd z = normal_matrix(rows, 2, 11);
      const Eigen::VectorXd x = 3e-3 * z.col(0), y = 1e6 * (rho * z.col(0) + std::sqrt(1 - rho * rho) * z.col(1));
      for (int k : {3, 6})
        EXPECT_NEAR(mutual_information(span_of(x), span_of(y), {k}), -0.5 * std::log(1 - rho * rho),
                    3 * 1.2 / std::sqrt(rows))
            << rho << " " << rows;
    }
}

TEST(MutualInformation, HasNoBiasAtIndependence) {
  // Over 60 draws of 400 rows the mean is known to 1.2/sqrt(400 * 60) = 0.008.
  double sum = 0;
  for (std::uint64_t draw = 0; draw < 60; ++draw) {
    const Eigen::MatrixXd z = normal_matrix(400, 2, 100 + draw);
    sum += mutual_information(z, span_of(Eigen::VectorXd(z.col(1))))[0];
  }
  EXPECT_NEAR(sum / 60, 0, 0.02);
}

TEST(MutualInformation, SeesWhatACorrelationDoesNot) {
  const Eigen::VectorXd x = normal_matrix(1000, 1, 3);
  const Eigen::VectorXd y = x.cwiseAbs2();
  EXPECT_LT(std::abs(spearman(span_of(x), span_of(y)).coefficient), 0.1);
  EXPECT_GT(mutual_information(span_of(x), span_of(y)), 2);
}

TEST(MutualInformation, IsTheSameForAnyNumberOfThreadsAndTellsRepeatedRows) {
  Eigen::MatrixXd columns = normal_matrix(300, 7, 5);
  columns.col(3) = columns.col(3).array().round();  // many equal values
  const Eigen::VectorXd target = columns.col(0) + columns.col(3);
  const Eigen::VectorXd one = mutual_information(columns, span_of(target), {3, 1});
  EXPECT_EQ(one, mutual_information(columns, span_of(target), {3, 4}));
  EXPECT_TRUE(one.allFinite());
  const Eigen::MatrixXd given = columns.leftCols(2);
  EXPECT_EQ(conditional_mutual_information(columns.rightCols(5), span_of(target), given, {3, 1}),
            conditional_mutual_information(columns.rightCols(5), span_of(target), given, {3, 3}));
}

TEST(ConditionalInformation, OfNormalColumnsIsItsClosedForm) {
  // x, y driven by z: the partial correlation decides.
  for (const auto& [own, common] : {std::pair{0.0, 1.0}, {0.6, 0.8}, {0.9, 0.5}}) {
    const Eigen::MatrixXd n = normal_matrix(4000, 4, 21);
    const Eigen::VectorXd x = n.col(1) + common * n.col(0);
    const Eigen::VectorXd y = own * n.col(1) + std::sqrt(1 - own * own) * n.col(2) + common * n.col(0);
    const double told = conditional_mutual_information(x, span_of(y), n.col(0))[0];
    // Frenzel and Pompe's estimate is drawn to 0 by a few per cent of the information.
    EXPECT_NEAR(told, -0.5 * std::log(1 - own * own), 0.06) << own;
    // A column that says nothing changes little.
    Eigen::MatrixXd more(4000, 2);
    more << n.col(0), n.col(3);
    EXPECT_NEAR(conditional_mutual_information(x, span_of(y), more)[0], told, 0.08);
  }
  const Eigen::MatrixXd n = normal_matrix(100, 2, 3);
  EXPECT_EQ(conditional_mutual_information(n.col(0), span_of(Eigen::VectorXd(n.col(1))), Eigen::MatrixXd(100, 0)),
            mutual_information(n.col(0), span_of(Eigen::VectorXd(n.col(1)))));
}

TEST(SignificanceIndex, IsInformationTimesTheLargestForce) {
  EXPECT_DOUBLE_EQ(significance_index(0.5, -3, std::vector<double>{1, -4, 2}), 6);
}

TEST(MutualInformation, RefusesWhatItCannotTake) {
  const std::vector<double> x{1, 2, 3, 4, 5, 6}, flat(6, 2.5);
  EXPECT_EQ(message_of([&] { mutual_information(x, std::vector<double>(5, 1.0)); }),
            "mutual_information: columns 1 and 2 have 6 and 5 rows: cut them to one window");
  EXPECT_EQ(message_of([&] { mutual_information(x, flat); }),
            "mutual_information: column 2 is constant, 2.5: nothing can vary with it");
  EXPECT_EQ(message_of([&] {
              mutual_information(x, std::vector<double>{1, 2, NAN, 4, 5, 6});
            }),
            "mutual_information: column 2 is not a number at row 3 of 6: leave such rows out of the window");
  EXPECT_EQ(message_of([&] {
              mutual_information(std::vector<double>{1, 2, 3}, std::vector<double>{1, 2, 3});
            }),
            "mutual_information: column 1: expected 5 rows or more, got 3");
  EXPECT_EQ(message_of([&] { mutual_information(x, x, {6}); }),
            "mutual_information: neighbours: expected 1 to 5, got 6");
}

}  // namespace
}  // namespace lunid
