// Elastic net, SR3, non-negative and total least squares, spike and slab, ensembles, bootstrap: conditions of
// optimality, closed forms, brute force.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "message.hpp"
#include "regress/solvers.hpp"
#include "regress_samples.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

VectorXd sizes(const MatrixXd& x) { return (x.colwise().squaredNorm() / static_cast<double>(x.rows())).cwiseSqrt(); }

}  // namespace

TEST(RegressElasticNet, meets_its_first_order_conditions_along_the_path) {
  std::mt19937 random(6);
  const MatrixXd x = leaning_matrix(random, 80, 6);
  const VectorXd z = x.col(0) - 2 * x.col(2) + 0.5 * random_matrix(random, 80, 1);
  const VectorXd size = sizes(x);
  const double target = std::sqrt(z.squaredNorm() / 80);
  for (const double mixture : {0.2, 0.7}) {
    std::vector<PathPoint> path;
    lasso(blocks_of(x, z, 4), {.mixture = mixture}, {}, &path);
    EXPECT_EQ(path.front().coefficients.norm(), 0);
    for (const PathPoint& p : path) {
      const VectorXd slope = x.transpose() * (z - x * p.coefficients) / 80;  // of half the mean square
      for (Index j = 0; j < 6; ++j) {
        const double s = size[j] * p.coefficients[j] / target;
        const double left = slope[j] / (size[j] * target) - p.lambda * (1 - mixture) * s, limit = p.lambda * mixture;
        if (s == 0)
          EXPECT_LE(std::abs(left), limit * (1 + 1e-8));
        else
          EXPECT_NEAR(left, std::copysign(limit, s), 1e-8 * limit);
      }
    }
  }
}

TEST(RegressElasticNet, tends_to_ridge_and_to_the_lasso) {
  std::mt19937 random(9);
  const MatrixXd x = leaning_matrix(random, 60, 4);
  const VectorXd z = x.rowwise().sum() + random_matrix(random, 60, 1);
  const Statistic data = data_of(x, z);
  const Fit nearly = lasso(std::span(&data, 1), {.mixture = 1e-9, .lambda = 0.1});
  EXPECT_LE((nearly.coefficients - ridge(data, {0.1}).coefficients).norm(), 1e-7);
  const Fit one = lasso(std::span(&data, 1), {.mixture = 1 - 1e-9, .lambda = 0.1});
  EXPECT_LE((one.coefficients - lasso(std::span(&data, 1), {.lambda = 0.1}).coefficients).norm(), 1e-7);
  EXPECT_EQ(message([&] { lasso(std::span(&data, 1), {.mixture = 0, .lambda = 1}); }),
            "elastic_net: mixture: expected > 0 and <= 1, got 0");
}

TEST(RegressSr3, ends_at_a_fixed_point_of_its_two_steps) {
  std::mt19937 random(12);
  const MatrixXd x = leaning_matrix(random, 100, 6);
  const VectorXd z = 2 * x.col(1) - x.col(4) + 0.2 * random_matrix(random, 100, 1);
  const VectorXd size = sizes(x);
  const double target = std::sqrt(z.squaredNorm() / 100);
  const MatrixXd scaled = x * size.cwiseInverse().asDiagonal();
  for (const bool absolute : {false, true})
    for (const double nu : {0.05, 1.0}) {
      const double cut = 0.1;
      const Fit fit =
          sr3(data_of(x, z),
              {.threshold = cut, .relaxation = nu, .absolute = absolute, .refit = false, .tolerance = 1e-14});
      ASSERT_TRUE(fit.summary.converged);
      const VectorXd w = fit.coefficients.cwiseProduct(size) / target;
      // s solves its normal equations for this w, and w is the proximal point of s.
      const MatrixXd gram = scaled.transpose() * scaled / 100 + MatrixXd::Identity(6, 6) / nu;
      const VectorXd s = gram.ldlt().solve(scaled.transpose() * z / (100 * target) + w / nu);
      for (Index j = 0; j < 6; ++j) {
        const double hard = std::abs(s[j]) > cut ? s[j] : 0;
        const double soft = std::copysign(std::max(std::abs(s[j]) - cut, 0.0), s[j]);
        EXPECT_NEAR(w[j], absolute ? soft : hard, 1e-11);
      }
      EXPECT_GT((w.array() == 0).count(), 1);
      // l1 is the lasso of lambda = cut / nu, which keeps nothing at 2.
      if (!absolute || nu == 1) EXPECT_LT((w.array() == 0).count(), 5);
    }
}

