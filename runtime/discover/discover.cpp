#include "discover/discover.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <optional>

#include "discover/baseline.hpp"
#include "discover/between_samples.hpp"
#include "discover/conclusion.hpp"
#include "discover/frame.hpp"
#include "discover/gap.hpp"
#include "discover/naming.hpp"
#include "discover/proposal_fits.hpp"
#include "discover/search.hpp"
#include "discover/sensor.hpp"
#include "discover/verdict.hpp"
#include "expr/digits.hpp"
#include "record/parallel.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

/// Drop of the squared error at which a force that is read otherwise between its samples is worth a new search.
constexpr double interpolation_gain = 0.02;
constexpr double interpolation_part = 0.1;  ///< the same, of what is above the sensor's noise
constexpr double left_open = 0.1;  ///< part of the squared error above the noise, at which more models are asked
constexpr std::size_t asked_sets = 3;
constexpr double follows_better = 0.5;  ///< of the squared error of what was chosen, that they have to leave then
constexpr double lost = 0.3;            ///< gap beyond which a run follows nothing
constexpr double runaway = 10;       ///< gap of a run that grows beyond all motion: no noise leads a stable model there
constexpr double short_run = 2;      ///< in periods of the motion's upper frequency
constexpr int most_coordinates = 5;  ///< their motion, velocity and acceleration all drive internal states

std::string seconds(double t) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g s", t);
  return text;
}

class Spine {
 public:
  Spine(const Model& baseline, const std::vector<Effect>& catalogue, const std::vector<Record>& train,
        const std::vector<Record>& test, const DiscoverOptions& options)
      : options_(options), given_(catalogue), model_(complete(baseline)) {
    progress("check the data", 0.0);
    whole_ = prepare(model_, train, test, options_);
    study_ = shortened(whole_);
    out_.warnings = study_.warnings;
    for (const auto& data : whole_.train)
      for (const auto& w : data.record.warnings()) out_.warnings.push_back(w);
    out_.baseline_before = model_.parameters;
  }

  Discovery run() {
    progress("refit the baseline", 0.05);
    baseline_ = fit_baseline(study_, model_, out_.warnings);
    choose_catalogue();
    if (lower_noise(whole_, baseline_)) take_noise();
    Round round = look_at_all();
    if (nothing_follows(round)) look_in_short_runs(round);
    fit_all_rows(round);
    doubt_names(round);
    progress("open the test record", 0.94);
    validate_on_test(round);
    warn_of_untried(round.found);
    conclude(
        study_, catalogue_, round, runs_, tried_,
        [this](const std::string& stage, double fraction) { progress(stage, fraction); }, out_);
    progress("done", 1.0);
    return std::move(out_);
  }

 private:
  /// The entries that these records can show, the common ones first.
  void choose_catalogue() {
    std::vector<std::string> left;
    const auto many =
        options_.first > 0 ? std::min<std::ptrdiff_t>(options_.first, std::ssize(given_)) : std::ssize(given_);
    catalogue_ = testable(study_, baseline_, {given_.begin(), given_.begin() + many}, left);
    first_ = catalogue_.size();
    std::vector<Effect> others = testable(study_, baseline_, {given_.begin() + many, given_.end()}, left);
    const auto with_states = std::stable_partition(others.begin(), others.end(), [](const Effect& effect) {
      return !is_physics(effect) || effect.states.empty();
    });
    without_states_ = first_ + static_cast<std::size_t>(with_states - others.begin());
    std::move(others.begin(), others.end(), std::back_inserter(catalogue_));
    for (std::size_t i = 0; i < left.size(); ++i) (i == 0 ? untested_ = "not tried: " : untested_ += ", ") += left[i];
  }

  /// The common entries, and the others where those leave something open.
  Round look_at_all() {
    Round round = look(first_, {}, first_ < catalogue_.size() ? 0.4 : 0.9);
    if (first_ < catalogue_.size() && leaves_open(round))
      look_further(round, "the whole catalogue", catalogue_.size());
    else if (without_states_ > first_ && round.names())
      look_further(round, "the rivals without memory", without_states_);
    return round;
  }

