#pragma once
// A force that answers the motion: whether it does, and what a reference, which no noise enters, says of a model.
#include "discover/gap.hpp"

namespace lunid {

/// The share of what is new in the force of the training records (its innovations, by an autoregression) that follows
/// what is new in what these runs over them leave, within twenty rows: a controller answers the noise of its sensor,
/// and disturbances. 0 where it is below one percent, six times what chance makes of white series, or three times the
/// share the other way round: what a model that lacks something leaves follows the force. Not of imposed motion, of
/// short runs, and of decays.
double answer_of_force(const Study& study, std::span<const FreeRun> runs);

/// The parameters that were fitted, each by one step of the instrumental-variable equations from the fit (exact where
/// the force is linear in them): the columns of the force along the smoothed motion, the same along the reference's
/// motion for instruments, less what drawn noise leaves along the model's own `runs` over the training records;
/// deviations from sums of scores over blocks of two periods. (Janot, Vandanjon & Gautier 2014, IEEE Trans. Control
/// Syst. Technol. 22, 132.) Empty without a reference in all training records, with several coordinates, for models
/// whose readings a sensor falsifies, and where the reference does not tell the parameters apart.
std::vector<Parameter> by_instruments(const Study& study, const Candidate& model, std::span<const FreeRun> runs);

/// Pooled over records, of no more than the first 20 000 rows of each. One step is not asked of models with internal
/// states, neither of several coordinates.
OtherGaps other_gaps(const Study& study, const Candidate& model, const std::vector<Record>& records);

}  // namespace lunid
