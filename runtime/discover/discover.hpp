#pragma once
// Discovery: detect -> locate -> characterise -> propose -> rank -> refit -> validate -> decide (docs/discovery.md).
#include <atomic>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "discover/effect.hpp"
#include "discover/experiment.hpp"
#include "discover/maps.hpp"
#include "record/record.hpp"
#include "simulate/simulate.hpp"

namespace lunid {

enum class Verdict { explained, nothing_missing, ambiguous, unknown_effect };
/// As everybody sees it: "nothing-missing", ...
const char* to_string(Verdict verdict);

/// A fitted set of effects, as a criterion of the user's own sees it.
struct FittedSet {
  std::string name;  ///< "coulomb_friction + constant_force"
  double gap = 0;    ///< of its fit to the training records
  Model model;       ///< as it was fitted
};

struct DiscoverOptions {
  double alpha = 0.01;         ///< false-alarm level of the whole search, 0 < alpha < 0.5
  double minimum_gain = 0.05;  ///< least relative drop of the left-out gap for which an effect is named, 0..1
  int first = 0;         ///< so many entries are tried first, the others where these leave it open; 0: all at once
  int max_effects = 4;   ///< named one after another, >= 1
  int blocks = 6;        ///< left-out blocks of the training records, >= 3
  double holdout = 0.3;  ///< last part of each record held out when no test is given, 0..0.9
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all cores
  std::function<void(const std::string& stage, double fraction)> progress;
  /// Of the user's own, asked from the thread that calls discover(): false for a set that is never to be named. What
  /// it throws ends the search. Empty: none.
  std::function<bool(const FittedSet& set)> criterion;
  const std::atomic<bool>* cancelled = nullptr;
};
/// Throws InputError naming option, value and the admissible range.
void validate(const DiscoverOptions& options);
/// Throws InputError for a model that discovery does not look at: more than five coordinates, a delay, inputs other
/// than forces.
void check_baseline(const Model& baseline);

/// A gap: RMSE of the free-run displacement (velocity or acceleration where that alone was measured) over the standard
/// deviation of the measured one, never re-initialised; with imposed motion that of the force. NaN where the run
/// exploded (stopped_at, cause).
struct Gap {
  double value = 0;
  double floor = 0;  ///< what sensor noise, input noise and first-state error alone leave, as far as it is known
  double floor_std = 0;
  double stopped_at = 0;
  std::string cause;
};

/// What was looked at of a record: all of it in one run, or short runs of it.
struct RecordUsed {
  std::string record, role;  ///< path; "train" or "test"
  std::string part;          ///< of a file with gaps: Record::words_of_part()
  Eigen::Index rows = 0;     ///< of all runs together
  double seconds = 0;        ///< from the first row to the last
  double rate = 0;           ///< [Hz]
  int runs = 1;
  int joined = 1;  ///< rows that fits take for one, their mean: gaps of fits and of left-out blocks are of these
};

/// A measured record beside the free runs of baseline and final model, for figures and reports. All in SI.
struct Comparison {
  std::string record, role;                         ///< path; "train" or "test"
  std::string output;                               ///< the channel, one comparison for each
  Eigen::VectorXd t, measured, baseline, final;     ///< of the output; NaN in the lead-in
  Eigen::VectorXd y, v;                             ///< measured motion of its coordinate, smoothed
  Eigen::VectorXd residual_before, residual_after;  ///< force that the model leaves unexplained [N]
  Eigen::VectorXd named_force;                      ///< the named effects' force along the measured motion [N]
};

/// Of several coordinates: a named effect's force at its place along the first training record [N], and what the final
/// model leaves there.
struct PlacedForce {
  std::string name;
  Eigen::VectorXd t, y, v, named, left;
};

/// Of several coordinates: the gaps of one.
struct OutputGaps {
  std::string output;
  Gap baseline_train, baseline_test, final_train, final_test;
};

struct Rival {
  std::string name;
  double gap = 0;  ///< of its fit to the training records, which knows all rows
  double log_likelihood = 0;
  double p_value = 1;  ///< against the baseline, corrected alike
  std::string remark;  ///< why it was not named
  Model model;         ///< as it was fitted
};

struct NamedEffect {
  std::string name, family, formula, where, sentence;
  std::string place;                  ///< of several coordinates: what it is a function of, "y2" or "y1 - y2"
  std::string label;                  ///< the name, and where
  std::vector<Parameter> parameters;  ///< under the entry's own names, with std
  std::vector<std::string> indistinguishable;
  std::vector<std::string> same_force;  ///< of these: the same force in another notation, no rivals
  double gap_train = 0, gap_test = 0;
  double p_value = 1;  ///< against the model without it (F-test), times the start points tried in the whole search
};

/// How often each set of effects would have been named.
struct Naming {
  int resamples = 0;
  std::vector<std::pair<std::string, int>> counts;  ///< most frequent first; "nothing" where the baseline stays
  int of(const std::string& name) const;
};

/// A term of the baseline that the records do not need: offered for removal, never removed.
struct Removable {
  std::string parameter;  ///< whose term it is
  std::string term;       ///< "Fc*sign(v)"
  double value = 0, std = 0;
  double p_value = 1;  ///< that its coefficient is zero (Wald, with the covariance of the fit)
  std::string reason;
};

/// What an unknown effect's force looks like along the training motion.
struct UnknownForce {
  struct Harmonic {
    double amplitude = 0;  ///< of the force that the baseline leaves unexplained, over the phase of the motion [N]
    double level = 0;      ///< that noise alone stays below, 95 % over all orders [N]
  };
  std::vector<Harmonic> harmonics;  ///< orders 0, 1, 2, ...
  Eigen::VectorXd y, v;             ///< cell centres
  Eigen::MatrixXd force;            ///< mean force [N], (y index, v index); NaN where there is no data
  /// The baseline with forces without a name that lower the gap of its free runs on the test records, and their gaps.
  struct Closure {
    Model model;
    Gap train, test;
    std::string interpolation;  ///< of the force between its samples, under which it was fitted
  };
  std::optional<Closure> closure;  ///< whose force `force` is; where there is none it is what the baseline leaves
};

/// What a model leaves by the two other ways of looking: of the force along the smoothed measured motion (over the
/// force's standard deviation), and of predictions from each row to the next (over that of the motion). NaN where they
/// cannot be asked.
struct OtherGaps {
  double force = 0, one_step = 0;
};

/// Records whose force answers the motion, or that hold what a controller was to follow.
struct ClosedLoop {
  double answer = 0;      ///< share of what is new in the force that follows what the final model leaves; 0: none seen
  std::string reference;  ///< the channel that serves as instrument; empty: none
  std::vector<Parameter> by_instruments;  ///< of the final model; empty: no reference, or it does not tell them apart
  OtherGaps baseline_train, baseline_test, final_train, final_test;
};

/// Whether the force answers, without a full stop.
std::string sentence_of(const ClosedLoop& loop);

struct Discovery {
  Verdict verdict = Verdict::nothing_missing;
  std::string sentence;   ///< the verdict in one sentence
  std::string where;      ///< where baseline and data disagree
  Model baseline, final;  ///< refitted, with standard deviations
  std::vector<Parameter> baseline_before;
  Gap baseline_train, baseline_test, final_train, final_test;
  double gap_left_out_before = 0, gap_left_out_after = 0;
  double gap_fit = 0;  ///< of the final model's fit, which knows all rows, as the rivals' gaps are
  bool test_chose =
      false;  ///< the test records chose among what the training records left open: their gap is not held out
  double test_p_value = 1;  ///< of "the final model's test gap is not below the baseline's"
  std::vector<NamedEffect> effects;
  std::vector<Rival> rivals;  ///< of the last round, where nothing (more) was named
  std::vector<std::string> warnings;
  std::vector<RecordUsed> records;
  std::vector<Comparison> comparisons;  ///< of each record; of short runs a few
  std::vector<OutputGaps> outputs;      ///< with several coordinates: of each
  std::vector<PlacedForce> forces;      ///< with several coordinates: of each named effect
  std::string map_place;                ///< with several coordinates: what the map's y is, "y2" or "y1 - y2"
  ResidualMap map;
  /// Where the baseline fails, each map beside its noise, and what the final model leaves there; none where a model's
  /// force is not finite along the motion, `after` neither where nothing was named.
  std::optional<ResidualMaps> maps_before, maps_after;
  Naming naming;                      ///< how often resampled records give the same names
  std::vector<Removable> removable;   ///< terms of the baseline that these records do not need
  ExperimentDesign experiment;        ///< what would tell an ambiguous class apart; else empty
  ExperimentOptions same_experiment;  ///< limits, rate and noise as these records had them
  Units units;                        ///< of all forces and motions here, as the records have them
  std::string output = "y";           ///< what free runs are held against: y, or v or a alone; F with imposed motion
  double run_length = 0;  ///< [s] of the free runs, where those over whole records are lost to noise; else 0
  /// Where those over the whole test records alone are: what the names were held against there.
  struct ShortTest {
    double seconds = 0;  ///< of each run; 0: whole test records were used
    Gap baseline, final;
  } short_test;
  std::optional<UnknownForce> unknown;  ///< of an unknown effect
  std::optional<ClosedLoop> loop;       ///< of records from a closed loop
  std::string interpolation, solver, noise_model;
  bool noise_has_colour = false;  ///< the floors are of what the final run leaves beside its own band
  double check_error = 0;         ///< largest difference of the fast path to SUNDIALS, over std(y)
  std::string check_solver;
  double seconds = 0;
};

/// Names what the baseline lacks. `train` is used for every choice; `test` is opened once these are made, and takes
/// names back; what `train` left open it may choose (`test_chose`). With no test the last `holdout` part of each record
/// is cut off first. Throws InputError for what cannot be a discovery (5 rows, a constant displacement, a parameter
/// that the data do not excite, ...).
Discovery discover(const Model& baseline, const std::vector<Effect>& catalogue, const std::vector<Record>& train,
                   const std::vector<Record>& test, const DiscoverOptions& options = {});

/// What there is to say before anything is fitted.
struct Outset {
  std::string baseline;  ///< its equation, and of each parameter whether it is fitted and from where
  std::vector<std::string> notes;
};
/// Throws what discover() throws of records and baseline.
Outset before_discovery(const Model& baseline, const std::vector<Record>& train, const std::vector<Record>& test,
                        const DiscoverOptions& options = {});

/// discovery.json (contract: schema 1). Every null has a reason beside it.
nlohmann::json to_json(const Discovery& discovery);
nlohmann::json to_json(const ExperimentDesign& design);
/// What the terminal shows.
std::string to_terminal(const Discovery& discovery);

}  // namespace lunid
