// Ridge, STLSQ and lasso: known optima, first-order conditions, recovered truths, refusals.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "message.hpp"
#include "regress/fit.hpp"
#include "regress/quadratic.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Sample {
  std::vector<std::string> names;
  MatrixXd x;
  VectorXd z, truth;

  Statistic data() const {
    Statistic sum(names);
    sum.add(x, z);
    return sum;
  }
  std::vector<Statistic> blocks(Index count) const {
    std::vector<Statistic> out;
    for (Index k = 0; k < count; ++k) {
      const Index from = x.rows() * k / count, to = x.rows() * (k + 1) / count;
      out.emplace_back(names);
      out.back().add(x.middleRows(from, to - from), z.segment(from, to - from));
    }
    return out;
  }
};

/// Polynomials of a random motion in SI units of millimetres, so that columns differ by many decades, and a Duffing
/// force k y + c v + k3 y^3 with 3 % noise.
Sample duffing(Index rows, unsigned seed, bool constant) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Sample s;
  for (int i = 0; i <= 5; ++i)
    for (int j = 0; i + j <= 5; ++j)
      if (constant || i + j > 0) s.names.push_back("y^" + std::to_string(i) + "*v^" + std::to_string(j));
  const Index n = static_cast<Index>(s.names.size());
  s.x.resize(rows, n);
  s.z.resize(rows);
  s.truth = VectorXd::Zero(n);
  for (Index row = 0; row < rows; ++row) {
    const double y = 2e-3 * normal(random), v = 0.4 * normal(random);
    Index column = 0;
    for (int i = 0; i <= 5; ++i)
      for (int j = 0; i + j <= 5; ++j)
        if (constant || i + j > 0) s.x(row, column++) = std::pow(y, i) * std::pow(v, j);
    s.z[row] = 2e4 * y + 10 * v + 1e9 * y * y * y;
  }
  for (Index j = 0; j < n; ++j) {
    const std::string& name = s.names[static_cast<std::size_t>(j)];
    if (name == "y^1*v^0") s.truth[j] = 2e4;
    if (name == "y^0*v^1") s.truth[j] = 10;
    if (name == "y^3*v^0") s.truth[j] = 1e9;
  }
  const double level = 0.03 * std::sqrt(s.z.squaredNorm() / static_cast<double>(rows));
  for (Index row = 0; row < rows; ++row) s.z[row] += level * normal(random);
  return s;
}

/// Largest violation of the lasso's first-order conditions at b, relative to lambda, from the rows themselves.
double lasso_violation(const Sample& s, const VectorXd& b, double lambda, bool constant) {
  const double rows = static_cast<double>(s.x.rows());
  const auto size_of = [&](const VectorXd& column) {
    const double mean = constant ? column.mean() : 0;
    return std::sqrt((column.array() - mean).matrix().squaredNorm() / rows);
  };
  const VectorXd residual = s.z - s.x * b;
  const double target = size_of(s.z);
  double worst = 0;
  for (Index j = 0; j < b.size(); ++j) {
    const bool intercept = constant && j == 0;
    const double size = intercept ? 1 : size_of(s.x.col(j));
    const double slope = s.x.col(j).dot(residual) / (rows * size * target);
    if (intercept)
      worst = std::max(worst, std::abs(slope) / lambda);
    else if (b[j] == 0)
      worst = std::max(worst, std::abs(slope) / lambda - 1);
    else
      worst = std::max(worst, std::abs(slope / lambda - (b[j] > 0 ? 1 : -1)));
  }
  return worst;
}

}  // namespace

TEST(RegressLeastSquares, coverage_of_the_standard_errors) {
  // 200 samples: 95 % intervals cover each true coefficient between 90 and 99 % of the time (4 binomial deviations).
  int covered = 0, count = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Sample s = duffing(300, seed, false);
    const Fit fit = least_squares(s.data());
    for (Index j = 0; j < s.truth.size(); ++j, ++count)
      covered += std::abs(fit.coefficients[j] - s.truth[j]) < 1.96 * fit.std[j];
  }
  EXPECT_GT(covered, 0.93 * count);
  EXPECT_LT(covered, 0.97 * count);
}

