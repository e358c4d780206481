// History models: exact poles of a linear oscillator, coloured noise, known nonlinear models, predictions and tests.
#include <gtest/gtest.h>

#include <cmath>

#include "message.hpp"
#include "record/random.hpp"
#include "regress/history.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kMass = 2, kDamping = 3, kStiffness = 800, kDt = 0.01;

Record record_of(const VectorXd& y, const VectorXd& u, Interpolation between, double dt = kDt) {
  std::vector<Channel> channels(2);
  channels[0].name = "y";
  channels[0].values = y;
  channels[1].name = "F";
  channels[1].values = u;
  channels[1].between = between;
  return Record("made", 0, dt, std::move(channels));
}

VectorXd white(Index rows, std::uint64_t stream) {
  Philox random(11, stream);
  VectorXd out(rows);
  for (double& x : out) x = random.normal();
  return out;
}

/// The oscillator under a sampled force, by 200 classical Runge-Kutta steps a sample: nothing that the model knows of.
VectorXd oscillator(const VectorXd& force, bool straight) {
  VectorXd out(force.size());
  double y = 0, v = 0;
  const int parts = 200;
  const double h = kDt / parts;
  for (Index k = 0; k < force.size(); ++k) {
    out[k] = y;
    const double f0 = force[k], slope = straight && k + 1 < force.size() ? force[k + 1] - f0 : 0;
    for (int i = 0; i < parts; ++i) {
      const auto rate = [&](double at, double yy, double vv) {
        return (f0 + slope * (i + at) / parts - kDamping * vv - kStiffness * yy) / kMass;
      };
      const double a1 = rate(0, y, v), v2 = v + h / 2 * a1, a2 = rate(0.5, y + h / 2 * v, v2);
      const double v3 = v + h / 2 * a2, a3 = rate(0.5, y + h / 2 * v2, v3);
      const double v4 = v + h * a3, a4 = rate(1, y + h * v3, v4);
      y += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  }
  return out;
}

TEST(History, arx_of_an_oscillator_has_its_exact_poles_and_equation) {
  const VectorXd force = white(600, 1);
  for (const bool straight : {false, true}) {
    Pool pool;
    const Record record =
        record_of(oscillator(force, straight), force, straight ? Interpolation::linear : Interpolation::hold);
    HistoryOptions options;
    options.input_delay = straight ? 0 : 1;
    options.input_lags = straight ? 3 : 2;
    const HistoryModel model = fit_history(pool, {&record, 1}, options);
    const auto poles = history_poles(model);
    ASSERT_EQ(poles.size(), 2u);
    EXPECT_NEAR(poles[1].first, -kDamping / (2 * kMass), 1e-6);
    EXPECT_NEAR(poles[1].second, std::sqrt(kStiffness / kMass - std::pow(kDamping / (2 * kMass), 2)), 1e-6);
    const ContinuousModel found = to_continuous(model);
    EXPECT_NEAR(found.mass / kMass, 1, 1e-6);
    EXPECT_NEAR(found.damping / kDamping, 1, 1e-6);
    EXPECT_NEAR(found.stiffness / kStiffness, 1, 1e-6);
    EXPECT_LT(found.mismatch, 1e-6);
    const Prediction run = predict(model, record, 0);
    EXPECT_LT(run.rmse, 1e-9 * record.channel("y").values.norm());
  }
}

TEST(History, the_wrong_force_between_samples_shows_as_a_mismatch) {
  Pool pool;
  const VectorXd force = white(600, 1);
  const Record record = record_of(oscillator(force, true), force, Interpolation::hold);
  EXPECT_GT(to_continuous(fit_history(pool, {&record, 1}, {})).mismatch, 0.1);
}

/// y_k = 1.5 y_1 - 0.8 y_2 + 0.5 F_1 + 0.3 F_2 + e + 0.9 e_1 + 0.4 e_2
Record coloured(Index rows, std::uint64_t stream, double noise) {
  const VectorXd u = white(rows, stream), e = noise * white(rows, stream + 100);
  VectorXd y = VectorXd::Zero(rows);
  for (Index k = 2; k < rows; ++k)
    y[k] = 1.5 * y[k - 1] - 0.8 * y[k - 2] + 0.5 * u[k - 1] + 0.3 * u[k - 2] + e[k] + 0.9 * e[k - 1] + 0.4 * e[k - 2];
  return record_of(y, u, Interpolation::hold);
}
constexpr double kTruth[] = {1.5, -0.8, 0.5, 0.3, 0.9, 0.4};

TEST(History, coloured_noise_biases_arx_and_not_armax) {
  Pool pool;
  const Record record = coloured(5000, 2, 0.5);
  const HistoryModel arx = fit_history(pool, {&record, 1}, {});
  EXPECT_GT(std::abs(arx.terms[0].coefficient - kTruth[0]), 10 * arx.terms[0].std);
  HistoryOptions options;
  options.noise_lags = 2;
  const HistoryModel armax = fit_history(pool, {&record, 1}, options);
  EXPECT_TRUE(armax.converged) << armax.stopped;
  ASSERT_EQ(armax.terms.size(), 6u);
  // Extended least squares is consistent, not efficient: its deviations understate the moving-average part's by up
  // to 2.
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(armax.terms[i].coefficient, kTruth[i], 4 * 2 * armax.terms[i].std) << to_text(armax.terms[i].feature);
  EXPECT_NEAR(armax.residual_std, 0.5, 4 * 0.5 / std::sqrt(2 * 5000.0));
  EXPECT_LT(armax.bic, arx.bic);
}

TEST(History, residual_tests_pass_the_right_model_and_fail_the_wrong_ones) {
  Pool pool;
  const Record record = coloured(3000, 4, 0.5);
  const auto whiteness = residual_tests(fit_history(pool, {&record, 1}, {}), record);
  EXPECT_FALSE(whiteness[0].passed);
  EXPECT_NEAR(whiteness[0].bound, 1.96 / std::sqrt(2998.0), 1e-15);
  HistoryOptions options;
  options.noise_lags = 2;
  // Of a right model's residual 5 % of the lags lie outside, over 40 draws. With itself somewhat more do: extended
  // least squares is consistent, but what it lacks in efficiency is left in the residual.
  int outside = 0, independent = 0, whitened = 0;
  for (std::uint64_t draw = 0; draw < 40; ++draw) {
    const Record own = coloured(1000, 300 + draw, 0.5);
    const auto tests = residual_tests(fit_history(pool, {&own, 1}, options), own);
    outside += tests[1].outside;
    independent += tests[1].passed;
    whitened += tests[0].passed;
  }
  EXPECT_NEAR(outside / (40.0 * 51), 0.05, 0.025);
  EXPECT_GE(independent, 37);
  EXPECT_GE(whitened, 33);
}

TEST(History, narx_and_narmax_find_a_known_nonlinear_model) {
  // y_k = 0.5 y_1 + F_1 - 0.1 y_1^2 F_1 + e (+ 0.6 e_1)
  for (const double colour : {0.0, 0.6}) {
    const Index rows = 3000;
    const VectorXd u = white(rows, 20), e = 0.1 * white(rows, 21);
    VectorXd y = VectorXd::Zero(rows);
    for (Index k = 1; k < rows; ++k)
      y[k] = 0.5 * y[k - 1] + u[k - 1] - 0.1 * y[k - 1] * y[k - 1] * u[k - 1] + e[k] + colour * e[k - 1];
    const Record record = record_of(y, u, Interpolation::hold);
    Pool pool;
    HistoryOptions options;
    options.output_lags = options.input_lags = 1;
    options.degree = 3;
    options.noise_lags = colour > 0 ? 1 : 0;
    const HistoryModel model = fit_history(pool, {&record, 1}, options);
    EXPECT_EQ(model.terms.size(), colour > 0 ? 10u : 9u);
    for (const HistoryTerm& term : model.terms) {
      const std::string name = to_text(term.feature);
      const double truth = name == "y_1"         ? 0.5
                           : name == "F_1"       ? 1
                           : name == "y_1^2*F_1" ? -0.1
                           : name == "e_1"       ? colour
                                                 : 0;
      EXPECT_NEAR(term.coefficient, truth, 5 * term.std) << name;
    }
    for (const ResidualTest& test : residual_tests(model, record)) EXPECT_TRUE(test.passed) << test.name;
    HistoryOptions linear = options;
    linear.degree = 1;
    const auto missing = residual_tests(fit_history(pool, {&record, 1}, linear), record);
    EXPECT_EQ(missing.size(), 2u);
  }
}

TEST(History, predictions_of_several_steps_lie_between_one_step_and_the_free_run) {
  Pool pool;
  const Record record = coloured(2000, 7, 0.5);
  HistoryOptions options;
  options.noise_lags = 2;
  const HistoryModel model = fit_history(pool, {&record, 1}, options);
  const double one = predict(model, record, 1).rmse, five = predict(model, record, 5).rmse,
               all = predict(model, record, 0).rmse;
  EXPECT_NEAR(one, model.residual_std, 0.01 * model.residual_std);
  EXPECT_GT(five, 1.5 * one);
  EXPECT_GT(all, five);
  // Two steps by hand: the error is e_k + (1.5 + 0.9) e_1, of variance 1 + 2.4^2 that of the noise.
  EXPECT_NEAR(predict(model, record, 2).rmse / (0.5 * std::sqrt(1 + 2.4 * 2.4)), 1, 0.05);
}

TEST(History, orders_are_chosen_by_bic) {
  Pool pool;
  const VectorXd u = white(2000, 30), e = 0.1 * white(2000, 31);
  VectorXd y = VectorXd::Zero(2000);
  for (Index k = 3; k < 2000; ++k)
    y[k] = 1.2 * y[k - 1] - 0.6 * y[k - 2] + 0.2 * y[k - 3] + u[k - 1] + 0.5 * u[k - 2] + e[k];
  const Record record = record_of(y, u, Interpolation::hold);
  HistoryOptions options;
  options.output_lags = options.input_lags = 5;
  const auto orders = history_orders(pool, {&record, 1}, options);
  ASSERT_EQ(orders.size(), 25u);
  EXPECT_EQ(orders[0].output_lags, 3);
  EXPECT_EQ(orders[0].input_lags, 2);
}

TEST(History, a_free_run_that_explodes_says_where) {
  Pool pool;
  const Record record = coloured(400, 9, 0.1);
  HistoryModel model = fit_history(pool, {&record, 1}, {});
  model.terms[0].coefficient = 2.5;
  const Prediction run = predict(model, record, 0);
  EXPECT_GT(run.ended, 2);
  EXPECT_TRUE(std::isinf(run.rmse));
  EXPECT_TRUE(std::isnan(run.values[399]));
}

TEST(History, faults) {
  Pool pool;
  const Record record = coloured(100, 9, 0.1);
  const auto fault = [&](auto change) {
    HistoryOptions options;
    change(options);
    return message([&] { to_continuous(fit_history(pool, {&record, 1}, options)); });
  };
  EXPECT_EQ(fault([](HistoryOptions& o) { o.degree = 6; }), "history model: degree: expected 1 to 5, got 6");
  EXPECT_EQ(fault([](HistoryOptions& o) { o.output_lags = 40; }),
            "history model: made has 100 rows: expected more than three times the longest lag");
  EXPECT_EQ(
      fault([&](HistoryOptions& o) { o.features = {pool.channel("v_1")}; }),
      "history model: feature of 'v_1': expected y_1 ... (past outputs), F_0 ... (inputs) or e_1 ... (past errors)");
  EXPECT_EQ(fault([](HistoryOptions& o) { o.output_lags = o.input_lags = 9, o.degree = 4; }),
            "history model: more than 400 terms: fewer lags, or a lower degree");
  EXPECT_EQ(
      fault([](HistoryOptions& o) { o.output_lags = 3; }),
      "history model: an equation m*a + c*v + k*y = F has two output lags and inputs of lags 0 to 2, this one has 3 "
      "and 3");
}

}  // namespace
