#pragma once
// Free runs. Two ways to integrate, one answer (docs/methods.md): the record-locked fixed-step path for fits and free
// runs on sampled forces; SUNDIALS for events to tolerance, stiff models and as the check of the fast path.
#include <Eigen/Core>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "record/record.hpp"
#include "simulate/model.hpp"

namespace lunid {

class TimeTape;

/// f(t) at many times at once; `out` is as long as `t`. Called by several threads at a time.
struct TimeFunction {
  std::function<void(std::span<const double> t, std::span<double> out)> values;
  /// The same at t0 + dt*(row + place) of every row of `out`, 0 <= place < 1, where a grid can be had for less; or
  /// empty
  std::function<void(double t0, double dt, double place, std::span<double> out)> grid;

  TimeFunction() = default;
  template <class F>
  requires std::is_invocable_v<F, std::span<const double>, std::span<double>> TimeFunction(F f)
      : values(std::move(f)) {}  // implicit: most are no more than this
  explicit operator bool() const { return static_cast<bool>(values); }
  void operator()(std::span<const double> t, std::span<double> out) const { values(t, out); }
  void on_grid(double t0, double dt, double place, std::span<double> out) const;
};

/// A force on an even time base, ready for integration: values on a refined grid of the samples. A value type; copies
/// share their samples and the refined grids made so far (thread-safe).
class Excitation {
 public:
  Excitation() = default;
  /// F at t0 + i*dt. Throws InputError when fewer than 2 samples or a value is not finite, or dt <= 0.
  Excitation(double t0, double dt, std::span<const double> force, Interpolation interpolation = Interpolation::linear);
  /// F = f(t) sampled at t0 + i*dt for `rows` rows (an analytic force is evaluated exactly between samples). The same
  /// errors.
  Excitation(double t0, double dt, Eigen::Index rows, TimeFunction force);
  Excitation(double t0, double dt, Eigen::Index rows, std::function<double(double)> force);
  /// F = f(t) plus what the samples have beyond it, which is interpolated (held values as straight lines). The same
  /// errors.
  Excitation(double t0, double dt, std::span<const double> force, Interpolation interpolation, TimeFunction formula);

  Eigen::Index rows() const { return rows_; }
  double t0() const { return t0_; }
  double dt() const { return dt_; }
  /// What happens between samples; with a formula: cubic (it is smooth there).
  Interpolation interpolation() const { return interpolation_; }
  bool analytic() const;      ///< known by a formula alone
  double at(double t) const;  ///< F(t); constant beyond the ends
  /// The same, but for what came before the first row: of a part the rows that it was cut from, of a whole its formula
  /// and for samples their linear prediction (Burg's model, record/extension.hpp).
  double also_before(double t) const;
  double peak() const;  ///< largest |F| on the samples
  Eigen::VectorXd samples() const;
  /// The force at the ends of `substeps` equal parts of each sample interval, and at their midpoints: the entry
  /// 2*(row*substeps + j) is F at row + j/substeps. Size 2*(rows-1)*substeps + 1. With `hold`, an entry on a sample is
  /// the value from there on. Throws InputError when substeps < 1.
  Eigen::VectorXd refined(int substeps) const;
  /// The force at the stages of the fixed path: five values per substep (at 0, 1/5, 3/10, 4/5, 8/9 of it), then the
  /// last sample. Made once; valid as long as this excitation or a copy or part of it lives.
  std::span<const double> stage_grid(int substeps) const;
  /// `factor` times this one, its formula included.
  Excitation scaled(double factor) const;
  /// The same force on every `rows`-th row: between these the cubic that has the force's values at its ends, its
  /// integral and its first moment, which are all that y and v at the rows see of a force on a mass. Throws InputError
  /// when rows < 1, or when fewer than two would be left.
  Excitation joined(Eigen::Index rows) const;
  /// Of a held force: the same so much later, >= 0 s, before its first row as also_before() has it, and the rate of
  /// that. The jump between two rows is the cubic of joined(), which goes with the delay without jumps of its own.
  std::pair<Excitation, Excitation> held_later(double delay) const;
  /// The same with so much more at each sample, read between them as the samples are. Throws InputError when these are
  /// not as many or a sum is not finite.
  Excitation plus(std::span<const double> more) const;
  /// Rows [first, first + count); the force between them is that of the whole. Throws InputError outside the rows.
  Excitation part(Eigen::Index first, Eigen::Index count) const;

