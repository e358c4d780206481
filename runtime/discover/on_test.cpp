#include "discover/on_test.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "discover/between_samples.hpp"
#include "discover/gap.hpp"
#include "discover/proposal_fits.hpp"
#include "discover/refute.hpp"
#include "expr/digits.hpp"

namespace lunid {

namespace {

struct TestRuns {
  Study study;
  std::vector<FreeRun> before, after;
};

TestRuns runs_on_test(Study study, const SearchResult& found) {
  TestRuns out{std::move(study), {}, {}};
  out.before = runs(out.study, found.baseline, out.study.test, false);
  out.after = runs(out.study, found.chosen, out.study.test);
  return out;
}

std::string left_open_by_training(const Candidate& named, const std::string& fault, const Gap& of_all) {
  return "the named " + named.name() + " " + fault + " with the parameters of the training records, which leave them " +
         "open: one fit to all records follows these down to their noise (" + number(of_all.value, 2) + " there, " +
         number(of_all.floor, 2) + " from noise alone). Train on both";
}

std::string taken_for_noise(const Round& round) {
  return "what " + round.found.chosen.name() + " leaves of the training records is " +
         number(round.left.gap.value / round.left.gap.floor, 2) +
         " times the noise that the band beside their motion shows. It is taken for noise of a colour that this band "
         "does not show: generic forces of the motion see nothing in it, it follows no force, and it is no larger a "
         "part of the motion on the test records";
}

double error_on_test(const Study& study, const Candidate& model) {
  double squares = 0;
  for (const FreeRun& run : runs(study, model, study.test, false)) squares += run.squares;
  return std::isfinite(squares) ? squares : INFINITY;
}

class OnTest {
 public:
  OnTest(Ground& ground, Discovery& out) : ground_(ground), study_(ground.study), out_(out) {}

  ModelRuns judge(Round& round) {
    read_test_force(round.found.chosen);
    bear_out(round);
    if (!round.names()) hear_the_colour(round);
    const std::optional<TestRuns> shorter = judge_names(round);
    if (round.names()) hear_the_colour(round);
    fill_gaps(round, shorter);
    if (!shorter) warn_of_reading(round.found.chosen);
    if (out_.baseline_train.value > runaway_gap)
      out_.warnings.insert(out_.warnings.begin(),
                           "the baseline's free run grows beyond the motion: with these parameters it is unstable (a "
                           "channel that comes late, a controller's part that is held between samples, or forces that "
                           "feed the motion make damping negative)");
    return std::move(runs_);
  }

 private:
  /// A test force that looks otherwise than the training records' may come from the same machine all the same (a
  /// controller holds noise and tones alike): it is read as theirs where the model as it was chosen follows it far
  /// better so. Not where they differ among themselves, and say which look is read how.
  void read_test_force(const Candidate& chosen) {
    if (study_.between.alike || !chosen.ran() || !one_look(study_) || look_alike(study_, study_.test)) return;
    constexpr double far_better = 0.8;
    Study alike = study_;
    alike.between.alike = true;
    if (!(error_on_test(alike, chosen) < far_better * error_on_test(study_, chosen))) return;
    ground_.whole.between.alike = study_.between.alike = true;
    out_.warnings.push_back(
        "between its samples the force of the test records is read as that of the training records (" +
        std::string(to_string(study_.between.kind)) + "), though it looks otherwise");
  }

  /// What the force does between its samples may show on the test records alone, which choose nothing, or be otherwise
  /// than the baseline says: it is told.
  void warn_of_reading(const Candidate& chosen) {
    constexpr double far_better = 0.8, follows = 3;  // of the squared error; times the floor
    const Gap& gap = out_.final_test;
    const bool said = is_said(study_);
    if (study_.imposed || !chosen.ran() || !(said || gap.value < follows * gap.floor)) return;
    const double present = error_on_test(study_, chosen);
    double least = far_better * present;
    std::optional<Interpolation> better;
    for (const Interpolation kind : every_interpolation) {
      if (kind == study_.between.kind) continue;
      Study other = study_;
      read_force(other, {kind, true});
      Candidate refitted = chosen;
      refitted.fit = fit_near(other, chosen, chosen.fit.theta, 10, chosen.fit.substeps);
      if (const double error = error_on_test(other, refitted); error < least) {
        least = error;
        better = kind;
      }
    }
    if (!better) return;
    const std::string name = to_string(*better);
    out_.warnings.push_back("the test records are followed better with the force read as " + name +
                            " between its samples (gap " + number(gap.value * std::sqrt(least / present), 3) +
                            ") than as it is " + (said ? "said " : "") + "(" + number(gap.value, 3) +
                            (said ? ")" : "), which the training records do not tell") +
                            ": where that is what it does, say interpolation = \"" + name + "\" (--interpolation " +
                            name + "); the parameters change with it");
  }

