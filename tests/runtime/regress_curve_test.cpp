// Nonlinear least squares: NIST's nonlinear problems, and what a fit does with bounds, weights and data that do not
// tell.
#include <gtest/gtest.h>

#include <cmath>

#include "message.hpp"
#include "nist/problems.hpp"
#include "record/random.hpp"
#include "regress/curve.hpp"
#include "regress/fit.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

class NistNonlinear : public testing::TestWithParam<nist::Formula> {};

TEST_P(NistNonlinear, from_both_starts) {
  const std::filesystem::path folder = std::filesystem::path(LUNID_SHARED_DATA) / "nist/nonlinear";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no ../shared/data/nist/nonlinear: the NIST problems are not run";
  const nist::NonlinearProblem problem = nist::read_nonlinear(folder, GetParam().name);
  for (int start = 0; start < 2; ++start) {
    const nist::Solved solved = nist::solve(problem, GetParam(), start);
    EXPECT_GE(solved.values, 6) << "start " << start + 1 << ": " << solved.stopped;
    EXPECT_GE(solved.deviations, 4) << "start " << start + 1 << ": " << solved.stopped;
  }
}

INSTANTIATE_TEST_SUITE_P(Regress, NistNonlinear, testing::ValuesIn(nist::formulas()),
                         [](const auto& info) { return std::string(info.param.name); });

/// y = 3 exp(-0.7 x) + noise, at x = 0 .. 5
Record decay(Index rows, double noise) {
  Philox random(1, 0);
  std::vector<Channel> channels(2);
  channels[0].name = "x";
  channels[1].name = "y";
  channels[0].values = VectorXd::LinSpaced(rows, 0, 5);
  channels[1].values = (3 * (-0.7 * channels[0].values.array()).exp()).matrix();
  for (double& value : channels[1].values) value += noise * random.normal();
  return Record("decay", 0, 1, std::move(channels));
}

struct Curve {
  Pool pool;
  Record record;
  CurveOptions options;

  Curve(Record data, const char* formula, std::vector<CurveParameter> parameters) : record(std::move(data)) {
    for (const Channel& c : record.channels()) pool.channel(c.name);
    options.formula = parse(pool, formula);
    options.response = pool.channel("y");
    options.parameters = std::move(parameters);
  }
  CurveFit fit() const { return fit_curve({&record, 1}, options); }
};

CurveParameter guess(const char* name, double value) {
  CurveParameter p;
  p.name = name;
  p.value = value;
  return p;
}

TEST(RegressCurve, a_linear_formula_is_linear_least_squares) {
  Curve curve(decay(300, 0.1), "p + q*x", {guess("p", -7), guess("q", 40)});
  curve.options.weight = parse(curve.pool, "1 + x^2");
  const CurveFit fit = curve.fit();
  const VectorXd root = (1 + Eigen::Map<const VectorXd>(curve.record["x"].data(), 300).array().square()).sqrt();
  Eigen::MatrixXd x(300, 2);
  x.col(0) = root;
  x.col(1) = root.array() * Eigen::Map<const VectorXd>(curve.record["x"].data(), 300).array();
  Statistic data({"p", "q"});
  data.add(x, (root.array() * Eigen::Map<const VectorXd>(curve.record["y"].data(), 300).array()).matrix());
  const Fit linear = least_squares(data);
  for (Index i = 0; i < 2; ++i) {
    const CurveParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    EXPECT_NEAR(p.value / linear.coefficients[i], 1, 1e-10);
    EXPECT_NEAR(p.std / linear.std[i], 1, 1e-10);
  }
  EXPECT_NEAR(fit.covariance(0, 1) / linear.covariance(0, 1), 1, 1e-9);
}

