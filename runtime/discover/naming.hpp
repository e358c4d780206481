#pragma once
// How sure the names are: the choice among the finalists made again on resampled blocks of the records.
#include "discover/search.hpp"

namespace lunid {

/// Blocks of whitened rows (bootstrap_block) are drawn with replacement; every finalist (baseline, chosen and judged
/// rivals) is refitted to them to first order, and the search's rule chooses: the likeliest by BIC, then the simplest
/// that is not rejected against it, then the baseline unless that is rejected at the level of the whole search. Fits
/// are not run again, so that the search's proposals are taken as given (as in RELL; Kishino, Miyata & Hasegawa 1990,
/// J. Mol. Evol. 31, 151, with a Gauss-Newton step for each resample).
Naming bootstrap_naming(const Study& study, const SearchResult& found, int resamples = 100);

}  // namespace lunid
