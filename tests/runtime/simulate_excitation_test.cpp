// The force between its samples.
#include "simulate_models.hpp"

namespace lunid {
namespace {

using testing::fault_of;
using testing::model_of;
using testing::state;
using testing::theta_of;
using testing::with_substeps;

std::vector<double> samples_of(const std::function<double(double)>& f, int rows, double dt) {
  std::vector<double> force(rows);
  for (int i = 0; i < rows; ++i) force[i] = f(dt * i);
  return force;
}

TEST(Excitation, RefinedGridMeetsTheSamplesAndAt) {
  const auto force = samples_of([](double t) { return std::sin(3 * t) + t; }, 60, 0.05);
  for (const Interpolation kind :
       {Interpolation::hold, Interpolation::linear, Interpolation::cubic, Interpolation::band_limited}) {
    const Excitation excitation(2, 0.05, force, kind);
    const Eigen::VectorXd grid = excitation.refined(3);
    ASSERT_EQ(grid.size(), 2 * 59 * 3 + 1);
    for (Eigen::Index i = 0; i < grid.size(); ++i) {
      if (i % 6 == 0) {
        EXPECT_EQ(grid[i], force[i / 6]);
      }
      // band-limited at() reads a grid of its own by six points: 1e-7 of the force
      EXPECT_NEAR(excitation.at(2 + 0.05 * (static_cast<double>(i) + 1e-9) / 6), grid[i], 1e-6) << to_string(kind) << i;
    }
    EXPECT_EQ(excitation.at(-5), force.front());
    EXPECT_EQ(excitation.at(500), force.back());
  }
}

// A delayed force needs what came before the record: two tones are predicted from their rows, a part knows the rows
// that it was cut from, a formula holds for all times.
TEST(Excitation, WhatCameBeforeIsPredictedOrKnown) {
  const auto f = [](double t) { return std::sin(3 * t + 0.7) + 0.4 * std::cos(7.3 * t); };
  const Excitation whole(2, 0.05, samples_of([&](double t) { return f(2 + t); }, 900, 0.05), Interpolation::cubic);
  for (const double t : {1.99, 1.93, 1.8, 1.5}) EXPECT_NEAR(whole.also_before(t), f(t), 1e-3) << t;
  const Excitation part = whole.part(100, 200);
  for (const double t : {2.4, 5.013, 6.9}) EXPECT_NEAR(part.also_before(t), whole.at(t), 1e-12) << t;
  EXPECT_NEAR(part.also_before(1.9), f(1.9), 1e-3);
  EXPECT_EQ(part.also_before(8.123), part.at(8.123));
  EXPECT_DOUBLE_EQ(Excitation(0, 0.1, 50, [&](double t) { return f(t); }).also_before(-0.33), f(-0.33));
  EXPECT_DOUBLE_EQ(Excitation(0, 0.1, 50, [](double t) { return std::sqrt(t) + 1; }).also_before(-0.33), 1);
  const std::vector<double> constant(40, 5.0);
  EXPECT_NEAR(Excitation(0, 0.1, constant).also_before(-1), 5, 1e-12);
  EXPECT_DOUBLE_EQ(Excitation(0, 0.1, std::vector<double>{3, 4}).also_before(-0.25), 3);
}

TEST(Excitation, KindsDoWhatTheySay) {
  const std::vector<double> force{0, 1, 8, 27, 64, 125};  // i^3
  EXPECT_EQ(Excitation(0, 1, force, Interpolation::hold).at(2.9), 8);
  EXPECT_EQ(Excitation(0, 1, force, Interpolation::hold).at(3), 27);
  EXPECT_DOUBLE_EQ(Excitation(0, 1, force, Interpolation::linear).at(2.5), 17.5);
  for (const double t : {0.3, 1.5, 2.5, 4.7})  // four points reproduce a cubic
    EXPECT_NEAR(Excitation(0, 1, force, Interpolation::cubic).at(t), t * t * t, 1e-12);
  EXPECT_DOUBLE_EQ(Excitation(0, 1, 6, [](double t) { return std::exp(t); }).at(1.3), std::exp(1.3));
}

// Away from the ends, the windowed sinc is exact to 1e-6 up to 0.87 of the Nyquist frequency; three samples per period
// are 0.67 of it. The cubic is off by a tenth there, straight lines by half.
TEST(Excitation, BandLimitedReconstructsAMultisineOfThreeSamplesPerPeriod) {
  const auto f = [](double t) {
    return std::sin(2 * std::numbers::pi * t / 3 + 0.4) + 0.7 * std::sin(2 * std::numbers::pi * t / 4.37);
  };
  const auto force = samples_of(f, 400, 1);
  const auto worst = [&](Interpolation kind, double from, double to) {
    const Excitation excitation(0, 1, force, kind);
    double error = 0;
    for (double t = from; t < to; t += 0.37) error = std::max(error, std::abs(excitation.at(t) - f(t)));
    return error;
  };
  EXPECT_LT(worst(Interpolation::band_limited, 40, 359), 1e-5);
  EXPECT_GT(worst(Interpolation::cubic, 40, 359), 0.1);
  EXPECT_GT(worst(Interpolation::linear, 40, 359), 0.4);
  // near the ends nothing rings: the error stays a part of the force that fades within some samples
  EXPECT_LT(worst(Interpolation::band_limited, 0, 10), 0.5);
  EXPECT_LT(worst(Interpolation::band_limited, 10, 20), 0.02);
}

TEST(Excitation, BandLimitedDoesNotRingAtEndsAndOffsets) {
  const auto ramp = samples_of([](double t) { return 5 + 3 * t; }, 50, 1);
  const Eigen::VectorXd grid = Excitation(0, 1, ramp, Interpolation::band_limited).refined(2);
  for (Eigen::Index i = 0; i < grid.size(); ++i) EXPECT_NEAR(grid[i], 5 + 3 * 0.25 * static_cast<double>(i), 1e-11);
}

// A free run on a force of 3 samples per period: the choice between the samples decides the gap.
TEST(Excitation, BandLimitedRunIsFarCloserToTheTruthThanStraightLines) {
  const auto f = [](double t) { return std::sin(20.9 * t) + 0.5 * std::sin(14.3 * t + 1) + 0.3 * std::sin(5.2 * t); };
  const System system(model_of("1", "1.2*v + 350*y"));
  const int rows = 400;
  const auto force = samples_of(f, rows, 0.1);
  const lunid::Run truth = simulate(system, {}, Excitation(0, 0.1, rows, f), state({0, 0}), with_substeps(32));
  const auto gap = [&](Interpolation kind) {
    const lunid::Run run = simulate(system, {}, Excitation(0, 0.1, force, kind), state({0, 0}), with_substeps(32));
    const auto error = (run.x.col(0) - truth.x.col(0)).tail(300);  // the start-up error at the end has decayed
    const auto y = truth.x.col(0).tail(300);
    return error.norm() / y.norm();
  };
  EXPECT_GT(gap(Interpolation::linear), 0.1);
  EXPECT_LT(gap(Interpolation::band_limited), 0.02 * gap(Interpolation::linear));
}

TEST(Excitation, PartKeepsTheForceBetweenSamples) {
  const auto force = samples_of([](double t) { return std::sin(2 * t) + std::cos(0.3 * t * t); }, 80, 1);
  for (const Interpolation kind : {Interpolation::hold, Interpolation::cubic, Interpolation::band_limited}) {
    const Excitation whole(0, 1, force, kind), part = whole.part(10, 30);
    EXPECT_EQ(part.t0(), 10);
    EXPECT_EQ(part.rows(), 30);
    EXPECT_EQ((part.refined(4) - whole.refined(4).segment(80, 233)).cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(part.at(12.3), whole.at(12.3));
    EXPECT_EQ(part.part(5, 4).at(16.2), whole.at(16.2));
  }
}

TEST(Excitation, FaultsNameTheValue) {
  const std::vector<double> one{1}, bad{1, 2, std::nan("")}, good{1, 2, 3};
  EXPECT_EQ(fault_of([&] { Excitation(0, 1, one); }), "excitation: expected 2 rows or more, got 1");
  EXPECT_EQ(fault_of([&] { Excitation(0, 1, bad); }), "excitation: force: row 3: expected a finite value, got nan");
  EXPECT_EQ(fault_of([&] { Excitation(0, 0, good); }), "excitation: dt: expected > 0, got 0");
  EXPECT_EQ(fault_of([&] { Excitation(std::nan(""), 1, good); }), "excitation: t0: expected a finite value, got nan");
  EXPECT_EQ(fault_of([&] { Excitation(0, 1, good).refined(0); }), "excitation: substeps: expected >= 1, got 0");
  EXPECT_EQ(fault_of([&] { Excitation(0, 1, good).part(1, 3); }), "excitation: rows 2 to 4 are not within its 3 rows");
}

/// f at many times at once.
TimeFunction by_columns(std::function<double(double)> f) {
  return [f](std::span<const double> t, std::span<double> out) { std::transform(t.begin(), t.end(), out.begin(), f); };
}

// A formula between the samples, and what the samples have beyond it interpolated.
TEST(Excitation, FormulaIsExactBetweenTheSamples) {
  const auto formula = [](double t) { return std::sin(40 * t); };
  const auto rest = [](double t) { return t < 0.5 ? 1.0 : 3.0; };
  const int rows = 101;
  const double dt = 0.01;
  const auto pure = samples_of(formula, rows, dt);
  const auto both = samples_of([&](double t) { return formula(t) + rest(t); }, rows, dt);
  const Excitation exact(0, dt, pure, Interpolation::band_limited, by_columns(formula));
  EXPECT_TRUE(exact.analytic());
  const Excitation sum(0, dt, both, Interpolation::linear, by_columns(formula));
  EXPECT_FALSE(sum.analytic());
  const Eigen::VectorXd grid = sum.refined(2);
  for (int i = 0; i < grid.size(); ++i) {
    const double t = dt * i / 4;
    EXPECT_NEAR(exact.at(t), formula(t), 1e-15);
    if (t > 0.49 && t < 0.5) continue;  // the step is a ramp of one interval
    EXPECT_NEAR(sum.at(t), formula(t) + rest(t), 1e-12) << t;
    EXPECT_NEAR(grid[i], formula(t) + rest(t), 1e-12) << t;
  }
  EXPECT_NEAR(sum.at(0.495), formula(0.495) + 2, 1e-12);
  EXPECT_EQ(grid[4 * 37], both[37]);
  // a part of it is the same force
  EXPECT_NEAR(sum.part(30, 50).at(0.7012), sum.at(0.7012), 1e-12);
  // held values beside a formula run straight
  EXPECT_NEAR(Excitation(0, dt, both, Interpolation::hold, by_columns(formula)).at(0.495), formula(0.495) + 2, 1e-12);
}

TEST(Excitation, BandLimitedRestBesideAFormula) {
  const auto formula = [](double t) { return 5 * std::cos(7 * t); };
  const auto wave = [](double t) { return std::sin(2 * std::numbers::pi * t / 0.035); };  // 3.5 samples a period
  const auto force = samples_of([&](double t) { return formula(t) + wave(t); }, 400, 0.01);
  const Excitation sum(0, 0.01, force, Interpolation::band_limited, by_columns(formula));
  for (double t = 1; t < 3; t += 0.0037) EXPECT_NEAR(sum.at(t), formula(t) + wave(t), 2e-6);
}

/// Half sines of `rows` rows at 0.01 s.
std::vector<double> blows(double rows) {
  constexpr double dt = 0.01;
  return samples_of(
      [=](double t) {
        const double since = std::fmod(t + 0.0037, 1.3), length = rows * dt;
        return since < length ? 10 * std::sin(std::numbers::pi * since / length) : 0.0;
      },
      2001, dt);
}

// What a mass on a spring does at the rows that are left, in one step from one to the next, is what it does there in
// steps of the recorded rows: half a percent of the motion is lost by a cubic through the rows that are left.
TEST(Excitation, JoinedRowsDoTheWorkOfAllOfThem) {
  const System system(model_of("1", "k*y + c*v"));
  const std::vector<double> theta = theta_of(system, {{"k", 15}, {"c", 0.3}});
  for (const Interpolation kind :
       {Interpolation::hold, Interpolation::linear, Interpolation::cubic, Interpolation::band_limited}) {
    const Excitation all(1, 0.01, blows(5), kind);
    const auto motion = [&](const Excitation& force, int substeps) {
      return Eigen::MatrixXd(simulate(system, theta, force, state({0, 0}), with_substeps(substeps)).x);
    };
    const Eigen::MatrixXd exact = motion(all, 4)(Eigen::seqN(0, 501, 4), Eigen::placeholders::all);
    const Excitation joined = all.joined(4);
    const double lost = (motion(joined, 1) - exact).col(0).norm() / exact.col(0).norm();
    EXPECT_LT(lost, 1e-4) << to_string(kind);
    EXPECT_NE(joined.interpolation(), Interpolation::hold);
    const Eigen::VectorXd left = joined.samples();
    const std::span<const double> values(left.data(), static_cast<std::size_t>(left.size()));
    const Excitation through(1, 0.04, values, Interpolation::cubic);
    EXPECT_GT((motion(through, 1) - exact).col(0).norm() / exact.col(0).norm(), 50 * lost) << to_string(kind);
    EXPECT_EQ(left[7], all.samples()[28]);
    // all that reads it reads the same
    const Eigen::VectorXd grid = joined.refined(3);
    for (Eigen::Index i = 0; i < grid.size(); ++i)
      EXPECT_NEAR(joined.at(1 + 0.04 * static_cast<double>(i) / 6), grid[i], 1e-9);
    EXPECT_NEAR(joined.scaled(-2).at(1.613), -2 * joined.at(1.613), 1e-12);
    EXPECT_NEAR(joined.part(40, 30).at(3.013), joined.at(3.013), 1e-12);
    EXPECT_NEAR(joined.part(40, 30).also_before(1.613), joined.at(1.613), 1e-12);
  }
}

// A cubic is told by its ends and two moments.
TEST(Excitation, JoinedRowsOfACubicAreThatCubic) {
  const auto cubic = [](double t) { return t * t * t - 4 * t * t + 3; };
  const Excitation joined = Excitation(0, 0.1, samples_of(cubic, 47, 0.1), Interpolation::cubic).joined(7);
  EXPECT_EQ(joined.rows(), 7);
  for (const double t : {0.0, 0.31, 1.05, 2.66, 4.17}) EXPECT_NEAR(joined.at(t), cubic(t), 1e-12) << t;
}

TEST(Excitation, MoreIsReadAsTheSamplesAre) {
  const auto force = samples_of([](double t) { return std::sin(t); }, 40, 0.1);
  std::vector<double> more(40, 0.0), sum = force;
  for (std::size_t i = 0; i < more.size(); ++i) sum[i] += more[i] = 0.1 * std::cos(40.0 * static_cast<double>(i));
  for (const Interpolation kind :
       {Interpolation::hold, Interpolation::linear, Interpolation::cubic, Interpolation::band_limited})
    EXPECT_NEAR(Excitation(0, 0.1, force, kind).plus(more).at(1.234), Excitation(0, 0.1, sum, kind).at(1.234), 1e-9);
  const Excitation exact(0, 0.1, 40, [](double t) { return std::sin(t); }), joined = exact.joined(3);
  EXPECT_NEAR(exact.plus(more).at(1.2), std::sin(1.2) + more[12], 1e-9);
  EXPECT_FALSE(exact.plus(more).analytic());
  const std::vector<double> three(14, 0.5);
  EXPECT_NEAR(joined.plus(three).at(1.234), joined.at(1.234) + 0.5, 1e-12);
  EXPECT_NEAR(joined.part(4, 5).plus(std::vector<double>(5, 0.5)).at(1.5), joined.at(1.5) + 0.5, 1e-12);
  EXPECT_EQ(fault_of([&] { joined.plus(more); }), "excitation: expected 14 values to add, got 40");
  EXPECT_EQ(fault_of([&] { joined.joined(14); }), "excitation: joined: expected 1 to 13 rows, got 14");
}

TEST(Excitation, OfARecord) {
  Pool pool;
  const Expr formula = parse(pool, "3*cos(20*t)");
  Channel force;
  force.name = "F";
  force.formula = formula;
  force.values = Eigen::VectorXd::NullaryExpr(50, [](Eigen::Index i) { return 3 * std::cos(20 * (1 + 0.02 * i)); });
  const Record record("made", 1, 0.02, {force});
  EXPECT_NEAR(excitation_of(record).at(1.511), 3 * std::cos(20 * 1.511), 1e-14);
  EXPECT_NEAR(excitation_of(record.window(1.2, 1.9)).at(1.511), 3 * std::cos(20 * 1.511), 1e-14);
  const double line = 0.45 * force.values[25] + 0.55 * force.values[26];
  EXPECT_NEAR(excitation_of(record, Interpolation::linear).at(1.511), line, 1e-12);  // asked for
  force.formula = parse(pool, "k*t");
  EXPECT_EQ(fault_of([&] { excitation_of(Record("made", 1, 0.02, {force})); }).find("k") == std::string::npos, false);
}

}  // namespace
}  // namespace lunid
