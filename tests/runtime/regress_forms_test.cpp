// Regressions that look at the data in another way: weak form, robust, total, groups, passivity, lags, units.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "message.hpp"
#include "regress/lag.hpp"
#include "regress/regress.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// A motion of three frequencies (exact y, v, a) and the force of m a + f(y, v) = F.
template <class Force>
Record made(Index rows, double dt, double mass, Force f) {
  VectorXd y = VectorXd::Zero(rows), v = y, a = y, force(rows);
  for (Index i = 0; i < rows; ++i) {
    const double t = dt * static_cast<double>(i);
    for (const double hertz : {20.0, 31.0, 7.3}) {
      const double w = 2 * M_PI * hertz;
      y[i] += 2e-3 * std::sin(w * t + hertz);
      v[i] += 2e-3 * w * std::cos(w * t + hertz);
      a[i] -= 2e-3 * w * w * std::sin(w * t + hertz);
    }
    force[i] = mass * a[i] + f(y[i], v[i]);
  }
  return Record("made.csv", 0, dt,
                {{"F", "N", "", "", force}, {"y", "m", "", "", y}, {"v", "m/s", "", "", v}, {"a", "m/s^2", "", "", a}});
}

/// Only F and y, with noise as part of their rms; v and a derived from them as a reader does.
Record measured(const Record& record, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Channel> channels;
  for (const char* name : {"F", "y"}) {
    Channel c = record.channel(name);
    const double level = noise * std::sqrt(c.values.squaredNorm() / static_cast<double>(c.values.size()));
    for (Index i = 0; i < c.values.size(); ++i) c.values[i] += level * normal(random);
    c.noise = level;
    channels.push_back(c);
  }
  return derive_motion(Record("measured.csv", 0, record.dt(), channels));
}

double duffing(double y, double v) { return 2e4 * y + 10 * v + 1e9 * y * y * y; }

struct Symbols {
  Pool pool;
  Expr y = pool.channel("y"), v = pool.channel("v");
};

Regression run(const Record& record, const RegressOptions& options) { return regress(std::span(&record, 1), options); }

}  // namespace

TEST(RegressWeak, exact_data_give_the_equation_to_the_rule_of_integration) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v, pow(s.y, 3)};
  options.mass = s.pool.constant(1);
  options.weak = WeakForm{.order = 10};
  const Record record = made(8000, 1e-3, 1, duffing);
  const Regression r = run(record, options);
  EXPECT_NEAR(r.terms[0].coefficient / 2e4, 1, 1e-6);
  EXPECT_NEAR(r.terms[1].coefficient / 10, 1, 1e-4);
  EXPECT_NEAR(r.terms[2].coefficient / 1e9, 1, 1e-6);
  EXPECT_EQ(r.form.substr(0, 9), "weak form");
}

TEST(RegressWeak, needs_no_derivative_of_noisy_data) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v, pow(s.y, 3)};
  options.mass = s.pool.constant(1);
  const Record clean = made(16000, 5e-4, 1, duffing);
  double weak = 0, strong = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Record record = measured(clean, 0.02, seed);
    options.weak = WeakForm{};
    const Regression r = run(record, options);
    EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
    EXPECT_NEAR(r.terms[0].coefficient / 2e4, 1, 0.03) << "seed " << seed;
    EXPECT_NEAR(r.terms[1].coefficient / 10, 1, 0.3) << "seed " << seed;
    EXPECT_NEAR(r.terms[2].coefficient / 1e9, 1, 0.03) << "seed " << seed;
    weak += std::abs(r.terms[2].coefficient / 1e9 - 1);
    options.weak.reset();
    strong += std::abs(run(record, options).terms[2].coefficient / 1e9 - 1);
  }
  EXPECT_LT(weak, strong);
}