TEST(RegressSr3, honours_constraints_or_says_why_not) {
  std::mt19937 random(1);
  const MatrixXd x = random_matrix(random, 50, 3);
  const VectorXd z = 2 * x.col(0) - x.col(1);
  const Statistic data = data_of(x, z);
  std::vector<Constraint> c = {at_least(1, 0.25)};
  c[0].where = {"study.lua", 8, 0};
  EXPECT_NEAR(sr3(data, {}, c).coefficients[1], 0.25, 1e-12);
  EXPECT_EQ(message([&] { sr3(data, {.refit = false}, c); }),
            "study.lua:8: sr3: without refit the sparse copy need not meet 'x1 >= 0.25': take refit = true, or no "
            "constraint");
  EXPECT_EQ(message([&] { sr3(data, {.threshold = 0}); }), "sr3: threshold: expected > 0, got 0");
}

TEST(RegressNonNegative, agrees_with_all_subsets) {
  std::mt19937 random(31);
  for (int trial = 0; trial < 50; ++trial) {
    const int n = 5;
    const MatrixXd x = leaning_matrix(random, 20, n);
    const VectorXd z = random_matrix(random, 20, 1) + x.col(2) - x.col(3);
    double best = z.squaredNorm();
    for (unsigned mask = 1; mask < 1u << n; ++mask) {
      std::vector<Index> in;
      for (Index j = 0; j < n; ++j)
        if (mask >> j & 1) in.push_back(j);
      MatrixXd part(20, static_cast<Index>(in.size()));
      for (std::size_t k = 0; k < in.size(); ++k) part.col(static_cast<Index>(k)) = x.col(in[k]);
      const VectorXd b = part.householderQr().solve(z);
      if (b.minCoeff() >= 0) best = std::min(best, (z - part * b).squaredNorm());
    }
    const Fit fit = non_negative(data_of(x, z));
    EXPECT_GE(fit.coefficients.minCoeff(), 0);
    EXPECT_NEAR(fit.rmse * fit.rmse * 20 / best, 1, 1e-10);
  }
}

TEST(RegressInstrumentalVariables, is_the_textbook_formula) {
  // b = (X'P X)^-1 X'P z with P = Z (Z'Z)^-1 Z', covariance s^2 (X'P X)^-1 (Theil 1953).
  std::mt19937 random(5);
  const Index rows = 300, n = 3, q = 5;
  MatrixXd z = random_matrix(random, rows, q);
  z.col(4) = z.col(0) - 2 * z.col(3);  // says nothing more: left out
  const VectorXd common = random_matrix(random, rows, 1);
  MatrixXd x = z.leftCols(4) * random_matrix(random, 4, n) + common * Eigen::RowVectorXd::Ones(n);
  const VectorXd truth = Eigen::Vector3d(2, -1, 0.5);
  const VectorXd target = x * truth + 3 * common + 0.1 * random_matrix(random, rows, 1);
  MatrixXd all(rows, n + q);
  all << x, z;
  const Fit fit = instrumental_variables(data_of(all, target), n);
  const MatrixXd own = z.leftCols(4);
  const MatrixXd p = own * (own.transpose() * own).inverse() * own.transpose(), gram = x.transpose() * p * x;
  const VectorXd expected = gram.inverse() * (x.transpose() * (p * target));
  EXPECT_LE((fit.coefficients - expected).norm(), 1e-10);
  const double variance = (target - x * expected).squaredNorm() / static_cast<double>(rows - n);
  EXPECT_LE((fit.covariance - variance * gram.inverse()).norm(), 1e-9 * fit.covariance.norm());
  EXPECT_GT((least_squares(data_of(x, target)).coefficients - truth).norm(), 0.3);
  EXPECT_LT((fit.coefficients - truth).norm(), 4 * fit.std.norm());
  EXPECT_EQ(fit.summary.solver, "two-stage least squares, 4 instruments");
  // A fixed coefficient takes its part of the target.
  const Fit held = instrumental_variables(data_of(all, target), n, std::vector{fixed(1, -1)});
  MatrixXd rest(rows, n + q - 1);
  rest << x.col(0), x.col(2), z;
  const Fit less = instrumental_variables(data_of(rest, target + x.col(1)), n - 1);
  EXPECT_NEAR(held.coefficients[0], less.coefficients[0], 1e-10);
  EXPECT_NEAR(held.coefficients[2], less.coefficients[1], 1e-10);
}