  /// Names the one effect that the training records show by less than the least gain, where the test bears it out.
  void bear_out(Round& round) {
    std::optional<Round> named = borne_out(study_, round);
    if (!named) return;
    round = std::move(*named);
    out_.test_chose = true;
    remark_ties(round.found);
    const double gain = 1 - round.found.chosen.left_out_gap / round.found.baseline.left_out_gap;
    out_.warnings.push_back("the training records show " + round.found.chosen.name() +
                            " beyond chance, but by less than the least gain (" + number(100 * gain, 2) +
                            " %): the test records bear it out. Train on one like these as well");
  }

  /// What nothing explains is held against the noise whatever its colour, where it may have one. Names are so only
  /// where the test records refute nothing (leaves_noise_of_a_colour): that floor holds what they may lack.
  void hear_the_colour(Round& round) {
    if (!may_have_colour(study_, round)) return;
    ground_.whole.noise_has_colour = study_.noise_has_colour = true;
    for (const Candidate& set : round.found.grown.sets)
      if (set.ran()) study_.least_left = std::min(study_.least_left, rms_error(set.fit));
    ground_.whole.least_left = study_.least_left;
    round.train = runs(study_, round.found.chosen, study_.full);
    round.left.gap = round.gap(round.train);
    if (round.names()) runs_.after_test = runs(study_, round.found.chosen, study_.test);
  }

  /// What the names leave open is noise by all that can be told: generic forces see nothing in it, on the training nor
  /// on the test records, it follows no force, is no larger a part of the motion on the test, and taken for noise
  /// leaves nothing that refutes these.
  bool leaves_noise_of_a_colour(const Round& round) const {
    constexpr double larger = 1.3;
    if (!may_leave_noise(study_, round) || follows_the_forces(study_, runs_.after_test, study_.test)) return false;
    Round heard = round;
    std::vector<FreeRun> after = runs_.after_test;
    for (std::vector<FreeRun>* all : {&heard.train, &after})
      for (FreeRun& run : *all) run.floor_squares = std::max(run.floor_squares, run.squares);
    heard.left.gap = heard.gap(heard.train);
    return heard.gap(after).value < larger * heard.left.gap.value &&
           refuted(study_, heard, out_.test_p_value, runs_.before_test, after).empty() &&
           !test_shows_structure(study_, round.found.chosen, round.found.whitening);
  }

  /// Holds the names against the test records; returns their short runs, where these were held against.
  std::optional<TestRuns> judge_names(Round& round) {
    SearchResult& found = round.found;
    runs_.after_test = runs(study_, found.chosen, study_.test);
    runs_.before_test = round.names() ? runs(study_, found.baseline, study_.test, false) : runs_.after_test;
    if (!round.names()) {
      round.verdict = verdict_without_names(round);
      return {};
    }
    std::optional<TestRuns> shorter;
    if (noise_on_test(round) > lost_gap) shorter = short_test_runs(round);
    auto [fault, of_all] = held_against_test(round, shorter);
    if (!fault.empty() && !of_all && !shorter && parameters_lead_astray(round)) {
      shorter = short_test_runs(round);
      std::tie(fault, of_all) = held_against_test(round, shorter);
    }
    const Choices judged = found.chosen.choices;
    std::string noise;
    if (!fault.empty() && !of_all && !shorter && leaves_noise_of_a_colour(round)) {
      noise = taken_for_noise(round);
      fault.clear();
    }
    const Study& study = shorter ? shorter->study : study_;
    const std::vector<FreeRun>&before = shorter ? shorter->before : runs_.before_test,
          &after = shorter ? shorter->after : runs_.after_test;
    if (of_all) {
      if (of_all->settled && !shorter)
        take_open_from_test(round, *of_all->settled);
      else
        out_.warnings.push_back(left_open_by_training(found.chosen, fault, of_all->test));
    } else if (!fault.empty()) {
      if (!leave_to(tied_that_stand(study_, study, round, before), round, fault))
        take_back(study, round, fault, steps_that_stand(study, round, before));
    } else if (leaves_a_good_part(round, after)) {
      leave_to(tied_that_take_most(study, round, before, after), round,
               "leaves " + number(round.gap(after).value / round.gap(after).floor, 2) +
                   " times what noise alone leaves on the test record, most of which the latter takes");
    } else if (const std::size_t stand = steps_that_help(study, round, after); stand < found.steps.size()) {
      take_back(study, round, "did no better on the test record than " + found.steps[stand - 1].model.name(), stand);
    }
    if (!noise.empty() && found.chosen.choices == judged) out_.warnings.push_back(noise);
    return shorter;
  }