TEST(RegressWeak, says_what_it_cannot_free_of_derivatives_and_what_it_refuses) {
  Symbols s;
  RegressOptions options;
  const Record record = measured(made(4000, 1e-3, 1, duffing), 0.01, 1);
  options.features = {s.y, s.v, pow(s.v, 3)};
  options.mass = s.pool.constant(1);
  options.weak = WeakForm{};
  const Regression r = run(record, options);
  ASSERT_FALSE(r.warnings.empty());
  EXPECT_EQ(
      r.warnings.back(),
      "weak form: the feature 'v^3' holds v, which was derived from the data: it is not free of their derivative");
  const auto text = [&] { return message([&] { run(record, options); }); };
  options.solver = HuberOptions{};
  EXPECT_EQ(text(),
            "huber: needs the rows of the record, the weak form has integrals: take another solver, or leave weak_form "
            "out");
  options.solver = LeastSquaresOptions{};
  options.mass = s.y + 1.0;
  EXPECT_EQ(text(), "weak_form: expected a mass that is a number, 'y + 1' depends on y");
  options.mass = s.pool.constant(1);
  options.weak->half_width = 3;
  EXPECT_EQ(text(),
            "weak_form: a block of measured.csv lasts 4 s, a test function 6 s: take fewer blocks or a smaller "
            "half_width");
  options.weak->half_width = -1;
  EXPECT_EQ(text(), "weak_form: half_width: expected >= 0, got -1");
}

TEST(RegressHuber, outliers_are_named_and_do_not_move_the_answer) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v, pow(s.y, 3)};
  options.mass = s.pool.constant(1);
  Record record = made(6000, 1e-3, 1, duffing);
  Channel force = record.channel("F");
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  for (Index i = 0; i < 6000; ++i) force.values[i] += normal(random);
  const std::vector<Index> bad = {700, 701, 702, 2500, 2501, 4000};
  for (const Index i : bad) force.values[i] += 2000;
  record = record.with(force);
  const Regression plain = run(record, options);
  options.solver = HuberOptions{.outlier = 6};
  const Regression robust = run(record, options);
  EXPECT_TRUE(robust.fit.summary.converged) << robust.fit.summary.stopped;
  for (std::size_t j = 0; j < 3; ++j) {
    const double truth = std::vector<double>{2e4, 10, 1e9}[j];
    EXPECT_LT(std::abs(robust.terms[j].coefficient - truth), 4 * robust.terms[j].std);
    EXPECT_LT(robust.terms[j].std, 0.2 * plain.terms[j].std);
  }
  EXPECT_NEAR(robust.fit.residual_std, 1, 0.05);
  ASSERT_EQ(robust.outliers.count, 6);
  for (const Outlier& o : robust.outliers.largest) {
    EXPECT_NE(std::find(bad.begin(), bad.end(), o.row), bad.end());
    EXPECT_NEAR(o.time, 1e-3 * static_cast<double>(o.row), 1e-12);
    EXPECT_GT(o.size, 1000);
  }
  options.constraints = {at_most(s.v, 5)};
  EXPECT_NEAR(run(record, options).terms[1].coefficient, 5, 1e-10);
  options.threads = 1;
  const Regression one = run(record, options);
  options.threads = 3;
  EXPECT_EQ(one.terms[0].coefficient, run(record, options).terms[0].coefficient);
}