TEST(RegressCurve, many_rows_are_folded_in_blocks) {
  Curve whole(decay(5000, 0.05), "p*exp(-q*x)", {guess("p", 1), guess("q", 0.1)});
  const CurveFit fit = whole.fit();
  EXPECT_TRUE(fit.converged);
  EXPECT_NEAR(fit.parameters[0].value, 3, 4 * fit.parameters[0].std);
  EXPECT_NEAR(fit.parameters[1].value, 0.7, 4 * fit.parameters[1].std);
  const Record parts[] = {whole.record.slice(0, 1777), whole.record.slice(1777, 3223)};
  const CurveFit other = fit_curve(parts, whole.options);
  EXPECT_NEAR(other.parameters[1].value / fit.parameters[1].value, 1, 1e-9);
  EXPECT_NEAR(other.parameters[1].std / fit.parameters[1].std, 1, 1e-9);
}

TEST(RegressCurve, deviations_are_those_of_repeated_experiments) {
  VectorXd found(200);
  double claimed = 0;
  for (int draw = 0; draw < 200; ++draw) {
    Curve curve(decay(60, 0), "p*exp(-q*x)", {guess("p", 1), guess("q", 0.1)});
    Philox random(7, static_cast<std::uint64_t>(draw));
    Channel y = curve.record.channel("y");
    for (double& value : y.values) value += 0.1 * random.normal();
    curve.record = curve.record.with(y);
    const CurveFit fit = curve.fit();
    found[draw] = fit.parameters[1].value;
    claimed += fit.parameters[1].std / 200;
  }
  const double spread = std::sqrt((found.array() - found.mean()).square().sum() / 199);
  EXPECT_NEAR(claimed / spread, 1, 0.15);  // three deviations of a deviation of 200 draws
}

TEST(RegressCurve, a_bound_holds_and_the_others_are_fitted_beside_it) {
  Curve curve(decay(100, 0.01), "p*exp(-q*x)", {guess("p", 1), guess("q", 0.1)});
  curve.options.parameters[0].max = 2.5;
  const CurveFit fit = curve.fit();
  EXPECT_TRUE(fit.converged) << fit.stopped;
  EXPECT_EQ(fit.parameters[0].value, 2.5);
  EXPECT_TRUE(fit.parameters[0].at_bound);
  EXPECT_TRUE(std::isnan(fit.parameters[0].std));
  Curve held(decay(100, 0.01), "p*exp(-q*x)", {guess("q", 0.1)});
  held.options.values["p"] = 2.5;
  const CurveFit other = held.fit();
  EXPECT_NEAR(fit.parameters[1].value / other.parameters[0].value, 1, 1e-8);
  EXPECT_NEAR(fit.parameters[1].std / other.parameters[0].std, 1, 1e-8);
}

TEST(RegressCurve, what_the_data_do_not_tell_apart_is_said) {
  Curve curve(decay(100, 0.01), "p*exp(c - q*x)", {guess("p", 1), guess("q", 0.5), guess("c", 0.1)});
  const CurveFit fit = curve.fit();
  EXPECT_TRUE(fit.parameters[2].unexcited);
  EXPECT_FALSE(fit.parameters[0].unexcited);
  EXPECT_TRUE(std::isnan(fit.parameters[2].std));
  EXPECT_NEAR(fit.parameters[0].value * std::exp(fit.parameters[2].value), 3, 0.05);
}

TEST(RegressCurve, the_same_bits_each_time) {
  const Curve curve(decay(500, 0.05), "p*exp(-q*x)", {guess("p", 1), guess("q", 0.1)});
  const CurveFit one = curve.fit(), two = curve.fit();
  EXPECT_EQ(one.parameters[1].value, two.parameters[1].value);
  EXPECT_EQ(one.rss, two.rss);
}

TEST(RegressCurve, faults) {
  Curve curve(decay(50, 0), "p*exp(-q*x)", {guess("p", 1), guess("q", 0.1)});
  curve.options.parameters[0].min = 2;
  EXPECT_EQ(message([&] { curve.fit(); }), "fit_curve: parameter 'p': expected a first guess in 2..inf, got 1");
  curve.options.parameters.pop_back();
  curve.options.parameters[0].min = 0;
  EXPECT_EQ(message([&] { curve.fit(); }), "fit_curve: parameter 'q': expected either a first guess or a fixed value");
  curve.options.parameters.push_back(guess("d", 1));
  EXPECT_EQ(message([&] { curve.fit(); }), "fit_curve: parameter 'd' is not in the formula");
}

}  // namespace