  /// Parameters that no step of the training fit changes (of a hidden mode in a decay, how heavy it is) are those of
  /// one fit to all records.
  void take_open_from_test(Round& round, const FitResult& settled) {
    SearchResult& found = round.found;
    out_.test_chose = study_.test_is_known = true;
    out_.warnings.push_back("the training records leave " + unidentifiable(found.chosen) + " of " +
                            found.chosen.name() + " open: the values are those of one fit to all records, the test " +
                            "records too, whose gap is not held out then. Train on one like them as well");
    found.chosen.fit = settled;
    if (!found.steps.empty()) found.steps.back().model.fit = settled;
    round.train = runs(study_, found.chosen, study_.full);
    runs_.after_test = runs(study_, found.chosen, study_.test);
    out_.test_p_value = test_p_value(study_, runs_.before_test, runs_.after_test);
  }

  void fill_gaps(const Round& round, const std::optional<TestRuns>& shorter) {
    runs_.after_train = round.train;
    runs_.before_train = round.names() ? runs(study_, round.found.baseline, study_.full, false) : runs_.after_train;
    runs_.share = input_noise_share(runs_.after_train);
    out_.baseline_train = pool_gap(runs_.before_train, runs_.share);
    out_.baseline_test = pool_gap(runs_.before_test, runs_.share);
    out_.final_train = pool_gap(runs_.after_train, runs_.share);
    out_.final_test = pool_gap(runs_.after_test, runs_.share);
    if (shorter && round.names())
      out_.short_test = {shorter->study.run_length, pool_gap(shorter->before, runs_.share),
                         pool_gap(runs(shorter->study, round.found.chosen, shorter->study.test), runs_.share)};
    const std::vector<std::string> outputs = study_.outputs();
    for (std::size_t i = 0; i < outputs.size() && outputs.size() > 1; ++i) {
      const auto gap = [&](const std::vector<FreeRun>& all) {
        return pool_gap(of_output(all, outputs[i]), runs_.share);
      };
      out_.outputs.push_back(
          {outputs[i], gap(runs_.before_train), gap(runs_.before_test), gap(runs_.after_train), gap(runs_.after_test)});
    }
  }

  /// What the test records, whole or in short runs, have against the names, and a fit to all records where that
  /// answers it.
  std::pair<std::string, std::optional<FitToAll>> held_against_test(const Round& round,
                                                                    const std::optional<TestRuns>& shorter) {
    const Study& study = shorter ? shorter->study : study_;
    const std::vector<FreeRun>&before = shorter ? shorter->before : runs_.before_test,
          &after = shorter ? shorter->after : runs_.after_test;
    out_.test_p_value = test_p_value(study, before, after);
    std::string fault = refuted(study, round, out_.test_p_value, before, after);
    if (fault.empty()) return {};
    return {std::move(fault), fit_to_all(study, round, out_.test_p_value, before, after)};
  }

  /// Of the motion, what noise makes of the chosen model's run over the test records: that of the forces whole, of
  /// which a small part leads as far away where small differences grow.
  double noise_on_test(const Round& round) const {
    return pool_gap(runs_.after_test, round.input_share() > 0 ? 1 : 0).floor;
  }

  /// The deviations of the parameters of a model that follows the training records down to their noise, and noise, lose
  /// its run over the test records.
  bool parameters_lead_astray(const Round& round) const {
    if (!(round.left.gap.value < 1.3 * round.left.gap.floor)) return false;
    return std::hypot(noise_on_test(round), parameter_spread(study_, round.found.chosen, study_.test)) > lost_gap;
  }

