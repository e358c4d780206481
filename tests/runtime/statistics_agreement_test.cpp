// Residual tests over lags, intervals, and all measures at once.
#include <gtest/gtest.h>

#include <cmath>

#include "expr/error.hpp"
#include "statistics/statistics.hpp"
#include "statistics_noise.hpp"

namespace lunid {
namespace {

using test::alarms;
using test::autoregressive;
using test::message_of;
using test::span_of;

TEST(Whiteness, CountsWhatIsBeyondItsBound) {
  const Eigen::VectorXd x = autoregressive(400, {0.5}, 1);
  const LagTest test = whiteness(span_of(x), 20);
  EXPECT_EQ(test.coefficients, autocorrelation(span_of(x), 20).tail(20));
  EXPECT_NEAR(test.bound, 1.96 / 20, 1e-5);
  EXPECT_GE(test.beyond, 3);
  EXPECT_EQ(test.p_value, ljung_box(span_of(x), 20).p_value);
  // Of white noise 1 in 20 is beyond: 40 draws of 20 lags, 40 +- 4 deviations of 6.
  int beyond = 0;
  for (std::uint64_t draw = 0; draw < 40; ++draw)
    beyond += whiteness(span_of(autoregressive(400, {}, draw)), 20).beyond;
  EXPECT_GE(beyond, 16);
  EXPECT_LE(beyond, 64);
}

TEST(CrossCorrelation, FindsTheLagAndItsSign) {
  const Eigen::VectorXd u = autoregressive(1000, {}, 1);
  Eigen::VectorXd e = 0.3 * autoregressive(1000, {}, 2);
  e.tail(995) += u.head(995);  // e follows u by 5 rows
  const LagTest test = cross_correlation(span_of(e), span_of(u), 10);
  Eigen::Index place = 0;
  test.coefficients.maxCoeff(&place);
  EXPECT_EQ(test.lags[static_cast<std::size_t>(place)], 5);
  EXPECT_LT(test.p_value, 1e-10);
  EXPECT_NEAR(test.bound, 1.96 / std::sqrt(1000), 0.1 * test.bound);  // both white
}

TEST(CrossCorrelation, HoldsItsLevelForColouredSeries) {
  // 400 draws of a 5 % test. With 1.96 / sqrt(n) the share beyond the bound would be 0.3 for the last pair.
  const std::vector<std::pair<std::vector<double>, std::vector<double>>> colours{
      {{}, {}}, {{0.8}, {}}, {{0.8}, {0.7}}, {{1.6, -0.8}, {1.5, -0.7}}};
  for (const auto& [of_e, of_u] : colours) {
    double beyond = 0;
    const double share = alarms(400, [&](std::uint64_t draw) {
      const LagTest test = cross_correlation(span_of(autoregressive(600, of_e, draw)),
                                             span_of(autoregressive(600, of_u, draw + 5000)), 10);
      beyond += test.beyond / 21.0 / 400;
      return test.p_value;
    });
    EXPECT_GE(share, 0.02) << of_e.size() << of_u.size();
    EXPECT_LE(share, 0.10) << of_e.size() << of_u.size();
    EXPECT_NEAR(beyond, 0.05, 0.025);
  }
}

TEST(LagTests, RefuseWhatTheyCannotTake) {
  const std::vector<double> x{1, 2, 3, 4, 5, 7};
  EXPECT_EQ(message_of([&] { whiteness(x, 6); }), "whiteness: lags: expected 1 to 5, got 6");
  EXPECT_EQ(message_of([&] { whiteness(x, 2, 2); }), "whiteness: lags: expected 3 to 5, got 2");
  EXPECT_EQ(message_of([&] { cross_correlation(x, std::vector<double>(6, 1.0), 2); }),
            "cross_correlation: column 2 is constant, 1: nothing can vary with it");
}

Eigen::VectorXd one_value(double value) {
  Eigen::VectorXd x(1);
  x[0] = value;
  return x;
}

/// Share of 95 % intervals of the correlation of two coloured series that hold the truth.
template <class Intervals>
double coverage(int draws, Eigen::Index block, Intervals intervals) {
  int held = 0;
  for (std::uint64_t draw = 1; draw <= static_cast<std::uint64_t>(draws); ++draw) {
    const Eigen::VectorXd a = autoregressive(400, {0.6}, draw), b = 0.75 * a + autoregressive(400, {0.6}, draw + 7000);
    const auto statistic = [&](std::span<const Eigen::Index> rows) {
      const std::vector<Eigen::Index> list(rows.begin(), rows.end());
      const Eigen::VectorXd p = a(list), q = b(list);
      const Eigen::VectorXd x = p.array() - p.mean(), y = q.array() - q.mean();
      return one_value(x.dot(y) / (x.norm() * y.norm()));
    };
    const Interval found = intervals(400, statistic, IntervalOptions{0.95, 199, block, draw, 1})[0];
    held += found.low <= 0.6 && 0.6 <= found.high;  // 0.75/sqrt(0.75^2 + 1)
  }
  return static_cast<double>(held) / draws;
}

TEST(Intervals, CoverTheTruthUnderColour) {
  // 300 draws: a deviation of 1.3 %. Blocks cut some of the dependence off, which costs a few per cent; single rows, as
  // if there were no colour, cost far more.
  EXPECT_GE(coverage(300, 20, bootstrap_intervals), 0.88);
  EXPECT_LE(coverage(300, 20, bootstrap_intervals), 0.98);
  EXPECT_LE(coverage(300, 1, bootstrap_intervals), 0.88);
  EXPECT_GE(coverage(300, 20, jackknife_intervals), 0.88);
  EXPECT_LE(coverage(300, 20, jackknife_intervals), 0.99);
}

TEST(Intervals, AreTheSameForAnyNumberOfThreads) {
  const Eigen::VectorXd x = autoregressive(200, {0.5}, 1);
  const auto mean = [&](std::span<const Eigen::Index> rows) {
    double sum = 0;
    for (Eigen::Index i : rows) sum += x[i];
    return one_value(sum / static_cast<double>(rows.size()));
  };
  IntervalOptions one{0.9, 199, 10, 3, 1}, more{0.9, 199, 10, 3, 4};
  const Interval a = bootstrap_intervals(200, mean, one)[0], b = bootstrap_intervals(200, mean, more)[0];
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
  // The deviation of the mean: sqrt(long-run variance / n), to 25 % at 20 blocks.
  EXPECT_NEAR(a.std / std::sqrt(long_run_variance(span_of(x)) / 200), 1, 0.3);
  one.level = 1;
  EXPECT_EQ(message_of([&] { bootstrap_intervals(200, mean, one); }),
            "interval: level: expected > 0 and < 1, got 1.000000");
  more.block_length = 41;
  EXPECT_EQ(message_of([&] { jackknife_intervals(200, mean, more); }),
            "interval: block: expected 1 to 40 rows, a fifth of them, got 41");
  more.block_length = 10;
  EXPECT_EQ(message_of([&] {
              bootstrap_intervals(
                  200, [](auto) { return one_value(NAN); }, more);
            }),
            "interval: the statistic is not finite for some choice of the rows: take longer blocks or a longer window");
}

TEST(Agreement, GivesEveryMeasureByItsOwnFunction) {
  const int rows = 500;
  const Eigen::VectorXd y = autoregressive(rows, {1.8, -0.95}, 1), v = autoregressive(rows, {1.8, -0.95}, 2);
  const Eigen::VectorXd model = y + 0.5 * autoregressive(rows, {0.3}, 3), force = autoregressive(rows, {}, 4);
  const Eigen::VectorXd residual = y - model;
  AgreementOptions options;
  options.level = 0.9;
  options.draws = 199;
  const Agreement found = agreement({span_of(y), span_of(model), span_of(v), span_of(v), span_of(force)}, options);
  EXPECT_EQ(found.rmse, rmse(span_of(y), span_of(model)));
  EXPECT_EQ(found.r2, r_squared(span_of(y), span_of(model)));
  EXPECT_NEAR(found.fit, 100 * (1 - found.nrmse), 1e-12);
  EXPECT_EQ(*found.qqcc, quantile_correlation(normal_quantiles(span_of(residual))));
  EXPECT_EQ(*found.dtw, phase_portrait_distance(span_of(y), span_of(v), span_of(model), span_of(v)));
  EXPECT_EQ(*found.mutual_information, mutual_information(span_of(model), span_of(y)));
  EXPECT_EQ(found.kendall->coefficient, kendall(span_of(y), span_of(model)).coefficient);
  EXPECT_EQ(found.white->p_value, ljung_box(span_of(residual), 25).p_value);
  EXPECT_EQ(found.follows->coefficients, cross_correlation(span_of(residual), span_of(force), 25).coefficients);
  ASSERT_EQ(found.intervals.size(), 7u);
  for (const auto& [name, value] : {std::pair{"rmse", found.rmse},
                                    {"r2", found.r2},
                                    {"spearman", found.spearman->coefficient},
                                    {"mutual_information", *found.mutual_information}}) {
    EXPECT_LE(found.intervals.at(name).low, value) << name;
    EXPECT_GE(found.intervals.at(name).high, value) << name;
  }
}

TEST(Agreement, OfAPerfectModelAndOfOneAtRest) {
  const Eigen::VectorXd y = autoregressive(100, {0.5}, 1), rest = Eigen::VectorXd::Zero(100);
  const Agreement perfect = agreement({span_of(y), span_of(y), {}, {}, {}});
  EXPECT_EQ(perfect.rmse, 0);
  EXPECT_EQ(perfect.fit, 100);
  EXPECT_FALSE(perfect.qqcc || perfect.white || perfect.dtw);
  const Agreement still = agreement({span_of(y), span_of(rest), {}, {}, {}});
  EXPECT_FALSE(still.mutual_information || still.spearman);
  EXPECT_TRUE(still.white);
  EXPECT_EQ(message_of([&] {
              agreement({span_of(rest), span_of(y), {}, {}, {}});
            }),
            "compare: measured: the column is constant, 0: nothing can vary with it");
  EXPECT_EQ(message_of([&] {
              agreement({span_of(y).first(19), span_of(y).first(19), {}, {}, {}});
            }),
            "compare: measured: the column: expected 20 rows or more, got 19");
}

}  // namespace
}  // namespace lunid
