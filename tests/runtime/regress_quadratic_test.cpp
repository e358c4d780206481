// Constrained least squares against every possible active set, and the constraints of the solvers.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "message.hpp"
#include "regress/fit.hpp"
#include "regress/quadratic.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The least objective over all active sets whose stationary point is feasible; infinite when there is none.
double least_by_enumeration(const MatrixXd& r, const VectorXd& z, const MatrixXd& c, const VectorXd& d,
                            int equalities) {
  const Index n = r.cols(), m = c.rows();
  double best = std::numeric_limits<double>::infinity();
  for (int set = 0; set < (1 << m); ++set) {
    bool all_equalities = true;
    std::vector<Index> rows;
    for (Index i = 0; i < m; ++i) {
      if (set >> i & 1)
        rows.push_back(i);
      else if (i < equalities)
        all_equalities = false;
    }
    const Index q = static_cast<Index>(rows.size());
    if (!all_equalities || q > n) continue;
    MatrixXd k = MatrixXd::Zero(n + q, n + q);  // the KKT system
    VectorXd right(n + q);
    k.topLeftCorner(n, n) = r.transpose() * r;
    right.head(n) = r.transpose() * z;
    for (Index i = 0; i < q; ++i) {
      k.row(n + i).head(n) = c.row(rows[static_cast<std::size_t>(i)]);
      k.col(n + i).head(n) = c.row(rows[static_cast<std::size_t>(i)]).transpose();
      right[n + i] = d[rows[static_cast<std::size_t>(i)]];
    }
    const Eigen::FullPivLU<MatrixXd> lu(k);
    if (!lu.isInvertible()) continue;
    const VectorXd x = lu.solve(right).head(n);
    const VectorXd slack = c * x - d;
    if ((slack.array() < -1e-9).any()) continue;
    if (equalities > 0 && slack.head(equalities).cwiseAbs().maxCoeff() > 1e-9) continue;
    best = std::min(best, 0.5 * (r * x - z).squaredNorm());
  }
  return best;
}

MatrixXd random_matrix(std::mt19937& random, Index rows, Index columns) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

Statistic data_of(const MatrixXd& x, const VectorXd& z) {
  std::vector<std::string> names;
  for (Index j = 0; j < x.cols(); ++j) names.push_back("x" + std::to_string(j));
  Statistic data(names);
  data.add(x, z);
  return data;
}

}  // namespace

TEST(RegressQuadratic, agrees_with_enumeration_of_active_sets) {
  std::mt19937 random(7);
  int infeasible = 0, constrained = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Index n = 1 + static_cast<Index>(random() % 5), m = static_cast<Index>(random() % 8);
    const int equalities = m > 1 && n > 2 ? static_cast<int>(random() % 2) : 0;
    MatrixXd r = random_matrix(random, n, n).triangularView<Eigen::Upper>();
    r.diagonal().array() += (r.diagonal().array() < 0).select(-0.5, Eigen::ArrayXd::Constant(n, 0.5));
    const VectorXd z = random_matrix(random, n, 1), d = random_matrix(random, m, 1);
    const MatrixXd c = random_matrix(random, m, n);
    const double best = least_by_enumeration(r, z, c, d, equalities);
    const QuadraticSolution s = solve_quadratic(r, z, c, d, equalities);
    ASSERT_TRUE(s.finished);
    if (std::isinf(best)) {
      EXPECT_GE(s.blocked, 0) << "trial " << trial;
      ++infeasible;
      continue;
    }
    ASSERT_EQ(s.blocked, -1) << "trial " << trial;
    EXPECT_NEAR(0.5 * (r * s.x - z).squaredNorm(), best, 1e-8 * (1 + best)) << "trial " << trial;
    const VectorXd gradient = r.transpose() * (r * s.x - z);
    EXPECT_LE((gradient - c.transpose() * s.multipliers).norm(), 1e-9 * (1 + gradient.norm())) << "trial " << trial;
    for (Index i = equalities; i < m; ++i) EXPECT_GE(s.multipliers[i], 0);
    constrained += !s.active.empty();
  }
  EXPECT_GT(infeasible, 10);
  EXPECT_GT(constrained, 100);
}

TEST(RegressQuadratic, degenerate_vertices_and_repeated_constraints_end) {
  // x >= 0 given three times, with sum >= 0: more constraints than dimensions meet at the optimum, the origin.
  const MatrixXd r = MatrixXd::Identity(2, 2);
  const VectorXd z = VectorXd::Constant(2, -1);
  MatrixXd c(7, 2);
  c << 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, std::sqrt(0.5), std::sqrt(0.5);
  const QuadraticSolution s = solve_quadratic(r, z, c, VectorXd::Zero(7), 0);
  EXPECT_TRUE(s.finished);
  EXPECT_EQ(s.blocked, -1);
  EXPECT_LE(s.x.norm(), 1e-14);
}