  /// What a search stands on.
  struct Ground {
    Study whole, study;
    Candidate baseline;
  };
  Ground ground() const { return {whole_, study_, baseline_}; }
  void stand_on(Ground ground) {
    whole_ = std::move(ground.whole);
    study_ = std::move(ground.study);
    baseline_ = std::move(ground.baseline);
  }

  // ---- motions that forget where they came from ----
  /// Noise alone keeps the run from the measured motion. Of names, the fit too, which knows all rows and may follow
  /// such a motion. Where nothing was named, also that no set which was fitted comes near, or that the best one is
  /// lost.
  bool nothing_follows(const Round& round) const {
    if (study_.imposed || round.left.gap.value < lost) return false;
    const bool lost_so = lost_to_noise(study_, round.left.gap);
    if (round.names()) return lost_so && rms_error(round.found.chosen.fit) > 2 * study_.sensor_noise();
    const double near = std::max(0.1 * study_.measured_std(), 2 * study_.sensor_noise());
    const auto follows = [&](const Candidate& c) { return rms_error(c.fit) < near; };
    const std::vector<Candidate>& sets = round.found.grown.sets;
    return lost_so || std::ranges::none_of(sets, follows) || is_lost(study_, sets.front());
  }

  /// A wrong model and a motion that no run can hold look alike over a long record. Over short ones a right model
  /// reaches the noise; and the long runs of that model are lost to noise alone.
  void look_in_short_runs(Round& round) {
    Ground before = ground();
    whole_ = study_ = in_short_runs(before.whole, short_run);
    progress("runs of " + seconds(study_.run_length), done_);
    std::vector<std::string> unsaid;
    baseline_ = fit_baseline(study_, model_, unsaid);
    Round shorter = look_at_all();
    const bool reached = rms_error(shorter.found.chosen.fit) < 1.5 * study_.sensor_noise();
    if (shorter.verdict != "unknown-effect" && reached && is_lost(before.study, shorter.found.chosen)) {
      round = std::move(shorter);
      out_.warnings.push_back(
          "runs over whole records are lost to noise, whatever the model: all runs, fits and gaps are of " +
          seconds(study_.run_length) + ", each from a first state of its own");
      return;
    }
    stand_on(std::move(before));
  }

  /// Most of the gap is what noise makes of it, far more than the sensor's own.
  static bool lost_to_noise(const Study& study, const Gap& gap) {
    constexpr double part = 0.1, times = 3;
    return gap.floor > std::max(part, times * study.noise_gap()) && gap.value < 2 * gap.floor && gap.value < runaway;
  }

  /// Of a model's runs over whole records. A fit that knows the first states of all rows may follow such a motion.
  static bool is_lost(const Study& study, const Candidate& model) {
    return lost_to_noise(study, pool_gap(runs(study, model, study.full), 1));
  }

  /// Searches the first entries of the catalogue. What is found may show how the force is to be read between its
  /// samples; where that matters the search is made again.
  /// `until`: part of the whole work that is done then.
  Round look(std::size_t entries, const Grown& known, double until) {
    const std::span<const Effect> part(catalogue_.data(), entries);
    const auto step = [this, from = done_, until](const std::string& stage, double fraction) {
      progress(stage, from + (until - from) * fraction);
    };
    Round round;
    round.found = search(study_, model_, baseline_, part, known, step);
    const BetweenSamples before = study_.between;
    if (reading_shows_beside(round.found.chosen) || reading_shows_beside_the_best(round.found)) {
      fit(study_, baseline_, full_fit(study_, 40));
      round.found = search(study_, model_, baseline_, part, {}, step);
    } else if (study_.between != before) {
      judge_again(round.found);
    }
    if (lower_noise(whole_, round.found.chosen)) {
      take_noise();
      judge_again(round.found);
    }
    tried_ = std::max(tried_, round.found.grown.tried);
    progress("decide", until);
    round.between = study_.between;
    decide(study_, round);
    return round;
  }

