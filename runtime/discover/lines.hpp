#pragma once
// Frequencies that stand out in what a model leaves.
#include <optional>
#include <vector>

#include "discover/candidate.hpp"

namespace lunid {

/// The angular frequencies [rad/s] of the strongest lines in the displacement (force, with imposed motion) that a model
/// leaves open, at most eight; none of a model that cannot be run.
std::vector<double> residual_lines(const Study& study, const Candidate& candidate);

/// Those at which a stiffness that goes up and down, a*cos(w*t)*y, would take most of what a model leaves, at most
/// eight: of all w at once, each over the motion that it makes behind the receptance, since noise is white there.
std::vector<double> modulation_lines(const Study& study, const Candidate& candidate,
                                     const std::optional<Place>& place = {});

/// The strongest of these that goes round twice in the record, where it is beyond chance (a tenth of alpha, of all w)
/// above those about it, or takes half of the squares of what is left.
std::optional<double> standing_modulation(const Study& study, const Candidate& candidate,
                                          const std::optional<Place>& place = {});

}  // namespace lunid
