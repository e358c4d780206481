#pragma once
// What discovery knows of its data: training records cut and checked, their smoothed motion, scales and noise.
#include <cmath>
#include <memory>
#include <vector>

#include "discover/discover.hpp"
#include "discover/units.hpp"
#include "discover/views.hpp"
#include "simulate/fit.hpp"
#include "statistics/moments.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

using moments::standard_deviation;

/// How forces are read between their samples.
struct BetweenSamples {
  Interpolation kind = Interpolation::linear;  ///< of the first training record and all that look like it
  bool alike = false;  ///< of all records, whatever they look like: one machine put the forces out
  bool operator==(const BetweenSamples&) const = default;
};

struct Study {
  const DiscoverOptions* options = nullptr;
  int most_effects = 0;  ///< that are named together: max_effects, or fewer where more rows are searched
  bool imposed = false;
  std::vector<FitData> train;  ///< means over rows where a record is sampled far faster than it moves
  std::vector<Record> full;    ///< training records at their own rate, for gaps and figures
  std::vector<Record> test;
  std::vector<Record> smooth;  ///< training records with y v a F through one Savitzky-Golay kernel
  std::vector<FitData> force;  ///< the same for fits of the force; edges of the kernel left out
  bool in_pieces = false;      ///< train, smooth and force are pieces of longer records (shortened)
  double run_length = 0;       ///< [s] of the parts that records were cut into (in_short_runs); 0: whole
  std::vector<std::string> warnings;
  double omega = 0;                    ///< dominant angular frequency [rad/s]
  std::vector<Interpolation> guesses;  ///< of the force between its samples, per training record, from the force alone
  std::vector<std::shared_ptr<const Record>> recorded;  ///< what the rows of each were joined of; null: as recorded
  BetweenSamples between;

  Model model;                              ///< the baseline
  std::vector<std::string> forces = {"F"};  ///< what drives it: F, or F1 ... of the driven coordinates

  bool test_is_known = false;     ///< rows of it are among the training records, or gave a parameter its value
  std::string measured = "y";     ///< what the records hold of the motion: y, or v or a alone
  double slow = 0;                ///< [Hz]: below it integrals of v or a are drift, taken off; 0: y was measured
  bool noise_has_colour = false;  ///< of the outputs: what a run leaves beside its own band is noise too
  double least_left = INFINITY;   ///< [first output] rms that some set left of the training records: noise is no more
  double motion_noise = 0;        ///< [N] rms: what noise of a prescribed motion makes of the baseline's force

  Eigen::Index rows() const;  ///< of the training records together
  int degrees() const { return model.pool ? model.degrees() : 1; }
  std::string channel(char quantity, int coordinate) const;
  /// Of the derivative of the displacement that was measured: 0 of y, 1 of v, 2 of a.
  int measured_order() const { return measured == "y" ? 0 : measured == "v" ? 1 : 2; }
  /// What free runs are held against, one channel for each coordinate.
  std::vector<std::string> outputs() const;
  const std::string output() const { return outputs().front(); }
  /// What a controller was to follow: the channel y_reference, or v_reference, a_reference where that was measured.
  std::string reference() const;
  Units units() const;  ///< of the first training record and its first coordinate
  /// Of the outputs of a record: the noise of the first over their own. All pooled numbers are of weighted outputs.
  std::vector<double> weights(const Record& record) const;
  double measured_std() const;  ///< of the outputs, over the training records
  double sensor_noise() const;  ///< of the outputs, over the training records, and what `motion_noise` adds
  double noise_gap() const { return sensor_noise() / measured_std(); }  ///< what the sensor alone leaves
};

/// A record without a force whose motion dies away gets F = 0. Cuts the holdout, checks the records (rows, motion,
/// force, channels) and smooths them. Throws InputError.
Study prepare(const Model& baseline, std::vector<Record> train, std::vector<Record> test,
              const DiscoverOptions& options);

/// `smooth` and `force` of the training records, by the noise that these have.
void smooth_all(Study& study);

/// The force between the samples of the first training record and of all records that look like it; others keep what
/// their own force suggests (a held random force to train on, a recorded sweep to test), unless all are read alike.
void read_force(Study& study, BetweenSamples between);
FitData fit_data(const Study& study, const Record& record);
/// The forces of these records look like that of the first training record between their samples.
bool look_alike(const Study& study, const std::vector<Record>& records);

/// The study on all rows as they were recorded, where some were joined.
Study as_recorded(const Study& whole);

/// How many rows of long records are searched: few at first, more where what is found on these leaves anything.
enum class Searched { first, again };
/// The study on pieces of its training records where those are long: a search that takes minutes to each candidate on
/// all rows is made on these. `full` and `test` stay what they are; short records, and an imposed motion, whose
/// internal states need all that came before, are taken whole. To be made again after read_force.
Study shortened(const Study& whole, Searched searched);

/// The study on consecutive parts of its records, each so many periods of its upper frequency long and with a first
/// state of its own: for a motion that forgets where it came from (chaos, several attractors), which a run over the
/// whole record loses, whatever the model. Of long records evenly spread parts.
Study in_short_runs(const Study& whole, double periods = 2);

/// The channels of a record beside F and y that can drive a model: the motion of a base or of a shaft.
std::vector<std::string> side_channels(const Record& record);

/// y v a of a record, from what was measured of them: derivatives, or integrals without what lies below Study::slow.
Record with_motion(const Study& study, const Record& record);
/// The kernel that a record's noise calls for, and y v a F and side channels of a record through one kernel.
SavitzkyGolay smoothing_kernel(const Study& study, const Record& record);
Record smooth_motion(const Study& study, const Record& record, const SavitzkyGolay& kernel);

/// How a smoothed column is differentiated. The derivatives of a polynomial window have less noise, but are not quite
/// those of the smoothed column: with one coordinate its k and c take that up, with several modes nothing does, and it
/// would look like a missing spring. By differences of the column m*a + f(y, v) = F stays true for linear terms.
enum class Slopes { of_window, of_column };
Record smooth_motion(const Study& study, const Record& record, const SavitzkyGolay& kernel, Slopes slopes);
/// Rows at either end that are smoothed with others.
Eigen::Index edge_of(const SavitzkyGolay& kernel, Slopes slopes);

/// The band that the motion fills: highest angular frequency [rad/s] with power in it, std(a) / std(v).
double upper_frequency(const Study& study);

/// y, v or a as an effect at this place sees it: of the coordinate, or the difference of two.
Eigen::VectorXd motion_at(const Record& record, const std::optional<Place>& place, char quantity);
/// The force at this place: of the forces on all coordinates, one after another, that on the coordinate; of a joint the
/// part that acts on both alike and against each other.
Eigen::VectorXd force_at(const Eigen::VectorXd& forces, Eigen::Index rows, const std::optional<Place>& place);

RecordScales scales(const Study& study, double residual_std, const std::optional<Place>& place = {});

/// An experiment like the study's: its largest force and displacement, its band, rate, time and noise.
ExperimentOptions same_experiment(const Study& study);

}  // namespace lunid
