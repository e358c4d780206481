// Regressions on records: features as expressions, mass, known parts, windows, constraints, implicit parameters.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "message.hpp"
#include "regress/regress.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// A record whose motion is a sum of sines (exact y, v, a) and whose force obeys m a + f(y, v) = F; `noise` is added
/// to the force, as part of its rms.
template <class Force>
Record make_record(Index rows, double dt, double mass, Force f, double noise = 0, double amplitude = 2e-3,
                   std::vector<double> frequencies = {20, 30, 7.3}) {
  VectorXd y = VectorXd::Zero(rows), v = y, a = y, force(rows);
  for (Index i = 0; i < rows; ++i) {
    const double t = dt * static_cast<double>(i);
    for (const double hertz : frequencies) {
      const double w = 2 * M_PI * hertz;
      y[i] += amplitude * std::sin(w * t + hertz);
      v[i] += amplitude * w * std::cos(w * t + hertz);
      a[i] -= amplitude * w * w * std::sin(w * t + hertz);
    }
    force[i] = mass * a[i] + f(y[i], v[i]);
  }
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  const double level = noise * std::sqrt(force.squaredNorm() / static_cast<double>(rows));
  for (Index i = 0; i < rows; ++i) force[i] += level * normal(random);
  return Record("made.csv", 0, dt,
                {{"F", "N", "", "", force}, {"y", "m", "", "", y}, {"v", "m/s", "", "", v}, {"a", "m/s^2", "", "", a}});
}

Record duffing(double noise = 0, Index rows = 8000) {
  return make_record(
      rows, 1e-3, 1, [](double y, double v) { return 2e4 * y + 10 * v + 1e9 * y * y * y; }, noise);
}

struct Symbols {
  Pool pool;
  Expr y = pool.channel("y"), v = pool.channel("v");
  std::vector<Expr> library(int degree) {
    std::vector<Expr> out;
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j)
        if (i + j > 0) out.push_back(pow(y, i) * pow(v, j));
    return out;
  }
};

Regression run(const Record& record, const RegressOptions& options) { return regress(std::span(&record, 1), options); }

}  // namespace

TEST(RegressRecord, exact_data_give_the_exact_equation) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v, pow(s.y, 3)};
  options.mass = s.pool.constant(1);
  const Regression r = run(duffing(), options);
  EXPECT_NEAR(r.terms[0].coefficient / 2e4, 1, 1e-11);  // the mass times a is 2 orders above the damping force
  EXPECT_NEAR(r.terms[1].coefficient / 10, 1, 1e-11);
  EXPECT_NEAR(r.terms[2].coefficient / 1e9, 1, 1e-11);
  EXPECT_NEAR(r.r2, 1, 1e-14);
  EXPECT_EQ(r.mode, "equation error, train");
  EXPECT_EQ(r.windows, std::vector<std::string>{"made.csv, 0 to 7.999 s, 8000 rows"});
  EXPECT_TRUE(r.warnings.empty());
}

TEST(RegressRecord, mass_is_a_feature_where_it_is_unknown) {
  Symbols s;
  RegressOptions options;
  options.features = {s.pool.channel("a"), s.y, s.v, pow(s.y, 3)};
  const Regression r = run(duffing(), options);
  EXPECT_NEAR(r.terms[0].coefficient, 1, 1e-11);
  EXPECT_NEAR(r.terms[2].coefficient / 10, 1, 1e-10);
}

TEST(RegressRecord, known_part_moves_to_the_left_and_returns_in_the_restoring_force) {
  Symbols s;
  RegressOptions options;
  options.features = {s.v, pow(s.y, 3)};
  options.mass = s.pool.parameter("m");
  options.known = s.pool.parameter("k") * s.y;
  options.values = {{"m", 1}, {"k", 2e4}};
  const Regression r = run(duffing(), options);
  EXPECT_NEAR(r.terms[1].coefficient / 1e9, 1, 1e-10);
  const Expr expected = options.known + r.terms[0].coefficient * s.v + r.terms[1].coefficient * pow(s.y, 3);
  EXPECT_EQ(to_text(r.restoring), to_text(expected));
}