  /// What the first entries leave open is held against all, what they name against the faults of sensors and of the
  /// input, and against all that runs fast, without which no physics is named. Names that were found stand unless
  /// others take their place.
  void look_further(Round& round, const std::string& stage, std::size_t entries) {
    progress(stage, done_);
    const BetweenSamples before = study_.between;
    const Candidate baseline = baseline_;
    if (before != BetweenSamples{study_.guesses.front()}) {  // chosen beside a model that was not the right one
      read_force({study_.guesses.front()});
      fit(study_, baseline_, full_fit(study_, 40));
      round.found.grown.sets.clear();
    }
    Round further = look(entries, round.found.grown, 0.9);
    if (takes_the_place(further, round)) {
      if (round.names()) further.displaced = std::make_shared<Round>(std::move(round));
      round = std::move(further);
    } else {
      read_force(before);
      baseline_ = baseline;
    }
  }

  /// What was found on pieces of long records is fitted to all their rows. The names stay.
  void fit_all_rows(Round& round) {
    if (!study_.in_pieces) return;
    progress("fit all rows", 0.92);
    study_ = whole_;
    SearchResult& found = round.found;
    const std::vector<Candidate*> all = models_of(found);
    const auto fit_again = [&](int i) {
      Candidate& c = *all[static_cast<std::size_t>(i)];
      if (c.ran()) c.fit = fit_near(study_, c, c.fit.theta, 12, c.fit.substeps);
    };
    parallel_for(static_cast<int>(all.size()), options_.threads, fit_again);
    drop_those_that_do_not_run(found);
    found.whitening = residual_colour(study_, found.chosen.ran() ? found.chosen : found.baseline);
    judge_again(found);
    baseline_ = found.baseline;
    decide(study_, round);
  }

  /// All that were judged, baseline and chosen set first; the last step is the chosen set.
  static std::vector<Candidate*> models_of(SearchResult& found) {
    std::vector<Candidate*> all{&found.baseline, &found.chosen};
    for (std::size_t i = 0; i + 1 < found.steps.size(); ++i) all.push_back(&found.steps[i].model);
    for (Beaten& rival : found.rivals) all.push_back(&rival.model);
    if (found.faint) all.push_back(&*found.faint);
    return all;
  }

  static void drop_those_that_do_not_run(SearchResult& found) {
    std::erase_if(found.rivals, [](const Beaten& rival) { return !rival.model.ran(); });
    if (found.faint && !found.faint->ran()) found.faint.reset();
  }

  /// To the study as it is now. The names stay; rivals are judged where they are, nearly.
  void judge_again(SearchResult& found) const {
    const std::vector<Candidate*> all = models_of(found);
    parallel_for(static_cast<int>(all.size()), options_.threads, [&](int i) {
      Candidate& c = *all[static_cast<std::size_t>(i)];
      c.left_out.resize(0);
      judge(study_, c, found.whitening, i < 2 ? 30 : 2);
    });
    for (Candidate* c : {&found.baseline, &found.chosen}) run_left_out(study_, *c);
    if (found.faint) run_left_out(study_, *found.faint);
    if (!found.steps.empty()) found.steps.back().model = found.chosen;
  }

  /// What a quarter of the resampled training records would have named in place of the chosen set is a tie. Not a part
  /// of it, nor what holds it: these were told apart by free runs over left-out blocks, which no resample makes.
  void doubt_names(Round& round) const {
    if (!round.names()) return;
    constexpr double doubt = 0.25;
    SearchResult& found = round.found;
    const Choices& chosen = found.chosen.choices;
    const Naming naming = bootstrap_naming(study_, found);
    for (const auto& [rival, by, remark] : found.rivals) {
      const Choices& set = rival.choices;
      const int count = naming.of(rival.name());
      if (count == 0 || count < doubt * naming.resamples || within(set, chosen) || within(chosen, set)) continue;
      if (!is_among(found.ties.rivals, set)) found.ties.rivals.push_back(set);
    }
    remark_ties(found);
    round.verdict = found.ties.verdict();
  }

