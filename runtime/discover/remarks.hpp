#pragma once
// What --check says of records beside the notes that a discovery has too: nothing is wrong with them, but one may have
// meant something else.
#include <string>
#include <vector>

#include "discover/study.hpp"

namespace lunid {

/// The baseline that a discovery would start from, as it was given; a line for each parameter says whether it is fitted
/// and from where. `moves`: it stands on a base that moves, and a force whose channel no record has is 0 there.
std::string words_of_baseline(Model baseline, bool moves, const std::vector<Record>& train,
                              const std::vector<Record>& test);

/// Of the records as they were given: units that are not said, a set point without its name, a clock far from 0; and
/// how the study reads the force between its rows. Throws InputError for what would stop the fit of the baseline.
std::vector<std::string> remarks(const Study& study, const std::vector<Record>& train, const std::vector<Record>& test);

}  // namespace lunid
