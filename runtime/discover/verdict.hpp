#pragma once
// What is decided on a search: from generic forces that still see something, and from the test record.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "discover/closure.hpp"
#include "discover/gap.hpp"
#include "discover/search.hpp"

namespace lunid {

/// What generic forces of the motion would explain beside a model, and whether that counts.
struct Left {
  Gap gap;  ///< of the model itself over the training records
  Closure closure;
  bool seen = false;      ///< it is there beyond chance, and free runs over the training records get better by it
  bool material = false;  ///< and it is more than what is asked of an effect
  bool whole = false;     ///< and these forces explain it down to the noise, or nearly all of it where it is far above
};

/// A search and what was decided on it, the test records closed.
struct Round {
  SearchResult found;
  Left left;
  std::vector<FreeRun> train;  ///< of the chosen model over the training records
  Verdict verdict = Verdict::nothing_missing;
  std::string withdrawn;
  bool loose_test = false;  ///< nothing is named, and what is left on the test records hangs on the parameters
  double driven = 0;  ///< nothing is named, and this part of what is left follows the forces linearly (lacks_dynamics)
  BetweenSamples between;            ///< under which it was made
  std::shared_ptr<Round> displaced;  ///< of common entries and of all, the one that was put behind; null: none
  bool names() const { return !found.chosen.choices.empty(); }
  /// The gap of runs with what the force's noise adds to their floor, as far as the training runs show that it does.
  double input_share() const { return input_noise_share(train); }
  Gap gap(const std::vector<FreeRun>& runs) const { return pool_gap(runs, input_share()); }
};

/// Free runs over whole records, each output of the first record, then those of the second ... `floor`: with what noise
/// alone would leave of each.
std::vector<FreeRun> runs(const Study& study, const System& system, const FitResult& fit,
                          const std::vector<Record>& records, bool floor = true);
std::vector<FreeRun> runs(const Study& study, const Candidate& c, const std::vector<Record>& records,
                          bool floor = true);

/// The parameters with which a run over this record is made: those of the fit, but for the entries whose parameters are
/// those of one record (Effect::separate), which are found on it while the others are held. Not in short runs.
Eigen::VectorXd theta_on(const Study& study, const Candidate& c, const Record& record);

/// So many floors and more, and no less than `least`.
bool far_from_the_floor(const Gap& gap, double least, double times = 3);

/// "Nothing missing" cannot be said of a model that leaves a good part of the motion open, whatever the search found.
/// Less is enough in free decays, where no force is there to be known badly. `part`: of the share that is enough.
bool leaves_motion_open(const Study& study, const Gap& gap, double part = 1);
/// The part of what a model leaves of the training and of the test records that follows the forces linearly, where that
/// is more than `least`, far above their floors, and no loop makes the forces answer it: dynamics that the model lacks
/// and no force of its motion stands for. 0 elsewhere.
double lacks_dynamics(const Study& study, const Gap& train, const Gap& test, const std::vector<FreeRun>& train_runs,
                      const std::vector<FreeRun>& test_runs, double least);
/// A model that follows the training records leaves no more open on the test than three deviations of its parameters
/// make of it there: a sweep through a jump hangs on a damping that the training records show to a percent.
bool hangs_on_parameters(const Study& study, const Candidate& model, const Gap& train, const Gap& test);

/// Two springs and stops at one place that leave what noise does not of the training records, and close less than
/// 99.8 % of the squared excess over left-out blocks (`closed`).
bool is_loose_series(const Choices& names, const Gap& train, double closed);

/// `train`: the model's runs over the training records.
Left look_for_structure(const Study& study, const Candidate& c, const std::vector<FreeRun>& train,
                        const Whitening& whitening);

/// By half the least gain, as a name has to on the training records and on the test records. A sensitive motion is
/// followed by whatever starts well: left-out blocks, which keep the fit's first states, may then favour a force that
/// is none.
bool lowers_the_gap(const Study& study, const std::vector<FreeRun>& before, const std::vector<FreeRun>& after);

/// Fills in what follows from `found`; the test records stay closed.
void decide(const Study& study, Round& round);

/// The test records do not bear out what generic forces saw in the training records beside the chosen model: the gap on
/// them does not fall by these, nor do they show such forces of their own. False where these cannot be run there.
/// `before`: the model's runs over the test records.
bool gone_on_test(const Study& study, const Round& round, const std::vector<FreeRun>& before);

/// Remark of names that the test records take back.
inline constexpr auto not_confirmed = "not confirmed by the test record";

/// Takes the names back; the model is the baseline again.
void withdraw(Round& round, Beaten::By by, const std::string& remark);

/// Names the last of these steps, one or more, which is among the rivals no more.
void name_steps(const Study& study, SearchResult& found, std::vector<NamedStep> steps);

/// The round in which the first names stand alone, without those that were added to them last. `remark`: of all.
Round first_names(const Study& study, const Round& round, std::size_t count, const std::string& remark);

/// Rivals that are ties say so.
void remark_ties(SearchResult& found);
/// Of a chosen set that another had the place of: its ties among the rivals.
void find_ties_again(const Study& study, SearchResult& found);

/// That the named model is better than the baseline on the test records, by their runs over these.
double test_p_value(const Study& study, const std::vector<FreeRun>& before, const std::vector<FreeRun>& after);

/// Why the test records take the names back; empty when they do not.
std::string refuted(const Study& study, const Round& round, double p_value, const std::vector<FreeRun>& before,
                    const std::vector<FreeRun>& after);

/// Nothing is named, and the training records show an effect by less than the least gain (two tones, a low level): the
/// round in which it is named, where the test records, on which far more hangs on it, bear it out whole. Not where what
/// the baseline leaves there hangs on its parameters.
std::optional<Round> borne_out(const Study& study, const Round& round);

/// A single effect that the training records cannot tell from the chosen one, and what it does.
struct TiedRival {
  Candidate model;
  Left left;
  std::vector<FreeRun> train, test;
  double test_p_value;
};

/// Of those, and of the same force in other words there, in the order of the rivals: the ones that the test records do
/// not take back, and which none of these betters there beyond chance. None of several names.
/// `tested`: the study as the test records are judged, `before` the baseline's runs in it.
std::vector<TiedRival> tied_that_stand(const Study& study, const Study& tested, const Round& round,
                                       const std::vector<FreeRun>& before);

/// The named model fitted to training and test records together.
struct FitToAll {
  Gap test;  ///< the gap there
  /// Where parameters were open that no step of the training fit changes: the fit to the training records with those of
  /// the fit to all.
  std::optional<FitResult> settled;
};
/// Where that is down to the noise of both, the training records allow these parameters, and the names lower the test
/// gap as they are, or have parameters that no step of the training fit changes: the training records leave the
/// parameters open, not the name (two single tones before a sweep through the resonance). Not of several springs at one
/// place, which bend as a series does.
std::optional<FitToAll> fit_to_all(const Study& study, const Round& round, double p_value,
                                   const std::vector<FreeRun>& before, const std::vector<FreeRun>& after);

/// How many of the first steps the test records confirm for themselves where they do not confirm all: what a single
/// record has of its own (a drift of its sensor) must not take the others' names. They have to close nearly all of the
/// gap, to leave little, to be told from zero, and to leave above one and a half floors no force that the test
/// records show for themselves. `before`: the baseline's runs over the test records.
std::size_t steps_that_stand(const Study& study, const Round& round, const std::vector<FreeRun>& before);
/// The same where they confirm all together: without the last ones whose step has raised the gap, or closed less than
/// half of what the steps before it leave above the noise. `after`: the final model's runs over the test records.
std::size_t steps_that_help(const Study& study, const Round& round, const std::vector<FreeRun>& after);

}  // namespace lunid
