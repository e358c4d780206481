#pragma once
// A candidate model: the baseline with some effects of the catalogue, its start read off the data, and its fit.
#include <algorithm>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "discover/choices.hpp"
#include "discover/study.hpp"

namespace lunid {

/// Substeps per sample of internal states where the force alone is looked at.
inline constexpr int start_substeps = 2;
/// Those that are not held.
int free_parameters(std::span<const Parameter> table);

struct Candidate {
  Choices choices;
  std::shared_ptr<const System> system, force_system;  ///< as simulated; with imposed motion, for fits of the force
  std::vector<std::uint8_t> linear;                    ///< parameters in which the force is affine, all at once
  std::vector<std::pair<std::size_t, std::pair<double, double>>>
      shown;                            ///< parameter, and where the record can show it
  Tape margins;                         ///< of the entries' conditions, from all parameters
  std::vector<Eigen::VectorXd> starts;  ///< first guesses, the best first
  int state_substeps = 1;               ///< that the entries' internal states need along the motion, at least
  double force_misfit = INFINITY;       ///< squared misfit of the force as it is, unweighted; infinite: not looked at
  double force_cost = 0;                ///< squared misfit of the smoothed force at the best start
  bool seen_by_force = true;            ///< false: a sensor's fault shows in the motion alone (sensor.hpp)
  bool guesses_tried = false;           ///< its other guesses were, from the parent on
  bool minimum_left = false;            ///< and from where its fit had ended, and short runs from there
  bool looked_beside = false;           ///< and from beside it, by factors of its shape
  FitResult fit;
  // Filled by the judge:
  FitResult whitened;           ///< the likeliest parameters under the noise's colour
  Eigen::VectorXd innovations;  ///< whitened residual of all records
  double likelihood_cost = 0;   ///< squared norm of it after the whitened fit
  double log_likelihood = 0;
  double price_of_first_values = INFINITY;  ///< at most, off the log likelihood (judge.hpp)
  Eigen::VectorXd left_out;  ///< residual of free runs on rows that the fit did not see; all records in a row
  double left_out_gap = 0;   ///< its RMSE over std of the measured output

  int parameters() const { return system->parameters(); }
  int free_parameters() const { return lunid::free_parameters(system->model().parameters); }
  /// First values of internal states, in every run that was fitted.
  int first_values() const {
    return (system->states() - 2 * system->degrees()) * static_cast<int>(std::max<std::size_t>(1, fit.segments.size()));
  }
  /// All that a fit may use to explain noise.
  int unknowns() const { return free_parameters() + first_values(); }
  bool ran() const { return std::isfinite(fit.cost); }
  const Eigen::VectorXd& best_theta() const { return ran() ? fit.theta : starts.front(); }
  /// An effect has shrunk to nothing or to another one: its coefficient, or a shape parameter, sits at its limit, or
  /// its conditions do not hold.
  bool degenerate() const;
  std::size_t added() const;        ///< free parameters of the effects
  std::size_t first_added() const;  ///< place of the effects' own parameters, the last of the model's
  std::string name() const { return name_of(choices); }
};

/// The candidate of this set among them; null where there is none.
auto find_in(auto& candidates, const Choices& set) -> decltype(candidates.data()) {
  const auto at = std::ranges::find_if(candidates, [&](const Candidate& c) { return same(c.choices, set); });
  return at != candidates.end() ? &*at : nullptr;
}

/// The error on the trajectory with Schwarz' price of a parameter: whom to hear.
double priced(const Candidate& c);

/// A run in the steps in which a fit was made.
SimulateOptions steps_of(const Study& study, const FitResult& fit);

/// Where a record of these scales can show a choice's shape parameters, and its parameters within that.
Ranges ranges_of(const Choice& choice, const RecordScales& scales);
std::vector<Parameter> limited(std::vector<Parameter> parameters, const Ranges& ranges);

/// Compiles baseline + choices, shape parameters limited to what the study's records can show. Changes the pool: main
/// thread only.
Candidate compile(const Study& study, const Model& baseline, const Choices& choices);

/// What a guess says of a parameter; its own value, or 1, where it says nothing; within its bounds.
double guessed(const Parameter& parameter, const Guess& guess);

/// Reads first guesses off the smoothed data: linear parameters by regression of the force, shape parameters from the
/// entries' guesses, refined on the force. `theta` holds the values of the parameters that come before (baseline).
void find_starts(const Study& study, Candidate& candidate, const Eigen::VectorXd& theta,
                 const std::vector<std::vector<Guess>>& guesses);

/// A set's parameters as the last of these fits that has them found them; zero where none has.
Eigen::VectorXd values_of(const Candidate& c, std::initializer_list<const Candidate*> fits);

/// The model with the values of its fit and their standard deviations.
Model fitted(const Candidate& candidate);
/// The same, with what the study found the force to do between its samples.
Model fitted(const Study& study, const Candidate& candidate);

/// Fits on the trajectory from the best start, short free runs first.
void fit(const Study& study, Candidate& candidate, const FitOptions& options);

/// The parameters that a fit leaves open, "k, c": other values of these, together, make the same motion.
std::string unidentifiable(const Candidate& candidate);

/// What a model with these parameters leaves of the force along a record's motion, F - m*a - f [N]; of several
/// coordinates one after another.
Eigen::VectorXd open_force(const Candidate& candidate, const Eigen::VectorXd& theta, const Record& record);

/// J'J of a model's force along the training records at these parameters; `substeps` 0: as many as the force needs.
Eigen::MatrixXd gram_of_force(const Study& study, const Candidate& candidate, const Eigen::VectorXd& theta,
                              int substeps = 0);

/// The first parameters of a system, each free one with its size alone, within its bounds: a start whose run does not
/// grow without bound where that of a regression does.
Eigen::VectorXd without_signs(const System& system, Eigen::VectorXd theta);

/// The mass of a coordinate holds this symbol.
bool in_a_mass(const Model& model, Expr symbol);

/// Of each coordinate what goes with its acceleration at these parameters, the mass and terms beside it; NaN where that
/// is not one number. Main thread only (derivatives grow the pool).
std::vector<double> inertias(const Model& model, const Eigen::VectorXd& theta);
/// Hardly any of one of these is left. Where no force acts, nothing is left open then either: all of m*a + f is zero.
bool takes_the_mass(const std::vector<double>& before, const std::vector<double>& after);
/// The same of two fits; false where one did not run.
bool takes_the_mass(const Candidate& before, const Candidate& after);

/// What a parameter of which nothing is known may be: powers of ten of either sign that its bounds allow.
std::vector<double> magnitudes(const Parameter& parameter);

/// Parameters of this model in which m*a + f is affine, all at once. Main thread only (derivatives grow the pool).
std::vector<std::uint8_t> linear_parameters(const Model& model);

}  // namespace lunid
