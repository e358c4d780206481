#pragma once
// Ensembles: many members of one model that differ in parameters, first state and excitation, on the fixed path
// (docs/ensembles.md). Members of a model without switches run side by side in lanes; each member's result has the bits
// of simulate() on it alone with the same substeps, for any number of threads.
#include <Eigen/Core>
#include <atomic>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "simulate/simulate.hpp"
#include "simulate/time_tape.hpp"

namespace lunid {

/// What drives the members; all have the same number of rows.
class MemberForce {
 public:
  /// One excitation for all members.
  static MemberForce of(Excitations excitation);
  /// An excitation for each; `make` is called by several threads.
  static MemberForce of(Eigen::Index rows, std::function<Excitations(Eigen::Index member)> make);
  /// Expressions of time and of parameters q, exact between the samples: one output for each channel, which are the
  /// system's inputs in their order; a column of q and an entry of dt [s] for each member. Evaluated for many members
  /// at once.
  static MemberForce of(std::vector<std::string> channels, TimeTape force, Eigen::MatrixXd q, double t0,
                        Eigen::VectorXd dt, Eigen::Index rows);

  Eigen::Index rows() const { return rows_; }
  /// The excitation of one member, as simulate() takes it.
  Excitations excitation(Eigen::Index member) const;
  bool is_shared() const { return shared_; }  ///< one for all
  bool is_expression() const { return !make_; }
  const std::vector<std::string>& channels() const { return channels_; }
  const TimeTape& tape() const { return tape_; }
  const double* q(Eigen::Index member) const { return q_.data() + q_.rows() * member; }
  double t0() const { return t0_; }
  double dt(Eigen::Index member) const { return dt_[member]; }

 private:
  Eigen::Index rows_ = 0;
  bool shared_ = false;
  std::function<Excitations(Eigen::Index)> make_;
  std::vector<std::string> channels_;
  TimeTape tape_;
  Eigen::MatrixXd q_;
  double t0_ = 0;
  Eigen::VectorXd dt_;
};

struct Ensemble {
  const System* system = nullptr;
  Eigen::MatrixXd theta;  ///< parameters() x members
  Eigen::MatrixXd x0;     ///< states() x members
  MemberForce force;

  Eigen::Index members() const { return theta.cols(); }
};

/// A number for each member, over the rows of a run that are not left out. std: over all of them (divided by their
/// number); amplitude: half of max - min.
enum class Summary { max, min, mean, std, rms, amplitude, last };
struct EnsembleOutput {
  Summary summary = Summary::rms;
  int state = 0;      ///< index of the signal among the states
  bool rate = false;  ///< the signal is the rate of that state (a is the rate of v)
  std::string name;   ///< "rms_y"
  std::string signal;
};
/// "max_y" "rms_a" "last_z" ...: a summary and a signal of the model. Throws InputError with the choices.
EnsembleOutput output_from(std::string_view name, const System& system);

struct EnsembleOptions {
  std::vector<EnsembleOutput> outputs;           ///< 1 or more
  int substeps = 0;                              ///< per sample; 0: chosen by halving on a few members
  double settled = 0;                            ///< part of the run before the summaries begin, >= 0 and < 1
  bool trajectories = false;                     ///< keep the whole signals of the outputs
  double memory = 2e9;                           ///< [byte] that trajectories may take
  double bound = 0;                              ///< as in SimulateOptions
  int max_events = 1000000;                      ///< as in SimulateOptions
  int threads = 0;                               ///< 0: all cores
  const std::atomic<bool>* cancelled = nullptr;  ///< set by Ctrl-C: no further member is begun, finished ones are kept
  /// Called after some members are done, by one thread at a time.
  std::function<void(std::span<const Eigen::Index> members)> finished;
};

/// Of each member. A member that exploded is a result: no values, but when and why it stopped.
struct EnsembleResult {
  std::vector<std::string> outputs;
  Eigen::MatrixXd values;                     ///< members x outputs; NaN where a run stopped early
  std::vector<char> done;                     ///< the member has run
  Eigen::VectorXd stopped_at;                 ///< [s]; NaN: completed
  std::vector<std::string> cause;             ///< in words where it stopped
  std::vector<std::string> signals;           ///< of the trajectories
  std::vector<Eigen::MatrixXd> trajectories;  ///< rows x members of each signal; empty unless kept
  int substeps = 1;
  double change = 0;  ///< of y on halving the step, over std(y): the greatest of the members looked at

  Eigen::Index finished() const;
  Eigen::Index stopped() const;
};

/// An empty result for run_members; checks everything and chooses the substeps. Throws InputError: sizes that do not
/// fit, values that are not finite (naming the member), options out of range, trajectories beyond the memory, members
/// that need steps too small for the fixed path.
EnsembleResult prepare_ensemble(const Ensemble& ensemble, const EnsembleOptions& options);
/// Runs the given members that are not done yet. Returns early, without an error, when cancelled.
void run_members(const Ensemble& ensemble, const EnsembleOptions& options, std::span<const Eigen::Index> members,
                 EnsembleResult& result);
/// All members.
EnsembleResult run_ensemble(const Ensemble& ensemble, const EnsembleOptions& options);

}  // namespace lunid
