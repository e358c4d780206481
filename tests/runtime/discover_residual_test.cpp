// Maps of the residual: what they say of known forces, and how often they speak up where there is noise alone.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "discover/residual_maps.hpp"
#include "record/random.hpp"

namespace lunid {
namespace {

/// A motion of slowly changing amplitude up to 1 with a force on it, and noise of the colour x_i = 0.9 x_(i-1) + e_i.
ResidualRows rows_of(double noise, std::uint64_t seed, const std::function<double(double y, double v, double t)>& force,
                     int count = 2400) {
  ResidualRows rows;
  rows.dt = 0.05;
  rows.omega = 2 * M_PI / 2;
  rows.block = 80;
  rows.seed = 1;
  rows.row_of_record = {0, count};
  rows.t.resize(count);
  rows.y = rows.v = rows.force = rows.t;
  Philox random(seed, 0);
  double coloured = 0;
  for (int i = 0; i < count; ++i) {
    const double t = 0.05 * i, amplitude = 0.7 + 0.3 * std::sin(0.11 * t);
    rows.t[i] = t;
    rows.y[i] = amplitude * std::sin(rows.omega * t);
    rows.v[i] = amplitude * rows.omega * std::cos(rows.omega * t);
    coloured = 0.9 * coloured + random.normal();
    rows.force[i] = noise * coloured + force(rows.y[i], rows.v[i], t);
  }
  return rows;
}

TEST(ResidualMaps, ACubicGrowsWithDisplacementIsOddAndFeedsTheThirdHarmonic) {
  // the baseline's spring has absorbed what it can: y^3 - 0.5 y has little first harmonic at these amplitudes
  const ResidualMaps maps =
      map_residual(rows_of(0.002, 3, [](double y, double, double) { return y * y * y - 0.42 * y; }));
  EXPECT_GT(maps.map("y").share, 0.95);
  EXPECT_LT(maps.map("v").share, 0.3);
  EXPECT_TRUE(maps.map("harmonic").above(3));
  EXPECT_LT(maps.loop_share, 0.05);
  for (const char* word : {"|y|", "odd", "third harmonic", "the same on loading and unloading"})
    EXPECT_NE(maps.sentence.find(word), std::string::npos) << word << " in: " << maps.sentence;
  EXPECT_EQ(maps.sentence.find("over the record"), std::string::npos) << maps.sentence;
}

TEST(ResidualMaps, FrictionJumpsWithTheSignOfVelocityAndMakesALoop) {
  const ResidualMaps maps = map_residual(rows_of(0.01, 4, [](double, double v, double) { return v > 0 ? 1.0 : -1.0; }));
  EXPECT_TRUE(maps.loop);
  for (const char* word : {"jumps with the sign of v", "different on loading and unloading"})
    EXPECT_NE(maps.sentence.find(word), std::string::npos) << word << " in: " << maps.sentence;
}

TEST(ResidualMaps, ASquareIsEvenAndFeedsTheMeanAndTheSecondHarmonic) {
  const ResidualMaps maps = map_residual(rows_of(0.01, 5, [](double y, double, double) { return y * y; }));
  EXPECT_TRUE(maps.map("harmonic").above(0));
  EXPECT_TRUE(maps.map("harmonic").above(2));
  EXPECT_FALSE(maps.map("harmonic").above(3));
  EXPECT_NE(maps.sentence.find(", even"), std::string::npos) << maps.sentence;
}

TEST(ResidualMaps, AStiffnessThatDriftsChangesOverTheRecord) {
  const ResidualMaps maps =
      map_residual(rows_of(0.01, 6, [](double y, double, double t) { return 0.3 * (t / 60 - 1) * y; }));
  EXPECT_TRUE(maps.slow.changes[1]);
  EXPECT_FALSE(maps.slow.changes[0]);
  EXPECT_NE(maps.sentence.find("its slope in y changes over the record"), std::string::npos) << maps.sentence;
}

/// Half of each harmonic order's power in cos, half in sin: amplitudes of a known sum, by hand.
TEST(ResidualMaps, HarmonicsAreThoseOfTheForceOverTheMotionsPhase) {
  ResidualRows rows = rows_of(0, 1, [](double, double, double) { return 0.0; });
  for (Eigen::Index i = 0; i < rows.force.size(); ++i) {
    const double phase = rows.omega * rows.t[i];  // y = sin: one quarter turn behind the phase of the maps
    rows.force[i] = 0.5 + 2 * std::sin(phase) + 0.75 * std::sin(4 * phase + 1);
  }
  const ResidualMaps maps = map_residual(rows);
  const BinnedMap& map = maps.map("harmonic");
  EXPECT_NEAR(map.value[0], 0.5, 1e-9);
  EXPECT_NEAR(map.value[1], 2, 1e-9);
  EXPECT_NEAR(map.value[4], 0.75, 1e-9);
  for (const int k : {2, 3, 5, 6, 7, 8}) EXPECT_NEAR(map.value[k], 0, 1e-9) << k;
}

/// The level holds for coloured noise: 5 % of records over all bins of a map; of 80 records at most 10 by chance
/// (0.99).
TEST(ResidualMaps, NoiseAloneSeldomRisesAboveTheLevel) {
  std::map<std::string, int> above;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    const ResidualMaps maps = map_residual(rows_of(1, seed, [](double, double, double) { return 0.0; }));
    for (const BinnedMap& map : maps.maps) above[map.over] += map.any_above();
    above["plane"] += (maps.plane.before.array().abs() > maps.plane_level.array()).any();
    above["slow"] += maps.slow.changes[0] || maps.slow.changes[1] || maps.slow.changes[2];
  }
  for (const char* over : {"time", "y", "v", "amplitude", "harmonic", "frequency", "plane", "slow"})
    EXPECT_LE(above.at(over), 10) << over;
  EXPECT_EQ(above.size(), 8u);
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(ResidualMaps, AForceInOneStretchOfTimeShowsThereAlone) {
  const ResidualMaps maps = map_residual(
      rows_of(0.1, 3, [](double, double, double t) { return t > 48 && t < 60 ? std::sin(7.1 * t) : 0.0; }));
  const BinnedMap& map = maps.map("time");
  for (Eigen::Index i = 0; i < map.x.size(); ++i) {
    const double half = 0.5 * (map.x[1] - map.x[0]);
    if (map.x[i] - half > 48.1 && map.x[i] + half < 59.9)
      EXPECT_TRUE(map.above(i)) << map.x[i];
    else if (map.x[i] + half < 48 || map.x[i] - half > 60)
      EXPECT_FALSE(map.above(i)) << map.x[i];
  }
  EXPECT_TRUE(has(map.sentence, "above the noise from 48 s to 60 s; most at 5")) << map.sentence;
  EXPECT_TRUE(has(maps.sentence, "no function of y or v alone, most from 48 s to 60 s")) << maps.sentence;
  EXPECT_TRUE(maps.above_noise);
}

TEST(ResidualMaps, AForceAboveAnAmplitudeShowsThereAlone) {
  const ResidualMaps maps = map_residual(rows_of(0.1, 3, [](double y, double v, double t) {
    return std::hypot(y, v / M_PI) > 0.75 ? std::sin(7.1 * t) : 0.0;  // no function of y and v
  }));
  const BinnedMap& map = maps.map("amplitude");
  ASSERT_EQ(map.x.size(), 12);  // to 1 m
  for (Eigen::Index i = 0; i < map.x.size(); ++i) EXPECT_EQ(map.above(i), map.x[i] > 0.75) << map.x[i];
  EXPECT_TRUE(has(map.sentence, "above the noise from 750 mm to 1 m; most at ")) << map.sentence;
}

// The strongest tone is slow and small: v over its frequency would be ten times the motion.
TEST(ResidualMaps, OfAWideBandTheAmplitudeStaysWithinTheMotion) {
  ResidualRows rows = rows_of(0.1, 3, [](double, double, double) { return 0.0; });
  for (int i = 0; i < rows.t.size(); ++i) {
    const double t = rows.t[i];
    rows.y[i] = std::sin(0.3 * t) + 0.9 * std::sin(7.1 * t);
    rows.v[i] = 0.3 * std::cos(0.3 * t) + 0.9 * 7.1 * std::cos(7.1 * t);
  }
  rows.omega = 0.3;
  const Eigen::VectorXd& x = map_residual(rows).map("amplitude").x;
  EXPECT_LT(x[x.size() - 1], 1.1 * rows.y.maxCoeff());
}

TEST(ResidualMaps, AnEdgeAtZeroIsZero) {
  for (const double scale : {1.0, 0.31, 0.0123, 3.7, 1.3e-6, 0.0777, 41.3}) {
    ResidualRows rows = rows_of(0.05, 3, [](double y, double, double) { return y > 0 ? 1.0 : 0.0; });
    rows.y *= scale;
    rows.v *= scale;
    const std::string sentence = map_residual(rows).map("y").sentence;
    EXPECT_TRUE(has(sentence, "above the noise from 0 ")) << sentence;
  }
}

TEST(ResidualMaps, AForceAtOneFrequencyShowsThereAlone) {
  const ResidualMaps maps =
      map_residual(rows_of(0.1, 3, [](double, double, double t) { return 0.2 * std::sin(2 * M_PI * 1.7 * t); }));
  const BinnedMap& map = maps.map("frequency");
  int above = 0;
  for (Eigen::Index i = 0; i < map.x.size(); ++i) {
    above += map.above(i);
    if (map.above(i)) EXPECT_NEAR(map.x[i], 1.7, 0.16) << i;  // two bins of the segments
  }
  EXPECT_GE(above, 1);
  EXPECT_TRUE(has(map.sentence, "above the noise from 1.")) << map.sentence;
  EXPECT_TRUE(has(maps.sentence, "no function of y or v alone, most at 1.7")) << maps.sentence;
}

TEST(ResidualMaps, ThePhasePlaneShowsACornerOfIt) {
  const ResidualMaps maps =
      map_residual(rows_of(0.05, 3, [](double y, double v, double) { return y > 0.2 && v > 0.6 ? 1.0 : 0.0; }));
  int right = 0, wrong = 0;
  for (Eigen::Index i = 0; i < maps.plane.y.size(); ++i)
    for (Eigen::Index j = 0; j < maps.plane.v.size(); ++j)
      if (std::abs(maps.plane.before(i, j)) > maps.plane_level(i, j))
        ++(maps.plane.y[i] > 0.1 && maps.plane.v[j] > 0.4 ? right : wrong);
  EXPECT_GT(right, 10);
  EXPECT_EQ(wrong, 0);
  EXPECT_TRUE(has(maps.plane_sentence, "above the noise in ")) << maps.plane_sentence;
}

/// Of several records, each of which begins at 0, the time goes on: 100 s each, the force acts in the second.
TEST(ResidualMaps, RecordsThatBeginAnewFollowEachOther) {
  ResidualRows rows = rows_of(
      0.1, 3, [](double, double, double t) { return t > 150 && t < 170 ? std::sin(7.1 * t) : 0.0; }, 4000);
  rows.row_of_record = {0, 2000, 4000};
  for (Eigen::Index i = 2000; i < 4000; ++i) rows.t[i] -= 100;
  const ResidualMaps maps = map_residual(rows);
  EXPECT_NEAR(maps.map("time").x.tail(1)[0], 198, 1);
  EXPECT_TRUE(has(maps.map("time").sentence, "above the noise from 148 s to 172 s")) << maps.map("time").sentence;
  EXPECT_NEAR(maps.slow.time[5], 200 - 100.0 / 6, 0.1);
}

/// What is left of a spring with play at 0.55 beside a baseline whose spring has absorbed what it can.
TEST(ResidualMaps, AClearanceAndAStopSayWhereTheyBegin) {
  const auto beyond = [](double x) { return std::max(0.0, x - 0.55); };
  const ResidualMaps both =
      map_residual(rows_of(0.005, 3, [&](double y, double, double) { return beyond(y) - beyond(-y) - 0.18 * y; }));
  EXPECT_TRUE(has(both.sentence, "grows with |y| above 5")) << both.sentence;
  EXPECT_FALSE(has(both.sentence, "side")) << both.sentence;
  const ResidualMaps stop =
      map_residual(rows_of(0.005, 3, [&](double y, double, double) { return beyond(y) - 0.09 * y - 0.03; }));
  EXPECT_TRUE(has(stop.sentence, "grows with |y| above 5")) << stop.sentence;
  EXPECT_TRUE(has(stop.sentence, " on the positive side")) << stop.sentence;
  // a play that is small beside the motion: what is left of it is much the same size from the first bins on
  const ResidualMaps early = map_residual(rows_of(0.005, 3, [&](double y, double, double) {
    const auto out = [](double x) { return std::max(0.0, x - 0.2); };
    return out(y) - out(-y) - 0.85 * y;
  }));
  EXPECT_TRUE(has(early.sentence, "grows with |y| above 190 mm") || has(early.sentence, "grows with |y| above 200 mm"))
      << early.sentence;
  const ResidualMaps jump =
      map_residual(rows_of(0.005, 3, [](double y, double, double) { return y > 0 ? 1.0 : -1.0; }));
  EXPECT_TRUE(has(jump.sentence, "jumps with the sign of y")) << jump.sentence;
  const ResidualMaps cubic =
      map_residual(rows_of(0.005, 3, [](double y, double, double) { return y * y * y - 0.42 * y; }));
  EXPECT_FALSE(has(cubic.sentence, "above")) << cubic.sentence;
}

TEST(ResidualMaps, AnOffsetIsNoJump) {
  const ResidualMaps maps = map_residual(rows_of(0.05, 3, [](double, double, double) { return 1.0; }));
  EXPECT_TRUE(has(maps.sentence, "is an offset")) << maps.sentence;
}

TEST(ResidualMaps, NoDataIsSaid) {
  const ResidualMaps maps = map_residual(rows_of(0.1, 1, [](double, double, double) { return 0.0; }));
  EXPECT_TRUE(std::isnan(maps.plane.before(0, 0)));  // the corner: largest displacement and largest speed at once
  EXPECT_NE(maps.no_data.find("above 1 m,"), std::string::npos) << maps.no_data;
}

}  // namespace
}  // namespace lunid
