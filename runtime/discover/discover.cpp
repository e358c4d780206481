#include "discover/discover.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <optional>

#include "discover/baseline.hpp"
#include "discover/conclusion.hpp"
#include "discover/gap.hpp"
#include "discover/locate.hpp"
#include "discover/naming.hpp"
#include "discover/places.hpp"
#include "discover/proposal_fits.hpp"
#include "discover/removable.hpp"
#include "discover/search.hpp"
#include "discover/sensor.hpp"
#include "record/parallel.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

/// Drop of the squared error at which a force that is read otherwise between its samples is worth a new search.
constexpr double interpolation_gain = 0.02;
constexpr double lost = 0.3;         ///< gap beyond which a run follows nothing
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
    progress("open the test record", 0.94);
    validate_on_test(round);
    show(round);
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
    Round round = look(first_, {});
    if (first_ < catalogue_.size() && leaves_open(round))
      look_further(round, "the whole catalogue", catalogue_.size());
    else if (without_states_ > first_ && round.names())
      look_further(round, "the rivals without memory", without_states_);
    return round;
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
    const Study whole = whole_, study = study_;
    const Candidate baseline = baseline_;
    whole_ = study_ = in_short_runs(whole, short_run);
    progress("runs of " + seconds(study_.run_length), 0.1);
    std::vector<std::string> unsaid;
    baseline_ = fit_baseline(study_, model_, unsaid);
    Round shorter = look_at_all();
    const bool reached = rms_error(shorter.found.chosen.fit) < 1.5 * study_.sensor_noise();
    if (shorter.verdict != "unknown-effect" && reached && is_lost(study, shorter.found.chosen)) {
      round = std::move(shorter);
      out_.warnings.push_back(
          "runs over whole records are lost to noise, whatever the model: all runs, fits and gaps are of " +
          seconds(study_.run_length) + ", each from a first state of its own");
      return;
    }
    whole_ = whole;
    study_ = study;
    baseline_ = baseline;
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
  Round look(std::size_t entries, const Grown& known) {
    const std::span<const Effect> part(catalogue_.data(), entries);
    Round round;
    round.found = search(study_, model_, baseline_, part, known, step());
    const Interpolation before = study_.interpolation;
    const double gain = rechoose_interpolation(round.found.chosen);
    if (gain > interpolation_gain) {
      fit(study_, baseline_, full_fit(study_, 40));
      round.found = search(study_, model_, baseline_, part, {}, step());
    } else if (study_.interpolation != before) {
      refit(round.found);
    }
    if (lower_noise(whole_, round.found.chosen)) {
      take_noise();
      refit(round.found);
    }
    tried_ = std::max(tried_, round.found.grown.tried);
    progress("decide", 0.88);
    round.interpolation = study_.interpolation;
    decide(study_, round);
    return round;
  }

  /// What the first entries leave open is held against all, what they name against the faults of sensors and of the
  /// input, and against all that runs fast, without which no physics is named. Names that were found stand unless
  /// others take their place.
  void look_further(Round& round, const std::string& stage, std::size_t entries) {
    progress(stage, 0.1);
    const Interpolation before = study_.interpolation;
    const Candidate baseline = baseline_;
    if (before != study_.guesses.front()) {  // chosen beside a model that was not the right one
      take_interpolation(study_.guesses.front());
      fit(study_, baseline_, full_fit(study_, 40));
      round.found.grown.sets.clear();
    }
    Round further = look(entries, round.found.grown);
    if (takes_the_place(further, round)) {
      if (round.names()) further.displaced = std::make_shared<Round>(std::move(round));
      round = std::move(further);
    } else {
      take_interpolation(before);
      baseline_ = baseline;
    }
  }

  /// What was found on pieces of long records is fitted to all their rows. The names stay.
  void fit_all_rows(Round& round) {
    if (!study_.in_pieces) return;
    progress("fit all rows", 0.92);
    study_ = whole_;
    SearchResult& found = round.found;
    std::vector<Candidate*> all{&found.baseline, &found.chosen};
    for (std::size_t i = 0; i + 1 < found.steps.size(); ++i) all.push_back(&found.steps[i]);  // the last is the chosen
    for (Candidate& c : found.rivals) all.push_back(&c);
    const auto fit_again = [&](int i) {
      Candidate& c = *all[static_cast<std::size_t>(i)];
      if (c.ran()) c.fit = fit_near(study_, c, c.fit.theta, 12, c.fit.substeps);
    };
    parallel_for(static_cast<int>(all.size()), options_.threads, fit_again);
    found.whitening = residual_colour(study_, found.chosen.ran() ? found.chosen : found.baseline);
    parallel_for(static_cast<int>(all.size()), options_.threads,
                 [&](int i) { judge(study_, *all[static_cast<std::size_t>(i)], found.whitening, i < 2 ? 30 : 2); });
    for (Candidate* c : {&found.baseline, &found.chosen}) run_left_out(study_, *c);
    if (!found.steps.empty()) found.steps.back() = found.chosen;
    baseline_ = found.baseline;
    decide(study_, round);
  }

  void progress(const std::string& stage, double fraction) const {
    if (options_.cancelled && *options_.cancelled)
      throw InputError("interrupted while: " + stage, {}, Fault::interrupted);
    if (options_.progress) options_.progress(stage, fraction);
  }
  std::function<void(const std::string&, double)> step() const {
    return [this](const std::string& stage, double fraction) { progress(stage, fraction); };
  }

  /// The names stay; what was fitted is fitted again to the study as it is now.
  void refit(SearchResult& found) const {
    for (Candidate* c : {&found.baseline, &found.chosen}) {
      judge(study_, *c, found.whitening);
      run_left_out(study_, *c);
    }
    for (auto& c : found.steps) judge(study_, c, found.whitening);
  }

  /// Several outputs weigh by their noise: the fit is another one.
  void take_noise() {
    study_ = shortened(whole_);
    if (study_.degrees() > 1) fit(study_, baseline_, full_fit(study_, 40));
  }

  // ---- force between its samples ----
  void take_interpolation(Interpolation kind) {
    set_interpolation(whole_, kind);
    study_ = shortened(whole_);
  }

  bool force_varies() const {
    for (const auto& data : study_.train)
      for (const std::string& force : study_.forces)
        if (standard_deviation(data.record[force]) > 0) return true;
    return false;
  }

  /// Asked of the final model, whose misfit no longer hides what the force does between its samples. The first choice
  /// (study.cpp) is made on the force alone. Where another kind is clearly likelier the study then holds it; returns
  /// the relative drop of the squared error.
  double rechoose_interpolation(const Candidate& chosen) {
    if (study_.imposed || !chosen.ran() || !force_varies()) return 0;
    const Interpolation before = study_.interpolation;
    Interpolation best = before;
    const double first = squared_error(chosen.fit);
    double cost = first;
    const double needed = std::exp(-12.0 / static_cast<double>(chosen.fit.rows));
    for (const auto kind :
         {Interpolation::linear, Interpolation::cubic, Interpolation::band_limited, Interpolation::hold}) {
      if (kind == before) continue;
      take_interpolation(kind);
      FitOptions options = full_fit(study_, 6);
      options.tolerance = 1e-4;
      options.substeps = chosen.fit.substeps;
      options.first_states = chosen.fit.segments;
      const FitResult fit = fit_trajectory(*chosen.system, chosen.fit.theta, study_.train, options);
      if (fit.cost < needed * cost) {
        cost = fit.cost;
        best = kind;
      }
    }
    take_interpolation(best);
    return 1 - cost / first;
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

  /// Opens the test record once. It can take names back, and leave what the training records held beside them (ties,
  /// and common names that rarer ones displaced); it never adds one.
  void validate_on_test(Round& round) {
    SearchResult& found = round.found;
    std::optional<TestRuns> shorter;
    after_test_ = runs(study_, found.chosen, study_.test);
    before_test_ = round.names() ? runs(study_, found.baseline, study_.test, false) : after_test_;
    if (round.names()) {
      shorter = short_test_runs(round);
      const Study& study = shorter ? shorter->study : study_;
      const std::vector<FreeRun>&before = shorter ? shorter->before : before_test_,
            &after = shorter ? shorter->after : after_test_;
      out_.test_p_value = test_p_value(study, before, after);
      const std::string fault = refuted(study, round, out_.test_p_value, before, after);
      const std::optional<Gap> of_all =
          fault.empty() ? std::nullopt : gap_of_one_fit_to_all(study, round, out_.test_p_value, before, after);
      if (of_all)
        out_.warnings.push_back(left_open_by_training(found.chosen, fault, *of_all));
      else if (!fault.empty() && !leave_the_tied(study, round, fault, before))
        take_back(round, fault, steps_that_stand(study, round, before));
      else if (const std::size_t stand = steps_that_help(study, round, after);
               fault.empty() && stand < found.steps.size())
        take_back(round, "did no better on the test record than " + found.steps[stand - 1].name(), stand);
    } else {
      round.verdict = something_is_missing(round) ? "unknown-effect" : "nothing-missing";
    }
    after_train_ = round.train;
    before_train_ = round.names() ? runs(study_, found.baseline, study_.full, false) : after_train_;
    share_ = input_noise_share(after_train_);
    out_.baseline_train = pool_gap(before_train_, share_);
    if (out_.baseline_train.value > runaway)
      out_.warnings.insert(out_.warnings.begin(),
                           "the baseline's free run grows beyond the motion: with these parameters it is unstable (a "
                           "channel that comes late, a controller's part that is held between samples, or forces that "
                           "feed the motion make damping negative)");
    out_.baseline_test = pool_gap(before_test_, share_);
    out_.final_train = pool_gap(after_train_, share_);
    out_.final_test = pool_gap(after_test_, share_);
    if (shorter && round.names())
      out_.short_test = {shorter->study.run_length, pool_gap(shorter->before, share_),
                         pool_gap(runs(shorter->study, found.chosen, shorter->study.test), share_)};
    const std::vector<std::string> outputs = study_.outputs();
    for (std::size_t i = 0; i < outputs.size() && outputs.size() > 1; ++i) {
      const auto gap = [&](const std::vector<FreeRun>& all) { return pool_gap(of_output(all, outputs[i]), share_); };
      out_.outputs.push_back({outputs[i], gap(before_train_), gap(before_test_), gap(after_train_), gap(after_test_)});
    }
    name_steps(found);
  }

  struct TestRuns {
    Study study;
    std::vector<FreeRun> before, after;
  };

  /// Short runs over the test records, where noise alone would have lost the model over the whole of them.
  std::optional<TestRuns> short_test_runs(const Round& round) {
    if (study_.imposed || study_.run_length > 0) return {};
    if (const Gap gap = round.gap(after_test_); !(gap.floor > lost && gap.value < runaway)) return {};
    TestRuns out{in_short_runs(study_, short_run), {}, {}};
    out.after = runs(out.study, round.found.chosen, out.study.test);
    out.before = runs(out.study, round.found.baseline, out.study.test, false);
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
    const std::string as_tied = tie_remark(found.chosen);
    withdraw(round, not_confirmed);
    std::ranges::replace(found.remarks, as_tied, not_confirmed);
    const auto at = std::ranges::find(found.rivals, first.model.name(), &Candidate::name) - found.rivals.begin();
    found.rivals.erase(found.rivals.begin() + at);
    found.remarks.erase(found.remarks.begin() + at);
    found.chosen = std::move(first.model);
    found.order = found.chosen.choices;
    found.steps = {found.chosen};
    for (std::size_t i = 1; i < standing.size(); ++i) found.ties.rivals.push_back(standing[i].model.choices);
    remark_ties(found);
    round.left = std::move(first.left);
    round.train = std::move(first.train);
    after_test_ = runs(study_, found.chosen, study_.test);
    out_.test_p_value = first.test_p_value;
    round.verdict = found.ties.rivals.empty() ? "explained" : "ambiguous";
    return true;
  }

  /// Names are taken back that had taken the place of common ones on the training records: where the test records bear
  /// those out whole, and they leave less there than what would stand, they are the answer after all.
  bool leave_the_common(Round& round, const std::string& fault, std::size_t stand) {
    if (!round.displaced) return false;
    const Study whole = whole_, study = study_;
    const Candidate baseline = baseline_;
    Round common = std::move(*round.displaced);
    round.displaced.reset();
    take_interpolation(common.interpolation);
    baseline_ = common.found.baseline;
    fit_all_rows(common);
    std::vector<FreeRun> before = runs(study_, common.found.baseline, study_.test, false),
                         after = runs(study_, common.found.chosen, study_.test);
    const double p_value = test_p_value(study_, before, after);
    const double open = stand == 0 ? INFINITY : round.gap(runs(study, round.found.steps[stand - 1], study.test)).value;
    if (!common.names() || !refuted(study_, common, p_value, before, after).empty() ||
        steps_that_help(study_, common, after) < common.found.steps.size() || !(common.gap(after).value < open)) {
      whole_ = whole;
      study_ = study;
      baseline_ = baseline;
      return false;
    }
    out_.warnings.push_back("the named " + round.found.chosen.name() + " " + fault + ": " + common.found.chosen.name() +
                            ", whose place they had taken on the training records, stands");
    common.found.rivals.insert(common.found.rivals.begin(), std::move(round.found.chosen));
    common.found.remarks.insert(common.found.remarks.begin(), not_confirmed);
    round = std::move(common);
    before_test_ = std::move(before);
    after_test_ = std::move(after);
    out_.test_p_value = p_value;
    return true;
  }

  /// All names but those of the first steps that stand.
  void take_back(Round& round, const std::string& fault, std::size_t stand) {
    if (leave_the_common(round, fault, stand)) return;
    SearchResult& found = round.found;
    const std::vector<Candidate> steps(found.steps.begin(), found.steps.begin() + static_cast<std::ptrdiff_t>(stand));
    const std::string what_stands =
        stand > 0 ? "only " + steps.back().name() + " stands"
                  : "the name is withdrawn. The training records may not show what the test record does: train on one "
                    "like it as well";
    out_.warnings.push_back("the named " + found.chosen.name() + " " + fault + ": " + what_stands);
    const bool patched = round.left.seen;
    withdraw(round, not_confirmed);
    found.order.resize(stand);
    if (stand > 0) {
      found.steps = steps;
      found.chosen = steps.back();
      if (found.chosen.left_out.size() == 0) run_left_out(study_, found.chosen);
    }
    after_test_ = runs(study_, found.chosen, study_.test);
    if (stand > 0)
      out_.test_p_value = test_p_value(study_, before_test_, after_test_);
    else
      before_test_ = after_test_;
    round.train = runs(study_, found.chosen, study_.full);
    round.left = look_for_structure(study_, found.chosen, round.train, found.whitening);
    if (stand > 0) find_ties_of_the_rest(found);
    round.verdict = stand > 0                              ? (found.ties.rivals.empty() ? "explained" : "ambiguous")
                    : something_is_missing(round, patched) ? "unknown-effect"
                                                           : "nothing-missing";
  }

  /// No name stands: much of the motion is open, or generic forces see something (or did, beside the names that the
  /// test records took back) which these records do not deny.
  bool something_is_missing(const Round& round, bool patched = false) const {
    if (!round.found.reading.empty()) return false;
    const bool open =
        leaves_motion_open(study_, round.gap(round.train)) || leaves_motion_open(study_, round.gap(before_test_));
    return open || ((patched || round.left.material) && !gone_on_test(study_, round, before_test_));
  }

  /// What is left of a larger set has rivals of its own.
  void find_ties_of_the_rest(SearchResult& found) const {
    std::vector<const Candidate*> rivals;
    for (const Candidate& c : found.rivals) rivals.push_back(&c);
    found.ties = find_ties(study_, found.baseline, found.chosen, rivals);
    remark_ties(found);
  }

  static void remark_ties(SearchResult& found) {
    for (std::size_t i = 0; i < found.rivals.size(); ++i)
      if (holds_name(found.ties.rivals, found.rivals[i].name())) found.remarks[i] = tie_remark(found.chosen);
  }

  /// For all start points of all rounds, whichever stands.
  double corrected(double p) const { return lunid::corrected(p, tried_); }

  void name_steps(const SearchResult& found) {
    for (std::size_t i = 0; i < found.steps.size(); ++i) {
      const Candidate& model = found.steps[i];
      const Effect& effect = *found.order[i].effect;
      NamedEffect named;
      named.name = effect.name;
      named.family = effect.family;
      named.formula = formula_at(effect.formula, effect.place);
      named.sentence = effect.sentence;
      named.label = effect.label();
      if (effect.place) named.place = motion_of(*effect.place);
      named.where = where(i == 0 ? found.baseline : found.steps[i - 1], found.chosen, effect.place);
      named.parameters = own_parameters(found.chosen, effect);
      const bool last = i + 1 == found.steps.size();
      named.gap_train = last ? out_.final_train.value : pool_gap(runs(study_, model, study_.full, false), share_).value;
      named.gap_test = last ? out_.final_test.value : pool_gap(runs(study_, model, study_.test, false), share_).value;
      named.p_value = corrected(improvement_p_value(i == 0 ? found.baseline : found.steps[i - 1], model));
      if (last) {
        for (const Choices& tie : found.ties.rivals) named.indistinguishable.push_back(name_of(tie));
        named.indistinguishable.insert(named.indistinguishable.end(), found.ties.aliases.begin(),
                                       found.ties.aliases.end());
      }
      if (found.steps.size() > 1)
        for (const Choices& tie : found.ties.rivals)
          if (std::string other = in_place_of(effect, found.chosen.choices, tie); !other.empty())
            named.indistinguishable.push_back(std::move(other));
      for (std::string& other : in_other_words(effect))
        if (std::ranges::find(named.indistinguishable, other) == named.indistinguishable.end())
          named.indistinguishable.push_back(std::move(other));
      out_.effects.push_back(std::move(named));
    }
  }

  /// Entries of which this one is a special case with as many parameters: one force in two notations, on any record.
  std::vector<std::string> in_other_words(const Effect& effect) const {
    std::vector<std::string> out;
    for (const Effect& general : catalogue_) {
      const bool is_general = std::ranges::find(effect.special_case_of, general.name) != effect.special_case_of.end();
      if (is_general && general.parameters.size() == effect.parameters.size())
        out.push_back(effect.place ? general.name + " " + words_of(*effect.place) : general.name);
    }
    return out;
  }

  /// What a tied set has where the chosen one has this effect: "constant_force" for "displacement_offset" of
  /// "displacement_offset + coulomb_friction" and "constant_force + coulomb_friction"; else "".
  static std::string in_place_of(const Effect& effect, const Choices& chosen, const Choices& tie) {
    Choices own = chosen, others = tie;
    std::erase_if(own, [&](const Choice& c) { return std::erase(others, c) > 0; });
    return own.size() == 1 && others.size() == 1 && own.front().effect == &effect ? name_of(others) : "";
  }

  /// The entry's parameters from the final model, under their own short names.
  static std::vector<Parameter> own_parameters(const Candidate& final_model, const Effect& effect) {
    std::vector<Parameter> out;
    const Model model = fitted(final_model);
    for (const auto& p : effect.parameters) {
      out.push_back(*model.find(p.name));
      out.back().name = own_name(effect, p.name);
    }
    return out;
  }

  // ---- show ----
  std::string where(const Candidate& model, const Candidate& reference, const std::optional<Place>& place) const {
    const std::string text = describe_residual(study_, model, reference, place);
    return place ? words_of(*place) + ": " + sizes_at(text, *place) : text;
  }

  /// With several coordinates: where the first effect was named, or generic forces see most.
  std::optional<Place> main_place(const Round& round) const {
    if (round.names()) return round.found.order.front().effect->place;
    if (study_.degrees() == 1) return {};
    return round.left.closure.place.value_or(Place{});
  }

  void show(const Round& round) {
    const SearchResult& found = round.found;
    out_.verdict = round.verdict;
    out_.gap_left_out_before = found.baseline.left_out_gap;
    out_.gap_left_out_after = found.chosen.left_out_gap;
    out_.gap_fit = rms_error(found.chosen.fit) / study_.measured_std();
    out_.baseline = fitted(found.baseline);
    out_.final = fitted(found.chosen);
    const std::optional<Place> place = main_place(round);
    out_.where = where(found.baseline, found.chosen, place) + sensor_hint(study_, found.baseline);
    for (std::size_t i = 0; i < found.rivals.size(); ++i) {
      const Candidate& c = found.rivals[i];
      out_.rivals.push_back({c.name(), rms_error(c.fit) / study_.measured_std(), c.log_likelihood,
                             corrected(improvement_p_value(found.baseline, c)), found.remarks[i], fitted(c)});
    }
    if (!found.grown.left_aside.empty()) {
      std::string list;
      for (const auto& name : found.grown.left_aside) list += (list.empty() ? "" : ", ") + name;
      out_.warnings.push_back("not tried, since this record cannot show them beside the baseline's own terms: " + list);
    }
    if (!untested_.empty()) out_.warnings.push_back(untested_);
    warn_of_bounds(found.chosen, out_);
    out_.removable = removable_terms(out_.baseline, found.chosen);
    if (!found.chosen.choices.empty()) {
      progress("name again on resampled blocks", 0.96);
      out_.naming = bootstrap_naming(study_, found);
    }
    if (out_.verdict == "ambiguous") progress("design the experiment that would decide", 0.97);
    design_next(study_, found, out_);
    check_by_sundials(study_, found.chosen, out_);
    list_records(study_.full, "train");
    list_records(study_.test, "test");
    compare_all(found, study_.full, before_train_, after_train_, "train");
    compare_all(found, study_.test, before_test_, after_test_, "test");
    out_.map = residual_map(study_, found.baseline, found.chosen, place);
    if (place) out_.map_place = motion_of(*place);
    for (const Choice& choice : found.order)
      if (choice.effect->place) out_.forces.push_back(force_of_effect(study_, found.chosen, *choice.effect, 0));
    out_.output = study_.output();
    out_.run_length = study_.run_length;
    out_.interpolation = study_.imposed ? "none: the motion is imposed" : to_string(study_.interpolation);
    out_.solver =
        study_.imposed ? "none: the motion is imposed" : fixed_solver_name(found.chosen.fit.substeps) + " per sample";
    out_.noise_model = found.whitening.ar.empty()
                           ? "white residual"
                           : "autoregressive residual of order " + std::to_string(found.whitening.ar.size()) +
                                 " on means of " + std::to_string(found.whitening.average) + " rows";
    out_.sentence = sentence(study_, round, out_);
  }

  /// Short runs of one record follow each other.
  void list_records(const std::vector<Record>& records, const std::string& role) {
    const std::size_t first = out_.records.size();
    double begin = 0;
    for (const Record& r : records) {
      const bool same = study_.run_length > 0 && out_.records.size() > first &&
                        out_.records.back().record == r.name() && r.start() > begin;
      if (!same) {
        begin = r.start();
        out_.records.push_back({r.name(), role, 0, 0, 1 / r.dt(), 0});
      }
      RecordUsed& used = out_.records.back();
      used.rows += r.rows();
      used.seconds = r.start() + r.duration() - begin;
      ++used.runs;
    }
  }

  void compare_all(const SearchResult& found, const std::vector<Record>& records, std::span<const FreeRun> before,
                   std::span<const FreeRun> after, const std::string& role) {
    const std::size_t outputs = study_.outputs().size();
    // Of short runs a few: there are dozens.
    const std::size_t step = study_.run_length > 0 ? (records.size() + 2) / 3 : 1;
    for (std::size_t i = 0; i < records.size(); i += step)
      for (Comparison& c : compare(study_, found.baseline, found.chosen, records[i],
                                   before.subspan(i * outputs, outputs), after.subspan(i * outputs, outputs), role))
        out_.comparisons.push_back(std::move(c));
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
  std::vector<FreeRun> before_train_, after_train_, before_test_, after_test_;  ///< of baseline and final model
  int tried_ = 0;     ///< start points of entries, of all rounds
  double share_ = 0;  ///< of the force channel's noise, that the system did not feel
  Discovery out_;
};

}  // namespace

void validate(const DiscoverOptions& o) {
  auto refuse = [](const std::string& field, const std::string& range, double got) {
    throw InputError("discover: " + field + ": expected " + range + ", got " + std::to_string(got), {}, Fault::usage);
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
      throw InputError("discover: a baseline driven by " + input +
                       " is not looked at: use relative displacements and F = -m*ab");
}

Discovery discover(const Model& baseline, const std::vector<Effect>& catalogue, const std::vector<Record>& train,
                   const std::vector<Record>& test, const DiscoverOptions& options) {
  validate(options);
  check_baseline(baseline);
  const auto begin = std::chrono::steady_clock::now();
  Discovery out = Spine(baseline, catalogue, train, test, options).run();
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace lunid
