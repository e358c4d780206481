#pragma once
// Units of what a discovery says: those that the records have, be they rad and N m, or V.
#include <string>

#include "record/record.hpp"

namespace lunid {

/// Of the motion and of the force that drives it; those of SI mechanics where a record says none.
struct Units {
  std::string y = "m", v = "m/s", a = "m/s^2", force = "N";

  /// Of the channel of this quantity: y, v, a or F, also of one coordinate ("y2").
  const std::string& of(const std::string& channel) const {
    return channel[0] == 'y' ? y : channel[0] == 'v' ? v : channel[0] == 'a' ? a : force;
  }
};

/// As the record has them; what it does not hold of the motion in the unit that follows from what it holds.
Units units_of(const Record& record, const std::string& displacement = "y", const std::string& force = "F");

/// A unit of SI mechanics in these: "N s/m" is "N m s/rad" where y is an angle and F a moment, "kg" is "kg m^2".
std::string in_units(const Units& units, const std::string& unit);

}  // namespace lunid
