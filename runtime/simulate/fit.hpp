#pragma once
// Parameters refined on the trajectory: least squares on the displacement of free runs, by exact sensitivities.
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "record/random.hpp"
#include "record/record.hpp"
#include "simulate/simulate.hpp"

namespace lunid {

/// A record with the force between its samples, and the rows that the fit may see.
struct FitData {
  Record record;
  Excitations excitation;
  std::vector<std::uint8_t> use;  ///< one entry per row, 0: left out of the fit (still simulated); empty: all used
  double weight = 1;  ///< of its residuals beside those of other records: one over their noise, up to a factor

  FitData part(Eigen::Index first, Eigen::Index count) const;  ///< rows [first, first + count)
};

/// What drives a record, with as much white noise on its forces again as their channels have (Channel::noise); none
/// where no force has any. One that is as rough as a random excitation is taken for that, not for a noisy sensor, and
/// one that has a formula has no noise.
std::optional<Excitations> with_noise_again(const FitData& data, Philox& random);

/// The colour of the residual: means over `average` rows, then the innovations e_t - sum ar_i e_(t-i) (generalised
/// least squares with an autoregressive noise; Cochrane & Orcutt 1949). The default leaves the residual as it is.
struct Whitening {
  int average = 1;
  std::vector<double> ar;
};

/// Applies a whitening to one column; rows out of use (and those that lack their history) become 0. `out` has
/// column.size() / average rows.
void whiten(const Eigen::VectorXd& column, const std::vector<std::uint8_t>& use, const Whitening& whitening,
            Eigen::VectorXd& out);

/// Squared residuals, or Huber's: beyond 1.345 standard deviations a residual counts linearly.
enum class Loss { squared, huber };

/// How a fit gets its gradient. forward: exact sensitivities of every row, for Levenberg-Marquardt. adjoint: the slope
/// of the cost alone, by one backward sweep whatever the number of parameters, for the L-BFGS of NLopt. automatic: the
/// adjoint from adjoint_parameters on, or where there are too many states for sensitivities.
enum class Gradient { automatic, forward, adjoint };
inline constexpr int adjoint_parameters = 40;
std::string to_string(Gradient);

/// One free run of the fit and its first state.
struct FitSegment {
  int record = 0;
  Eigen::Index first = 0, count = 0;
  Eigen::VectorXd x0;
  bool anchored = false;  ///< its anchored states (InternalState) stay as they are
};

/// Of the slopes by a segment's first state (the last columns), those by what the segment holds become zero.
void hold_anchored(const Model& model, const FitSegment& segment, Eigen::Ref<Eigen::MatrixXd> slopes);

struct FitOptions {
  Eigen::Index segment = 0;  ///< rows per free run, >= 0; 0: one run over the whole record (else multiple shooting)
  int max_iterations = 40;   ///< >= 1
  double tolerance = 1e-7;   ///< relative drop of the cost at which the fit stops, > 0
  int substeps = 0;          ///< per sample; 0: chosen by halving the step at the start
  /// Where steps are too long for parameters that the fit tries, it goes on with half of them (fixed path)
  bool shorten_steps = false;
  /// The covariance counts the noise of the forces' channels too (Channel::noise), by 24 runs of the model, as far as
  /// the residual shows it: noise that the system felt is no error. Where they have none, or the residual holds it
  /// whole, white disturbances of the forces, of the power that the residual shows: what rings at a resonance tells
  /// little of its damping. Not with the adjoint, nor along an imposed motion
  bool force_noise = false;
  Whitening whitening;  ///< what is done to the residual before it is squared
  /// Displacements, velocities and accelerations that are fitted, each weighted by its noise; empty: of each coordinate
  /// what was measured of it (measured_channel)
  std::vector<std::string> channels;
  std::vector<int> separate;  ///< parameters (from 0) that each record has for itself
  Loss loss = Loss::squared;
  std::vector<FitSegment> first_states;     ///< from which the fit starts: those of another fit; empty: the record's
  std::vector<int> hold;                    ///< entries of the fitted vector that stay where they start
  Solver solver = Solver::automatic;        ///< fixed, bdf or adams; automatic: fixed, or bdf where the start is stiff
  Gradient gradient = Gradient::automatic;  ///< adjoint: by the fixed path, of residuals that are not whitened
  int threads = 1;  ///< for the runs of segments, >= 0; 0: all cores. The result does not depend on it
  const std::atomic<bool>* cancelled = nullptr;
};
/// Throws InputError naming option, value and the admissible range.
void validate(const FitOptions& options);

/// Where each parameter of each record stands in the vector that is fitted: first those of the first record, then for
/// each further record the separate ones.
class FitLayout {
 public:
  FitLayout(int parameters, int records, const std::vector<int>& separate);
  int size() const { return static_cast<int>(parameter_.size()); }
  bool shared() const { return size() == parameters_; }
  int place(int record, int parameter) const;
  int parameter(int place) const { return parameter_[static_cast<std::size_t>(place)]; }
  Eigen::VectorXd of_record(const Eigen::VectorXd& theta, int record) const;
  /// The start of all from that of one record.
  Eigen::VectorXd expanded(const Eigen::VectorXd& theta) const;