  /// A search that is made again shows what it has shown before.
  void progress(const std::string& stage, double fraction) {
    done_ = std::max(done_, fraction);
    if (options_.cancelled && *options_.cancelled)
      throw InputError("interrupted while: " + stage, {}, Fault::interrupted);
    if (options_.progress) options_.progress(stage, done_);
  }

  /// Several outputs weigh by their noise: the fit is another one.
  void take_noise() {
    study_ = shortened(whole_);
    if (study_.degrees() > 1) fit(study_, baseline_, full_fit(study_, 40));
  }

  // ---- force between its samples ----
  void read_force(BetweenSamples between) {
    lunid::read_force(whole_, between);
    study_ = shortened(whole_);
  }

  /// The force is left as this model would have it read. Whether that is worth a new search.
  bool reading_shows_beside(const Candidate& model) { return reading_shows_beside(model, squared_error(model.fit)); }

  /// `error`: that the model has to come below, read so.
  bool reading_shows_beside(const Candidate& model, double error) {
    const double gain = rechoose_interpolation(study_, model, [this](BetweenSamples between) -> const Study& {
      read_force(between);
      return study_;
    });
    return gain > std::max(interpolation_gain, interpolation_part * open(model)) &&
           (1 - gain) * squared_error(model.fit) < error;
  }

  /// A model that lacks something may hide half a sample in its damper, where what it lacks would show it: the sets
  /// that follow best are asked too, where what was chosen leaves anything.
  bool reading_shows_beside_the_best(const SearchResult& found) {
    if (!(open(found.chosen) > left_open)) return false;
    const BetweenSamples chosen = study_.between;
    const std::vector<Candidate>& sets = found.grown.sets;
    for (std::size_t i = 0; i < std::min(sets.size(), asked_sets); ++i) {
      if (reading_shows_beside(sets[i], follows_better * squared_error(found.chosen.fit))) return true;
      read_force(chosen);
    }
    return false;
  }

  /// Part of the squared error that is not the sensor's noise.
  double open(const Candidate& model) const { return 1 - std::pow(study_.sensor_noise() / rms_error(model.fit), 2); }

  /// A test force that looks otherwise than the training records' may come from the same machine all the same (a
  /// controller holds noise and tones alike): it is read as theirs where the model as it was chosen follows it far
  /// better so. Not where they differ among themselves, and say which look is read how.
  void read_test_force(const Candidate& chosen) {
    if (study_.between.alike || !chosen.ran() || !one_look(study_) || look_alike(study_, study_.test)) return;
    constexpr double far_better = 0.8;
    Study alike = study_;
    alike.between.alike = true;
    const auto error = [&](const Study& study) {
      double squares = 0;
      for (const FreeRun& run : runs(study, chosen, study.test, false)) squares += run.squares;
      return std::isfinite(squares) ? squares : INFINITY;
    };
    if (!(error(alike) < far_better * error(study_))) return;
    whole_.between.alike = study_.between.alike = true;
    out_.warnings.push_back(
        "between its samples the force of the test records is read as that of the training records (" +
        std::string(to_string(study_.between.kind)) + "), though it looks otherwise");
  }

  /// What the first entries say may stand in for another entry: where the free run stays above its floor, where generic
  /// forces see more, where it takes several of them, and where others are simpler forms of what was named.
  bool leaves_open(const Round& round) const {
    const Closure& generic = round.left.closure;
    const bool hints = generic.p_value < options_.alpha / 10 && generic.gain > options_.minimum_gain;
    return round.verdict == "unknown-effect" || round.left.seen || hints || round.found.chosen.choices.size() > 1 ||
           !(round.left.gap.value < 1.2 * round.left.gap.floor) || has_simpler_form(round.found.chosen.choices);
  }

