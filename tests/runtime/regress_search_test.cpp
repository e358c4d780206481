// Searches for parameters inside features: every method on a function with many minima and on a record; the same bits
// from the same seed; no exception crosses NLopt; the penalty on the mean force.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "message.hpp"
#include "record/random.hpp"
#include "regress/minimise.hpp"
#include "regress/regress.hpp"

using namespace lunid;
using Eigen::VectorXd;

namespace {

constexpr double kDeep[] = {0.71, 0.27};  // the least minimum, of value 0

/// Rastrigin's function, its 25 minima in the unit square (Rastrigin 1974).
double rastrigin(const double* x, double* gradient) {
  double sum = 0;
  for (int i = 0; i < 2; ++i) {
    const double at = 5 * (x[i] - kDeep[i]), w = 2 * std::numbers::pi;
    sum += at * at + 3 * (1 - std::cos(w * at));
    if (gradient) gradient[i] = 5 * (2 * at + 3 * w * std::sin(w * at));
  }
  return sum;
}

detail::Objective many_minima(int& calls) {
  detail::Objective objective;
  objective.size = 2;
  objective.value = [&calls](const double* x, double* gradient) { return ++calls, rastrigin(x, gradient); };
  objective.part = [&calls](const double* x, double* gradient, int) { return ++calls, rastrigin(x, gradient); };
  return objective;
}

class Search : public testing::TestWithParam<std::string> {
 protected:
  SearchOptions options() const {
    SearchOptions options;
    options.method = search_method(GetParam());
    options.evaluations = 2000;
    options.starts = 60;
    options.seed = 5;
    return options;
  }
};

TEST_P(Search, finds_the_deepest_of_many_minima) {
  // The stochastic gradient follows the slope from one start: it gets one in the right valley.
  const bool local = GetParam() == "stochastic_gradient";
  int calls = 0;
  const detail::Minimum found = minimise(many_minima(calls), {local ? 0.68 : 0.1, local ? 0.3 : 0.9}, options());
  EXPECT_NEAR(found.x[0], kDeep[0], 1e-5);
  EXPECT_NEAR(found.x[1], kDeep[1], 1e-5);
  EXPECT_LE(calls, 60 * 200);
}

TEST_P(Search, the_same_bits_from_the_same_seed) {
  int first = 0, second = 0;
  const detail::Minimum one = minimise(many_minima(first), {0.3, 0.6}, options());
  const detail::Minimum two = minimise(many_minima(second), {0.3, 0.6}, options());
  EXPECT_EQ(one.x, two.x);
  EXPECT_EQ(first, second);
}

TEST_P(Search, an_exception_comes_back_after_the_library) {
  int calls = 0;
  detail::Objective objective = many_minima(calls);
  const auto value = objective.value;
  objective.value = [&](const double* x, double* gradient) {
    if (calls == 7) throw std::runtime_error("the seventh");
    return value(x, gradient);
  };
  objective.part = [&](const double* x, double* gradient, int) { return objective.value(x, gradient); };
  EXPECT_THROW(minimise(objective, {0.3, 0.6}, options()), std::runtime_error);
}

INSTANTIATE_TEST_SUITE_P(Regress, Search, testing::ValuesIn(search_methods()),
                         [](const auto& info) { return info.param; });

TEST(RegressSearch, faults) {
  EXPECT_EQ(message([] { search_method("annealling"); }), "search: no method 'annealling', did you mean 'annealing'?");
  EXPECT_EQ(message([] { validate(SearchOptions{.starts = 0}); }), "search: starts: expected >= 1, got 0");
  EXPECT_EQ(message([] { validate(SearchOptions{.evaluations = 9}); }), "search: evaluations: expected >= 10, got 9");
}

/// F = 10 v + 20 cos(900 y) + shift along two tones.
Record two_tones(double shift) {
  std::vector<Channel> channels(3);
  for (std::size_t i = 0; i < 3; ++i) {
    channels[i].name = std::string(1, "yvF"[i]);
    channels[i].values.resize(800);
  }
  Philox random(3, 0);
  for (int i = 0; i < 800; ++i) {
    const double t = 1.25e-3 * i, y = 8e-3 * std::sin(120 * t) + 3e-3 * std::sin(204 * t + 1);
    const double v = 0.96 * std::cos(120 * t) + 0.612 * std::cos(204 * t + 1);
    channels[0].values[i] = y;
    channels[1].values[i] = v;
    channels[2].values[i] = 10 * v + 20 * std::cos(900 * y) + shift + 0.5 * random.normal();
  }
  return Record("two tones", 0, 1.25e-3, std::move(channels));
}

TEST(RegressSearch, a_global_method_finds_what_a_descent_misses) {
  Pool pool;
  const Record record = two_tones(0);
  RegressOptions options;
  options.features = {pool.channel("v"), parse(pool, "cos(q*y)")};
  ImplicitParameter q;
  q.name = "q";
  q.value = 1900;
  q.min = 1;
  q.max = 2000;
  options.implicit = {q};
  options.search.starts = 1;
  const Regression local = regress({&record, 1}, options);
  EXPECT_GT(local.rmse, 2);
  for (const SearchMethod method : {SearchMethod::mlsl, SearchMethod::particle_swarm, SearchMethod::puddle_jumping}) {
    options.search.method = method;
    options.search.evaluations = 200;
    const Regression found = regress({&record, 1}, options);
    EXPECT_NEAR(found.implicit[0].value, 900, 4 * found.implicit[0].std) << to_text(method);
    EXPECT_NEAR(found.rmse, 0.5, 0.05) << to_text(method);
    EXPECT_NE(found.fit.summary.solver.find("around " + to_text(method) + " on 1 implicit"), std::string::npos);
  }
}

/// Mean residual of a regression over all rows.
double mean_residual(const Record& record, const Regression& found) {
  double sum = 0;
  for (Eigen::Index i = 0; i < record.rows(); ++i)
    sum += record["F"][static_cast<std::size_t>(i)] -
           found.terms[0].coefficient * record["y"][static_cast<std::size_t>(i)] -
           found.terms[1].coefficient * std::pow(record["y"][static_cast<std::size_t>(i)], 2);
  return sum / static_cast<double>(record.rows());
}

TEST(RegressObjective, a_penalty_on_the_mean_force_keeps_it_from_shifting) {
  Pool pool;
  const Record record = two_tones(5);  // no constant among the features: y^2 must carry the shift
  RegressOptions options;
  options.features = {pool.channel("y"), pow(pool.channel("y"), 2)};
  options.blocks = 1;
  const Regression plain = regress({&record, 1}, options);
  options.objective.mean_force = 0.25;
  const Regression quarter = regress({&record, 1}, options);
  options.objective.mean_force = 0.999;
  const Regression nearly = regress({&record, 1}, options);
  const double before = std::abs(mean_residual(record, plain)), after = std::abs(mean_residual(record, quarter));
  EXPECT_GT(before, 1e-3);
  EXPECT_LT(after, before);
  EXPECT_LT(std::abs(mean_residual(record, nearly)), 0.02 * before);
  EXPECT_GT(quarter.rmse, plain.rmse);
  // Brute force: no change of the two coefficients lowers what is minimised.
  const auto cost = [&](Regression r, double a, double b) {
    r.terms[0].coefficient *= 1 + a;
    r.terms[1].coefficient *= 1 + b;
    double squares = 0;
    for (std::size_t i = 0; i < 800; ++i)
      squares += std::pow(record["F"][i] - r.terms[0].coefficient * record["y"][i] -
                              r.terms[1].coefficient * std::pow(record["y"][i], 2),
                          2);
    return 0.75 * squares / 800 + 0.25 * std::pow(mean_residual(record, r), 2);
  };
  const double least = cost(quarter, 0, 0);
  EXPECT_NEAR(quarter.rmse, std::sqrt((least - 0.25 * after * after) / 0.75), 1e-9);
  for (const double step : {-1e-3, 1e-3}) {
    EXPECT_GT(cost(quarter, step, 0), least);
    EXPECT_GT(cost(quarter, 0, step), least);
  }
  options.objective.mean_force = 1;
  EXPECT_EQ(message([&] {
              regress({&record, 1}, options);
            }),
            "regress: objective: mean_force: expected >= 0 and < 1, got 1");
}

}  // namespace