 private:
  int parameters_;
  std::vector<int> separate_, parameter_;
};

struct FitResult {
  Eigen::VectorXd theta;  ///< as FitLayout has it
  std::vector<FitSegment> segments;
  /// per record: measured - model [m] of its first fitted channel (force [N] with imposed motion), rows out of use
  /// too; then of each record's second channel, as it is weighted beside the first, and so on
  std::vector<Eigen::VectorXd> residual;
  double cost = 0;              ///< sum of squared (whitened) residuals
  Eigen::Index rows = 0;        ///< rows in the cost
  double freedom = 1;           ///< rows less what was fitted
  Eigen::Index outliers = 0;    ///< rows that count linearly (Loss::huber)
  double clip = 0;              ///< beyond which they do
  Eigen::MatrixXd information;  ///< J'J of theta with the first states projected out, in the units of 1/theta^2 * cost
  std::vector<Eigen::MatrixXd> state_information;  ///< J'J of each segment's first state; none of an imposed motion
  /// Pseudo-inverse of information times cost / degrees of freedom, widened where sums of the scores over blocks vary
  /// more (the residual is not white); 0 rows at bounds
  Eigen::MatrixXd covariance;
  std::vector<std::uint8_t> at_bound;  ///< parameter sits at a bound that holds it
  std::vector<std::uint8_t> unseen;    ///< parameter that the data do not excite (rank)
  /// parameter that is not identifiable: other values of it and of others, together, leave the same residual (m, k and
  /// c of a free decay)
  std::vector<std::uint8_t> unidentifiable;
  bool converged = false;
  std::string stopped;   ///< why: "relative drop below tolerance" | "iterations" | "free run: <cause>" ...
  Eigen::VectorXd lost;  ///< the first parameters that were tried and could not be simulated; empty: none
  int iterations = 0;
  long runs = 0;
  int substeps = 1;
  std::string solver;                     ///< what integrated: "fixed DP5, 2 substeps", "CVODE BDF" ...
  Gradient gradient = Gradient::forward;  ///< what was used

  /// Standard deviation of a parameter; not a number where it has none: fixed, at a bound, not seen, not
  /// identifiable.
  [[nodiscard]] double deviation(Eigen::Index parameter) const {
    if (!identifiable(parameter)) return NAN;
    const double variance = parameter < covariance.rows() ? covariance(parameter, parameter) : 0;
    return variance > 0 ? std::sqrt(variance) : NAN;
  }
  [[nodiscard]] bool identifiable(Eigen::Index parameter) const {
    const auto k = static_cast<std::size_t>(parameter);
    return !(k < unidentifiable.size() && unidentifiable[k]);
  }
};

/// Levenberg-Marquardt with bounds (projected, active set; Nocedal & Wright 2006, chapters 10 and 16) on free runs
/// from estimated first states, which are eliminated per segment (Schur complement). `theta` is the start, bounds come
/// from the model's table. With imposed motion the residual is that of the force and segments are not used.
/// Throws InputError for wrong sizes; a fit that cannot simulate its start returns converged = false and infinite cost.
FitResult fit_trajectory(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                         const FitOptions& options = {});

/// The same from a rough start: short free runs first (two periods), then longer ones up to the whole record, so that a
/// wrong first guess does not lock into a neighbouring phase (multiple shooting; Bock 1983). Of free decays the first
/// periods alone, then ever more of the record: friction that stops the motion too early has no slope in the rows
/// thereafter. `to_beat`: a root mean square; the fit is given up, at infinite cost, once shorter runs, which may begin
/// anew more often, leave more than this.
FitResult fit_progressively(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                            const FitOptions& options = {}, double to_beat = INFINITY);

/// The profile likelihood of one entry of the fitted vector: the other parameters fitted again while it is held at
/// values on both sides (Venzon & Moolgavkar 1988, Appl. Statist. 37, 87). Throws InputError for an entry without a
/// deviation.
struct Profile {
  struct Point {
    double value;
    double drop;  ///< of twice the log-likelihood
  };
  std::vector<Point> points;  ///< in order of value
  double low = 0, high = 0;   ///< 95 % interval; infinite where it is open: at a bound, or beyond 10 deviations
};
Profile profile_likelihood(const System& system, const FitResult& result, const std::vector<FitData>& data,
                           const FitOptions& options, int index);

/// First state estimated on the rows [first, first + count) alone with theta fixed. `spread`: per state, how far from
/// its start it may well be (a standard deviation beside the sensor's noise; 0 or no entry: nothing is known). Internal
/// states that a few rows hardly show would else run away. `inner`: where the internal states start; empty: as
/// declared.
struct StateEstimate {
  Eigen::VectorXd x0;
  Eigen::MatrixXd covariance;
  double residual_variance = 0;  ///< of the rows used
  bool converged = false;
};
StateEstimate estimate_state(const System& system, const Eigen::VectorXd& theta, const FitData& data,
                             Eigen::Index first, Eigen::Index count, int substeps, const Eigen::VectorXd& spread = {},
                             const Eigen::VectorXd& inner = {});

/// The forces that a record shows on each coordinate, one coordinate after another; zero where none acts or is shown.
Eigen::VectorXd acting_forces(const Model& model, const Record& record);

/// Of each coordinate the channel that a fit looks at where no channels are named, and the weight of its residual: the
/// noise of the first over its own.
struct FittedChannel {
  std::string channel;
  double weight;
};
std::vector<FittedChannel> fitted_channels(const Model& model, const Record& record);

/// The smoothed measured state (y, v, initial z...) at a row: where a free run starts before its fit. Behind channels
/// that show something else (Model::measures) the motion that is shown so (motion_behind()).
Eigen::VectorXd measured_state(const System& system, std::span<const double> theta, const Record& record,
                               Eigen::Index row);

}  // namespace lunid
