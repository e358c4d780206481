#pragma once
// Frequencies that stand out in what a model leaves.
#include <optional>
#include <vector>

#include "discover/candidate.hpp"

namespace lunid {

/// The angular frequencies [rad/s] of the strongest lines in the displacement (force, with imposed motion) that a model
/// leaves open, at most eight; none of a model that cannot be run.
std::vector<double> residual_lines(const Study& study, const Candidate& candidate);

/// Those at which a stiffness that goes up and down, a*cos(w*t)*y, would take most of what a model leaves: of all w at
/// once, each over the motion that it makes behind the receptance, since noise is white there. At most eight, that go
/// round twice in the record, and stand out: by no chance (a tenth of alpha, of all w) above those about them, or by
/// half of the squares of what is left.
std::vector<double> modulation_lines(const Study& study, const Candidate& candidate,
                                     const std::optional<Place>& place = {});

}  // namespace lunid
