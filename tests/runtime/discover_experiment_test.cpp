// The designed experiment: its scores against closed forms, and whether it does what it promises on the truth
// generator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "discover_catalogue.hpp"
#include "message.hpp"
#include "record/random.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

using testing::baseline;
using testing::entry;
using testing::record_of;
using testing::row;

Model with_values(const std::shared_ptr<Pool>& pool, double mass, const std::string& restoring,
                  const std::vector<std::pair<std::string, double>>& values, bool imposed = false) {
  Model model;
  model.imposed_motion = imposed;
  model.pool = pool;
  model.mass = pool->constant(mass);
  model.restoring = parse(*pool, restoring);
  model = complete(model);
  for (const auto& [name, value] : values) model.find(name)->value = value;
  return model;
}

ExperimentOptions options_for(double force, double displacement) {
  ExperimentOptions o;
  o.limits = {force, displacement, 0.05, 0.4};
  o.duration = 150;
  o.rate = 5;
  o.noise = 0.01;
  o.threads = 1;
  return o;
}

const ExperimentCandidate& named(const ExperimentDesign& design, const std::string& name) {
  return *std::find_if(design.candidates.begin(), design.candidates.end(),
                       [&](const ExperimentCandidate& c) { return c.name == name; });
}

/// Along an imposed motion each refit is one division: the separation by hand.
TEST(Experiment, SeparationIsTheLeastSquaresOneAlongAnImposedMotion) {
  const auto pool = std::make_shared<Pool>();
  const Model cubic = with_values(pool, 0, "p*y^3", {{"p", 2}}, true),
              odd = with_values(pool, 0, "q*abs(y)*y", {{"q", 3}}, true);
  ExperimentOptions o = options_for(0, 2);
  const ExperimentDesign design = design_experiment({cubic, odd}, {"cubic", "odd"}, o);
  for (const ExperimentCandidate& c : design.candidates) {
    double cc = 0, dd = 0, cd = 0, rows = 0;
    for (const double y : c.excitation["y"]) {
      const double a = y * y * y, b = std::abs(y) * y;
      cc += a * a;
      dd += b * b;
      cd += a * b;
      ++rows;
    }
    const double odd_of_cubic = 4 * (cc - cd * cd / dd), cubic_of_odd = 9 * (dd - cd * cd / cc);
    const double wanted = std::sqrt(std::min(odd_of_cubic, cubic_of_odd) / rows) / o.noise;
    EXPECT_NEAR(c.separation, wanted, 1e-6 * wanted) << c.name;
    EXPECT_LE(c.excitation.channel("y").values.cwiseAbs().maxCoeff(), 2 * (1 + 1e-12)) << c.name;
  }
  EXPECT_GE(design.best().separation, named(design, "slow_cycles").separation);
}

/// m and k/m cannot be told apart by a rival that may fit both; with k fixed they can.
TEST(Experiment, ARivalThatCanFollowIsNotTold) {
  const auto pool = std::make_shared<Pool>();
  const Model soft = with_values(pool, 1, "ka*y + ca*v", {{"ka", 1}, {"ca", 0.1}}),
              stiff = with_values(pool, 1, "kb*y + cb*v", {{"kb", 1.1}, {"cb", 0.1}});
  const ExperimentDesign alike = design_experiment({soft, stiff}, {"soft", "stiff"}, options_for(0.1, 1));
  for (const ExperimentCandidate& c : alike.candidates) EXPECT_LT(c.separation, 0.02) << c.name;
  EXPECT_FALSE(alike.best().decides());
  Model held = stiff;
  held.find("kb")->fixed = held.find("cb")->fixed = true;
  Model other = soft;
  other.find("ka")->fixed = other.find("ca")->fixed = true;
  EXPECT_TRUE(design_experiment({other, held}, {"soft", "stiff"}, options_for(0.1, 1)).best().decides());
}

