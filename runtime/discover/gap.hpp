#pragma once
// The gap of a free run (DESIGN section 4): first state from a lead-in alone, never re-initialised.
#include "discover/candidate.hpp"

namespace lunid {

/// Rows whose motion gives the first state: two periods or 5 % of the rows (of a short run 20 %), whichever is less,
/// never under 5.
Eigen::Index lead_in(const Study& study, const Record& record);

/// One output of a record beside the free run of a model.
struct FreeRun {
  std::string output;  ///< the channel
  Eigen::Index lead = 0;
  Eigen::VectorXd model;      ///< of the output; NaN in the lead-in and after a stop
  double squares = 0;         ///< sum of squared errors after the lead-in, weighted; NaN when the run stopped
  double variance = 0;        ///< sum of squared deviations of the measured output from its mean, same rows
  double floor_squares = 0;   ///< what sensor noise and first-state error alone would leave
  double floor_variance = 0;  ///< of floor_squares, from the first state
  double input_squares = 0;   ///< what the force channel's noise would add, were it not felt by the system
  Eigen::Index rows = 0;
  double stopped_at = 0;
  std::string cause;
};
inline constexpr double lost_gap = 0.3;  ///< beyond which a run follows nothing
inline constexpr double runaway_gap =
    10;  ///< of a run that grows beyond all motion: no noise leads a stable model there

/// One run, of which each output is shown. `floor`: what noise alone would leave is asked too, at the cost of several
/// runs.
std::vector<FreeRun> free_run(const Study& study, const System& system, const Eigen::VectorXd& theta,
                              const Record& record, int substeps, bool floor = true);

/// The noise of the outputs, where what a model leaves of the training records shows that it is less than their spectra
/// told. Returns whether it is. Not asked of an imposed motion and of short runs.
bool lower_noise(Study& study, const Candidate& candidate);
/// What the noise of the sensors of a prescribed motion makes of the baseline's force. Returns whether that is
/// something.
bool learn_motion_noise(Study& study, const Candidate& baseline);

/// Root mean square [as rms_error] that noise alone leaves of a set's fit: that of the sensors, and what as much noise
/// on the forces makes of its runs. Of an imposed motion, and where a run stops, that of the sensors.
double noise_alone(const Study& study, const Candidate& candidate);

/// Pooled gap over records and outputs. `input_share`: the part of the force channel's noise that the system did not
/// feel, 0..1.
Gap pool_gap(const std::vector<FreeRun>& runs, double input_share);
/// Of all that the runs over these records leave, the part that follows the forces linearly: dynamics that the model
/// lacks, or a loop's. 0 of an imposed motion, and where a run stops.
double driven_part(const Study& study, const std::vector<FreeRun>& runs, const std::vector<Record>& records);
/// The runs of one output.
std::vector<FreeRun> of_output(const std::vector<FreeRun>& runs, const std::string& output);

/// What the parameters' own standard deviations make of free runs, as a gap: by drawn parameters, since what lies
/// beyond the training motion (a jump at a resonance) may bend. 0 where that is not known.
double parameter_spread(const Study& study, const Candidate& model, const std::vector<Record>& records);

/// The share of the force channel's noise that the residual shows (0: the system felt it, or there is none).
double input_noise_share(const std::vector<FreeRun>& train);

}  // namespace lunid
