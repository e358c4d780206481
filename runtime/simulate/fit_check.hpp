#pragma once
// The check of a trajectory fit: its final free runs by SUNDIALS beside those of the fixed path.
#include "simulate/fit.hpp"

namespace lunid {

/// The largest difference of a displacement between the final runs of a fit, made by the fixed path, and ARKODE's of
/// order 8 at its default tolerance, over the deviation of the displacement: infinite where only one of the two came to
/// its end. Of each run at most the first 10000 rows. NaN where there is nothing to compare: SUNDIALS made the fit's
/// runs, the motion is imposed, or the fit failed. Both share the tape and the force between the samples, so this tests
/// the integration alone.
double check_by_sundials(const System& system, const FitResult& result, const std::vector<FitData>& data,
                         const FitOptions& options);

}  // namespace lunid
