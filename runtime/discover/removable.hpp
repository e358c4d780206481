#pragma once
// Terms of the baseline that the records do not need: offered for removal, never removed.
#include "discover/candidate.hpp"

namespace lunid {

/// Terms of the baseline's restoring force whose coefficient is linear, free, and not told from zero in the final model
/// at the 5 % level, or sits at a bound of zero. One of a pair that the record cannot separate may have to stay: what
/// is left is to be fitted again.
std::vector<Removable> removable_terms(const Model& baseline, const Candidate& final_model);

}  // namespace lunid
