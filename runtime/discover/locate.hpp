#pragma once
// Where a model and its data disagree: on the force, along the measured motion.
#include "discover/candidate.hpp"
#include "discover/gap.hpp"

namespace lunid {

// Smoothing cuts the harmonics of the acceleration, which looks like a force. Each function therefore takes a
// reference, the final model: what the same smoothing makes of the reference's own free run, whose residual is zero, is
// taken away.

/// Force that a model leaves unexplained along the smoothed measured motion of training record `index` [N]; of several
/// coordinates that on each, one after another.
Eigen::VectorXd residual_force(const Study& study, const Candidate& candidate, const Candidate& reference,
                               std::size_t index);

/// Maps of it (residual_maps.hpp), whose sentences speak of the place; none where it is not finite.
std::optional<ResidualMaps> maps_at(const Study& study, const Candidate& candidate, const Candidate& reference,
                                    const std::optional<Place>& place = {});

/// The sentences of maps of a motion that is y at a place.
void speak_of(ResidualMaps& maps, const Place& place);

/// Mean residual force over the (y, v) plane of a place before and after (the reference), cells without data NaN.
ResidualMap residual_map(const Study& study, const Candidate& before, const Candidate& after,
                         const std::optional<Place>& place = {});

/// Measured, baseline and final (the reference) runs and forces of one record, for figures: one for each output, with
/// the motion and the forces of its coordinate. `baseline`, `final`: of each output.
std::vector<Comparison> compare(const Study& study, const Candidate& before, const Candidate& after,
                                const Record& record, std::span<const FreeRun> baseline, std::span<const FreeRun> final,
                                const std::string& role);

/// The force of a named effect alone along a smoothed training record, at its place.
Eigen::VectorXd named_force(const Study& study, const Candidate& final, const Effect& effect, std::size_t index);

/// The named force, and what the rest of the final model leaves, at the place of an effect along a training record.
PlacedForce force_of_effect(const Study& study, const Candidate& final, const Effect& effect, std::size_t index);

}  // namespace lunid