TEST(RegressHuber, meets_the_estimating_equations) {
  // sum psi(r/s) x = 0 and sum psi^2 = (n - p) E psi^2, from the rows themselves.
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v};
  Record record = made(500, 1e-3, 0, [](double y, double v) { return 2e4 * y + 10 * v; });
  Channel force = record.channel("F");
  std::mt19937 random(8);
  std::student_t_distribution<double> heavy(2);
  for (Index i = 0; i < 500; ++i) force.values[i] += heavy(random);
  record = record.with(force);
  options.solver = HuberOptions{};
  const Regression r = run(record, options);
  const double c = 1.345, scale = r.fit.residual_std;
  double square = 0, on_y = 0, on_v = 0, size_y = 0, size_v = 0;
  for (Index i = 0; i < 500; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double y = record["y"][k], v = record["v"][k];
    const double u = (record["F"][k] - r.terms[0].coefficient * y - r.terms[1].coefficient * v) / scale;
    const double psi = std::clamp(u, -c, c);
    square += psi * psi;
    on_y += psi * y, on_v += psi * v, size_y += std::abs(y), size_v += std::abs(v);
  }
  const double expected = std::erf(c / std::sqrt(2)) - 2 * c * std::exp(-c * c / 2) / std::sqrt(2 * M_PI) +
                          c * c * (1 - std::erf(c / std::sqrt(2)));
  EXPECT_NEAR(square / (498 * expected), 1, 1e-5);
  EXPECT_LT(std::abs(on_y), 1e-5 * size_y);
  EXPECT_LT(std::abs(on_v), 1e-5 * size_v);
}

TEST(RegressTotal, noise_of_the_channels_is_carried_to_the_features) {
  // y is measured with noise: least squares is low by var(noise) / var(y) = 1/(1 + 25), total least squares is not.
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v};
  Record record = made(20000, 1e-3, 0, [](double y, double v) { return 2e4 * y + 10 * v; });
  Channel y = record.channel("y"), force = record.channel("F");
  const double level = 0.2 * std::sqrt(y.values.squaredNorm() / 20000);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (Index i = 0; i < 20000; ++i) {
    y.values[i] += level * normal(random);
    force.values[i] += 0.5 * normal(random);
  }
  record = record.with(y).with(force);
  EXPECT_NEAR(run(record, options).terms[0].coefficient / 2e4, 1 / 1.04, 0.01);
  options.solver = TotalOptions{{{"y", level}, {"F", 0.5}}};
  const Regression r = run(record, options);
  EXPECT_LT(std::abs(r.terms[0].coefficient - 2e4), 4 * r.terms[0].std);
  EXPECT_LT(r.terms[0].std, 100);
  EXPECT_GT(r.terms[0].block_std, 0);
  options.solver = TotalOptions{{{"x", 1}}};
  EXPECT_EQ(message([&] { run(record, options); }), "total_least_squares: noise: the channel 'x' is in no feature");
  options.solver = TotalOptions{};
  EXPECT_EQ(message([&] { run(made(500, 1e-3, 1, duffing), options); }),
            "total_least_squares: no channel of the features has noise: give it, noise = { y = ... }, or take "
            "least_squares");
}

TEST(RegressGroups, the_best_choice_is_that_of_trying_each) {
  Symbols s;
  RegressOptions options;
  const Expr tanh = parse(s.pool, "tanh(400*y)");
  options.features = {s.y, s.v, pow(s.y, 3), pow(s.y, 5), tanh};
  options.mass = s.pool.constant(1);
  options.groups = {{{pow(s.y, 3), pow(s.y, 5), tanh}, 1, {"study.lua", 9, 0}}};
  const Record record = measured(made(4000, 1e-3, 1, duffing), 0, 1);
  const Regression r = run(record, options);
  double least = 1e300;
  for (const Expr& only : options.groups[0].features) {
    RegressOptions one = options;
    one.groups.clear();
    one.features = {s.y, s.v, only};
    least = std::min(least, run(record, one).rmse);
  }
  EXPECT_NEAR(r.rmse / least, 1, 1e-10);
  EXPECT_NE(r.terms[2].coefficient, 0);
  EXPECT_EQ(r.terms[3].coefficient, 0);
  EXPECT_EQ(r.terms[4].coefficient, 0);
  EXPECT_EQ(r.fit.summary.solver, "least squares, best of 3 choices of the groups");
  options.constraints = {at_least(pow(s.y, 3), 1), at_least(pow(s.y, 5), 1)};
  options.constraints[1].where = {"study.lua", 7, 0};
  EXPECT_EQ(message([&] { run(record, options); }),
            "study.lua:9: constraint 'y^5 = 0' contradicts 'y^5 >= 1' (study.lua:7)");
  options.groups[0].features.push_back(s.pool.channel("a"));
  EXPECT_EQ(message([&] { run(record, options); }), "study.lua:9: group: 'a' is not among the features");
}

