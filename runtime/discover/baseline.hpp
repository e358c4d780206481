#pragma once
// The model that a discovery begins with: fitted, and what must be said of it first.
#include <span>
#include <string>
#include <vector>

#include "discover/candidate.hpp"

namespace lunid {

/// To the end: relative drop of the cost below 1e-6.
FitOptions full_fit(const Study& study, int iterations);

/// The baseline fitted on the trajectory. Adds to `warnings`, before all others, that it cannot be run or that
/// parameters sit at bounds, and which terms are nearly one column. Throws InputError naming parameters that the data
/// do not excite, and for a force that is not finite. Elements of the model that are entries of the catalogue are
/// guessed as those are, where they have no first guesses of their own.
Candidate fit_baseline(const Study& study, const Model& model, std::vector<std::string>& warnings,
                       std::span<const Effect> catalogue = {});

/// Throws as fit_baseline() does of parameters that the data do not excite, as far as nothing has to be searched for
/// that: of a force that is linear in all of them. The rest is asked when the baseline is fitted.
void check_excitation_of_linear(const Study& study, const Model& model);

}  // namespace lunid
