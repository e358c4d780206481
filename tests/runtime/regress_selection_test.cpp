// Searches over subsets of features against exhaustive enumeration and classical Gram-Schmidt.
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

/// z(t) = 0.5 z(t-1) + u(t-2) + 0.1 u(t-1)^2 + e(t) with a uniform input, and all products up to degree 2 of its lags.
struct Narx {
  std::vector<std::string> names;
  MatrixXd x;
  VectorXd z;
};
Narx narx(unsigned seed) {
  constexpr Index rows = 500;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal(0, 0.02);
  VectorXd u(rows), z = VectorXd::Zero(rows);
  for (Index t = 0; t < rows; ++t) u[t] = uniform(random);
  for (Index t = 2; t < rows; ++t) z[t] = 0.5 * z[t - 1] + u[t - 2] + 0.1 * u[t - 1] * u[t - 1] + normal(random);
  const std::vector<std::string> lags = {"z1", "z2", "u1", "u2"};
  MatrixXd lag(rows - 2, 4);
  lag << z.segment(1, rows - 2), z.head(rows - 2), u.segment(1, rows - 2), u.head(rows - 2);
  Narx out{{}, MatrixXd(rows - 2, 14), z.tail(rows - 2)};
  Index column = 0;
  for (Index i = 0; i < 4; ++i) {
    out.names.push_back(lags[static_cast<std::size_t>(i)]);
    out.x.col(column++) = lag.col(i);
    for (Index j = i; j < 4; ++j) {
      out.names.push_back(lags[static_cast<std::size_t>(i)] + lags[static_cast<std::size_t>(j)]);
      out.x.col(column++) = lag.col(i).cwiseProduct(lag.col(j));
    }
  }
  return out;
}

/// The paper's algorithm as it is written: classical Gram-Schmidt on the columns (Chen, Billings & Luo 1989, section
/// 3).
std::vector<std::pair<Index, double>> by_gram_schmidt(const MatrixXd& x, const VectorXd& z, Index terms) {
  std::vector<std::pair<Index, double>> chosen;
  MatrixXd basis(x.rows(), terms);
  for (Index step = 0; step < terms; ++step) {
    Index best = -1;
    double largest = -1;
    for (Index j = 0; j < x.cols(); ++j) {
      if (std::any_of(chosen.begin(), chosen.end(), [j](const auto& c) { return c.first == j; })) continue;
      VectorXd w = x.col(j);
      for (Index k = 0; k < step; ++k) w -= basis.col(k).dot(x.col(j)) / basis.col(k).squaredNorm() * basis.col(k);
      const double ratio = std::pow(w.dot(z), 2) / (w.squaredNorm() * z.squaredNorm());
      if (ratio <= largest) continue;
      largest = ratio;
      best = j;
      basis.col(step) = w;
    }
    chosen.emplace_back(best, largest);
  }
  return chosen;
}

/// Residual sum of squares of the columns in `mask`, by normal equations in the subset.
double subset_rss(const MatrixXd& x, const VectorXd& z, unsigned mask) {
  std::vector<Index> in;
  for (Index j = 0; j < x.cols(); ++j)
    if (mask >> j & 1) in.push_back(j);
  if (in.empty()) return z.squaredNorm();
  MatrixXd part(x.rows(), static_cast<Index>(in.size()));
  for (std::size_t k = 0; k < in.size(); ++k) part.col(static_cast<Index>(k)) = x.col(in[k]);
  return (z - part * part.householderQr().solve(z)).squaredNorm();
}

unsigned mask_of(const std::vector<int>& features) {
  unsigned mask = 0;
  for (const int j : features) mask |= 1u << j;
  return mask;
}

}  // namespace

TEST(RegressFrols, ratios_are_those_of_classical_gram_schmidt) {
  const Narx s = narx(4);
  Statistic data(s.names);
  data.add(s.x, s.z);
  const Fit fit = frols(data, {.threshold = 0, .max_terms = 6});
  const auto expected = by_gram_schmidt(s.x, s.z, 6);
  ASSERT_EQ(fit.steps.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(fit.steps[k].feature, expected[k].first) << k;
    EXPECT_NEAR(fit.steps[k].error_reduction, expected[k].second, 1e-12) << k;
  }
  EXPECT_EQ(fit.summary.stopped, "max_terms reached");
}

TEST(RegressFrols, finds_the_terms_of_a_sampled_system) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Narx s = narx(seed);
    Statistic data(s.names);
    data.add(s.x, s.z);
    const Fit fit = frols(data, {.threshold = 1e-3});
    std::vector<std::string> kept;
    for (Index j = 0; j < fit.coefficients.size(); ++j)
      if (fit.coefficients[j] != 0) kept.push_back(s.names[static_cast<std::size_t>(j)]);
    EXPECT_EQ(kept, (std::vector<std::string>{"z1", "u1u1", "u2"})) << "seed " << seed;
  }
}

TEST(RegressFrols, takes_first_what_the_constraints_need) {
  std::mt19937 random(5);
  const MatrixXd x = random_matrix(random, 60, 5);
  const VectorXd z = 3 * x.col(0) + x.col(1) + 0.1 * random_matrix(random, 60, 1);
  const Fit fit = frols(data_of(x, z), {.threshold = 0.01}, std::vector{at_least(4, 0.5), at_most(0, 2)});
  EXPECT_EQ(fit.steps.front().feature, 4);
  EXPECT_NEAR(fit.coefficients[4], 0.5, 1e-12);
  EXPECT_NEAR(fit.coefficients[0], 2, 1e-12);
  EXPECT_NE(fit.coefficients[1], 0);
}