TEST(RegressPassivity, is_imposed_on_the_grid_and_looked_at_between) {
  // A force that creates energy at small amplitudes (van der Pol): plain least squares finds it, the passive fit
  // cannot.
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v, pow(s.y, 2) * s.v};
  options.mass = s.pool.constant(1);
  const Record record = made(4000, 1e-3, 1, [](double y, double v) { return 2e4 * y - 4 * v + 2e6 * y * y * v; });
  options.passive = PassiveOptions{.impose = false};
  const Regression free = run(record, options);
  ASSERT_TRUE(free.passivity);
  EXPECT_NEAR(free.terms[1].coefficient, -4, 1e-8);
  EXPECT_LT(free.passivity->least_power, -0.5);
  options.passive = PassiveOptions{};
  const Regression passive = run(record, options);
  EXPECT_GE(passive.passivity->least_power, 0.1 * free.passivity->least_power);  // between the points of the grid
  EXPECT_NEAR(passive.terms[1].coefficient, 0, 0.1);
  options.passive->points_y = 80;
  EXPECT_GE(run(record, options).passivity->least_power, 0.2 * passive.passivity->least_power);
  options.passive->points_y = 9;
  EXPECT_FALSE(passive.fit.active.empty());
  EXPECT_EQ(passive.fit.active.front().text.substr(0, 24), "no energy created at y =");
  EXPECT_LE(passive.fit.summary.kkt, 1e-10);
  options.features.push_back(parse(s.pool, "sin(t)"));
  options.passive->where = {"study.lua", 11, 0};
  EXPECT_EQ(
      message([&] { run(record, options); }),
      "study.lua:11: passive: 'sin(t)' depends on t: passivity is looked at over displacement and velocity alone");
}

TEST(RegressLags, are_the_rows_before) {
  // A sampled recursion with known coefficients: F(k) = 0.5 F(k-1) + 3 y(k-2).
  Symbols s;
  Record record = made(500, 1e-3, 0, [](double, double) { return 0.0; });
  Channel force = record.channel("F");
  for (Index k = 2; k < 500; ++k)
    force.values[k] = 0.5 * force.values[k - 1] + 3 * record["y"][static_cast<std::size_t>(k - 2)];
  record = record.with(force);
  RegressOptions options;
  options.features = {lag(s.pool.channel("F"), 1), lag(s.y, 2), lag(s.y, 1)};
  const Regression r = run(record, options);
  EXPECT_NEAR(r.terms[0].coefficient, 0.5, 1e-10);
  EXPECT_NEAR(r.terms[1].coefficient, 3, 1e-9);
  EXPECT_NEAR(r.terms[2].coefficient, 0, 1e-9);
  EXPECT_EQ(r.fit.rows, 498);
  EXPECT_EQ(to_text(options.features[1]), "y_lag2");
  EXPECT_EQ(message([&] { lag(s.y * 2.0, 1); }), "lag: expected a signal, such as lunid.displacement, got 'y*2'");
  EXPECT_EQ(message([&] { lag(s.y, 0); }), "lag: samples: expected >= 1, got 0");
  options.features = {lag(s.y, 600)};
  EXPECT_EQ(message([&] { run(record, options); }), "made.csv: the largest lag is 600 rows, the record has 500");
}