  /// Short runs over the test records, of a model that is lost over the whole of them.
  std::optional<TestRuns> short_test_runs(const Round& round) {
    if (study_.imposed || study_.run_length > 0 || !(round.gap(runs_.after_test).value < runaway_gap)) return {};
    TestRuns out = runs_on_test(in_short_runs(study_), round.found);
    out_.warnings.push_back(
        "runs over the whole test record are lost to noise, whatever the model: the names are held against runs of " +
        number(out.study.run_length, 3) + " s there");
    return out;
  }

  /// Not refuted, but far from the noise where others may be at it.
  static bool leaves_a_good_part(const Round& round, const std::vector<FreeRun>& after) {
    const Gap gap = round.gap(after);
    return round.found.chosen.choices.size() == 1 && gap.value > 1.5 * gap.floor;
  }

  /// Of those that the training records cannot tell from the one name: what takes most of that, beyond chance. None
  /// where the name with other parameters, which the training records leave open, would.
  std::vector<TiedRival> tied_that_take_most(const Study& tested, const Round& round,
                                             const std::vector<FreeRun>& before,
                                             const std::vector<FreeRun>& after) const {
    constexpr double most = 2.0 / 3, level = 0.05;  // of the excess; few blocks of a test record hold it
    const Gap left = round.gap(after);
    std::vector<TiedRival> out = tied_that_stand(study_, tested, round, before);
    std::erase_if(out, [&](const TiedRival& rival) {
      const Gap gap = round.gap(rival.test);
      return !(closed_share(left.value, gap.value, left.floor) > most) ||
             !(test_p_value(tested, after, rival.test) < level);
    });
    if (!out.empty() && fit_to_all(tested, round, out_.test_p_value, before, after)) out.clear();
    return out;
  }

  /// One name is taken back: of those that the training records cannot tell from it, what the test records leave.
  bool leave_to(std::vector<TiedRival> standing, Round& round, const std::string& fault) {
    SearchResult& found = round.found;
    if (standing.empty()) return false;
    TiedRival& first = standing.front();
    out_.test_chose = true;
    out_.warnings.push_back("the training records could not tell " + found.chosen.name() + " from " +
                            first.model.name() + ": the former " + fault);
    withdraw(round, Beaten::By::test, not_confirmed);
    for (Beaten& rival : found.rivals)
      if (rival.by == Beaten::By::tie) rival = {std::move(rival.model), Beaten::By::test, not_confirmed};
    name_steps(study_, found, {{first.model.choices.front(), first.model}});
    for (std::size_t i = 1; i < standing.size(); ++i) found.ties.rivals.push_back(standing[i].model.choices);
    remark_ties(found);
    round.left = std::move(first.left);
    round.train = std::move(first.train);
    runs_.after_test = runs(study_, found.chosen, study_.test);
    out_.test_p_value = first.test_p_value;
    round.verdict = found.ties.verdict();
    return true;
  }

  /// Names are taken back, of common entries or of all: where the test records bear out whole those that the training
  /// records had put behind, and these leave less there than what would stand, they are the answer after all; not where
  /// they leave far more of the training records than what is taken back.
  /// `tested`: the study as the test records are judged (short_test_runs).
  bool leave_what_was_put_behind(const Study& tested, Round& round, const std::string& fault, std::size_t stand) {
    if (!round.displaced) return false;
    const double followed = round.gap(round.train).value;
    const double open =
        stand == 0 ? INFINITY : round.gap(runs(tested, round.found.steps[stand - 1].model, tested.test)).value;
    Ground as_found = ground_;
    Round other = std::move(*round.displaced);
    round.displaced.reset();
    ground_.read_force({other.between.kind, study_.between.alike});
    ground_.baseline = other.found.baseline;
    fit_all_rows(ground_, other);
    const bool in_runs = tested.run_length > study_.run_length;
    TestRuns judged = runs_on_test(in_runs ? in_short_runs(study_) : study_, other.found);
    const auto& [study, before, after] = judged;
    const double p_value = test_p_value(study, before, after);
    const bool follows = other.gap(other.train).value < 3 * followed;
    const Gap left_there = other.gap(after);
    const bool whole = !(other.left.material && left_there.value > 3 * left_there.floor);
    if (!other.names() || !follows || !whole || !refuted(study, other, p_value, before, after).empty() ||
        steps_that_help(study, other, after) < other.found.steps.size() || !(left_there.value < open)) {
      ground_ = std::move(as_found);
      return false;
    }
    out_.test_chose = true;
    out_.warnings.push_back("the named " + round.found.chosen.name() + " " + fault + ": " + other.found.chosen.name() +
                            ", which the training records had put behind, stands");
    other.found.rivals.insert(other.found.rivals.begin(),
                              Beaten{std::move(round.found.chosen), Beaten::By::test, not_confirmed});
    round = std::move(other);
    if (in_runs) judged = runs_on_test(study_, round.found);
    runs_.before_test = std::move(judged.before);
    runs_.after_test = std::move(judged.after);
    out_.test_p_value = p_value;
    return true;
  }

