// Maps of the residual: what they say of known forces, and how often they speak up where there is noise alone.
#include <gtest/gtest.h>

#include <cmath>

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
  int y = 0, v = 0, harmonic = 0, slow = 0;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    const ResidualMaps maps = map_residual(rows_of(1, seed, [](double, double, double) { return 0.0; }));
    y += maps.map("y").any_above();
    v += maps.map("v").any_above();
    harmonic += maps.map("harmonic").any_above();
    slow += maps.slow.changes[0] || maps.slow.changes[1] || maps.slow.changes[2];
  }
  EXPECT_LE(y, 10);
  EXPECT_LE(v, 10);
  EXPECT_LE(harmonic, 10);
  EXPECT_LE(slow, 10);
}

TEST(ResidualMaps, NoDataIsSaid) {
  const ResidualMaps maps = map_residual(rows_of(0.1, 1, [](double, double, double) { return 0.0; }));
  EXPECT_TRUE(std::isnan(maps.plane.before(0, 0)));  // the corner: largest displacement and largest speed at once
  EXPECT_NE(maps.no_data.find("above 1 m,"), std::string::npos) << maps.no_data;
}

}  // namespace
}  // namespace lunid