TEST(RegressStepwise, no_single_step_lowers_the_criterion) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 30; ++trial) {
    const MatrixXd x = leaning_matrix(random, 50, 7);
    const VectorXd z = x.col(1) - 0.7 * x.col(3) + 0.3 * x.col(4) + random_matrix(random, 50, 1);
    for (const Criterion criterion : {Criterion::aicc, Criterion::bic}) {
      const Fit fit = stepwise(data_of(x, z), {.criterion = criterion});
      const auto value = [&](unsigned mask) {
        const double k = __builtin_popcount(mask), n = 50;
        const double fitted = n * std::log(subset_rss(x, z, mask) / n);
        return criterion == Criterion::bic ? fitted + k * std::log(n) : fitted + 2 * k + 2 * k * (k + 1) / (n - k - 1);
      };
      unsigned mask = 0;
      for (Index j = 0; j < 7; ++j)
        if (fit.coefficients[j] != 0) mask |= 1u << j;
      for (Index j = 0; j < 7; ++j) EXPECT_GE(value(mask ^ (1u << j)), value(mask) - 1e-9);
      if (!fit.steps.empty()) {
        EXPECT_NEAR(fit.steps.back().criterion, value(mask), 1e-9);
      }
    }
  }
}

TEST(RegressBestSubset, agrees_with_all_subsets) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 40; ++trial) {
    const Index n = 2 + static_cast<Index>(random() % 8);
    const MatrixXd x = leaning_matrix(random, 30, n);
    const VectorXd z = x.rowwise().sum() + 3 * random_matrix(random, 30, 1);
    const Fit fit = best_subset(data_of(x, z));
    std::vector<double> best(static_cast<std::size_t>(n + 1), 1e300);
    for (unsigned mask = 0; mask < 1u << n; ++mask) {
      double& least = best[static_cast<std::size_t>(__builtin_popcount(mask))];
      least = std::min(least, subset_rss(x, z, mask));
    }
    ASSERT_EQ(fit.steps.size(), best.size());
    for (std::size_t k = 0; k < best.size(); ++k) {
      EXPECT_NEAR(fit.steps[k].rmse * fit.steps[k].rmse * 30 / best[k], 1, 1e-10) << "trial " << trial << " size " << k;
      EXPECT_NEAR(subset_rss(x, z, mask_of(fit.steps[k].features)) / best[k], 1, 1e-10);
    }
    EXPECT_LT(fit.summary.iterations, 1 << n);  // it bounds
  }
}

TEST(RegressBestSubset, agrees_with_all_subsets_under_constraints) {
  std::mt19937 random(13);
  for (int trial = 0; trial < 20; ++trial) {
    const int n = 5;
    const MatrixXd x = leaning_matrix(random, 30, n);
    const VectorXd z = x * (VectorXd(5) << 1, -1, 0.5, 0, 2).finished() + random_matrix(random, 30, 1);
    const std::vector<Constraint> constraints = {at_least(1, 0), ordered(4, 0), at_least(2, 0.2)};
    const Statistic data = data_of(x, z);
    std::vector<double> best(n + 1, 1e300);
    for (unsigned mask = 0; mask < 1u << n; ++mask) {
      std::vector<Constraint> all = constraints;
      for (int j = 0; j < n; ++j)
        if (!(mask >> j & 1)) all.push_back(fixed(j, 0));
      try {
        const Fit one = least_squares(data, all);
        double& least = best[static_cast<std::size_t>(__builtin_popcount(mask))];
        least = std::min(least, one.rmse);
      } catch (const InputError&) {  // x2 is needed
      }
    }
    const Fit fit = best_subset(data, {}, constraints);
    for (const SelectionStep& step : fit.steps) EXPECT_NEAR(step.rmse / best[step.features.size()], 1, 1e-9);
    EXPECT_EQ(fit.steps.size(), 5u);  // sizes 1 to 5
    EXPECT_GE(fit.coefficients[2], 0.2 - 1e-12);
  }
}

TEST(RegressBestSubset, thirty_features_and_no_more) {
  std::mt19937 random(2);
  const MatrixXd x = leaning_matrix(random, 200, 31);
  const VectorXd z = x.col(3) + x.col(17) - x.col(25) + 0.5 * random_matrix(random, 200, 1);
  const Fit fit = best_subset(data_of(x.leftCols(30), z), {.terms = 3});
  EXPECT_TRUE(fit.summary.converged);
  EXPECT_EQ(mask_of(fit.steps[3].features), 1u << 3 | 1u << 17 | 1u << 25);
  EXPECT_EQ(
      message([&] { best_subset(data_of(x, z)); }),
      "best_subset: expected at most 30 features that are not fixed, got 31: the search grows as 2^features, take "
      "frols or stepwise");
  EXPECT_EQ(best_subset(data_of(x.leftCols(30), z), {.max_nodes = 5}).summary.stopped, "max_nodes reached");
}

TEST(RegressSelection, texts_of_what_is_refused) {
  std::mt19937 random(2);
  const Statistic data = data_of(random_matrix(random, 9, 2), random_matrix(random, 9, 1));
  EXPECT_EQ(message([&] { frols(data, {.threshold = 1}); }),
            "frols: threshold: expected >= 0 and < 1 (part of the target's sum of squares), got 1");
  EXPECT_EQ(message([&] { stepwise(data, {.max_terms = -1}); }), "stepwise: max_terms: expected >= 0, got -1");
  EXPECT_EQ(message([&] { best_subset(data, {.terms = 3}); }), "best_subset: terms: expected 0 to 2, got 3");
}