TEST(RegressLeastSquares, names_features_that_the_data_do_not_excite) {
  MatrixXd x(50, 4);
  for (Index i = 0; i < 50; ++i) {
    const double y = std::sin(0.37 * static_cast<double>(i));
    x.row(i) << y, std::cos(0.37 * static_cast<double>(i)), -4.0 * y, y * y;
  }
  Statistic data({"y", "v", "a", "y^2"});
  data.add(x, 3 * x.col(0) + x.col(3));
  const Fit fit = least_squares(data);
  ASSERT_EQ(fit.unexcited.size(), 1u);
  EXPECT_EQ(fit.unexcited[0].feature, 2);
  EXPECT_EQ(fit.unexcited[0].text, "on these data a = -4*y");
  EXPECT_EQ(fit.coefficients[2], 0);
  EXPECT_TRUE(std::isnan(fit.std[2]));
  EXPECT_NEAR(fit.coefficients[0], 3, 1e-13);
  // Fixing one of the two makes the other known.
  const Fit known = least_squares(data, std::vector{fixed(2, 1.0)});
  EXPECT_TRUE(known.unexcited.empty());
  EXPECT_NEAR(known.coefficients[0], 7, 1e-13);
}

TEST(RegressLeastSquares, texts_of_what_cannot_be) {
  Statistic few({"y", "v", "y^3"});
  few.add(MatrixXd::Random(2, 3), VectorXd::Random(2));
  EXPECT_EQ(message([&] { least_squares(few); }),
            "3 features need at least as many rows, got 2: take fewer features or more of the record");
  MatrixXd x = MatrixXd::Random(9, 3);
  x.col(1).setZero();
  Statistic zero({"y", "v", "y^3"});
  zero.add(x, VectorXd::Random(9));
  EXPECT_EQ(message([&] { least_squares(zero); }),
            "feature 'v' is zero on all rows: the data do not excite it, leave it out or fix its coefficient");
  EXPECT_EQ(least_squares(zero, std::vector{fixed(1, 2.0)}).coefficients[1], 2);
}

TEST(RegressRidge, solves_its_normal_equations) {
  for (const bool constant : {false, true}) {
    const Sample s = duffing(200, 4, constant);
    const double lambda = 0.03, rows = 200;
    VectorXd size = (s.x.colwise().squaredNorm() / rows).cwiseSqrt();
    if (constant) {
      const Eigen::RowVectorXd mean = s.x.colwise().mean();
      size = ((s.x.rowwise() - mean).colwise().squaredNorm() / rows).cwiseSqrt();
      size[0] = 0;
    }
    const Fit fit = ridge(s.data(), {lambda});
    const VectorXd slope = s.x.transpose() * (s.z - s.x * fit.coefficients);
    const VectorXd penalty = rows * lambda * size.cwiseAbs2().cwiseProduct(fit.coefficients);
    const VectorXd scale = s.x.colwise().norm() * s.z.norm();
    EXPECT_LE(((slope - penalty).array() / scale.array()).abs().maxCoeff(), 1e-13);
    EXPECT_LE(fit.summary.kkt, 1e-13);
  }
}

TEST(RegressRidge, tends_to_least_squares) {
  const Sample s = duffing(300, 2, false);
  const Fit small = ridge(s.data(), {1e-14}), plain = least_squares(s.data());
  for (Index j = 0; j < s.truth.size(); ++j) {
    EXPECT_NEAR(small.coefficients[j], plain.coefficients[j], 1e-6 * plain.std[j]);
    EXPECT_NEAR(small.std[j] / plain.std[j], 1, 1e-6);
  }
}

TEST(RegressStlsq, recovers_a_sparse_truth_in_every_seed) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Sample s = duffing(4000, seed, true);
    const Fit fit = stlsq(s.data(), {.threshold = 0.05});
    for (Index j = 0; j < s.truth.size(); ++j) {
      EXPECT_EQ(fit.coefficients[j] == 0, s.truth[j] == 0)
          << "seed " << seed << " " << s.names[static_cast<std::size_t>(j)];
      // 150 comparisons: none beyond 4.5 deviations (chance of one: 1e-3).
      if (s.truth[j] == 0) continue;
      EXPECT_LT(std::abs(fit.coefficients[j] - s.truth[j]), 4.5 * fit.std[j]);
    }
    EXPECT_TRUE(fit.summary.converged);
  }
}

TEST(RegressStlsq, keeps_what_a_constraint_keeps_from_zero) {
  const Sample s = duffing(1000, 3, false);
  const Fit fit = stlsq(s.data(), {.threshold = 0.05}, std::vector{at_least(1, 1e-6)});
  EXPECT_LT(fit.contribution[1], 0.05);
  EXPECT_GE(fit.coefficients[1], 1e-6 * (1 - 1e-12));
}

TEST(RegressLasso, meets_its_first_order_conditions_along_the_path) {
  for (const bool constant : {false, true}) {
    const Sample s = duffing(500, 9, constant);
    std::vector<PathPoint> path;
    lasso(s.blocks(5), {}, {}, &path);
    ASSERT_EQ(path.size(), 100u);
    for (const PathPoint& p : path)  // condition 1e2, lambda down to 1e-3 of its start: rounding leaves 1e-11
      EXPECT_LE(lasso_violation(s, p.coefficients, p.lambda, constant), 1e-9) << "lambda " << p.lambda;
  }
}

