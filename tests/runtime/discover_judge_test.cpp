// When a set of effects is rejected against another.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "discover/baseline.hpp"
#include "discover/judge.hpp"
#include "discover/linearised.hpp"
#include "discover/naming.hpp"
#include "discover/proposal_fits.hpp"
#include "discover/refute.hpp"
#include "discover_catalogue.hpp"

namespace lunid {
namespace {

constexpr int rows = 2000;
constexpr double noise = 0.01;

/// Residuals of white noise of one deviation; a burst of rows may hold more.
Eigen::VectorXd residual(double deviation, double burst) {
  Philox random(5, 1);
  Eigen::VectorXd out(rows);
  for (int i = 0; i < rows; ++i) {
    out[i] = deviation * random.normal();
    if (i >= 900 && i < 940) out[i] += burst * std::sin(0.7 * i);
  }
  return out;
}

struct Compared {
  Study study;
  Candidate best, other;

  Compared(double deviation, double burst) {
    const Model model = testing::baseline("k*y", 1);
    Channel y = testing::channel("y", "m", std::vector<double>(rows, 0.0));
    y.noise = noise;
    study.full.emplace_back("r", 0, 1, std::vector<Channel>{y});
    study.train.push_back({study.full.front(), {}, {}});
    fill(best, model, residual(deviation, 0));
    fill(other, model, residual(deviation, burst));
  }