  bool has_simpler_form(const Choices& named) const {
    const auto others = std::span<const Effect>(catalogue_).subspan(first_);
    return std::any_of(others.begin(), others.end(), [&](const Effect& e) {
      return std::any_of(named.begin(), named.end(), [&](const Choice& c) { return e.is_special_case(*c.effect); });
    });
  }

  /// Rare effects take the place of common ones where they are no more than those and fit as well, where they are fewer
  /// and fit better, or, as of a baseline that lacks nothing, where they close what is left; a third of it where they
  /// are a more general form of the same. A record with disturbances of its own (a loop that is closed, a foundation
  /// that moves) would otherwise be followed by ever more of them.
  bool takes_the_place(const Round& further, const Round& round) const {
    if (round.verdict == "unknown-effect") return true;
    if (!further.names()) return false;
    const Candidate &rare = further.found.chosen, &common = round.found.chosen;
    constexpr double as_well = 1.02;
    const bool fits_as_well =
        rms_error(rare.fit) <= as_well * rms_error(common.fit) || rare.left_out_gap <= as_well * common.left_out_gap;
    if (round.names() && rare.parameters() <= common.parameters() && fits_as_well) return true;
    const bool simpler = rare.parameters() < common.parameters(), fewer = rare.choices.size() < common.choices.size();
    if (round.names() && (simpler || fewer)) {
      Candidate as_heard = common;  // under the force between samples and the colour of the noise of the other search
      judge(study_, as_heard, further.found.whitening);
      if (simpler && !fits_worse(study_, rare, as_heard)) return true;
      if (fewer && fits_worse(study_, as_heard, rare)) return true;
    }
    const bool grown = is_general_form(rare.choices, common.choices);
    const double floor = std::max(study_.noise_gap(), further.left.gap.floor);
    return closed_share(common.left_out_gap, rare.left_out_gap, floor) > (grown ? 0.33 : 0.95);
  }

  /// Opens the test record once. It can take names back, leave what the training records held beside them (ties, and
  /// common names that rarer ones displaced), and bear out the one effect that these show by less than the least gain;
  /// it adds no other.
  void validate_on_test(Round& round) {
    read_test_force(round.found.chosen);
    if (std::optional<Round> named = borne_out(study_, round)) {
      round = std::move(*named);
      remark_ties(round.found);
      char gain[32];
      std::snprintf(gain, sizeof gain, "%.2g %%",
                    100 * (1 - round.found.chosen.left_out_gap / round.found.baseline.left_out_gap));
      out_.warnings.push_back("the training records show " + round.found.chosen.name() +
                              " beyond chance, but by less than the least gain (" + gain +
                              "): the test records bear it out. Train on one like these as well");
    }
    SearchResult& found = round.found;
    std::optional<TestRuns> shorter;
    runs_.after_test = runs(study_, found.chosen, study_.test);
    runs_.before_test = round.names() ? runs(study_, found.baseline, study_.test, false) : runs_.after_test;
    if (round.names()) {
      shorter = short_test_runs(round);
      const Study& study = shorter ? shorter->study : study_;
      const std::vector<FreeRun>&before = shorter ? shorter->before : runs_.before_test,
            &after = shorter ? shorter->after : runs_.after_test;
      out_.test_p_value = test_p_value(study, before, after);
      const std::string fault = refuted(study, round, out_.test_p_value, before, after);
      const std::optional<Gap> of_all =
          fault.empty() ? std::nullopt : gap_of_one_fit_to_all(study, round, out_.test_p_value, before, after);
      if (of_all)
        out_.warnings.push_back(left_open_by_training(found.chosen, fault, *of_all));
      else if (!fault.empty()) {
        if (!leave_the_tied(study, round, fault, before))
          take_back(study, round, fault, steps_that_stand(study, round, before));
      } else if (const std::size_t stand = steps_that_help(study, round, after); stand < found.steps.size())
        take_back(study, round, "did no better on the test record than " + found.steps[stand - 1].model.name(), stand);
    } else {
      round.verdict = something_is_missing(round) ? "unknown-effect" : "nothing-missing";
    }
    runs_.after_train = round.train;
    runs_.before_train = round.names() ? runs(study_, found.baseline, study_.full, false) : runs_.after_train;
    runs_.share = input_noise_share(runs_.after_train);
    out_.baseline_train = pool_gap(runs_.before_train, runs_.share);
    if (out_.baseline_train.value > runaway)
      out_.warnings.insert(out_.warnings.begin(),
                           "the baseline's free run grows beyond the motion: with these parameters it is unstable (a "
                           "channel that comes late, a controller's part that is held between samples, or forces that "
                           "feed the motion make damping negative)");
    out_.baseline_test = pool_gap(runs_.before_test, runs_.share);
    out_.final_train = pool_gap(runs_.after_train, runs_.share);
    out_.final_test = pool_gap(runs_.after_test, runs_.share);
    if (shorter && round.names())
      out_.short_test = {shorter->study.run_length, pool_gap(shorter->before, runs_.share),
                         pool_gap(runs(shorter->study, found.chosen, shorter->study.test), runs_.share)};
    const std::vector<std::string> outputs = study_.outputs();
    for (std::size_t i = 0; i < outputs.size() && outputs.size() > 1; ++i) {
      const auto gap = [&](const std::vector<FreeRun>& all) {
        return pool_gap(of_output(all, outputs[i]), runs_.share);
      };
      out_.outputs.push_back(
          {outputs[i], gap(runs_.before_train), gap(runs_.before_test), gap(runs_.after_train), gap(runs_.after_test)});
    }
  }

