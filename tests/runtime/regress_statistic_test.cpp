// The statistic itself: what it stands for, merging, bad values; and the kernel under it.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "regress/statistic.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Repeatable, spread over a few decades, no two columns alike.
MatrixXd table(Index rows, Index columns) {
  MatrixXd x(rows, columns);
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j) x(i, j) = std::pow(10.0, j % 4) * (std::sin(1.3 * i * (j + 1) + j) + 0.2 * j);
  return x;
}

std::vector<std::string> names(Index n) {
  std::vector<std::string> out;
  for (Index j = 0; j < n; ++j) out.push_back("x" + std::to_string(j));
  return out;
}

template <class F>
std::string message(F f) {
  try {
    f();
  } catch (const InputError& e) {
    return e.message();
  }
  return "no error";
}

}  // namespace

TEST(RegressTriangle, factor_has_the_gram_matrix_of_the_rows) {
  // Row counts around the width of a panel, of the vectors and of a block; column counts around a panel.
  for (const Index rows : {1, 3, 4, 7, 64, 257, 1000})
    for (const Index columns : {1, 2, 4, 5, 6, 9, 23}) {
      const MatrixXd x = table(rows, columns);
      MatrixXd r = MatrixXd::Zero(columns, columns), block = x;
      triangularise(r, block);
      const VectorXd size = x.colwise().norm();
      const MatrixXd difference = r.transpose() * r - x.transpose() * x;
      for (Index i = 0; i < columns; ++i)
        for (Index j = 0; j < columns; ++j)  // backward stable by columns: 1e-16 * columns * a few, no worse
          EXPECT_LE(std::abs(difference(i, j)), 2e-14 * size[i] * size[j]) << rows << " x " << columns;
      EXPECT_TRUE(r.isUpperTriangular(0));
    }
}

TEST(RegressTriangle, extended_precision_agrees) {
  const MatrixXd x = table(40, 7);
  MatrixXd r = MatrixXd::Zero(7, 7), block = x;
  triangularise(r, block);
  LongMatrix exact = LongMatrix::Zero(7, 7);
  triangularise(exact, x.cast<long double>());
  const VectorXd size = x.colwise().norm();
  for (Index i = 0; i < 7; ++i)
    for (Index j = i; j < 7; ++j)
      EXPECT_NEAR(std::abs(r(i, j)), std::abs(static_cast<double>(exact(i, j))), 1e-14 * size[j]);
}

TEST(RegressStatistic, knows_mean_deviation_rms_and_residual) {
  const MatrixXd x = table(600, 3);
  const VectorXd z = table(600, 5).col(4);
  Statistic data(names(3));
  data.add(x.topRows(590), z.head(590));
  data.add(x.bottomRows(10), z.tail(10));
  EXPECT_EQ(data.rows(), 600);
  MatrixXd all(600, 4);
  all << x, z;
  const VectorXd mean = all.colwise().mean(), rms = (all.colwise().squaredNorm() / 600).cwiseSqrt();
  const VectorXd deviation = ((all.rowwise() - mean.transpose()).colwise().squaredNorm() / 600).cwiseSqrt();
  for (Index j = 0; j < 4; ++j) {
    EXPECT_NEAR(data.mean()[j], mean[j], 1e-13 * rms[j]);
    EXPECT_NEAR(data.rms()[j], rms[j], 1e-13 * rms[j]);
    EXPECT_NEAR(data.deviation()[j], deviation[j], 1e-13 * rms[j]);
  }
  const Eigen::Vector3d b(0.5, -0.2, 0.01);
  EXPECT_NEAR(data.residual_sum(b) / (z - x * b).squaredNorm(), 1, 1e-13);
  const Triangle t = data.triangle();
  EXPECT_NEAR(((t.r * b - t.z).squaredNorm() + t.rest) / (z - x * b).squaredNorm(), 1, 1e-13);
}

TEST(RegressStatistic, leading_features_are_a_statistic_of_their_own) {
  const MatrixXd x = table(50, 5);
  const VectorXd z = table(50, 6).col(5);
  Statistic five(names(5)), two(names(2));
  five.add(x, z);
  two.add(x.leftCols(2), z);
  EXPECT_TRUE(five.leading(2).triangle().r.cwiseAbs().isApprox(two.triangle().r.cwiseAbs(), 1e-14));
  EXPECT_EQ(five.leading(2).rows(), 50);
}

TEST(RegressStatistic, finds_a_constant_feature_beside_a_large_offset) {
  MatrixXd x(100, 3);
  for (Index i = 0; i < 100; ++i) x.row(i) << 1 + 1e-9 * std::sin(double(i)), 2.5, std::cos(double(i));
  Statistic data(names(3));
  data.add(x, x.col(2));
  EXPECT_EQ(data.constant_feature(), 1);
  EXPECT_NEAR(data.deviation()[0], 0.707e-9, 0.01e-9);  // an offset 1e9 times the motion leaves its size
}

TEST(RegressStatistic, names_the_bad_value_and_stays_as_it_was) {
  Statistic data({"y", "y^3"});
  MatrixXd x = table(10, 2);
  VectorXd z = x.col(0);
  data.add(x, z);
  const MatrixXd before = data.triangle().r;
  x(4, 1) = std::nan("");
  EXPECT_EQ(message([&] { data.add(x, z); }),
            "feature 'y^3' is not a number at row 15: leave such rows out, or mend the record");
  x = table(10, 2);
  z[2] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(message([&] { data.add(x, z); }),
            "the target is infinite at row 13: leave such rows out, or mend the record");
  EXPECT_EQ(data.rows(), 10);
  EXPECT_EQ(data.triangle().r, before);
}

TEST(RegressStatistic, refuses_equal_names_and_other_features) {
  EXPECT_EQ(message([] { Statistic({"y", "v", "y"}); }), "feature 'y' is given twice");
  Statistic a({"y"}), b({"v"});
  EXPECT_EQ(message([&] { a.merge(b); }), "statistic: merged with one of other features");
}