TEST(RegressRecord, sparse_solvers_find_the_three_terms_among_twenty) {
  Symbols s;
  RegressOptions options;
  options.features = s.library(5);
  options.mass = s.pool.constant(1);
  options.solver = StlsqOptions{.threshold = 0.015};  // the damping force is 3 % of the whole
  const Regression r = run(duffing(0.03), options);
  for (const Term& term : r.terms) {
    const bool truth = term.feature == s.y || term.feature == s.v || term.feature == pow(s.y, 3);
    EXPECT_EQ(term.coefficient != 0, truth) << to_text(term.feature);
    if (!truth) continue;
    // White noise: the two estimates of the deviation agree to a chi distribution of 7 degrees (27 %), 4 of them.
    EXPECT_NEAR(std::log(term.block_std / term.std), 0, 1.1) << to_text(term.feature);
  }
}

TEST(RegressRecord, the_bits_do_not_depend_on_the_threads) {
  Symbols s;
  RegressOptions options;
  options.features = s.library(3);
  options.mass = s.pool.constant(1);
  options.solver = LassoOptions{};
  const Record record = duffing(0.05, 20000);
  options.threads = 1;
  const Regression one = run(record, options);
  for (const int threads : {2, 3, 8}) {
    options.threads = threads;
    const Regression more = run(record, options);
    for (std::size_t j = 0; j < one.terms.size(); ++j) EXPECT_EQ(one.terms[j].coefficient, more.terms[j].coefficient);
  }
  EXPECT_EQ(one.path.size(), 100u);
}

TEST(RegressRecord, windows_side_by_side_are_one_regression) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v, pow(s.y, 3)};
  options.mass = s.pool.constant(1);
  const Record whole = duffing(0.05);
  const std::vector<Record> parts = {whole.slice(5000, 3000), whole.slice(0, 5000)};
  const Regression joined = regress(parts, options), one = run(whole, options);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_NEAR(joined.terms[j].coefficient / one.terms[j].coefficient, 1, 1e-12);
    EXPECT_NEAR(joined.terms[j].std / one.terms[j].std, 1, 1e-12);
  }
  EXPECT_EQ(joined.windows[0], "made.csv, 5 to 7.999 s, 3000 rows");
}

TEST(RegressRecord, constraints_name_features) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v, pow(s.y, 3), pow(s.y, 5)};
  options.mass = s.pool.constant(1);
  options.constraints = {at_least(s.y, 0), fixed(s.v, 11), between(pow(s.y, 3), 0, 9e8),
                         at_most(pow(s.y, 5), pow(s.y, 3))};
  const Regression r = run(duffing(0.02), options);
  EXPECT_EQ(r.terms[1].coefficient, 11);
  EXPECT_EQ(r.terms[1].std, 0);
  EXPECT_LE(r.terms[2].coefficient, 9e8 * (1 + 1e-12));
  EXPECT_LE(r.terms[3].coefficient, r.terms[2].coefficient * (1 + 1e-12));
  ASSERT_GE(r.fit.active.size(), 2u);
  EXPECT_EQ(r.fit.active[0].text, "v = 11");
}

TEST(RegressRecord, time_and_piecewise_features_are_features) {
  Symbols s;
  RegressOptions options;
  options.features = {parse(s.pool, "sign(v)"), parse(s.pool, "where(y > 0, y, 0)"), parse(s.pool, "cos(t)"),
                      parse(s.pool, "1")};
  const Record record = make_record(
      4000, 1e-3, 0, [](double y, double v) { return 3 * (v > 0 ? 1.0 : -1.0) + 500 * std::max(y, 0.0) + 0.25; });
  const Regression r = run(record, options);
  EXPECT_NEAR(r.terms[0].coefficient, 3, 1e-12);
  EXPECT_NEAR(r.terms[1].coefficient, 500, 1e-9);
  EXPECT_NEAR(r.terms[2].coefficient, 0, 1e-12);
  EXPECT_NEAR(r.terms[3].coefficient, 0.25, 1e-12);
}