/// The larger of two nested models is told by what the smaller leaves of it, not by its following the smaller one.
TEST(Experiment, ANestedRivalIsToldWhereItIsTheTruth) {
  const auto pool = std::make_shared<Pool>();
  const Model linear = with_values(pool, 1, "k*y + c*v", {{"k", 1}, {"c", 0.1}}),
              duffing = with_values(pool, 1, "k*y + c*v + k3*y^3", {{"k", 1}, {"c", 0.1}, {"k3", 0.5}});
  EXPECT_TRUE(design_experiment({linear, duffing}, {"linear", "duffing"}, options_for(1, 1)).best().decides());
}

/// Under a small force a spring with a preload comes to rest on its seat, where a fit counts more switches than it
/// follows. That says nothing of how far the rivals are apart.
TEST(Experiment, AFitThatStopsIsNoSeparation) {
  const auto pool = std::make_shared<Pool>();
  const Model seat = with_values(pool, 1, "k*y + c*v + p*sign(y)", {{"k", 1}, {"c", 0.26}, {"p", 0.6}}),
              smooth =
                  with_values(pool, 1, "k*y + c*v + s*tanh(g*y/s)", {{"k", 1}, {"c", 0.26}, {"s", 0.6}, {"g", 20}});
  ExperimentOptions o = options_for(0.48, 1);
  o.duration = 100;
  const ExperimentDesign design = design_experiment({seat, smooth}, {"seat", "smooth"}, o);
  bool stopped = false;
  for (const ExperimentCandidate& c : design.candidates) {
    EXPECT_TRUE(std::isfinite(c.separation)) << c.name;
    stopped = stopped || c.remark.find("stops") != std::string::npos;
  }
  EXPECT_TRUE(stopped);
}

TEST(Experiment, KeepsTheLimits) {
  const auto pool = std::make_shared<Pool>();
  const Model a = with_values(pool, 1, "k*y + c*v + k3*y^3", {{"k", 1}, {"c", 0.05}, {"k3", 0.5}}),
              b = with_values(pool, 1, "k*y + c*v + k2*abs(y)*y", {{"k", 1}, {"c", 0.05}, {"k2", 0.5}});
  const ExperimentDesign design = design_experiment({a, b}, {"a", "b"}, options_for(0.8, 0.7));
  ASSERT_EQ(design.candidates.size(), 9u);
  for (const ExperimentCandidate& c : design.candidates) {
    EXPECT_LE(c.peak, 0.7) << c.name;
    EXPECT_LE(c.excitation.channel("F").values.cwiseAbs().maxCoeff(), 0.8 * (1 + 1e-12)) << c.name;
    EXPECT_LE(c.separation, design.best().separation);
  }
}

// ---- the promise: a record that cannot tell, an experiment, a record that can ----

struct Truth {
  std::string name;
  truth::Physics physics;
};

std::vector<Truth> truths() {
  truth::Physics cubic, odd;
  cubic.zeta = odd.zeta = 0.04;
  cubic.k3 = 0.06;
  odd.other = [](double x, double) { return 0.12 * std::abs(x) * x; };
  return {{"cubic_stiffness", cubic}, {"odd_quadratic_stiffness", odd}};
}

std::vector<Effect> rivals(Pool& pool) {
  return {entry(pool, "cubic_stiffness", "cubic_stiffness_k3*y^3", {row("cubic_stiffness_k3")}),
          entry(pool, "odd_quadratic_stiffness", "odd_quadratic_stiffness_k2*abs(y)*y",
                {row("odd_quadratic_stiffness_k2")}),
          entry(pool, "coulomb_friction", "coulomb_friction_Fc*sign(v)", {row("coulomb_friction_Fc", 0)})};
}