TEST(RegressLasso, path_starts_at_zero_and_is_monotone) {
  const Sample s = duffing(500, 12, false);
  const Statistic data = s.data();
  std::vector<PathPoint> path;
  lasso(std::span(&data, 1), {.lambda = 0.01, .path_ratio = 1e-6}, {}, &path);
  const VectorXd size = data.rms().head(data.features());
  EXPECT_EQ(path.front().coefficients.norm(), 0);
  EXPECT_GT(path[1].coefficients.norm(), 0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_LT(path[i].lambda, path[i - 1].lambda);
    EXPECT_LE(path[i].rmse, path[i - 1].rmse * (1 + 1e-12));
    EXPECT_GE(path[i].coefficients.cwiseAbs().dot(size), path[i - 1].coefficients.cwiseAbs().dot(size) * (1 - 1e-12));
  }
  const Fit plain = least_squares(data);
  EXPECT_NEAR(path.back().rmse / plain.rmse, 1, 1e-6);  // the last lambda is 1e-6
}

TEST(RegressLasso, orthonormal_features_are_soft_thresholded) {
  // Tibshirani 1996, equation 3: b = sign(b0) (|b0| - lambda)+ for orthonormal columns.
  const Index n = 4, rows = 16;
  MatrixXd x(rows, n);  // Walsh functions, rms 1
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < n; ++j) x(i, j) = (i >> j) % 2 ? 1 : -1;
  const Eigen::Vector4d b(3, -1, 0.4, 0.05);
  Statistic data({"p", "q", "r", "s"});
  data.add(x, x * b);
  const double lambda = 0.1, cut = lambda * b.norm();  // the target's rms is |b|
  const Fit fit = lasso(std::span(&data, 1), {.lambda = lambda});
  for (Index j = 0; j < n; ++j)
    EXPECT_NEAR(fit.coefficients[j], std::copysign(std::max(0.0, std::abs(b[j]) - cut), b[j]), 1e-14);
}

TEST(RegressLasso, cross_validation_finds_the_truth_and_refits) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Sample s = duffing(4000, seed, false);
    std::vector<PathPoint> path;
    const Fit fit = lasso(s.blocks(8), {.refit = true}, {}, &path);
    for (Index j = 0; j < s.truth.size(); ++j) {
      if (s.truth[j] == 0) continue;
      EXPECT_LT(std::abs(fit.coefficients[j] / s.truth[j] - 1), 0.05) << "seed " << seed;
    }
    EXPECT_NE(fit.summary.solver.find("one standard error"), std::string::npos);
    const Fit least = lasso(s.blocks(8), {.one_standard_error = false});
    EXPECT_LE((fit.coefficients.array() != 0).count(), (least.coefficients.array() != 0).count());
    for (const PathPoint& p : path) EXPECT_GT(p.cv_rmse, 0);
  }
}

TEST(RegressLasso, under_sign_constraints_no_point_of_a_grid_is_better) {
  const Index rows = 30;
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const MatrixXd x = MatrixXd::NullaryExpr(rows, 2, [&] { return normal(random); });
  const VectorXd z = x * Eigen::Vector2d(1.0, -0.6);
  Statistic data({"p", "q"});
  data.add(x, z);
  const double lambda = 0.1;
  const std::vector<Constraint> constraints = {at_least(1, -0.2), at_most(0, 0.7)};
  const Fit fit = lasso(std::span(&data, 1), {.lambda = lambda}, constraints);
  const VectorXd size = data.rms();
  const auto objective = [&](const Eigen::Vector2d& b) {
    return (z - x * b).squaredNorm() / (2 * rows * size[2] * size[2]) +
           lambda * (size[0] * std::abs(b[0]) + size[1] * std::abs(b[1])) / size[2];
  };
  for (double p = -1; p <= 0.7; p += 0.01)
    for (double q = -0.2; q <= 1; q += 0.01) EXPECT_GE(objective({p, q}), objective(fit.coefficients) - 1e-12);
}