TEST(RegressUnits, of_coefficients_and_of_records) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y,
                      s.v,
                      pow(s.y, 3),
                      parse(s.pool, "sign(v)"),
                      parse(s.pool, "max(y - 0.001, 0)"),
                      parse(s.pool, "tanh(80*y)"),
                      parse(s.pool, "sqrt(abs(v))"),
                      parse(s.pool, "y*v")};
  const Record record = made(500, 1e-3, 1, duffing);
  const std::vector<std::string> expected = {"N/m", "N s/m", "N/m^3", "N", "N/m", "N", "N s^0.5/m^0.5", "N s/m^2"};
  const Regression r = run(record, options);
  for (std::size_t j = 0; j < expected.size(); ++j) EXPECT_EQ(r.terms[j].unit, expected[j]);
  Channel y = record.channel("y");
  y.unit = "rad";
  const std::vector<Record> two = {record, record.with(y)};
  EXPECT_EQ(message([&] { regress(two, options); }),
            "regress: 'y' is in m in made.csv and in rad in made.csv: regress them one by one, or mend the units where "
            "they are read");
}

TEST(RegressIntervals, come_from_blocks_or_from_the_bootstrap) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y, s.v, pow(s.y, 3)};
  options.mass = s.pool.constant(1);
  options.blocks = 30;
  const Record record = measured(made(6000, 1e-3, 1, duffing), 0.02, 2);
  const Regression left_out = run(record, options);
  EXPECT_EQ(left_out.interval, "95 %, 30 blocks left out in turn");
  options.bootstrap = 1000;
  const Regression drawn = run(record, options);
  EXPECT_EQ(drawn.interval, "95 %, 1000 replicates of 30 blocks");
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_LT(drawn.terms[j].lower, drawn.terms[j].coefficient);
    EXPECT_GT(drawn.terms[j].upper, drawn.terms[j].coefficient);
    EXPECT_NEAR(std::log(drawn.terms[j].block_std / left_out.terms[j].block_std), 0, 0.3);
  }
  options.bootstrap = 10;
  EXPECT_EQ(message([&] { run(record, options); }),
            "regress: bootstrap: expected 20 replicates or more (or 0), got 10");
}

TEST(RegressWarnings, name_the_places_of_features_that_are_one) {
  Symbols s;
  RegressOptions options;
  options.features = {s.y, 2.0 * s.y + s.v, s.v};
  options.places = {{"study.lua", 4, 0}, {"study.lua", 5, 0}, {"study.lua", 6, 0}};
  const Regression r = run(made(500, 1e-3, 1, duffing), options);
  ASSERT_EQ(r.warnings.size(), 1u);
  EXPECT_EQ(
      r.warnings[0],
      "on these data v = -2*y + 1*(2*y + v) (v at study.lua:6, y at study.lua:4, 2*y + v at study.lua:5): they cannot "
      "be told apart, 'v' is left at 0");
}

TEST(RegressMemory, does_not_grow_with_the_rows) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps what was freed";
#endif
  // The peak of the resident memory over a regression, beyond what was resident before it.
  const auto field = [](const char* name) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
      if (word == name) return status >> word, std::stol(word);
    return -1L;
  };
  Symbols s;
  RegressOptions options;
  for (int i = 0; i <= 5; ++i)
    for (int j = 0; i + j <= 5; ++j) options.features.push_back(pow(s.y, i) * pow(s.v, j));
  options.features[0] = s.pool.constant(1);
  const Record record = made(400000, 1e-4, 1, duffing);
  const auto growth = [&](Index rows) {
    const Record part = record.slice(0, rows);
    if (!(std::ofstream("/proc/self/clear_refs") << "5")) return -1L;
    const long before = field("VmRSS:");
    run(part, options);
    return field("VmHWM:") - before;
  };
  growth(20000);  // threads and allocator arenas are made once
  const long small = growth(20000), large = growth(400000);
  if (small < 0 || large < 0) GTEST_SKIP() << "no /proc/self/clear_refs on this machine";
  EXPECT_LT(large, small + 2000);  // [kB]; the columns of 400000 rows would be 70 MB
}
