#pragma once
// Sets of effects grown from the baseline, one entry at a time: proposed on the force, fitted on the trajectory.
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "discover/candidate.hpp"

namespace lunid {

struct Grown {
  std::vector<Candidate> sets;            ///< fitted, none of them degenerate, least cost first
  std::vector<Candidate> at_limits;       ///< the degenerate ones: of some entry of theirs a simpler one is meant
  std::vector<std::string> left_aside;    ///< entries that this record cannot show beside the baseline, with the reason
  std::optional<BetweenSamples> reading;  ///< growing ended early: the force is to be read so (far_better_reading)
  Choices settled;     ///< several, in the little that they leave generic forces see nothing: they grow no further
  bool quiet = false;  ///< generic forces see nothing in what the baseline leaves: only what helps alone grows
  int tried = 0;       ///< start points over which a p-value is to be corrected, those of known sets too

  /// A set that was fitted, degenerate or not; null: none.
  const Candidate* find(const Choices& set) const {
    const Candidate* found = find_in(sets, set);
    return found ? found : find_in(at_limits, set);
  }
  /// Those of so many effects, degenerate or not.
  std::vector<const Candidate*> of_size(std::size_t effects) const;
  /// Of as many effects as the settled set, or more, and leaves as much.
  bool is_settled(const Candidate& c) const;
};

/// Grows sets of up to Study::most_effects entries from `baseline` (fitted) while the free runs get better. `known`:
/// sets of entries of this catalogue that have been grown already (fitted); they are not proposed again, and grow
/// further with the rest. `ask_reading`: growing ends where the force is to be read otherwise between its samples.
/// Changes the pool: main thread only; proposals and fits run on threads.
Grown grow(const Study& study, const Model& model, const Candidate& baseline, std::span<const Effect> catalogue,
           const Grown& known, bool ask_reading, const std::function<void(const std::string&, double)>& progress);

}  // namespace lunid