TEST(RegressLasso, with_any_constraints_agrees_with_the_split_programme) {
  // The textbook form: b = p - q with p, q >= 0, twice the variables; singular, so a ridge of (1e-4)^2 is added, which
  // moves the objective by some 1e-8; what rounding leaves of so flat a programme is of that size too.
  std::mt19937 random(21);
  std::normal_distribution<double> normal;
  int active = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Index n = 2 + static_cast<Index>(random() % 5), rows = 40;
    const MatrixXd x = MatrixXd::NullaryExpr(rows, n, [&] { return normal(random); });
    const VectorXd z = VectorXd::NullaryExpr(rows, [&] { return normal(random); }) + x.col(0) - 0.5 * x.col(1);
    std::vector<std::string> names;
    for (Index j = 0; j < n; ++j) names.push_back("x" + std::to_string(j));
    Statistic data(names);
    data.add(x, z);
    const auto any = [&] { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    std::vector<Constraint> constraints = {at_least(any(), random() % 2 ? 0 : -0.1)};
    if (random() % 2) constraints.push_back(at_most(any(), 0.3));
    if (random() % 2) constraints.push_back(at_least(any(), 0));
    const int first = any(), second = any();
    if (first != second) constraints.push_back(ordered(first, second));

    const double lambda = 0.02 + 0.1 * static_cast<double>(random() % 5);
    const Fit fit = lasso(std::span(&data, 1), {.lambda = lambda}, constraints);
    const VectorXd size = data.rms();
    const auto objective = [&](const VectorXd& b) {
      return (z - x * b).squaredNorm() / (2 * rows * size[n] * size[n]) +
             lambda * size.head(n).dot(b.cwiseAbs()) / size[n];
    };
    MatrixXd wide(rows + 2 * n, 2 * n + 1), r = MatrixXd::Zero(2 * n + 1, 2 * n + 1);
    const double scale = 1 / (std::sqrt(rows) * size[n]);
    wide << scale * x, -scale * x, scale * z, 1e-4 * MatrixXd::Identity(2 * n, 2 * n), VectorXd::Zero(2 * n);
    triangularise(r, wide);
    const MatrixXd factor = r.topLeftCorner(2 * n, 2 * n);
    const VectorXd slope = lambda / size[n] * size.head(n).replicate(2, 1);
    const VectorXd right = r.col(2 * n).head(2 * n) - factor.transpose().triangularView<Eigen::Lower>().solve(slope);
    MatrixXd c = MatrixXd::Zero(2 * n + static_cast<Index>(constraints.size()), 2 * n);
    VectorXd d = VectorXd::Zero(c.rows());
    c.topRows(2 * n).setIdentity();
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const Index row = 2 * n + static_cast<Index>(i);
      const bool upper = std::isfinite(constraints[i].upper);
      for (const auto& [j, weight] : constraints[i].terms) {
        c(row, j) += upper ? -weight : weight;
        c(row, n + j) -= upper ? -weight : weight;
      }
      d[row] = upper ? -constraints[i].upper : constraints[i].lower;
    }
    const QuadraticSolution split = solve_quadratic(factor, right, c, d, 0);
    ASSERT_EQ(split.blocked, -1);
    const VectorXd reference = split.x.head(n) - split.x.tail(n);
    EXPECT_NEAR(objective(fit.coefficients), objective(reference), 1e-7) << "trial " << trial;
    EXPECT_LE(fit.summary.kkt, 1e-10) << "trial " << trial;
    active += !fit.active.empty();
  }
  EXPECT_GT(active, 50);
}

TEST(RegressOptions, texts_of_what_is_refused) {
  const Sample s = duffing(100, 1, false);
  const Statistic data = s.data();
  EXPECT_EQ(message([&] { lasso(std::span(&data, 1), {.lambda = -1}); }), "lasso: lambda: expected > 0, got -1");
  EXPECT_EQ(message([&] { lasso(std::span(&data, 1), {}); }),
            "lasso: cross-validation needs at least 3 blocks of time, got 1");
  EXPECT_EQ(message([&] { lasso(std::span(&data, 1), {.lambda = 1, .path = 1}); }),
            "lasso: path: expected >= 2, got 1");
  EXPECT_EQ(message([&] { lasso(std::span(&data, 1), {.lambda = 1, .path_ratio = 2}); }),
            "lasso: path_ratio: expected > 0 and < 1, got 2");
  EXPECT_EQ(message([&] { ridge(data, {0}); }), "ridge: lambda: expected > 0, got 0");
  EXPECT_EQ(message([&] { stlsq(data, {.threshold = 1.5}); }),
            "stlsq: threshold: expected > 0 and < 1 (part of the target's rms), got 1.5");
  EXPECT_EQ(message([&] { stlsq(data, {.ridge = -2}); }), "stlsq: ridge: expected >= 0, got -2");
  EXPECT_EQ(message([&] { stlsq(data, {.max_passes = 0}); }), "stlsq: max_passes: expected >= 1, got 0");
}