  struct TestRuns {
    Study study;
    std::vector<FreeRun> before, after;
  };

  static TestRuns runs_on_test(Study study, const SearchResult& found) {
    TestRuns out{std::move(study), {}, {}};
    out.before = runs(out.study, found.baseline, out.study.test, false);
    out.after = runs(out.study, found.chosen, out.study.test);
    return out;
  }

  /// Short runs over the test records, where noise alone would have lost the model over the whole of them.
  std::optional<TestRuns> short_test_runs(const Round& round) {
    if (study_.imposed || study_.run_length > 0) return {};
    if (const Gap gap = round.gap(runs_.after_test); !(gap.floor > lost && gap.value < runaway)) return {};
    TestRuns out = runs_on_test(in_short_runs(study_, short_run), round.found);
    out_.warnings.push_back(
        "runs over the whole test record are lost to noise, whatever the model: the names are held against runs of " +
        seconds(out.study.run_length) + " there");
    return out;
  }

  static std::string left_open_by_training(const Candidate& named, const std::string& fault, const Gap& of_all) {
    char gaps[64];
    std::snprintf(gaps, sizeof gaps, "%.2g there, %.2g from noise alone", of_all.value, of_all.floor);
    return "the named " + named.name() + " " + fault +
           " with the parameters of the training records, which leave them " +
           "open: one fit to all records follows these down to their noise (" + gaps + "). Train on both";
  }

  /// One name is taken back: of those that the training records cannot tell from it, what the test records leave.
  /// `tested`: the study as the test records are judged (short_test_runs).
  bool leave_the_tied(const Study& tested, Round& round, const std::string& fault, const std::vector<FreeRun>& before) {
    SearchResult& found = round.found;
    if (found.chosen.choices.size() != 1) return false;
    std::vector<TiedRival> standing = tied_that_stand(study_, tested, round, before);
    if (standing.empty()) return false;
    TiedRival& first = standing.front();
    out_.warnings.push_back("the training records could not tell " + found.chosen.name() + " from " +
                            first.model.name() + ": the former " + fault);
    withdraw(round, Beaten::By::test, not_confirmed);
    for (Beaten& rival : found.rivals)
      if (rival.by == Beaten::By::tie) rival = {std::move(rival.model), Beaten::By::test, not_confirmed};
    name_alone(found, std::move(first.model));
    for (std::size_t i = 1; i < standing.size(); ++i) found.ties.rivals.push_back(standing[i].model.choices);
    remark_ties(found);
    round.left = std::move(first.left);
    round.train = std::move(first.train);
    runs_.after_test = runs(study_, found.chosen, study_.test);
    out_.test_p_value = first.test_p_value;
    round.verdict = found.ties.verdict();
    return true;
  }

