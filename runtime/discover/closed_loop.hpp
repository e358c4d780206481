#pragma once
// A force that answers the motion: whether it does, and what a reference, which no noise enters, says of a model.
#include <optional>

#include "discover/gap.hpp"
#include "discover/search.hpp"

namespace lunid {

/// What the chosen model's `runs` over the training records show of a controller; none where its force is not seen to
/// answer, and not all training records hold what was to be followed (Study::reference()).
std::optional<ClosedLoop> look_for_loop(const Study& study, const SearchResult& found, std::span<const FreeRun> runs);

}  // namespace lunid