TEST(RegressTotalLeastSquares, is_the_least_singular_vector_for_equal_noise) {
  // Golub & Van Loan 1980, SIAM J. Numer. Anal. 17, 883: [X z] v = sigma_min u, b = -v / v_last.
  std::mt19937 random(17);
  const Index rows = 200, n = 3;
  const MatrixXd clean = random_matrix(random, rows, n);
  const VectorXd truth = Eigen::Vector3d(2, -1, 0.5);
  MatrixXd all(rows, n + 1);
  all << clean, clean * truth;
  all += 0.3 * random_matrix(random, rows, n + 1);
  const Eigen::JacobiSVD<MatrixXd> svd(all, Eigen::ComputeThinV);
  const VectorXd v = svd.matrixV().col(n);
  const Statistic data = data_of(all.leftCols(n), all.col(n));
  const Fit fit = total_least_squares(data, MatrixXd::Identity(n + 1, n + 1));
  EXPECT_LE((fit.coefficients + v.head(n) / v[n]).norm(), 1e-12);
  EXPECT_TRUE(fit.summary.converged);
  for (Index j = 0; j < n; ++j) {
    EXPECT_LT(std::abs(fit.coefficients[j] - truth[j]), 4 * fit.std[j]);  // least squares is 8 % low, 5 deviations
    EXPECT_LT(fit.std[j], 0.06);
  }
  // No noise in the features is least squares, one exact feature the mixed problem: the others less their part along
  // it.
  MatrixXd noise = MatrixXd::Zero(1, n + 1);
  noise(0, n) = 1;
  EXPECT_LE((total_least_squares(data, noise).coefficients - least_squares(data).coefficients).norm(), 1e-12);
  noise = MatrixXd::Identity(n + 1, n + 1);
  noise(0, 0) = 0;
  const VectorXd exact = all.col(0).normalized();
  const MatrixXd rest = all.rightCols(n) - exact * (exact.transpose() * all.rightCols(n));
  const VectorXd w = Eigen::JacobiSVD<MatrixXd>(rest, Eigen::ComputeThinV).matrixV().col(n - 1);
  EXPECT_LE((total_least_squares(data, noise).coefficients.tail(n - 1) + w.head(n - 1) / w[n - 1]).norm(), 1e-12);
}

TEST(RegressTotalLeastSquares, fixed_coefficients_move_to_the_left_others_are_refused) {
  std::mt19937 random(18);
  const MatrixXd x = random_matrix(random, 60, 2);
  const VectorXd z = x * Eigen::Vector2d(1, 2) + 0.1 * random_matrix(random, 60, 1);
  const Statistic data = data_of(x, z);
  const MatrixXd noise = MatrixXd::Identity(3, 3);
  // With b1 = 2 the error of z - 2 x1 has the variance 1 + 4: scaled, the plain problem in two columns.
  MatrixXd two(60, 2);
  two << x.col(0), (z - 2 * x.col(1)) / std::sqrt(5.0);
  const VectorXd v = Eigen::JacobiSVD<MatrixXd>(two, Eigen::ComputeThinV).matrixV().col(1);
  const Fit fit = total_least_squares(data, noise, std::vector{fixed(1, 2)});
  EXPECT_NEAR(fit.coefficients[0], -v[0] / v[1] * std::sqrt(5.0), 1e-12);
  std::vector<Constraint> c = {at_least(0, 0)};
  c[0].where = {"study.lua", 4, 0};
  EXPECT_EQ(
      message([&] { total_least_squares(data, noise, c); }),
      "study.lua:4: total_least_squares: cannot honour the constraint 'x0 >= 0', only fixed coefficients: leave it "
      "out or take another solver");
}

