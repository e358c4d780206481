// Time warping against the full table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "expr/error.hpp"
#include "statistics/statistics.hpp"
#include "statistics_noise.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::autoregressive;
using test::message_of;

/// The whole table; `band` < 0: none, else as warping.hpp says.
double full_table(const MatrixXd& a, const MatrixXd& b, Index band = -1) {
  const Index n = a.rows(), m = b.rows();
  MatrixXd cost = MatrixXd::Constant(n + 1, m + 1, std::numeric_limits<double>::infinity());
  cost(0, 0) = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < m; ++j) {
      const Index here = n > 1 ? i * (m - 1) / (n - 1) : m - 1, next = i + 1 < n ? (i + 1) * (m - 1) / (n - 1) : m;
      const bool outside =
          band >= 0 && ((i > 0 && j < here - band) || (i + 1 < n && j > std::max(here, next - 1) + band));
      if (outside) continue;
      cost(i + 1, j + 1) = (a.row(i) - b.row(j)).norm() + std::min({cost(i, j), cost(i, j + 1), cost(i + 1, j)});
    }
  return cost(n, m);
}

MatrixXd curve(int rows, std::uint64_t seed) {
  MatrixXd x(rows, 2);
  x << autoregressive(rows, {1.8, -0.95}, seed), autoregressive(rows, {0.9}, seed + 100);
  return x;
}

/// A phase portrait run through at an uneven pace, with noise.
MatrixXd portrait(int rows, double phase, double noise, std::uint64_t seed) {
  MatrixXd x(rows, 2);
  for (int i = 0; i < rows; ++i) {
    const double t = 12.0 * i / rows + 0.3 * std::sin(5.0 * i / rows) + phase;
    x.row(i) << std::sin(t), std::cos(t);
  }
  return x + noise * curve(rows, seed);
}

TEST(Dtw, OfAFewNumbersByHand) {
  // 0 1 2 against 0 2: 0-0, 1-0 or 1-2, 2-2: one step of length 1.
  const MatrixXd a = (MatrixXd(3, 1) << 0, 1, 2).finished(), b = (MatrixXd(2, 1) << 0, 2).finished();
  EXPECT_EQ(dtw(a, b), 1);
  EXPECT_EQ(dtw(b, a), 1);
  EXPECT_EQ(dtw(a, a), 0);
  EXPECT_EQ(dtw(a.topRows(1), a), 3);
}

TEST(Dtw, IsThatOfTheFullTable) {
  // What is left out of the table changes no bit; the table here adds the squares of a row in another order.
  for (std::uint64_t draw = 0; draw < 6; ++draw)
    for (const auto& [n, m] : {std::pair{150, 150}, {150, 131}, {40, 200}, {3, 50}, {1, 4}}) {
      const MatrixXd unlike_a = curve(n, draw), unlike_b = curve(m, draw + 10);
      EXPECT_NEAR(dtw(unlike_a, unlike_b) / full_table(unlike_a, unlike_b), 1, 1e-14);
      const MatrixXd like_a = portrait(n, 0, 0.02, draw), like_b = portrait(m, 0.2, 0.02, draw + 10);
      EXPECT_NEAR(dtw(like_a, like_b) / full_table(like_a, like_b), 1, 1e-14);
    }
}

TEST(Dtw, KeepsToItsBand) {
  for (const auto& [n, m] : {std::pair{120, 120}, {120, 70}, {70, 120}}) {
    const MatrixXd a = portrait(n, 0, 0.05, 1), b = portrait(m, 0.5, 0.05, 2);
    double last = std::numeric_limits<double>::infinity();
    for (Index band : {0, 1, 3, 10, 40, 200}) {
      const double found = dtw(a, b, band);
      EXPECT_NEAR(found / full_table(a, b, band), 1, 1e-14) << n << " " << m << " " << band;
      EXPECT_LE(found, last);
      last = found;
    }
    EXPECT_EQ(last, dtw(a, b));
  }
  // Without room to bend, equal lengths are compared row by row.
  const MatrixXd a = curve(50, 1), b = curve(50, 2);
  EXPECT_NEAR(dtw(a, b, 0), (a - b).rowwise().norm().sum(), 1e-12);
}

TEST(PhasePortrait, ForgivesAPhaseAndNotAShape) {
  const int rows = 400;
  const MatrixXd measured = portrait(rows, 0, 0, 1), late = portrait(rows, 0.1, 0, 1), flat = 0.5 * measured;
  const auto distance = [&](const MatrixXd& model, double units) {
    const Eigen::VectorXd y = units * measured.col(0), v = 50 * units * measured.col(1), my = units * model.col(0),
                          mv = 50 * units * model.col(1);
    return phase_portrait_distance(test::span_of(y), test::span_of(v), test::span_of(my), test::span_of(mv));
  };
  EXPECT_EQ(distance(measured, 1), 0);
  EXPECT_LT(distance(late, 1), 0.02);
  // Half the radius: 0.5 over the deviation of a sine, 1/sqrt(2), at every row.
  EXPECT_NEAR(distance(flat, 1), 0.5 * std::sqrt(2.0), 0.03);
  EXPECT_NEAR(distance(flat, 1e-3), distance(flat, 1), 1e-12);  // whatever the unit
}

TEST(Dtw, RefusesWhatItCannotTake) {
  EXPECT_EQ(message_of([] { dtw(MatrixXd::Zero(3, 2), MatrixXd::Zero(3, 1)); }),
            "dtw: expected as many columns in the one curve as in the other, got 2 and 1");
  EXPECT_EQ(message_of([] { dtw(MatrixXd::Constant(3, 1, NAN), MatrixXd::Zero(3, 1)); }),
            "dtw: column 1 is not a number at row 1 of 3: leave such rows out of the window");
  EXPECT_EQ(message_of([] { dtw(MatrixXd(0, 1), MatrixXd::Zero(3, 1)); }),
            "dtw: column 1: expected 1 row or more, got 0");
}

}  // namespace
}  // namespace lunid