 private:
  struct Source;
  double within(double t) const;  ///< t in the source's own rows
  double t0_ = 0, dt_ = 1;
  Eigen::Index first_ = 0, rows_ = 0;  ///< of the source
  Interpolation interpolation_ = Interpolation::linear;
  std::shared_ptr<Source> source_;
};

/// The force of a record's channel: its formula where it has one, and its own interpolation where none is given.
/// Adds nodes to the pool of a formula, one call at a time. Throws InputError as Record and Excitation do.
Excitation excitation_of(const Record& record, std::optional<Interpolation> interpolation = {},
                         std::string_view channel = "F");
/// f(t) of an expression of the time alone. Adds nodes to its pool. Throws InputError naming another symbol.
TimeFunction function_of_time(Expr formula);
/// Output `output` of a tape of time at q.
TimeFunction function_of_time(TimeTape tape, std::vector<double> q, int output);

/// What drives a model: an excitation for each input channel, all on one time base. An input that none is given for is
/// zero. Made from one excitation it is the force: F, or that of the first driven coordinate.
class Excitations {
 public:
  Excitations() = default;
  Excitations(Excitation force) { add("F", std::move(force)); }  // implicit: one force is the usual case
  /// Channels: "F", "F1" "F2" ..., and what else drives models (Model::inputs). Throws InputError when the channel is
  /// there, when the time base differs from that of the first, or when a held signal meets one that is not.
  Excitations& add(const std::string& channel, Excitation signal);
  /// The same, and no error where a model does not hold the channel.
  Excitations& offer(const std::string& channel, Excitation signal);

  /// The same with another signal for a channel; force_rate is left out, so that it follows from the force anew.
  Excitations replaced(const std::string& channel, Excitation signal) const;

  bool empty() const { return signals_.empty(); }
  Eigen::Index rows() const { return empty() ? 0 : signals_[0].rows(); }
  double t0() const { return empty() ? 0 : signals_[0].t0(); }
  double dt() const { return empty() ? 1 : signals_[0].dt(); }
  Interpolation interpolation() const { return empty() ? Interpolation::linear : signals_[0].interpolation(); }
  int count() const { return static_cast<int>(signals_.size()); }
  const Excitation& operator[](int i) const { return signals_[static_cast<std::size_t>(i)]; }
  const std::string& channel(int i) const { return channels_[static_cast<std::size_t>(i)]; }
  /// Rows [first, first + count) of all. Throws InputError outside the rows.
  Excitations part(Eigen::Index first, Eigen::Index count) const;
  /// One for each input of the system, in its order; force_rate follows from F. Throws InputError naming a channel that
  /// is no input of it.
  Excitations ordered(const System& system) const;
  /// The same as the system takes them at these parameters: forces shifted by its delay (Excitation::also_before()),
  /// then their rates and the delay. The errors of ordered() and of System::delay.
  Excitations of(const System& system, std::span<const double> theta) const;

