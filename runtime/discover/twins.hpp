#pragma once
// Parameters of an entry that are one number with a parameter of the baseline: only their sum can be seen.
#include "discover/effect.hpp"
#include "simulate/model.hpp"

namespace lunid {

/// The entry without the linear parameters whose term the baseline has with a free coefficient of its own, without
/// bounds or fitted well within them: mu of (beta*y^2 - mu)*v beside c*v. They would count as parameters and have no
/// interval; Effect::twins has both names, and beside the entry the coefficient has no bounds (compile). Where none is
/// left, and where the coefficient is at a bound and may need the other, the entry stays as it is. Main thread only.
Effect without_twins(const Model& baseline, const Effect& effect);

}  // namespace lunid