  /// All names but those of the first steps that stand.
  void take_back(const Study& tested, Round& round, const std::string& fault, std::size_t stand) {
    if (leave_what_was_put_behind(tested, round, fault, stand)) return;
    SearchResult& found = round.found;
    while (stand > 0 && !may_be_named(study_, found.steps[stand - 1].model)) --stand;
    const std::vector<NamedStep> steps(found.steps.begin(), found.steps.begin() + static_cast<std::ptrdiff_t>(stand));
    // Where the model follows the training records, these lack what the test record shows; else it lacks it anyway.
    const bool followed = round.left.gap.value < 1.5 * round.left.gap.floor;
    const std::string what_stands =
        stand > 0  ? "only " + steps.back().model.name() + " stands"
        : followed ? "the name is withdrawn. The training records may not show what the test record does: train on one "
                     "like it as well"
                   : "the name is withdrawn";
    out_.warnings.push_back("the named " + found.chosen.name() + " " + fault + ": " + what_stands);
    const bool patched = round.left.seen;
    withdraw(round, Beaten::By::test, not_confirmed);
    if (stand > 0) name_steps(study_, found, steps);
    runs_.after_test = runs(study_, found.chosen, study_.test);
    if (stand == 0) {
      runs_.before_test = runs_.after_test;
    } else if (tested.run_length > study_.run_length) {
      const TestRuns judged = runs_on_test(tested, found);
      out_.test_p_value = test_p_value(tested, judged.before, judged.after);
    } else {
      out_.test_p_value = test_p_value(study_, runs_.before_test, runs_.after_test);
    }
    round.train = runs(study_, found.chosen, study_.full);
    round.left = look_for_structure(study_, found.chosen, round.train, found.whitening);
    if (stand > 0) find_ties_again(study_, found);  // what is left of a larger set has rivals of its own
    round.verdict = stand > 0 ? found.ties.verdict() : verdict_without_names(round, patched);
  }

  /// Names that are not the answer, for what the training records say of them, but leave less than half of the excess
  /// on the test records all the same: what they follow is there.
  bool withdrawn_names_follow(const Round& round) const {
    if (round.withdrawn.empty() || round.found.rivals.empty()) return false;
    const Beaten& nearest = round.found.rivals.front();
    if (nearest.by != Beaten::By::training || nearest.model.name() != round.withdrawn) return false;
    const Gap before = round.gap(runs_.before_test);
    const Gap after = round.gap(runs(study_, nearest.model, study_.test, false));
    return closed_share(before.value, after.value, before.floor) > 0.5;
  }

  /// No name stands: much of the motion is open, or generic forces see something (or did, beside the names that the
  /// test records took back) which these records do not deny, or names that were withdrawn follow it there.
  Verdict verdict_without_names(Round& round, bool patched = false) const {
    if (!round.found.reading.empty()) return Verdict::nothing_missing;
    const Gap train = round.gap(round.train), test = round.gap(runs_.before_test);
    round.loose_test = hangs_on_parameters(study_, round.found.baseline, train, test);
    constexpr double nearly_all = 0.7;
    round.driven =
        round.loose_test ? 0 : lacks_dynamics(study_, train, test, round.train, runs_.before_test, nearly_all);
    const bool open = round.driven > 0 || leaves_motion_open(study_, train) ||
                      (leaves_motion_open(study_, test) && !round.loose_test);
    const bool missing = open || withdrawn_names_follow(round) ||
                         ((patched || round.left.material) && !gone_on_test(study_, round, runs_.before_test));
    return missing ? Verdict::unknown_effect : Verdict::nothing_missing;
  }

  Ground& ground_;
  Study& study_;  ///< of the ground
  Discovery& out_;
  ModelRuns runs_;
};

}  // namespace

ModelRuns judge_on_test(Ground& ground, Round& round, Discovery& out) { return OnTest(ground, out).judge(round); }

}  // namespace lunid
