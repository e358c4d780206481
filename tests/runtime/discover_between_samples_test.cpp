// A controller that holds its part of the force between samples while the rest goes on straight: no kind of
// interpolation says so, and what it leaves looks like another mass.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "discover/baseline.hpp"
#include "discover/judge.hpp"
#include "discover/study.hpp"
#include "discover_catalogue.hpp"
#include "statistics/moments.hpp"
#include "truth/faults.hpp"
#include "truth/oscillator.hpp"

namespace lunid {
namespace {

constexpr double spacing = 2 * M_PI / 14;  // of a mass of 1 on k = 1
constexpr int rows = 840, finer = 32;

/// `mass` under a force of 40 lines and a loop of this stiffness and damping, by Runge and Kutta's method within each
/// sample.
Record looped(double mass, double loop, double damping, std::uint64_t seed) {
  const truth::Signal lines = truth::multisine(0.2, 2.2, 40, seed);
  truth::Motion out;
  double x = 0, v = 0;
  for (int row = 0; row < rows; ++row) {
    const double held = -loop * x - damping * v, first = 0.02 * lines(row * spacing),
                 last = 0.02 * lines((row + 1) * spacing);
    out.x.push_back(x);
    out.force.push_back(first + held);
    const double h = spacing / finer;
    for (int i = 0; i < finer; ++i) {
      const auto a = [&](double part, double y, double s) {
        return (first + (last - first) * (i + part) / finer + held - 0.06 * s - y) / mass;
      };
      const double a1 = a(0, x, v), v2 = v + h / 2 * a1, a2 = a(0.5, x + h / 2 * v, v2), v3 = v + h / 2 * a2,
                   a3 = a(0.5, x + h / 2 * v2, v3), v4 = v + h * a3, a4 = a(1, x + h * v3, v4);
      x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  }
  const double noise = 0.003 * moments::standard_deviation(out.x);
  Philox random(seed, 7);
  for (double& x_of_row : out.x) x_of_row += noise * random.normal();
  return Record("loop " + std::to_string(seed), 0, spacing,
                {testing::channel("F", "N", out.force), testing::channel("y", "m", out.x)});
}

/// Of a baseline with a mass of 1.
Discovery find(double mass, double loop, double damping) {
  const Model model = testing::baseline("k*y + c*v", 1);
  std::vector<Effect> catalogue = testing::small_catalogue(*model.pool);
  catalogue.push_back(testing::entry(*model.pool, "added_mass", "added_mass_ma*a", {testing::row("added_mass_ma")}));
  return discover(model, catalogue, {looped(mass, loop, damping, 11), looped(mass, loop, damping, 12)},
                  {looped(mass, loop, damping, 13)});
}

/// At six rows a period a curve through the rows of the base's acceleration lacks half a percent of it, and the mass on
/// it came out so much too large.
TEST(BetweenSamples, WhatMovesTheBaseIsReadAsTheForceIs) {
  const std::vector<double> values(60, 0.0), ramp = [] {
    std::vector<double> t(60);
    std::iota(t.begin(), t.end(), 0.0);
    return t;
  }();
  const Record record("base", 0, 0.1,
                      {testing::channel("F", "N", values), testing::channel("y", "m", ramp),
                       testing::channel("ab", "m/s^2", values), testing::channel("shaft_angle", "rad", ramp)});
  const auto read = [&](Interpolation said, const std::string& channel) {
    Study study;
    study.model = testing::baseline("k*y + c*v", 1);
    study.model.interpolation = said;
    study.forces = {"F"};
    study.guesses = {said};
    study.recorded = {nullptr};
    read_force(study, {said});
    const FitData data = fit_data(study, record);
    for (int i = 0; i < data.excitation.count(); ++i)
      if (data.excitation.channel(i) == channel) return data.excitation[i].interpolation();
    throw std::logic_error("no such channel");
  };
  EXPECT_EQ(read(Interpolation::band_limited, "ab"), Interpolation::band_limited);
  EXPECT_EQ(read(Interpolation::band_limited, "shaft_angle"), Interpolation::cubic);
  EXPECT_EQ(read(Interpolation::linear, "ab"), Interpolation::cubic);
  EXPECT_EQ(read(Interpolation::hold, "ab"), Interpolation::hold);
}

/// A mass of 1 on k = 1 and c = 0.06 under a force that a controller holds from row to row, exactly: 250 rows a period,
/// of which each step of the force is one hundredth.
Record held_and_fast(std::uint64_t seed) {
  constexpr int count = 6000;
  constexpr double dt = 2 * M_PI / 250, c = 0.06, decay = 0.5 * c;
  const double w = std::sqrt(1 - decay * decay), e = std::exp(-decay * dt), cosine = e * std::cos(w * dt),
               sine = e * std::sin(w * dt) / w;
  const truth::Signal lines = truth::multisine(0.3, 1.7, 20, seed);
  Philox random(seed, 8);
  truth::Motion out;
  double x = 0, v = 0;
  for (int row = 0; row < count; ++row) {
    const double force = 0.1 * lines(row * dt) + 0.01 * random.normal(), from = x - force;
    out.x.push_back(x);
    out.force.push_back(force);
    x = force + (cosine + decay * sine) * from + sine * v;
    v = (cosine - decay * sine) * v - sine * from;
  }
  const double noise = 1e-3 * moments::standard_deviation(out.x);
  for (double& x_of_row : out.x) x_of_row += noise * random.normal();
  return Record("held", 0, dt, {testing::channel("F", "N", out.force), testing::channel("y", "m", out.x)});
}

/// The baseline has k = 1 and c = 0.06 within this, and leaves no more than so many times the noise.
void expect_fitted(const Study& study, double within, double noises) {
  std::vector<std::string> warnings;
  const Candidate candidate = fit_baseline(study, study.model, warnings);
  EXPECT_NEAR(candidate.fit.theta[0], 1, within);
  EXPECT_NEAR(candidate.fit.theta[1], 0.06, within);
  EXPECT_LT(rms_error(candidate.fit), noises * study.sensor_noise());
}

/// Taken for held from one joined row to the next, the force came so much late that k was a percent off, 40 floors
/// open.
TEST(BetweenSamples, AForceThatWasHeldIsSmoothOfRowsThatWereJoined) {
  Model model = testing::baseline("k*y + c*v", 1);
  model.interpolation = Interpolation::hold;
  const DiscoverOptions options;
  Study study = prepare(model, {held_and_fast(1)}, {held_and_fast(2)}, options);
  ASSERT_GT(study.train.front().record.dt(), 1.5 * study.full.front().dt());
  expect_fitted(study, 1e-3, 1.3);
}

/// A mass of 1 on k = 1 and c = 0.06 under blows of six rows, 250 rows a period.
Record hammered(std::uint64_t seed) {
  constexpr int count = 9000;
  constexpr double dt = 2 * M_PI / 250, length = 6 * dt;
  Philox random(seed, 9);
  std::vector<double> at, size;
  for (double t = 1; t < count * dt; t += 6 + 4 * random.uniform()) {
    at.push_back(t);
    size.push_back(0.5 + random.uniform());
  }
  const truth::Signal blows = [&](double t) {
    const auto next = static_cast<std::size_t>(std::ranges::upper_bound(at, t) - at.begin());
    const double since = next > 0 ? t - at[next - 1] : length;
    return since < length ? size[next - 1] * std::pow(std::sin(M_PI * since / length), 2) : 0.0;
  };
  truth::Motion out = truth::integrate({}, blows, 1, {}, count, dt, 8);
  const double noise = 1e-3 * moments::standard_deviation(out.x);
  for (double& x_of_row : out.x) x_of_row += noise * random.normal();
  return Record("hammered", 0, dt, {testing::channel("F", "N", out.force), testing::channel("y", "m", out.x)});
}

/// Read through the means of joined rows, whatever the curve, blows of six rows leave five times what the noise does.
TEST(BetweenSamples, BlowsOfAFewRowsAreThoseOfAllRowsThatWereJoined) {
  const DiscoverOptions options;
  Study study = prepare(testing::baseline("k*y + c*v", 1), {hammered(1)}, {hammered(2)}, options);
  ASSERT_GT(study.train.front().record.dt(), 3.5 * study.full.front().dt());
  expect_fitted(study, 1e-4, 1.05);
  const Study parts = in_short_runs(study, 8);
  ASSERT_GT(parts.train.size(), 3u);
  const Excitation& whole = study.train.front().excitation[0];
  for (const FitData& part : parts.train)
    for (const double t : {part.record.start(), part.record.start() + 1.3})
      EXPECT_DOUBLE_EQ(part.excitation[0].at(t), whole.at(t));
}

/// A fit's gap is of means of rows then, below what noise alone leaves of single rows.
TEST(BetweenSamples, ADiscoverySaysHowManyRowsItsFitsTakeForOne) {
  const Model model = testing::baseline("k*y + c*v", 1);
  const Discovery d = discover(model, testing::small_catalogue(*model.pool), {hammered(1)}, {hammered(2)});
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << d.sentence;
  EXPECT_EQ(d.records[0].joined, 4);
  EXPECT_EQ(d.records[1].joined, 1);
  EXPECT_LT(d.gap_fit, 0.7 * d.final_train.floor);
  EXPECT_NE(to_terminal(d).find("Hz; fits take 4 rows for one\n"), std::string::npos);
}

/// A mass of 1 that slides, c = 0.1 and a friction of 1.2, under a controller that holds its force from row to row: 800
/// rows a period. Ten steps a row, each exact but for the damping, which is that of its first speed.
Record slid(std::uint64_t seed) {
  constexpr int count = 12000, finer = 10;
  constexpr double dt = 2 * M_PI / 800, h = dt / finer, c = 0.1, friction = 1.2, noise = 1e-4;
  const truth::Signal course = truth::multisine(0.5, 1.5, 12, seed);
  Philox random(seed, 10);
  truth::Motion out;
  double x = 0, v = 0, before = 0;
  for (int row = 0; row < count; ++row) {
    const double measured = x + noise * random.normal(), ahead = course(row * dt) - measured;
    const double force = 20 * ahead + 6 * (ahead - before) / dt;
    before = ahead;
    out.x.push_back(measured);
    out.force.push_back(force);
    const auto slide = [&](double time) {
      const double sign = v != 0 ? std::copysign(1, v) : std::copysign(1, force), a = force - friction * sign - c * v;
      if (v == 0 && std::abs(force) <= friction) return 0.0;
      const double left = v * (v + a * time) < 0 ? time + v / a : 0, gone = time - left;
      x += v * gone + 0.5 * a * gone * gone;
      v = left > 0 ? 0 : v + a * gone;
      return left;
    };
    for (int i = 0; i < finer; ++i)
      if (const double left = slide(h); left > 0) slide(left);
  }
  return Record("slid " + std::to_string(seed), 0, dt,
                {testing::channel("F", "N", out.force), testing::channel("y", "m", out.x)});
}

/// Between joined rows the mass turns round and sticks, by what the force does there: they left 40 times the noise, and
/// of one record a drift of the sensor was named for the way that a free mass goes astray.
TEST(BetweenSamples, JoinedRowsThatMisleadAreTakenAsTheyWereRecorded) {
  const Model model = testing::baseline("c*v + Fc*sign(v)", 1);
  std::vector<Effect> catalogue = testing::small_catalogue(*model.pool);
  catalogue.push_back(testing::sensor(*model.pool, "sensor_drift", "y + sensor_drift_b + sensor_drift_d*t",
                                      {testing::row("sensor_drift_b"), testing::row("sensor_drift_d")}));
  const DiscoverOptions options;
  const Study study = prepare(model, {slid(1)}, {slid(2)}, options);
  ASSERT_GT(study.train.front().record.dt(), 2.5 * study.full.front().dt());
  const Discovery d = discover(model, catalogue, {slid(1)}, {slid(2)}, options);
  EXPECT_TRUE(d.effects.empty()) << d.sentence;
  EXPECT_EQ(d.verdict, Verdict::nothing_missing) << d.sentence;
  EXPECT_LT(d.final_train.value, 1e-4);
  EXPECT_NEAR(d.baseline.parameters[1].value, 1.2, 2e-5);
}

TEST(BetweenSamples, APartThatIsHeldIsNoMass) {
  for (const double damping : {0.0, 0.15}) {
    const Discovery d = find(1, 0.3, damping);
    EXPECT_TRUE(d.effects.empty()) << d.sentence;
    EXPECT_EQ(d.verdict, Verdict::nothing_missing);
  }
}

/// kappa dt^2/12 of a spring that is held acts as a mass.
TEST(BetweenSamples, WhatALoopLeavesIsSaidToBeThat) {
  const Discovery d = find(1, 0.2, 0);
  EXPECT_EQ(d.verdict, Verdict::nothing_missing);
  EXPECT_NE(d.sentence.find("is gone where the force is read"), std::string::npos) << d.sentence;
  char mass[40];
  std::snprintf(mass, sizeof mass, "a mass that is %.2g %% more", 100 * 0.2 * spacing * spacing / 12);
  EXPECT_NE(d.sentence.find(mass), std::string::npos) << d.sentence;
}

TEST(BetweenSamples, AMassIsOne) {
  const Discovery d = find(1.12, 0.3, 0);
  ASSERT_EQ(d.effects.size(), 1u) << d.sentence;
  EXPECT_EQ(d.effects[0].name, "added_mass");
}

/// Beside the drag alone the lag of the channel, three quarters of a sample, looks like a force that was held. That
/// follows the record far worse than both do.
TEST(BetweenSamples, AReadingThatAPoorerModelAsksForIsNotTaken) {
  truth::Fault fault;
  fault.effect = "sensor_lag";
  fault.physics.drag = 0.1;
  fault.lag_y = 0.75 * 2 * M_PI / 40;
  truth::RecordOptions options;
  options.rows = 1600;
  options.noise_db = 60;
  const truth::Scale& scale = truth::scale_named("milli");
  truth::FaultyRecords records = truth::make_faulty(fault, scale, options);
  for (truth::Columns* made : {&records.train.columns, &records.test.columns})  // recorded in steps: something is left
    for (double& force : made->F) force = std::round(force / (0.02 * scale.force())) * 0.02 * scale.force();
  const Model model = testing::baseline("k*y + c*v", scale.mass);
  Pool& pool = *model.pool;
  Effect lag =
      testing::entry_with_state(pool, "sensor_lag", "z", "(y - z)/sensor_lag_tau", {testing::row("sensor_lag_tau", 0)});
  lag.family = "sensor";
  lag.variants[0].measures = {{"y", std::exchange(lag.variants[0].force, {})}};
  lag.guess = [](const RecordScales& s, int) { return std::vector{Guess{{"sensor_lag_tau", 2 * s.interval}}}; };
  lag.range = [](const RecordScales& s, int) { return Ranges{{"sensor_lag_tau", {0.5 * s.interval, 1 / s.omega}}}; };
  const Effect drag =
      testing::entry(pool, "quadratic_drag", "quadratic_drag_c2*abs(v)*v", {testing::row("quadratic_drag_c2", 0)});
  const Discovery d = discover(model, {drag, lag}, {testing::record_of(records.train.columns, "train")},
                               {testing::record_of(records.test.columns, "test")});
  ASSERT_EQ(d.effects.size(), 2u) << d.sentence;
  EXPECT_NE(d.interpolation, "hold");
}

}  // namespace
}  // namespace lunid
