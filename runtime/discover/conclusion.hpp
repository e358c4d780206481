#pragma once
// What a discovery says beside its models: the sentence, what would decide, and what to mind.
#include <string>

#include "discover/verdict.hpp"

namespace lunid {

/// The verdict in a sentence, without its first word; of a Discovery whose verdict, effects, gaps and experiment are
/// there.
std::string sentence(const Study& study, const Round& round, const Discovery& out);

/// What would tell an ambiguous class apart, within the force, displacement and band that these records had; of a
/// Discovery whose verdict, final model and rivals are there.
void design_next(const Study& study, const SearchResult& found, Discovery& out);

/// Parameters that sit at their bounds are warned of.
void warn_of_bounds(const Candidate& c, Discovery& out);

/// The fast path's last run again by SUNDIALS: tests the integration only (same tape, same force between samples).
void check_by_sundials(const Study& study, const Candidate& c, Discovery& out);

}  // namespace lunid