TEST(RegressSpikeSlab, probabilities_are_the_integrals_of_an_orthogonal_design) {
  // Given sigma the evidence of orthogonal features factorises: feature j multiplies it by (1 + g)^-1/2 exp(g / (1 + g)
  // (x_j'z)^2 / (2 sigma^2 |x_j|^2)); sigma is then integrated out numerically, in its logarithm.
  const Index n = 4, rows = 16;
  MatrixXd x(rows, n);  // Walsh functions
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < n; ++j) x(i, j) = (i >> j) % 2 ? 1 : -1;
  std::mt19937 random(3);
  const VectorXd z = x * Eigen::Vector4d(1, -0.5, 0.2, 0) + 0.6 * random_matrix(random, rows, 1);
  const double g = rows, prior = 0.3;
  Eigen::Vector4d expected = Eigen::Vector4d::Zero();
  double all = 0;
  for (double log_sigma = -1.8; log_sigma < 3; log_sigma += 1e-3) {
    const double variance = std::exp(2 * log_sigma);
    Eigen::Vector4d factor;
    for (Index j = 0; j < n; ++j)
      factor[j] = prior / (1 - prior) / std::sqrt(1 + g) *
                  std::exp(g / (1 + g) * std::pow(x.col(j).dot(z), 2) / (2 * variance * rows));
    const double weight =
        std::pow(variance, -rows / 2.0) * std::exp(-z.squaredNorm() / (2 * variance)) * (1 + factor.array()).prod();
    all += weight;
    expected.array() += weight * factor.array() / (1 + factor.array());
  }
  expected /= all;
  const Fit fit = spike_slab(data_of(x, z), {.prior = prior});
  for (Index j = 0; j < n; ++j) EXPECT_NEAR(fit.inclusion[j], expected[j], 1e-9);
  EXPECT_GT(expected[0], 0.9);
  EXPECT_LT(expected[3], 0.4);
}

TEST(RegressSpikeSlab, the_sampler_agrees_with_the_sum_over_all_models) {
  std::mt19937 random(23);
  const MatrixXd x = leaning_matrix(random, 60, 17);
  const VectorXd z = x.col(2) - 0.6 * x.col(9) + 0.35 * x.col(10) + random_matrix(random, 60, 1);
  const Statistic data = data_of(x, z);
  std::vector<Constraint> out = {fixed(0, 0), fixed(16, 0)};
  const Fit summed = spike_slab(data, {.prior = 0.2}, out);
  ASSERT_EQ(summed.summary.stopped, "all models summed");
  // 16 candidates are sampled; the prior of the seventeenth is made so small that it is out.
  const Fit sampled = spike_slab(data, {.prior = 0.2, .sweeps = 4000}, std::vector{fixed(0, 0)});
  ASSERT_EQ(sampled.summary.stopped, "sweeps done");
  for (Index j = 1; j < 16; ++j) EXPECT_NEAR(sampled.inclusion[j], summed.inclusion[j], 0.08) << j;
  EXPECT_NE(summed.coefficients[2], 0);
  EXPECT_EQ(message([&] { spike_slab(data, {}, std::vector{at_least(0, 0)}); }),
            "spike_slab: cannot honour the constraint 'x0 >= 0', only fixed coefficients: leave it out or take another "
            "solver");
  EXPECT_EQ(message([&] { spike_slab(data, {.prior = 1}); }), "spike_slab: prior: expected > 0 and < 1, got 1");
}

TEST(RegressEnsemble, keeps_what_the_members_keep) {
  std::mt19937 random(7);
  const MatrixXd x = leaning_matrix(random, 400, 8);
  const VectorXd z = 2 * x.col(0) - x.col(5) + random_matrix(random, 400, 1);
  const auto blocks = blocks_of(x, z, 20);
  for (const double share : {1.0, 0.8}) {
    const Fit fit = ensemble(blocks, {.solver = StlsqOptions{.threshold = 0.1}, .members = 50, .features = share});
    for (Index j = 0; j < 8; ++j) {
      const bool truth = j == 0 || j == 5;
      EXPECT_EQ(fit.coefficients[j] != 0, truth) << j;
      EXPECT_GE(fit.inclusion[j], 0);
      EXPECT_LE(fit.inclusion[j], 1);
      if (truth) EXPECT_GT(fit.inclusion[j], 0.95);
    }
  }
  const Fit bound = ensemble(blocks, {.members = 10}, std::vector{at_most(0, 1.5)});
  EXPECT_NEAR(bound.coefficients[0], 1.5, 1e-12);
  EXPECT_EQ(message([&] { ensemble(std::span(blocks).first(2), {}); }),
            "ensemble_of: resampling needs at least 3 blocks of time, got 2");
  EXPECT_EQ(message([&] { ensemble(blocks, {.members = 1}); }), "ensemble_of: members: expected >= 2, got 1");
  EXPECT_EQ(message([&] { ensemble(blocks, {.inclusion = 0}); }),
            "ensemble_of: inclusion: expected > 0 and <= 1, got 0");
}

