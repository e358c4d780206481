#pragma once
// Sets of effects grown from the baseline, one entry at a time: proposed on the force, fitted on the trajectory.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "discover/candidate.hpp"

namespace lunid {

struct Grown {
  std::vector<Candidate> sets;          ///< fitted, none of them degenerate, least cost first
  std::vector<std::string> left_aside;  ///< entries that this record cannot show beside the baseline, with the reason
  int tried = 0;  ///< start points over which a p-value is to be corrected, those of known sets too
};

/// Grows sets of up to max_effects entries from `baseline` (fitted) while the free runs get better. `known`: sets of
/// entries of this catalogue that have been grown already (fitted); they are not proposed again, and grow further with
/// the rest. Changes the pool: main thread only; proposals and fits run on threads.
Grown grow(const Study& study, const Model& model, const Candidate& baseline, std::span<const Effect> catalogue,
           const Grown& known, const std::function<void(const std::string&, double)>& progress);

bool holds(const Choices& set, const Effect* effect);
bool same(Choices a, Choices b);
/// Every choice of `part` is in `whole`, with its variant.
bool within(const Choices& part, const Choices& whole);
/// Related by special_case_of, either way: the simpler is named without doubt.
bool related(const Choices& a, const Choices& b);
/// As many entries, each that of `special` or one of which it is a special case.
bool is_general_form(const Choices& general, const Choices& special);

}  // namespace lunid
