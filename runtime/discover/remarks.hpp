#pragma once
// What --check says of records beside the notes that a discovery has too: nothing is wrong with them, but one may have
// meant something else.
#include <string>
#include <vector>

#include "discover/study.hpp"

namespace lunid {

/// Of the records as they were given: units that are not said, a set point without its name, a clock far from 0; and
/// how the study reads the force between its rows. Throws InputError for what would stop the fit of the baseline.
std::vector<std::string> remarks(const Study& study, const std::vector<Record>& train, const std::vector<Record>& test);

}  // namespace lunid
