#pragma once
// Simpler words for what has grown.
#include "discover/level_fits.hpp"

namespace lunid {

/// A set grows by what is best beside its parents, which may be an entry with more parameters than are needed: its
/// special cases, and in the best sets those that are as simple and do most on the trajectory, are fitted in its place.
/// Changes the sets of `out`, which are sorted by cost. Main thread only.
void contest_the_best(const Study& study, const Model& model, const Candidate& baseline, const Grown& known,
                      Offers& offers, LevelFits& fits, Grown& out);

}  // namespace lunid