  /// Names are taken back that had taken the place of common ones on the training records: where the test records bear
  /// those out whole, and they leave less there than what would stand, they are the answer after all; not where they
  /// leave far more of the training records than what is taken back.
  /// `tested`: the study as the test records are judged (short_test_runs).
  bool leave_the_common(const Study& tested, Round& round, const std::string& fault, std::size_t stand) {
    if (!round.displaced) return false;
    const double followed = round.gap(round.train).value;
    const double open =
        stand == 0 ? INFINITY : round.gap(runs(tested, round.found.steps[stand - 1].model, tested.test)).value;
    Ground as_found = ground();
    Round common = std::move(*round.displaced);
    round.displaced.reset();
    read_force({common.between.kind, study_.between.alike});
    baseline_ = common.found.baseline;
    fit_all_rows(common);
    const bool in_runs = tested.run_length > study_.run_length;
    TestRuns judged = runs_on_test(in_runs ? in_short_runs(study_, short_run) : study_, common.found);
    const auto& [study, before, after] = judged;
    const double p_value = test_p_value(study, before, after);
    const bool follows = common.gap(common.train).value < 3 * followed;
    if (!common.names() || !follows || !refuted(study, common, p_value, before, after).empty() ||
        steps_that_help(study, common, after) < common.found.steps.size() || !(common.gap(after).value < open)) {
      stand_on(std::move(as_found));
      return false;
    }
    out_.warnings.push_back("the named " + round.found.chosen.name() + " " + fault + ": " + common.found.chosen.name() +
                            ", whose place they had taken on the training records, stands");
    common.found.rivals.insert(common.found.rivals.begin(),
                               Beaten{std::move(round.found.chosen), Beaten::By::test, not_confirmed});
    round = std::move(common);
    if (in_runs) judged = runs_on_test(study_, round.found);
    runs_.before_test = std::move(judged.before);
    runs_.after_test = std::move(judged.after);
    out_.test_p_value = p_value;
    return true;
  }

  /// All names but those of the first steps that stand.
  void take_back(const Study& tested, Round& round, const std::string& fault, std::size_t stand) {
    if (leave_the_common(tested, round, fault, stand)) return;
    SearchResult& found = round.found;
    const std::vector<NamedStep> steps(found.steps.begin(), found.steps.begin() + static_cast<std::ptrdiff_t>(stand));
    const std::string what_stands =
        stand > 0 ? "only " + steps.back().model.name() + " stands"
                  : "the name is withdrawn. The training records may not show what the test record does: train on one "
                    "like it as well";
    out_.warnings.push_back("the named " + found.chosen.name() + " " + fault + ": " + what_stands);
    const bool patched = round.left.seen;
    withdraw(round, Beaten::By::test, not_confirmed);
    if (stand > 0) {
      found.steps = steps;
      found.chosen = steps.back().model;
      if (found.chosen.left_out.size() == 0) run_left_out(study_, found.chosen);
    }
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
    if (stand > 0) find_ties_of_the_rest(found);
    if (stand > 0)
      round.verdict = found.ties.verdict();
    else
      round.verdict = something_is_missing(round, patched) ? "unknown-effect" : "nothing-missing";
  }

  /// No name stands: much of the motion is open, or generic forces see something (or did, beside the names that the
  /// test records took back) which these records do not deny.
  bool something_is_missing(Round& round, bool patched = false) const {
    if (!round.found.reading.empty()) return false;
    const Gap train = round.gap(round.train), test = round.gap(runs_.before_test);
    round.loose_test = hangs_on_parameters(study_, round.found.baseline, train, test);
    const bool open = leaves_motion_open(study_, train) || (leaves_motion_open(study_, test) && !round.loose_test);
    return open || ((patched || round.left.material) && !gone_on_test(study_, round, runs_.before_test));
  }