TEST(RegressConstraints, each_kind_holds_and_is_reported) {
  std::mt19937 random(3);
  const MatrixXd x = random_matrix(random, 60, 5);
  const VectorXd z = x * (VectorXd(5) << 2, -1, 0.5, 3, 1).finished() + 0.1 * random_matrix(random, 60, 1);
  const std::vector<Constraint> constraints = {at_least(1, 0), between(0, 1.5, 1.6), fixed(2, 0.25), ordered(3, 4)};
  const Fit fit = least_squares(data_of(x, z), constraints);
  EXPECT_NEAR(fit.coefficients[1], 0, 1e-15);
  EXPECT_NEAR(fit.coefficients[0], 1.6, 1e-15);
  EXPECT_EQ(fit.coefficients[2], 0.25);
  EXPECT_NEAR(fit.coefficients[3], fit.coefficients[4], 1e-14);
  ASSERT_EQ(fit.active.size(), 4u);
  EXPECT_EQ(fit.active[0].text, "x1 >= 0");
  EXPECT_EQ(fit.active[1].text, "1.5 <= x0 <= 1.6");
  EXPECT_TRUE(fit.active[1].upper);
  EXPECT_EQ(fit.active[2].text, "x2 = 0.25");
  EXPECT_EQ(fit.active[3].text, "x3 <= x4");
  EXPECT_EQ(fit.free, 1);
  EXPECT_LE(fit.summary.kkt, 1e-13);
  // A bound costs its multiplier: tighten x0 <= 1.6 a little and see half the RSS rise.
  std::vector<Constraint> tighter = constraints;
  tighter[1].upper -= 1e-4;
  const auto rss = [](const Fit& f) { return f.rmse * f.rmse * static_cast<double>(f.rows); };
  const double rise = (rss(least_squares(data_of(x, z), tighter)) - rss(fit)) / 2e-4;
  EXPECT_NEAR(rise / fit.active[1].multiplier, 1, 1e-3);  // second order in the step of 1e-4
}

TEST(RegressConstraints, standard_errors_know_the_active_bounds) {
  // x0 = x1 by equality is the regression on their sum, whose deviation has the textbook form.
  std::mt19937 random(5);
  const MatrixXd x = random_matrix(random, 40, 3);
  const VectorXd z = x.rowwise().sum() + 0.3 * random_matrix(random, 40, 1);
  Constraint equal = ordered(0, 1);
  equal.upper = 0;
  const Fit fit = least_squares(data_of(x, z), std::vector{equal});
  MatrixXd sum(40, 2);
  sum << x.col(0) + x.col(1), x.col(2);
  const MatrixXd gram = (sum.transpose() * sum).inverse();
  const VectorXd b = gram * (sum.transpose() * z);
  const double sigma = std::sqrt((z - sum * b).squaredNorm() / 38);
  EXPECT_NEAR(fit.residual_std / sigma, 1, 1e-12);
  EXPECT_NEAR(fit.coefficients[0], b[0], 1e-12);
  EXPECT_NEAR(fit.std[0] / (sigma * std::sqrt(gram(0, 0))), 1, 1e-12);
  EXPECT_NEAR(fit.std[1], fit.std[0], 1e-12);
  EXPECT_NEAR(fit.covariance(0, 1) / (fit.std[0] * fit.std[1]), 1, 1e-12);
}

TEST(RegressConstraints, every_solver_honours_them) {
  std::mt19937 random(11);
  const MatrixXd x = random_matrix(random, 90, 4);
  const VectorXd z = x * (VectorXd(4) << 2, -1, 1, 0.5).finished() + 0.1 * random_matrix(random, 90, 1);
  const std::vector<Constraint> constraints = {at_least(1, -0.4), ordered(0, 2)};
  const Statistic data = data_of(x, z);
  for (const Fit& fit :
       {least_squares(data, constraints), ridge(data, {0.01}, constraints), stlsq(data, {0.05, 0, 20}, constraints),
        lasso(std::span(&data, 1), {.lambda = 0.05}, constraints)}) {
    EXPECT_GE(fit.coefficients[1], -0.4 - 1e-12) << fit.summary.solver;
    EXPECT_LE(fit.coefficients[0], fit.coefficients[2] + 1e-12) << fit.summary.solver;
    EXPECT_EQ(fit.active.size(), 2u) << fit.summary.solver;
    EXPECT_LE(fit.summary.kkt, 1e-12) << fit.summary.solver;
  }
}

TEST(RegressConstraints, texts_of_what_cannot_be) {
  const Statistic data = data_of(MatrixXd::Random(20, 3), VectorXd::Random(20));
  std::vector<Constraint> c = {at_least(2, -9), at_least(0, 2), at_most(0, 1)};
  c[1].where = {"study.lua", 6, 0};
  c[2].where = {"study.lua", 7, 0};
  EXPECT_EQ(message([&] { least_squares(data, c); }),
            "study.lua:7: constraint 'x0 <= 1' contradicts 'x0 >= 2' (study.lua:6)");
  c = {at_least(0, 2), at_most(1, 1), ordered(0, 1)};
  EXPECT_EQ(message([&] { least_squares(data, c); }),
            "constraint 'x0 <= x1' contradicts 'x0 >= 2' together with 'x1 <= 1'");
  c = {between(1, 3, 2)};
  EXPECT_EQ(message([&] { least_squares(data, c); }),
            "constraint on 'x1': the lower bound 3 is above the upper bound 2");
  c = {fixed(1, 3), fixed(1, 2)};
  EXPECT_EQ(message([&] { least_squares(data, c); }), "constraint 'x1 = 2' contradicts 'x1 = 3'");
  c = {fixed(1, 3), at_most(1, 2)};
  EXPECT_EQ(message([&] { least_squares(data, c); }), "constraint 'x1 <= 2' contradicts 'x1 = 3'");
  Statistic flat({"x0", "x1"});
  MatrixXd twice(9, 2);
  twice << VectorXd::LinSpaced(9, -1, 2), VectorXd::LinSpaced(9, -2, 4);
  flat.add(twice, VectorXd::Random(9));
  c = {at_least(1, 2)};
  EXPECT_EQ(message([&] { least_squares(flat, c); }),
            "constraint 'x1 >= 2' needs features that are left out or that the data do not excite");
  c = {at_least(5, 0)};
  EXPECT_EQ(message([&] { least_squares(data, c); }), "constraint: feature 6 of 3");
}
