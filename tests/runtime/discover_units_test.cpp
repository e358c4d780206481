// Units of what a discovery says, from those of the records.
#include <gtest/gtest.h>

#include "discover/units.hpp"

namespace lunid {
namespace {

Channel channel(const char* name, const char* unit) {
  Channel out;
  out.name = name;
  out.unit = unit;
  out.values = Eigen::VectorXd::Zero(3);
  return out;
}

Record record(std::vector<Channel> channels) { return Record("record", 0, 0.1, std::move(channels)); }

TEST(Units, OfARecordThatSaysNoneAreThoseOfMechanics) {
  const Units units = units_of(record({channel("y", ""), channel("F", "")}));
  EXPECT_EQ(units.y + ", " + units.v + ", " + units.a + ", " + units.force, "m, m/s, m/s^2, N");
}

TEST(Units, OfWhatWasNotMeasuredFollowFromWhatWas) {
  const Units shaft = units_of(record({channel("v", "rad/s"), channel("F", "N m")}));
  EXPECT_EQ(shaft.y + ", " + shaft.v + ", " + shaft.a + ", " + shaft.force, "rad, rad/s, rad/s^2, N m");
  const Units falling = units_of(record({channel("a2", "m/s^2"), channel("F1", "V")}), "y2", "F1");
  EXPECT_EQ(falling.y + ", " + falling.v + ", " + falling.force, "m, m/s, V");
  const Units tachometer = units_of(record({channel("v", "V")}));
  EXPECT_EQ(tachometer.y + ", " + tachometer.v + ", " + tachometer.a, "V s, V, V/s");
}

TEST(Units, OfAParameterAreThoseOfItsForceAndMotion) {
  const Units shaft = units_of(record({channel("y", "rad"), channel("F", "N m")}));
  EXPECT_EQ(in_units(shaft, "N s^p/m"), "N m s^p/rad");
  EXPECT_EQ(in_units(shaft, "1/m"), "1/rad");
  EXPECT_EQ(in_units(shaft, "kg"), "kg m^2");
  EXPECT_EQ(in_units({}, "kg"), "kg");
  EXPECT_EQ(in_units(units_of(record({channel("y", "m"), channel("F", "V")})), "kg"), "V s^2/m");
}

TEST(Units, OfACurrentAloneHoldNoSecondsThatCancel) {
  const Units coil = units_of(record({channel("v", "A"), channel("F", "V")}));
  EXPECT_EQ(in_units(coil, "kg"), "V s/A");
  EXPECT_EQ(in_units(coil, "N s^3/m^3"), "V/A^3");
  EXPECT_EQ(in_units(coil, "m/s"), "A");
  EXPECT_EQ(in_units(coil, "N/(m s)"), "V/A/s^2");
  EXPECT_EQ(in_units(coil, "N (s/m)^p"), "V (1/A)^p");
  EXPECT_EQ(in_units(coil, "N/m^n"), "V/(A s)^n");
  EXPECT_EQ(in_units(coil, ""), "");
}

}  // namespace
}  // namespace lunid
