#pragma once
// Which effects: sets of catalogue entries grown from the baseline, fitted on the trajectory, the simplest kept.
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "discover/grow.hpp"
#include "discover/judge.hpp"
#include "discover/ties.hpp"

namespace lunid {

/// A model between the baseline and the chosen set, and the effect that it has beyond the one before.
struct NamedStep {
  Choice added;
  Candidate model;
};

/// A judged set that was not chosen.
struct Beaten {
  enum class By { training, tie, test };  ///< tie: the training records cannot tell it from the chosen set
  Candidate model;
  By by;
  std::string remark;  ///< why not
};

/// The tie before it among the rivals that is the same force in another notation; nullptr where there is none.
const Beaten* same_force_before(const std::vector<Beaten>& rivals, std::size_t i);
/// Why the record cannot tell the rival at `i` from the chosen set.
std::string tie_remark(const std::vector<Beaten>& rivals, std::size_t i, const Candidate& chosen);

struct SearchResult {
  Whitening whitening;
  Candidate baseline;                ///< judged, with left-out runs
  Candidate chosen;                  ///< the baseline itself when nothing is named
  std::vector<NamedStep> steps;      ///< one effect more each; the last is the chosen set
  std::vector<Beaten> rivals;        ///< best first
  Ties ties;                         ///< what the record cannot tell from the chosen set
  Grown grown;                       ///< all that was fitted, before it was judged
  std::vector<Choices> denied;       ///< sets with the runs of the chosen one that another channel denies
  std::vector<std::string> refused;  ///< sets that the user's criterion refused, best first
  std::vector<std::string> as_read;  ///< sets that are no better than a force that is read otherwise (between_samples)
  /// Where nothing is named: the single effect that lowers the left-out gap beyond chance, by less than the least gain.
  std::optional<Candidate> faint;
  /// How the force is to be read between its samples for nearly all to go that the baseline leaves, where nothing is
  /// named; else empty.
  std::string reading;
};

/// Whether the user's criterion (DiscoverOptions) lets a set stand; true where there is none.
bool may_be_named(const Study& study, const Candidate& c);

/// Searches the catalogue for what `baseline` (fitted) lacks. `known`: what a search of a part of this catalogue has
/// grown on the same study. `ask_reading`: the search may end early with nothing but Grown::reading. Changes the pool:
/// main thread only; fits run on threads.
SearchResult search(const Study& study, const Model& model, const Candidate& baseline,
                    std::span<const Effect> catalogue, const Grown& known, bool ask_reading,
                    const std::function<void(const std::string&, double)>& progress);

}  // namespace lunid