 private:
  std::vector<std::string> channels_, offered_;
  std::vector<Excitation> signals_;
};

/// The time derivative of a signal by central differences of its samples, of fourth order but at the ends; held where
/// the signal is.
Excitation rate_of(const Excitation& signal);

/// The channels of a record that drive the system, each as excitation_of gives it. Throws InputError naming the channel
/// that it lacks: the forces may be absent where others drive, but not all inputs.
/// What a model says of the channels that drive it, where the record says nothing of them (Model::interpolation).
std::optional<Interpolation> read_between(const Model& model, const Record& record,
                                          const std::vector<std::string>& inputs);
Excitations excitations_of(const System& system, const Record& record, std::optional<Interpolation> interpolation = {});

/// automatic and fixed are ours; the rest is SUNDIALS': CVODE's BDF and Adams, ARKODE's explicit Runge-Kutta pairs 3(2)
/// (Bogacki & Shampine), 5(4) (Dormand & Prince) and 8(7) (Fehlberg), and its L-stable ESDIRK5(4)7L[2]SA (Kennedy &
/// Carpenter 2019).
enum class Solver { automatic, fixed, bdf, adams, rk23, rk45, rk78, esdirk };
std::string to_string(Solver);
/// All of them, in that order.
std::span<const Solver> all_solvers();
/// "auto" "fixed" "bdf" "adams" "rk23" "rk45" "rk78" "esdirk". Throws InputError with the choices.
Solver solver_from(std::string_view name);

/// [bytes] that a run may need where nothing else is said.
inline constexpr double default_memory = 8e9;

struct SimulateOptions {
  Solver solver = Solver::automatic;  ///< automatic: fixed; BDF where the explicit path is limited by stability
  double rtol = 1e-8;                 ///< SUNDIALS, < 1 and at least 100 roundings, 2.3e-14
  double atol = 0;                    ///< SUNDIALS, >= 0; 0: rtol times the scale of each state
  int substeps = 0;                   ///< fixed path, per sample; 0: chosen by halving
  double bound = 0;                   ///< |y| beyond which a run counts as exploded; 0: 1e6 times the motion's scale
  int max_events = 1000000;           ///< switches in a run; beyond it the run stops with a message
  Expr stop_when;  ///< of t, the inputs, the states and the parameters: the run ends where it rises above 0; empty:
                   ///< never
  double max_memory = default_memory;            ///< [bytes] that a run may need, > 0; more is refused
  const std::atomic<bool>* cancelled = nullptr;  ///< set by Ctrl-C; throws InputError(Fault::interrupted)
};

/// The name of the fixed path in summaries: "fixed DP5, 2 substeps".
std::string fixed_solver_name(int substeps);

/// What a run did.
struct RunSummary {
  std::string solver;     ///< "fixed DP5, 2 substeps" | "CVODE BDF" | ...
  bool completed = true;  ///< false: stopped early (exploded, too many events, solver failure)
  double stopped_at = 0;  ///< [s], when not completed
  std::string cause;      ///< in words, when not completed
  long steps = 0, evaluations = 0, events = 0;
  long tried = 0;    ///< evaluations of runs made to choose this one
  long grazing = 0;  ///< switches met so flatly that the sensitivities after them are not to be trusted
  double stuck = 0;  ///< [s] spent sticking (sliding on a switch)
  double ended_at = std::numeric_limits<double>::quiet_NaN();  ///< [s] where stop_when ended the run
  Eigen::VectorXd ended_in;                                    ///< the state there
  double error = 0;  ///< largest difference to the run with half the step, over std(y); fixed path, when checked
  double seconds = 0;
  std::vector<std::string> notes;  ///< on external functions: what they cost, and derivatives by differences
};

/// A run on the samples of its excitation. Rows after stopped_at or ended_at are NaN.
struct Run {
  double t0 = 0, dt = 1;
  Eigen::MatrixXd x;  ///< rows x states: y v z..., or y1 v1 y2 v2 ... z...
  Eigen::MatrixXd a;  ///< rows x coordinates: acceleration [m/s^2]
  RunSummary summary;
};

/// Numbers that a run keeps per row, those of its excitation included.
int run_values(const System& system);
/// Throws InputError, naming `caller`, when `rows` of `values` numbers each need more than `limit` bytes. For callers
/// that make an excitation of a given length; simulate() asks it by itself.
void check_memory(const std::string& caller, double rows, int values, double limit = default_memory);

/// Integrates from x0 (size states()) over the excitation. theta has parameters() values.
/// Throws InputError for wrong sizes or non-finite values; a failed run is a result.
Run simulate(const System& system, std::span<const double> theta, const Excitations& excitation,
             const Eigen::VectorXd& x0, const SimulateOptions& options = {});

/// A run with exact sensitivities of states to theta and x0, jumps at switches included (saltation).
struct SensitivityRun {
  Run run;
  std::vector<Eigen::MatrixXd> dx;  ///< per state, rows x (p + n): dx/dtheta, dx/dx0; empty where it was not asked for
  const Eigen::MatrixXd& dy() const { return dx[0]; }  ///< of the first displacement
  const Eigen::MatrixXd& dv() const { return dx[1]; }  ///< of the first velocity
};
/// What a channel shows of a run: the state or acceleration that it is named after, or what the model makes of it
/// (Model::measures).
Eigen::VectorXd shown(const System& system, std::span<const double> theta, const Run& run,
                      std::string_view channel = "y");
/// The displacement and the velocity of a coordinate at which its channels show at t what `x` has there (an offset, a
/// gain; Newton's method); what the record computed from a channel is divided by that one's gain. As it is in `x` where
/// the channel does not follow it (a lag, a limit).
Eigen::Vector2d motion_behind(const System& system, std::span<const double> theta, const Record& record, int coordinate,
                              double t, const Eigen::VectorXd& x);
/// What shown() gives, derived to theta and x0, rows x (p + n); of a run that kept the sensitivities of shown_states(),
/// under the same excitation. 0 in rows that slide, where a channel is an acceleration (acceleration_slopes).
Eigen::MatrixXd shown_slopes(const System& system, std::span<const double> theta, const Excitations& excitation,
                             const SensitivityRun& run, std::string_view channel = "y");
/// The states that a channel shows, from 0: of an acceleration all. Throws InputError for a channel that is no
/// displacement, velocity or acceleration of the model.
std::vector<int> shown_states(const System& system, std::string_view channel);
/// True for the displacements, velocities and accelerations of a model: what shown() knows.
bool is_shown(const Model& model, std::string_view channel);

/// By the fixed path, or by CVODES (solver bdf or adams, and automatic where that is stiff), which holds them to rtol
/// of what a parameter of its own size makes. `wanted`: the states whose sensitivities are kept, from 0; empty: all.
/// Throws InputError as simulate() does, for a solver of ARKODE, and for more than Dynamics::dense_limit states.
SensitivityRun simulate_sensitivities(const System& system, std::span<const double> theta,
                                      const Excitations& excitation, const Eigen::VectorXd& x0,
                                      const SimulateOptions& options = {}, std::span<const int> wanted = {});

/// Imposed motion: the force m*a + f that the model predicts for measured y, v, a (rows; of several coordinates one
/// after another), internal states included; with exact derivatives to theta (rows x p) when `dforce` is given. NaN
/// throughout where the states are too fast for the samples or diverge; `substeps` 0: as many as the force needs.
Eigen::VectorXd imposed_force(const System& system, std::span<const double> theta, const Record& record,
                              Eigen::MatrixXd* dforce = nullptr, int substeps = 0);

/// Substeps per sample at which halving the step changes y by less than `tolerance` * std(y).
int choose_substeps(const System& system, std::span<const double> theta, const Excitations& excitation,
                    const Eigen::VectorXd& x0, double tolerance = 1e-5);

}  // namespace lunid
