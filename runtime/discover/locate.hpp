#pragma once
// Where a model and its data disagree: on the force, along the measured motion.
#include "discover/candidate.hpp"
#include "discover/gap.hpp"

namespace lunid {

// Smoothing cuts the harmonics of the acceleration, which looks like a force. Each function therefore takes a
// reference, the final model: what the same smoothing makes of the reference's own free run, whose residual is zero, is
// taken away.

/// Force that a model leaves unexplained along the smoothed measured motion of training record `index` [N].
Eigen::VectorXd residual_force(const Study& study, const Candidate& candidate, const Candidate& reference,
                               std::size_t index);

/// What an engineer would say about it (residual_maps.hpp).
std::string describe_residual(const Study& study, const Candidate& candidate, const Candidate& reference);

/// Mean residual force over the (y, v) plane before and after (the reference), cells without data NaN.
ResidualMap residual_map(const Study& study, const Candidate& before, const Candidate& after);

/// Measured, baseline and final (the reference) runs and forces of one record, for figures.
Comparison compare(const Study& study, const Candidate& before, const Candidate& after, const Record& record,
                   const FreeRun& baseline, const FreeRun& final, const std::string& role);

}  // namespace lunid
