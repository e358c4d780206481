#pragma once
// What is decided on a search, the test records closed: from generic forces that still see something.
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

inline constexpr double little_open = 0.05;  ///< of the motion
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
/// The quietest part of a spectrum says too little of noise that a filter has shaped, or that drifts: where generic
/// forces see nothing in what the chosen model leaves above it, that may be noise.
bool may_have_colour(const Study& study, const Round& round);
/// The same of what names leave, where it is no more than such a colour explains and does not follow the forces.
bool may_leave_noise(const Study& study, const Round& round);
/// Of what runs over these records leave, more follows the forces linearly than chance makes of noise.
bool follows_the_forces(const Study& study, const std::vector<FreeRun>& runs, const std::vector<Record>& records);
/// Of the squared excess, by names that stand beside a small repeatable force: each has to leave less where they are
/// several, and two springs nothing to speak of, which follow a curve of another kind as a series does.
double most_closed(const Choices& names);

/// Two springs and stops at one place that leave what noise does not of the training records, and close less than
/// 99.8 % of the squared excess over left-out blocks (`closed`).
bool is_loose_series(const Choices& names, const Gap& train, double closed);

/// `train`: the model's runs over the training records.
Left look_for_structure(const Study& study, const Candidate& c, const std::vector<FreeRun>& train,
                        const Whitening& whitening);

/// A damper of the baseline itself feeds the motion beside the names, by so many deviations, and did not alone.
bool feeds_the_motion(const Candidate& baseline, const Candidate& named, double deviations = 3);

/// By half the least gain, as a name has to on the training records and on the test records. A sensitive motion is
/// followed by whatever starts well: left-out blocks, which keep the fit's first states, may then favour a force that
/// is none.
bool lowers_the_gap(const Study& study, const std::vector<FreeRun>& before, const std::vector<FreeRun>& after);

/// Fills in what follows from `found`; the test records stay closed.
void decide(const Study& study, Round& round);

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

}  // namespace lunid
