#pragma once
// The shape of a force that no entry of the catalogue explains, and a model that follows it without a name.
#include "discover/verdict.hpp"

namespace lunid {

/// Of a round whose verdict is unknown-effect; with several coordinates at a place. Generic forces are refined along
/// their own run where that lowers the left-out gap, and left out where they do not lower the gap on the test records,
/// which choose nothing else. Changes the pool: main thread only.
/// `left`: the map of what the baseline leaves there; `test`: its gap on the test records. Its harmonics stay empty.
UnknownForce unknown_force(const Study& study, const Round& round, const std::optional<Place>& place,
                           const ResidualMap& left, const Gap& test);

std::vector<UnknownForce::Harmonic> harmonics_of(const ResidualMaps& maps);

}  // namespace lunid