TEST(RegressRecord, one_frequency_is_said_to_hide_mass_behind_stiffness) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v};
  options.mass = s.pool.constant(1);
  const Record record =
      make_record(4000, 1e-3, 1, [](double y, double v) { return 2e4 * y + 10 * v; }, 0.01, 2e-3, {33.1});
  const Regression r = run(record, options);
  ASSERT_EQ(r.warnings.size(), 1u);
  EXPECT_EQ(r.warnings[0],
            "on these data a = -4.325e+04*y (R2 1): one frequency, so that an error of the mass appears in "
            "the coefficient of y");
  options.features = {s.pool.channel("a"), s.y, s.v};
  options.mass = Expr();
  const Regression both = run(record, options);
  ASSERT_EQ(both.fit.unexcited.size(), 1u);
  EXPECT_EQ(both.fit.features[static_cast<std::size_t>(both.fit.unexcited[0].feature)], "y");
}

TEST(RegressImplicit, finds_the_slope_of_a_tanh_and_its_deviation) {
  Symbols s;
  const Expr p = s.pool.parameter("p");
  RegressOptions options;
  options.features = {s.v, s.pool.apply(Op::tanh, {p * s.y})};
  options.mass = s.pool.constant(1);
  options.implicit = {{"p", 100, 1, 5000}};
  const auto force = [](double y, double v) { return 20 * v + 300 * std::tanh(800 * y); };
  const Regression exact = run(make_record(4000, 1e-3, 1, force), options);
  EXPECT_NEAR(exact.implicit[0].value / 800, 1, 1e-6);  // the search stops at 1e-8 of the bounds' range
  EXPECT_NEAR(exact.terms[1].coefficient / 300, 1, 1e-6);
  const Regression noisy = run(make_record(4000, 1e-3, 1, force, 0.05), options);
  EXPECT_GT(noisy.implicit[0].std, 0);
  EXPECT_LT(std::abs(noisy.implicit[0].value - 800), 4 * noisy.implicit[0].std);
  EXPECT_LT(noisy.implicit[0].std, 80);
  EXPECT_EQ(symbols(noisy.restoring, SymbolKind::parameter).size(), 0u);
}

TEST(RegressErrors, full_texts) {
  Symbols s;
  const Record record = duffing(0, 100);
  RegressOptions options;
  const auto text = [&] { return message([&] { run(record, options); }); };
  EXPECT_EQ(text(), "regress: features: expected at least one");
  options.features = {s.y, s.v};
  options.blocks = 0;
  EXPECT_EQ(text(), "regress: blocks: expected 1 to 1000, got 0");
  options.blocks = 8;
  options.solver = LassoOptions{.lambda = -1};
  EXPECT_EQ(text(), "lasso: lambda: expected > 0, got -1");
  options.solver = LeastSquaresOptions{};
  options.constraints = {at_least(pow(s.y, 3), 0)};
  options.constraints[0].where = {"study.lua", 12, 0};
  EXPECT_EQ(text(), "study.lua:12: constraint: 'y^3' is not among the features");
  options.constraints.clear();
  options.mass = s.pool.parameter("m");
  EXPECT_EQ(text(),
            "regress: parameter 'm' in the mass or the known part has no value: give one, or fit it as the coefficient "
            "of a feature (for a mass: mass 0 and the feature a)");
  options.mass = s.pool.constant(1);
  options.features = {s.y, parse(s.pool, "tanh(p*y)")};
  EXPECT_EQ(text(),
            "regress: parameter 'p' in feature 'tanh(p*y)' has no value: fix it, or give it min and max to have "
            "it searched for");
  options.implicit = {{"p", 5, 10, 1}};
  EXPECT_EQ(text(), "regress: implicit parameter 'p': expected finite bounds min < max, got 10 and 1");
  options.implicit = {{"p", 5, 10, 20}};
  EXPECT_EQ(text(), "regress: implicit parameter 'p': expected a first guess in 10..20, got 5");
  options.implicit.clear();
  options.features = {s.y, s.pool.state("z")};
  EXPECT_EQ(text(), "state 'z' is not measured: a regression knows channels only, fit such a model on its trajectory");
  options.features = {s.y, parse(s.pool, "log(y)")};
  EXPECT_EQ(text().substr(0, 43), "feature 'log(y)' is not a number at t = 0.0");
  options.features = {s.y, s.y};
  EXPECT_EQ(text(), "feature 'y' is given twice");
}