TEST(RegressBootstrap, replicates_are_refits_of_the_merged_blocks) {
  // By hand: the same draws, the blocks merged and solved. Equal to rounding, constraints included.
  std::mt19937 random(41);
  const MatrixXd x = leaning_matrix(random, 240, 3);
  const VectorXd z = x * Eigen::Vector3d(1, 0.05, -1) + random_matrix(random, 240, 1);
  const auto blocks = blocks_of(x, z, 12);
  for (const std::vector<Constraint>& c : {std::vector<Constraint>{}, std::vector<Constraint>{at_least(1, 0)}}) {
    const Fit fit = least_squares(merged(blocks), c);
    const Bootstrap quick = bootstrap(blocks, c, fit, 200, 5);
    ASSERT_EQ(quick.replicates, 200);
    std::mt19937_64 draws(5);
    MatrixXd values(3, 200);
    for (Index i = 0; i < 200; ++i) {
      Statistic sum({"x0", "x1", "x2"});
      for (std::size_t b = 0; b < blocks.size(); ++b) sum.merge(blocks[draws() % blocks.size()]);
      values.col(i) = least_squares(sum, c).coefficients;
    }
    const VectorXd mean = values.rowwise().mean();
    const VectorXd deviation = ((values.colwise() - mean).rowwise().squaredNorm() / 199).cwiseSqrt();
    for (Index j = 0; j < 3; ++j) EXPECT_NEAR(quick.std[j], deviation[j], 1e-10);
    EXPECT_GT(quick.upper[0], fit.coefficients[0]);
    EXPECT_LT(quick.lower[0], fit.coefficients[0]);
    if (!c.empty()) EXPECT_GE(quick.lower[1], -1e-12);
  }
  const Fit fit = least_squares(merged(blocks));
  EXPECT_EQ(message([&] { bootstrap(blocks, {}, fit, 5); }), "bootstrap: expected 20 replicates or more, got 5");
  EXPECT_EQ(message([&] { bootstrap(std::span(blocks).first(2), {}, fit, 50); }),
            "bootstrap: expected at least 3 blocks of time, got 2");
}

TEST(RegressBootstrap, deviations_are_those_of_white_noise) {
  std::mt19937 random(2);
  const MatrixXd x = random_matrix(random, 4000, 3);
  const VectorXd z = x.rowwise().sum() + random_matrix(random, 4000, 1);
  const auto blocks = blocks_of(x, z, 100);
  const Fit fit = least_squares(merged(blocks));
  const Bootstrap drawn = bootstrap(blocks, {}, fit, 1000);
  for (Index j = 0; j < 3; ++j)  // 100 blocks: 7 % of the deviation itself, three of them
    EXPECT_NEAR(drawn.std[j] / fit.std[j], 1, 0.21);
}

TEST(RegressInflation, is_one_over_one_minus_r2) {
  std::mt19937 random(4);
  MatrixXd x = leaning_matrix(random, 70, 4);
  x.col(0).setOnes();
  const Fit fit = least_squares(data_of(x, random_matrix(random, 70, 1)));
  EXPECT_TRUE(std::isnan(fit.vif[0]));
  for (Index j = 1; j < 4; ++j) {
    MatrixXd others(70, 3);
    for (Index k = 0, c = 0; k < 4; ++k)
      if (k != j) others.col(c++) = x.col(k);
    const VectorXd rest = x.col(j) - others * others.householderQr().solve(x.col(j));
    const double total = (x.col(j).array() - x.col(j).mean()).matrix().squaredNorm();
    EXPECT_NEAR(fit.vif[j], total / rest.squaredNorm(), 1e-10 * fit.vif[j]);
  }
}