/// What the truth does from rest under the samples of a force, straight between them, with noise on y.
Record measure(const truth::Physics& physics, const truth::Scale& scale, const Record& excitation, double noise,
               std::uint64_t seed) {
  const auto f = excitation["F"];
  const double spacing = scale.omega() * excitation.dt();
  const auto force = [&](double tau) {
    const double at = std::clamp(tau / spacing, 0.0, static_cast<double>(f.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(at), f.size() - 2);
    return (f[i] + (f[i + 1] - f[i]) * (at - static_cast<double>(i))) / scale.force();
  };
  const truth::Motion motion =
      truth::integrate(physics, force, 1, {}, static_cast<int>(excitation.rows()), spacing, 24);
  truth::Columns columns;
  Philox random(seed, 0);
  for (std::size_t i = 0; i < motion.x.size(); ++i) {
    columns.t.push_back(excitation.dt() * static_cast<double>(i));
    columns.F.push_back(f[i]);
    columns.y.push_back(motion.x[i] * scale.length + noise * random.normal());
  }
  return record_of(columns, "designed");
}

TEST(Experiment, LetsDiscoveryNameWhatTheFirstRecordCouldNot) {
  const truth::Scale& scale = truth::scale_named("milli");
  truth::RecordOptions options;
  options.rows = 1500;
  options.noise_db = 12;
  options.seed = 3;
  for (const Truth& truth : truths()) {
    const truth::Columns first =
        truth::make_record(truth.physics, scale, truth::multisine(0.7, 1.2, 20, 5), 0.55, options);
    options.seed += 10;
    const truth::Columns second =
        truth::make_record(truth.physics, scale, truth::multisine(0.7, 1.2, 20, 6), 0.55, options);
    const Model model = baseline("k*y + c*v", scale.mass);
    const Discovery before =
        discover(model, rivals(*model.pool), {record_of(first, "first")}, {record_of(second, "second")});
    ASSERT_EQ(before.verdict, Verdict::ambiguous) << truth.name << ": " << before.sentence;
    ASSERT_FALSE(before.experiment.empty());
    const ExperimentCandidate& best = before.experiment.best();
    EXPECT_TRUE(best.decides()) << truth.name << ": " << before.sentence;
    EXPECT_NE(before.sentence.find(best.name), std::string::npos) << before.sentence;

    const double noise = before.same_experiment.noise;
    const Model again = baseline("k*y + c*v", scale.mass);
    const Discovery after =
        discover(again, rivals(*again.pool), {measure(truth.physics, scale, best.excitation, noise, options.seed)},
                 {record_of(second, "second")});
    EXPECT_EQ(after.verdict, Verdict::explained) << truth.name << ": " << after.sentence;
    ASSERT_EQ(after.effects.size(), 1u) << after.sentence;
    EXPECT_EQ(after.effects[0].name, truth.name);
    EXPECT_GE(after.naming.of(truth.name), 90);
    EXPECT_LT(before.naming.of(truth.name), after.naming.of(truth.name) + 1);
  }
}

// ---- errors ----

std::string refusal(const std::vector<Model>& models, const ExperimentOptions& options) {
  return message([&] { design_experiment(models, std::vector<std::string>(models.size(), "m"), options); });
}

TEST(ExperimentRefuses, WhatIsOutOfRange) {
  const auto pool = std::make_shared<Pool>();
  const Model a = with_values(pool, 1, "k*y", {{"k", 1}}), b = with_values(pool, 1, "k*y + c*v", {{"k", 1}});
  EXPECT_EQ(refusal({a}, options_for(1, 1)), "design_experiment: models: expected at least two rivals, got 1");
  EXPECT_EQ(refusal({a, b}, options_for(1, 1)),
            "design_experiment: models: entry 2: parameter 'c' has no value; fit the model first");
  EXPECT_EQ(refusal({a, a}, options_for(0, 1)), "design_experiment: limits.force: expected > 0 N, got 0");
  ExperimentOptions slow = options_for(1, 1);
  slow.rate = 2;
  EXPECT_EQ(refusal({a, a}, slow),
            "design_experiment: rate: expected >= 3.2 Hz, eight rows in a period of limits.frequency[2], got 2");
  ExperimentOptions brief = options_for(1, 1);
  brief.duration = 50;
  EXPECT_EQ(refusal({a, a}, brief),
            "design_experiment: duration: expected >= 100 s, five periods of limits.frequency[1], got 50");
  ExperimentOptions still = options_for(1, 1);
  still.noise = 0;
  EXPECT_EQ(refusal({a, a}, still), "design_experiment: noise: expected > 0, got 0");
}

}  // namespace
}  // namespace lunid
