#pragma once
// A force that answers the motion: whether it does, and what a reference, which no noise enters, says of a model.
#include <optional>

#include "discover/gap.hpp"
#include "discover/search.hpp"

namespace lunid {

/// The share of what is new in the force of the training records (its innovations, by an autoregression) that follows
/// what is new in what these runs over them leave, within twenty rows: a controller answers the noise of its sensor,
/// and disturbances. 0 where it is below one percent, six times what chance makes of white series, or three times the
/// share the other way round: what a model that lacks something leaves follows the force. Not of imposed motion, of
/// short runs, and of decays.
double answer_of_force(const Study& study, std::span<const FreeRun> runs);

/// What the chosen model's `runs` over the training records show of a controller; none where its force is not seen to
/// answer, and not all training records hold what was to be followed (Study::reference()).
std::optional<ClosedLoop> look_for_loop(const Study& study, const SearchResult& found, std::span<const FreeRun> runs);

}  // namespace lunid