  /// What is left of a larger set has rivals of its own.
  void find_ties_of_the_rest(SearchResult& found) const {
    std::vector<const Candidate*> rivals;
    for (const Beaten& rival : found.rivals) rivals.push_back(&rival.model);
    found.ties = find_ties(study_, found.baseline, found.chosen, rivals);
    remark_ties(found);
  }

  static void remark_ties(SearchResult& found) {
    for (Beaten& rival : found.rivals)
      if (holds_name(found.ties.rivals, rival.model.name()))
        rival = {std::move(rival.model), Beaten::By::tie, tie_remark(found.chosen)};
  }

  void warn_of_untried(const SearchResult& found) {
    std::string list;
    for (const auto& name : found.grown.left_aside) list += (list.empty() ? "" : ", ") + name;
    if (!list.empty())
      out_.warnings.push_back("not tried, since this record cannot show them beside the baseline's own terms: " + list);
    if (!untested_.empty()) out_.warnings.push_back(untested_);
  }

  const DiscoverOptions& options_;
  const std::vector<Effect>& given_;
  std::vector<Effect> catalogue_;   ///< of the given, what these records can show
  std::size_t first_ = 0;           ///< so many of them are tried first
  std::size_t without_states_ = 0;  ///< the same, and those without internal states that come behind them
  std::string untested_;
  Model model_;
  Study whole_, study_;  ///< of all rows, and of those that are looked at now: pieces of long records in the search
  Candidate baseline_;
  ModelRuns runs_;
  double done_ = 0;  ///< part of the work
  int tried_ = 0;    ///< start points of entries, of all rounds
  Discovery out_;
};

}  // namespace

void validate(const DiscoverOptions& o) {
  auto refuse = [](const std::string& field, const std::string& range, double got) {
    throw InputError("discover: " + field + ": expected " + range + ", got " + number(got), {}, Fault::usage);
  };
  if (!(o.alpha > 0 && o.alpha < 0.5)) refuse("alpha", "0 < alpha < 0.5", o.alpha);
  if (!(o.minimum_gain >= 0 && o.minimum_gain < 1)) refuse("minimum_gain", "0 <= minimum_gain < 1", o.minimum_gain);
  if (o.max_effects < 1) refuse("max_effects", ">= 1", o.max_effects);
  if (o.blocks < 3) refuse("blocks", ">= 3", o.blocks);
  if (!(o.holdout >= 0 && o.holdout < 0.9)) refuse("holdout", "0 <= holdout < 0.9", o.holdout);
  if (o.threads < 0) refuse("threads", ">= 0", o.threads);
}

void check_baseline(const Model& given) {
  const Model baseline = complete(given);
  if (baseline.degrees() > most_coordinates)
    throw InputError("discover: expected a model of no more than " + std::to_string(most_coordinates) +
                     " coordinates, got " + std::to_string(baseline.degrees()) +
                     ": take a part of it, or one of its modes");
  if (baseline.delay.valid()) throw InputError("discover: a baseline with a delayed force is not looked at: shift F");
  for (const std::string& input : baseline.inputs())
    if (input[0] != 'F')
      throw InputError("discover: a baseline driven by " + input + " is not looked at" +
                       (baseline.imposed_motion ? " with imposed motion" : "") + ": take what it does into F");
}

Discovery discover(const Model& baseline, const std::vector<Effect>& catalogue, const std::vector<Record>& train,
                   const std::vector<Record>& test, const DiscoverOptions& options) {
  validate(options);
  const Frame frame(baseline);
  check_baseline(frame.model());
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Effect> entries = frame.seen(catalogue);
  Discovery out = frame.as_given(Spine(frame.model(), entries, frame.seen(train), frame.seen(test), options).run());
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace lunid