  void fill(Candidate& c, const Model& model, const Eigen::VectorXd& e) const {
    c = compile(study, complete(model), {});
    c.fit.residual = {e};
    c.innovations = e;
    c.likelihood_cost = e.squaredNorm();
  }
};

/// A model with one force more, whose parameter came out as `value` with a variance of 1.
Candidate with_force(const Study& study, double value, const std::string& force = "drag_c*abs(v)*v") {
  const Model model = testing::baseline("k*y", 1);
  static std::vector<Effect> kept;
  kept = {testing::entry(*model.pool, "drag", force, {testing::row("drag_c")})};
  Candidate c = compile(study, complete(model), {{&kept.front(), 0}});
  c.fit.theta = Eigen::Vector2d(1, value);
  c.fit.covariance = Eigen::Matrix2d::Identity();
  return c;
}

/// A model with a power of the rate more, whose size is known to this part at a rate of 1, as it stands in smaller
/// units.
Candidate with_power(const Study& study, double power, double relative, double unit) {
  constexpr double value = 0.4, of_power = 0.05;
  const Model model = testing::baseline("k*y", 1);
  static std::vector<Effect> kept;
  kept = {testing::entry(*model.pool, "drag", "drag_c*abs(v)^drag_p*sign(v)",
                         {testing::row("drag_c"), testing::row("drag_p")})};
  Candidate c = compile(study, complete(model), {{&kept.front(), 0}});
  const double there = value * std::pow(unit, power), slope = there * std::log(unit);
  c.fit.theta = Eigen::Vector3d(1, there, power);
  c.fit.covariance = Eigen::Matrix3d::Identity();
  c.fit.covariance(1, 1) = std::pow(relative * there, 2) + std::pow(slope * of_power, 2);
  c.fit.covariance(1, 2) = c.fit.covariance(2, 1) = slope * of_power * of_power;
  c.fit.covariance(2, 2) = of_power * of_power;
  return c;
}

TEST(ClosedShare, AModelThatIsWorseThanNoneCountsAsNone) {
  EXPECT_DOUBLE_EQ(closed_share(1e6, 0.3, 0), closed_share(1, 0.3, 0));
  EXPECT_DOUBLE_EQ(closed_share(INFINITY, 0.3, 0), 1 - 0.3 * 0.3);
  EXPECT_DOUBLE_EQ(closed_share(0.5, 0.1, 0.1), 1);
}

/// The coefficient of a power is another number in other units, and its deviation holds that of the exponent there.
TEST(Judge, ACoefficientOfAPowerIsToldFromZeroInAllUnits) {
  const Compared c(noise, 0);
  for (const double unit : {1.0, 1e3, 1e6})
    EXPECT_TRUE(told_from_zero(c.study, with_power(c.study, 1.5, 0.1, unit), c.best)) << unit;
}

/// A baseline whose fit ended elsewhere makes the likelihood of any force that started better: the force's own
/// coefficient knows better.
TEST(Judge, AForceWhoseCoefficientMayBeZeroIsNone) {
  const Compared c(noise, 0);
  EXPECT_FALSE(told_from_zero(c.study, with_force(c.study, 1.5), c.best));
  EXPECT_FALSE(told_from_zero(c.study, with_force(c.study, -1.5), c.best));
  EXPECT_TRUE(told_from_zero(c.study, with_force(c.study, -2.5), c.best));
  EXPECT_TRUE(told_from_zero(c.study, c.other, c.best));  // no coefficient of its own
}

/// Over a chaotic run all parameters do the same: one of which the rows say nothing has a variance of zero.
TEST(Judge, AForceWhoseCoefficientIsNotSeenIsNone) {
  const Compared c(noise, 0);
  Candidate larger = with_force(c.study, 2.5);
  larger.fit.covariance(1, 1) = 0;
  larger.fit.unseen = {0, 1};
  EXPECT_FALSE(told_from_zero(c.study, larger, c.best));
  EXPECT_TRUE(std::isnan(fitted(larger).parameters[1].std));
}

/// Along which forces are compared; `size`: its largest value.
void add_motion(Compared& c, double size = 1) {
  std::vector<Channel> motion;
  for (const char* name : {"y", "v", "a", "F"}) {
    std::vector<double> values(rows);
    for (int i = 0; i < rows; ++i) values[static_cast<std::size_t>(i)] = size * std::sin(0.1 * i + (*name == 'v'));
    motion.push_back(testing::channel(name, "1", std::move(values)));
  }
  c.study.smooth.emplace_back("r", 0, 1, motion);
  c.best.fit.theta = Eigen::VectorXd::Ones(1);
}

/// A hidden mass of 6(5) kg: no coefficient, but without it there is no force.
TEST(Judge, AForceWhoseSizeMayBeZeroIsNone) {
  Compared c(noise, 0);
  add_motion(c);
  const std::string size = "drag_c*drag_c*v", shape = "0.1*tanh(v/drag_c)";
  EXPECT_FALSE(told_from_zero(c.study, with_force(c.study, 1.5, size), c.best));
  EXPECT_TRUE(told_from_zero(c.study, with_force(c.study, 2.5, size), c.best));
  EXPECT_TRUE(told_from_zero(c.study, with_force(c.study, 1.5, shape), c.best));  // sharper where it goes to zero
}

/// Bristles whose own damping may be zero: their spring is the force.
TEST(Judge, AForceThatIsThereWithoutItsCoefficientIsToldByItsOtherNumbers) {
  Compared c(noise, 0);
  add_motion(c);
  EXPECT_FALSE(told_from_zero(c.study, with_force(c.study, 1.5, "drag_c*v"), c.best));
  EXPECT_TRUE(told_from_zero(c.study, with_force(c.study, 1.5, "tanh(v) + 0.1*drag_c*v"), c.best));
}

/// Beside c*v a power near 1 grows without end. In small units the coefficient of any power is uncertain: the force is
/// not.
TEST(Judge, ASizeIsToldByItsForceInAllUnits) {
  for (const double unit : {1.0, 1e3, 1e6})
    for (const double relative : {0.1, 0.9, 1.1}) {
      Compared c(noise, 0);
      add_motion(c, 1 / unit);
      EXPECT_EQ(sizes_are_told(c.study, with_power(c.study, 1.1, relative, unit)), relative < 1)
          << unit << ' ' << relative;
    }
}

/// A run of ten rows with this squared error, beside a motion of variance 1.
std::vector<FreeRun> run_with(double squares) {
  FreeRun run;
  run.rows = 10;
  run.squares = squares;
  run.variance = 10;
  return {run};
}

/// The first state may carry nearly all of a floor: no reported gap lies below such a guess.
TEST(Judge, AFloorThatIsKnownBadlyIsBoundedByTheRun) {
  std::vector<FreeRun> run = run_with(0.1);
  run[0].rows = 1000;
  run[0].floor_squares = 0.105;
  EXPECT_NEAR(pool_gap(run, 0).floor, std::sqrt(0.0105), 1e-12);  // within its own deviation: chance
  run[0].floor_squares = 10;
  run[0].floor_variance = 400;
  EXPECT_EQ(pool_gap(run, 0).floor, pool_gap(run, 0).value);
  run[0].floor_squares = 0.01;
  EXPECT_NEAR(pool_gap(run, 0).floor, std::sqrt(0.001), 1e-12);
}

TEST(Judge, ANameLowersTheGap) {
  Study study;
  const DiscoverOptions options;
  study.options = &options;
  EXPECT_FALSE(lowers_the_gap(study, run_with(1), run_with(1.1)));
  EXPECT_FALSE(lowers_the_gap(study, run_with(1), run_with(0.9999)));
  EXPECT_TRUE(lowers_the_gap(study, run_with(1), run_with(0.5)));
  EXPECT_TRUE(lowers_the_gap(study, run_with(NAN), run_with(0.5)));
}

/// A passage of forty rows holds all that tells the two apart: one observation to Vuong's test, but beyond the noise.
TEST(Judge, RejectsWhatStaysAboveTheNoiseInOnePassage) {
  const Compared c(noise, 0.05);
  EXPECT_LT(vuong_z(c.best, c.other), vuong_level);
  EXPECT_TRUE(fits_worse(c.study, c.other, c.best));
  EXPECT_FALSE(fits_worse(c.study, c.best, c.other));
}

/// Where the better one is above the noise itself, such a passage may be a disturbance that it happens to follow.
TEST(Judge, KeepsBothWhereTheBetterOneIsAboveTheNoiseToo) {
  const Compared c(3 * noise, 0.15);
  EXPECT_FALSE(fits_worse(c.study, c.other, c.best));
}

TEST(Judge, KeepsBothWhereTheyDifferByLittle) {
  const Compared c(noise, 0.01);
  EXPECT_FALSE(fits_worse(c.study, c.other, c.best));
}

/// Whether names stand where the baseline leaves a part of the test motion, they another, and noise alone the floor.
std::string refuted_on(const Study& study, const Round& round, double baseline, double test, double floor) {
  FreeRun before, after;
  before.rows = after.rows = 1000;
  before.variance = after.variance = 1;
  before.floor_squares = after.floor_squares = floor * floor;
  before.squares = baseline * baseline;
  after.squares = test * test;
  return refuted(study, round, 0.001, {before}, {after});
}

/// The verdict on names whose free run leaves these parts of the training and of the test motion, where the baseline
/// left this part.
std::string verdict_on(int names, double train, double test, double floor, bool leaves_a_force = false,
                       double baseline = 1.25) {
  DiscoverOptions options;
  Study study;
  study.options = &options;
  const Model model = testing::baseline("k*y", 1);
  const std::vector<Effect> catalogue = testing::small_catalogue(*model.pool);
  study.full.emplace_back("driven", 0, 1, std::vector<Channel>{testing::channel("F", "N", {0, 1})});
  Round round;
  for (int i = 0; i < names; ++i) round.found.chosen.choices.push_back({&catalogue[static_cast<std::size_t>(i)], 0});
  round.found.baseline.fit.cost = INFINITY;  // of no run
  round.left.gap.value = train;
  round.left.gap.floor = floor;
  round.left.seen = round.left.material = round.left.whole = leaves_a_force;
  round.left.closure.system = compile(study, complete(testing::baseline("k*y", 1)), {}).system;
  return refuted_on(study, round, baseline, test, floor);
}

TEST(Verdict, AsksMoreOfSeveralNamesThanOfOne) {
  EXPECT_EQ(verdict_on(1, 0.18, 0.19, 0.01), "");
  EXPECT_EQ(verdict_on(2, 0.18, 0.19, 0.01), "left much of the gap on the test record open");
  EXPECT_EQ(verdict_on(1, 0.1, 0.1, 0.01, false, 0.37), "");  // 93 % of the excess closed
  EXPECT_EQ(verdict_on(2, 0.1, 0.1, 0.01, false, 0.37), "left much of the gap on the test record open");
  EXPECT_EQ(verdict_on(2, 0.07, 0.07, 0.01, false, 0.5), "");
}

/// Flag-shaped loops were a spring that saturates and a pile's shaft, a tenth of the motion and thirty floors open. A
/// mean force beside a name has no shape that could follow another's.
TEST(Verdict, AsksOfTwoShapesThatTheyLeaveHalfAsMuchOfTheMotion) {
  const std::string much = "left much of the gap on the test record open";
  EXPECT_EQ(verdict_on(2, 0.1, 0.1, 0.01, false, 0.5), much);
  EXPECT_EQ(verdict_on(1, 0.1, 0.1, 0.01, false, 0.5), "");
  DiscoverOptions options;
  Study study;
  study.options = &options;
  study.full.emplace_back("driven", 0, 1, std::vector<Channel>{testing::channel("F", "N", {0, 1})});
  Effect friction, mean;
  friction.name = "bouc_wen";
  friction.family = "hysteresis";
  mean.family = "stiffness";
  for (const char* name : {"constant_force", "cubic_stiffness"}) {
    mean.name = name;
    Round round;
    round.found.chosen.choices = {{&friction, 0}, {&mean, 0}};
    round.found.baseline.fit.cost = NAN;  // it could not be run
    round.left.gap.value = 0.1;
    round.left.gap.floor = 0.01;
    EXPECT_EQ(refuted_on(study, round, 0.5, 0.1, 0.01), mean.name == "constant_force" ? "" : much) << name;
  }
}

TEST(Verdict, TakesNoNameBackForASmallForceBesideThoseThatCloseNearlyAll) {
  EXPECT_EQ(verdict_on(1, 0.011, 0.06, 0.02, true), "left a force that is repeatable");
  EXPECT_EQ(verdict_on(1, 0.011, 0.04, 0.02, true), "");
}

TEST(Verdict, AsksOfThreeNamesThatTheyLeaveNoRepeatableForce) {
  const std::string another = "left a repeatable force beside several: they follow another one";
  EXPECT_EQ(verdict_on(3, 0.036, 0.07, 0.02, true), another);
  EXPECT_NE(verdict_on(2, 0.036, 0.07, 0.02, true), another);
  EXPECT_NE(verdict_on(3, 0.036, 0.07, 0.02, false), another);
  EXPECT_EQ(verdict_on(3, 0.03, 0.045, 0.02, true), another);  // however much they close
}

/// A dashpot that acts beyond a gap was a power of the rate, beside a damper that fed the motion.
TEST(Verdict, TakesBackNamesThatMakeTheBaselinesDampingNegative) {
  const auto feeds = [](double c, double std, double test, const std::string& restoring, bool material = false,
                        const std::vector<Twin>& twins = {}) {
    DiscoverOptions options;
    Study study;
    study.options = &options;
    const Model model = testing::baseline(restoring, 1);
    std::vector<Effect> catalogue = testing::small_catalogue(*model.pool);
    catalogue[0].twins = twins;
    study.full.emplace_back("driven", 0, 1, std::vector<Channel>{testing::channel("F", "N", {0, 1})});
    Round round;
    round.found.baseline = compile(study, complete(model), {});
    round.found.chosen = round.found.baseline;
    round.found.baseline.fit.theta = Eigen::Vector2d(1, 1);
    round.found.baseline.fit.covariance = Eigen::Vector2d(1e-4, 1e-2).asDiagonal();
    round.found.chosen.fit.theta = Eigen::Vector2d(1, c);
    round.found.chosen.fit.covariance = Eigen::Vector2d(1e-4, std * std).asDiagonal();
    round.found.baseline.fit.cost = round.found.chosen.fit.cost = 1;
    round.found.chosen.choices.push_back({&catalogue[0], 0});
    round.left.gap.value = round.left.gap.floor = 0.02;
    round.left.material = material;
    return refuted_on(study, round, 1, test, 0.02);
  };
  EXPECT_EQ(feeds(-3.1, 0.6, 0.035, "k*y + c*v"), "left something open, and made the baseline's own damping negative");
  EXPECT_EQ(feeds(-3.1, 2, 0.035, "k*y + c*v"), "");
  EXPECT_EQ(feeds(-3.1, 0.6, 0.025, "k*y + c*v"), "");
  EXPECT_EQ(feeds(-3.1, 0.6, 0.025, "k*y + c*v", true),
            "left something open, and made the baseline's own damping negative");
  EXPECT_EQ(feeds(-3.1, 0.6, 0.035, "k*y + c*y^3"), "");
  EXPECT_EQ(feeds(-3.1, 1.3, 0.035, "k*y + c*v"), "");
  EXPECT_EQ(feeds(-3.1, 1.3, 0.07, "k*y + c*v"), "left something open, and made the baseline's own damping negative");
  EXPECT_EQ(feeds(-3.1, 0.6, 0.035, "k*y + c*v", false, {{"mu", "c"}}), "") << "c holds the entry's own mu";
  // A power of the rate near 1 and the baseline's own c*v, each many times what there is, take each other back.
  EXPECT_EQ(feeds(-36, 500, 0.035, "k*y + c*v"), "left something open, and made the baseline's own damping negative");
  EXPECT_EQ(feeds(-8, 500, 0.035, "k*y + c*v"), "");
}

/// Whether the one linear entry stands with this value beside k*y, where it leaves this part of the test motion and the
/// baseline all of it.
std::string refuted_with(const Model& model, const Effect& entry, double value, double test) {
  DiscoverOptions options;
  Study study;
  study.options = &options;
  std::vector<double> y, v;
  for (int i = 0; i < 100; ++i) y.push_back(std::sin(0.3 * i)), v.push_back(0.3 * std::cos(0.3 * i));
  study.full.emplace_back("driven", 0, 1,
                          std::vector<Channel>{testing::channel("y", "m", y), testing::channel("v", "m/s", v),
                                               testing::channel("a", "m/s^2", y), testing::channel("F", "N", y)});
  study.smooth = study.full;
  Round round;
  round.found.baseline = compile(study, complete(model), {});
  round.found.chosen = compile(study, complete(model), {{&entry, 0}});
  round.found.baseline.fit.theta = Eigen::VectorXd::Ones(1);
  round.found.chosen.fit.theta = Eigen::Vector2d(1, value);
  round.found.baseline.fit.cost = round.found.chosen.fit.cost = 1;
  round.left.gap.value = round.left.gap.floor = 0.02;
  return refuted_on(study, round, 1, test, 0.02);
}

/// Magnets that leave their plate were a rounded friction and one that turns round with |y|.
TEST(Verdict, TakesBackAFrictionThatDrivesTheMotion) {
  const Model model = testing::baseline("k*y", 1);
  Effect friction = testing::entry(*model.pool, "friction", "friction_Fc*sign(v)", {testing::row("friction_Fc")});
  friction.family = "friction";
  const auto with_friction = [&](double Fc, double test) { return refuted_with(model, friction, Fc, test); };
  EXPECT_EQ(with_friction(-0.1, 0.035), "left something open, and has a friction that drives the motion");
  EXPECT_EQ(with_friction(0.1, 0.035), "");
  EXPECT_EQ(with_friction(-0.1, 0.025), "");
}

/// A sensor on a part that gives way was a second mass, with all of the given one taken away.
TEST(Verdict, TakesBackNamesThatTakeTheMassAway) {
  const Model model = testing::baseline("k*y", 75);
  const Effect added = testing::entry(*model.pool, "added_mass", "added_mass_ma*a", {testing::row("added_mass_ma")});
  const auto with_mass = [&](double ma, double test) { return refuted_with(model, added, ma, test); };
  EXPECT_EQ(with_mass(-74.9, 0.035), "left something open, and took the mass away that the baseline has");
  EXPECT_EQ(with_mass(-60, 0.035), "");
  EXPECT_EQ(with_mass(-74.9, 0.025), "") << "the given mass is ten times too large: this is the answer";
}

TEST(Verdict, AsksOfThreeNamesThatTheyLeaveLittle) {
  EXPECT_EQ(verdict_on(3, 0.036, 0.07, 0.02), "left far more than noise on the test record");
  EXPECT_EQ(verdict_on(2, 0.036, 0.07, 0.02), "");
  EXPECT_EQ(verdict_on(3, 0.036, 0.055, 0.02), "");
}

/// An exponential spring was a stop, a quadratic spring, a cubic one and a clearance.
TEST(Verdict, TakesThreeSpringsAtOnePlaceForASeries) {
  const auto spring = [](const std::string& name, std::optional<Place> place = {}) {
    Effect out;
    out.name = name;
    out.family = name == "quadratic_drag" ? "damping" : "stiffness";
    out.place = place;
    return out;
  };
  const Effect cubic = spring("cubic_stiffness"), square = spring("quadratic_stiffness"), gap = spring("clearance"),
               weight = spring("constant_force"), drag = spring("quadratic_drag"),
               elsewhere = spring("clearance", Place{1, 0});
  EXPECT_TRUE(is_series({{&cubic, 0}, {&square, 0}, {&gap, 0}}));
  EXPECT_FALSE(is_series({{&cubic, 0}, {&square, 0}, {&drag, 0}}));
  EXPECT_FALSE(is_series({{&cubic, 0}, {&square, 0}, {&weight, 0}}));  // a cubic spring that rests elsewhere
  EXPECT_FALSE(is_series({{&cubic, 0}, {&square, 0}, {&elsewhere, 0}}));
}

TEST(Verdict, TakesTwoSpringsThatLeaveSomethingForASeries) {
  Effect cubic, square, drag;
  cubic.family = square.family = "stiffness";
  drag.family = "damping";
  const Choices springs{{&cubic, 0}, {&square, 0}}, others{{&cubic, 0}, {&drag, 0}};
  Gap train;
  train.value = 0.02;
  train.floor = 0.01;
  EXPECT_TRUE(is_loose_series(springs, train, 0.99));
  EXPECT_FALSE(is_loose_series(springs, train, 0.999));
  EXPECT_FALSE(is_loose_series(others, train, 0.99));
  train.value = 0.014;
  EXPECT_FALSE(is_loose_series(springs, train, 0.99));
}

/// A magnet's force was a cubic spring and a clearance that pull against each other: they closed 99.9 % of the excess,
/// and left ten floors.
TEST(Verdict, TakesTwoSpringsBackThatLeaveARepeatableForceHoweverMuchTheyClose) {
  DiscoverOptions options;
  Study study;
  study.options = &options;
  study.full.emplace_back("driven", 0, 1, std::vector<Channel>{testing::channel("F", "N", {0, 1})});
  Effect cubic, gap, drag;
  cubic.family = gap.family = "stiffness";
  drag.family = "damping";
  const auto judged = [&](const Effect& other, bool repeatable) {
    Round round;
    round.found.chosen.choices = {{&cubic, 0}, {&other, 0}};
    round.found.baseline.fit.cost = NAN;  // it could not be run
    round.left.gap.value = 0.02;
    round.left.gap.floor = 0.003;
    round.left.seen = round.left.material = round.left.whole = repeatable;
    return refuted_on(study, round, 0.6, 0.02, 0.003);
  };
  EXPECT_EQ(judged(gap, true), "left a force that is repeatable");
  EXPECT_EQ(judged(gap, false), "");
  EXPECT_EQ(judged(drag, true), "");
}

TEST(Verdict, AsksOfAnyNameThatItClosesFourFifthsOfTheTest) {
  EXPECT_EQ(verdict_on(1, 0.35, 0.6, 0.3), "left a good part of the gap on the test record open");
  EXPECT_EQ(verdict_on(1, 0.35, 0.5, 0.3), "");
  EXPECT_EQ(verdict_on(1, 0.35, 0.44, 0.3), "");
}

/// A sum of powers follows any smooth curve within the motion that it was fitted to.
TEST(Verdict, AsksOfThreeNamesThatTheyReachTheFloorOfTheTest) {
  const std::string patchwork =
      "fitted the training records down to their noise by several forces, but not the test record";
  EXPECT_EQ(verdict_on(2, 0.102, 0.125, 0.1), "");
  EXPECT_EQ(verdict_on(2, 0.102, 0.16, 0.1), patchwork);
  EXPECT_EQ(verdict_on(3, 0.102, 0.125, 0.1), patchwork);
  EXPECT_EQ(verdict_on(3, 0.102, 0.108, 0.1), "");
}

/// At resonance the steady motion goes as 1/c: a relative deviation of c is that of the motion.
TEST(Gap, OfTheParametersIsTheirDeviationTimesTheSlopes) {
  constexpr double c = 0.2, part = 0.01;
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  std::vector<double> force, motion;
  for (int i = 0; i < 1500; ++i) {
    const double t = 0.25 * i;
    force.push_back(std::sin(t));
    motion.push_back(-std::cos(t) / c);
  }
  const Record record =
      derive_motion(Record("tone", 0, 0.25, {testing::channel("F", "N", force), testing::channel("y", "m", motion)}));
  const DiscoverOptions options;
  const Study study = prepare(model, {record}, {record}, options);
  Candidate candidate = compile(study, model, {});
  candidate.fit.theta = Eigen::Vector2d(1, c);
  candidate.fit.substeps = 4;
  EXPECT_EQ(parameter_spread(study, candidate, study.test), 0);  // not known
  candidate.fit.covariance = Eigen::Vector2d(0, std::pow(part * c, 2)).asDiagonal();
  const double spread = parameter_spread(study, candidate, study.test);
  EXPECT_NEAR(spread, part, 0.5 * part);  // of twelve draws
  candidate.fit.covariance *= 4;
  EXPECT_NEAR(parameter_spread(study, candidate, study.test), 2 * spread, 0.05 * spread);
}

/// A set that runs away would be followed by implicit steps for minutes.
TEST(Search, TriesItsSetsOnTheFixedPath) {
  const DiscoverOptions options;
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  const truth::Motion motion =
      truth::integrate({}, truth::multisine(0.2, 2.2, 60, 3), 0.3, {}, 800, testing::spacing, 16);
  const Record record = testing::noisy_record(motion, "y", motion.x, 0.01, 3);
  const Study study = prepare(model, {record}, {record}, options);
  const Candidate stiff = compile(study, model, {});
  const FitResult fit = fit_near(study, stiff, Eigen::Vector2d(1, 4e4), 4, 0);
  EXPECT_EQ(fit.solver.rfind("fixed", 0), 0u) << fit.solver;
}

/// One set may come out of a search twice, grown from each of its members.
TEST(Naming, EndsWhereASetIsItsOwnRival) {
  const DiscoverOptions options;
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  const std::vector<Effect> catalogue = testing::small_catalogue(*model.pool);
  truth::Physics physics;
  physics.k3 = 0.4;
  const truth::Motion motion =
      truth::integrate(physics, truth::multisine(0.2, 2.2, 60, 3), 0.3, {}, 1500, testing::spacing, 16);
  const Record record = testing::noisy_record(motion, "y", motion.x, 0.01, 3);
  const Study study = prepare(model, {record}, {record}, options);
  std::vector<std::string> warnings;
  const Candidate baseline = fit_baseline(study, model, warnings);
  SearchResult found = search(study, model, baseline, catalogue, {}, false, [](const std::string&, double) {});
  ASSERT_EQ(found.chosen.name(), "cubic_stiffness");
  found.rivals.push_back({found.chosen, Beaten::By::training, ""});
  EXPECT_EQ(bootstrap_naming(study, found, 20).of("cubic_stiffness"), 20);
}

/// A stiff solver may take minutes over what a fit in coarse fixed steps took for a motion.
TEST(Judge, StaysWithTheStepsThatAFitWasRunIn) {
  const Model model = complete(testing::baseline("k*y + c*v", 1));
  const truth::Motion motion =
      truth::integrate({}, truth::multisine(0.2, 2.2, 20, 5), 0.2, {}, 300, testing::spacing, 16);
  DiscoverOptions options;
  const Study study = prepare(model, {testing::noisy_record(motion, "y", motion.x, 1e-3, 5)}, {}, options);
  Candidate c = compile(study, model, {});
  FitOptions few = full_fit(study, 1);
  const auto judged_after = [&](const std::string& solver) {
    c.fit = fit_trajectory(*c.system, Eigen::Vector2d(1, 1e4), study.train, few);
    EXPECT_EQ(c.fit.solver, "CVODE BDF");
    c.fit.solver = solver;
    for (Eigen::VectorXd& r : c.fit.residual) r *= 2;
    judge(study, c, {}, 1);
    return c.whitened.solver;
  };
  EXPECT_EQ(judged_after("fixed DP5, 1 substep"), "fixed DP5, 1 substep");
  EXPECT_EQ(judged_after("CVODE BDF"), "CVODE BDF");
}

/// Twenty elements that slip within the first swing share what little the record knows of where they began.
TEST(Judge, FirstValuesThatTheMotionForgetsCostWhatTheRecordTellsOfThem) {
  Model model = testing::baseline("k*y + c*v", 1);
  const truth::Motion motion =
      truth::integrate({}, truth::multisine(0.2, 2.2, 20, 5), 0.2, {}, 1500, testing::spacing, 16);
  DiscoverOptions options;
  const Study study = prepare(complete(model), {testing::noisy_record(motion, "y", motion.x, 0.02, 5)}, {}, options);
  Effect loop = testing::entry(*model.pool, "loop", "0", {testing::row("loop_k")});
  Expr sum = model.pool->constant(0);
  for (int i = 1; i <= 20; ++i) {
    const Expr z = model.pool->state("z" + std::to_string(i)), reach = model.pool->constant(1e-3 * i);
    sum = sum + z;
    loop.states.push_back({z, model.pool->channel("v"), 0, -reach, reach});
  }
  loop.variants[0].force = model.pool->parameter("loop_k") * sum;
  Candidate c = compile(study, complete(model), {{&loop, 0}});
  c.fit = fit_trajectory(*c.system, Eigen::Vector3d(1, 0.06, 1e-3), study.train, full_fit(study, 1));
  judge(study, c, {}, 1);
  const double one = 0.5 * std::log(static_cast<double>(c.innovations.size()));
  const double all = price_of_unknowns(c, static_cast<double>(c.innovations.size())) - c.parameters() * one;
  EXPECT_GE(all, 0.5 * 20) << "each may follow noise";
  EXPECT_LT(all, 0.5 * 20 + one);
}

/// Two outputs of three records: the rows of a record's second output stand behind those of all first ones.
TEST(Linearised, WithoutFirstStatesLeavesTheSameParametersAndMisfit) {
  constexpr Eigen::Index rows = 12, outputs = 2, records = 3, parameters = 2, states = 3;
  Philox random(5, 1);
  Linearised linear;
  linear.columns.setZero(outputs * records * rows, parameters + records * states);
  linear.residual = Eigen::VectorXd::NullaryExpr(linear.columns.rows(), [&](Eigen::Index) { return random.normal(); });
  for (Eigen::Index s = 0; s < outputs * records; ++s) {
    linear.row_of_record.push_back(s * rows);
    for (Eigen::Index i = s * rows; i < (s + 1) * rows; ++i) {
      for (Eigen::Index j = 0; j < parameters; ++j) linear.columns(i, j) = random.normal();
      for (Eigen::Index j = 0; j < states; ++j)
        linear.columns(i, parameters + s % records * states + j) = j == 2 ? 0 : random.normal();  // a state not seen
    }
  }
  linear.row_of_record.push_back(linear.columns.rows());
  for (Eigen::Index r = 0; r <= records; ++r) linear.state_of_record.push_back(parameters + r * states);
  const Eigen::VectorXd all = linear.columns.completeOrthogonalDecomposition().solve(linear.residual);
  const double misfit = (linear.residual - linear.columns * all).squaredNorm();
  project_first_states(linear);
  ASSERT_EQ(linear.columns.cols(), parameters);
  const Eigen::VectorXd own = linear.columns.householderQr().solve(linear.residual);
  EXPECT_LT((own - all.head(parameters)).norm(), 1e-12);
  EXPECT_NEAR((linear.residual - linear.columns * own).squaredNorm(), misfit, 1e-12);
}

}  // namespace
}  // namespace lunid
