#include "discover/discover.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "discover/accept.hpp"
#include "discover/baseline.hpp"
#include "discover/conclusion.hpp"
#include "discover/frame.hpp"
#include "discover/gap.hpp"
#include "discover/ground.hpp"
#include "discover/naming.hpp"
#include "discover/on_test.hpp"
#include "discover/proposal_fits.hpp"
#include "discover/remarks.hpp"
#include "discover/search.hpp"
#include "discover/sensor.hpp"
#include "discover/verdict.hpp"
#include "expr/digits.hpp"
#include "expr/joined.hpp"
#include "record/parallel.hpp"

namespace lunid {

namespace {

constexpr int most_coordinates = 5;  ///< their motion, velocity and acceleration all drive internal states

class Spine {
 public:
  Spine(const Model& baseline, const std::vector<Effect>& catalogue, const std::vector<Record>& train,
        const std::vector<Record>& test, const DiscoverOptions& options)
      : options_(options), given_(catalogue), model_(complete(baseline)) {
    progress("check the data", 0.0);
    ground_.whole = prepare(model_, train, test, options_);
    ground_.whole.test_is_known = warn_of_known_rows(train, test, ground_.whole.warnings);
    study_ = shortened(ground_.whole, ground_.searched);
    out_.warnings = study_.warnings;
    for (const auto& data : ground_.whole.train)
      for (const auto& w : data.record.warnings()) out_.warnings.push_back(w);
    out_.baseline_before = model_.parameters;
  }

  /// Of the records, as far as they are known before anything is fitted.
  const std::vector<std::string>& notes() const { return out_.warnings; }
  const Study& whole() const { return ground_.whole; }

  Discovery run() {
    progress("refit the baseline", 0.05);
    Round round = begin();
    if (nothing_follows(round) || may_be_one_that_is_lost(round)) look_in_short_runs(round);
    fit_all(round);
    if (leaves_anything(round) && !is_noise_of_forces(round) && ground_.take_more_rows(most_on_more_rows(round)))
      look_at_more_rows(round);
    doubt_names(round);
    progress("open the test record", 0.94);
    const ModelRuns runs = judge_on_test(ground_, round, out_);
    conclude(
        study_, catalogue_, round, runs, tried_,
        [this](const std::string& stage, double fraction) { progress(stage, fraction); }, out_);
    say_what_was_left_aside(round.found);
    progress("done", 1.0);
    return std::move(out_);
  }

 private:
  /// The baseline, and what is found beside it; of the rows as they were recorded where those that were joined mislead.
  Round begin() {
    std::vector<std::string> notes = out_.warnings;
    baseline_ = fit_baseline(study_, model_, notes, given_);
    if (const auto between = joined_rows_mislead(ground_, baseline_)) return begin_as_recorded(*between);
    choose_catalogue();
    if (lower_noise(ground_.whole, baseline_) || learn_motion_noise(ground_.whole, baseline_)) ground_.take_noise();
    Round round = look_at_common();
    if (const auto between = joined_rows_mislead(ground_, round.found.chosen)) return begin_as_recorded(*between);
    if (look_at_others(round))
      if (const auto between = joined_rows_mislead(ground_, round.found.chosen)) return begin_as_recorded(*between);
    out_.warnings = std::move(notes);
    return round;
  }

  Round begin_as_recorded(Interpolation between) {
    progress("take the rows as they were recorded", done_);
    ground_.take_rows_as_recorded(between);
    grown_.clear();
    return begin();
  }

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
  Round look_at_all(bool quiet = false) {
    Round round = look_at_common(quiet);
    look_at_others(round);
    return round;
  }

  Round look_at_common(bool quiet = false) {
    Grown known;
    known.quiet = quiet;
    return look(first_, known, first_ < catalogue_.size() ? 0.4 : 0.9);
  }

  /// What is left above the sensors' noise may be noise of another colour.
  static bool is_quiet(const Round& round) { return round.verdict == Verdict::nothing_missing && !round.left.seen; }

  /// Whether it did.
  bool look_at_others(Round& round) {
    const bool open = first_ < catalogue_.size() && leaves_open(round);
    if (open)
      look_further(round, "the whole catalogue", catalogue_.size());
    else if (without_states_ > first_ && round.names())
      look_further(round, "the rivals without memory", without_states_);
    else
      return false;
    return true;
  }

  // ---- long records ----
  void fit_all(Round& round) {
    if (study_.in_pieces) progress("fit all rows", 0.92);
    fit_all_rows(ground_, round);
  }

  /// What a search of few rows has led down to the noise of all is not searched for on more.
  bool leaves_anything(const Round& round) const {
    return round.verdict == Verdict::unknown_effect || round.left.seen || !near_the_floor(round.left.gap);
  }

  /// What the noise of the forces makes of the runs of what was found is not searched for on more rows either.
  bool is_noise_of_forces(const Round& round) const {
    constexpr double most = 3;  // times the floor of the sensors: an excitation that is rough may be taken for noise
    return round.verdict != Verdict::unknown_effect && !round.left.seen && near_the_floor(round.gap(round.train)) &&
           round.left.gap.value < most * round.left.gap.floor;
  }

  /// Three effects that few rows did not begin to show are not found on more of them, only sought for minutes.
  static int most_on_more_rows(const Round& round) {
    const std::vector<Candidate>& sets = round.found.grown.sets;
    return std::max<int>(2, sets.empty() ? 0 : static_cast<int>(sets.front().choices.size()));
  }

  void look_at_more_rows(Round& round) {
    progress("search more rows", done_);
    grown_.clear();
    ground_.read_force({study_.guesses.front()});
    std::vector<std::string> unsaid;
    baseline_ = fit_baseline(study_, model_, unsaid, given_);
    round = look_at_all(is_quiet(round));
    fit_all(round);
  }

  // ---- motions that forget where they came from ----
  /// Noise alone keeps the run from the measured motion. Of names, the fit too, which knows all rows and may follow
  /// such a motion. Also that no set which was fitted comes near; where nothing was named, that the best one is lost.
  bool nothing_follows(const Round& round) const {
    const Gap& gap = round.left.gap;
    if (study_.imposed || std::max(gap.value, round.names() ? gap.floor : 0) < lost_gap) return false;
    const double near = std::max(0.1 * study_.measured_std(), 2 * study_.sensor_noise());
    const auto follows = [&](const Candidate& c) { return rms_error(c.fit) < near; };
    const std::vector<Candidate>& sets = round.found.grown.sets;
    const bool none_follows = std::ranges::none_of(sets, follows);
    if (round.names()) return none_follows || (noise_leads_astray(study_, gap) && stays_above_noise(round));
    return none_follows || lost_to_noise(study_, gap) || is_lost(study_, sets.front());
  }

  bool stays_above_noise(const Round& round) const {
    return rms_error(round.found.chosen.fit) > 2 * study_.sensor_noise();
  }

  /// What was found stays above the noise, and of the best single effects one is lost: a force that jumps, say, where a
  /// smooth one beside it comes nearer.
  bool may_be_one_that_is_lost(const Round& round) const {
    int asked = 3;
    if (study_.imposed || !stays_above_noise(round)) return false;
    return std::ranges::any_of(round.found.grown.sets, [&](const Candidate& c) {
      return c.choices.size() == 1 && asked-- > 0 && is_lost(study_, c);
    });
  }

  /// A wrong model and a motion that no run can hold look alike over a long record. Over short ones a right model
  /// reaches the noise; and the long runs of that model are lost to noise alone.
  void look_in_short_runs(Round& round) {
    Ground before = ground_;
    grown_.clear();
    ground_.whole = study_ = in_short_runs(before.whole);
    const std::string length = number(study_.run_length, 3) + " s";
    progress("runs of " + length, done_);
    std::vector<std::string> unsaid;
    baseline_ = fit_baseline(study_, model_, unsaid, given_);
    Round shorter = look_at_all();
    const bool reached = rms_error(shorter.found.chosen.fit) < 1.5 * study_.sensor_noise();
    if (shorter.verdict != Verdict::unknown_effect && reached && is_lost(before.study, shorter.found.chosen)) {
      round = std::move(shorter);
      out_.warnings.push_back(
          "runs over whole records are lost to noise, whatever the model: all runs, fits and gaps are of " + length +
          ", each from a first state of its own");
      return;
    }
    ground_ = std::move(before);
    grown_.clear();
    if (reached) look_from(shorter.found.grown.sets, round);
  }

  /// What short runs have led to the noise may follow the whole records too, from there: a strong spring beside a fault
  /// of its sensor has more minima over many periods than over two.
  void look_from(const std::vector<Candidate>& found, Round& round) {
    constexpr std::size_t most = 8;
    constexpr double near = 2;  // times the least squared error
    std::vector<Candidate> sets;
    for (const Candidate& c : found)
      if (sets.size() < most && c.fit.cost < near * found.front().fit.cost) sets.push_back(c);
    parallel_for(static_cast<int>(sets.size()), options_.threads, [&](int i) {
      Candidate& c = sets[static_cast<std::size_t>(i)];
      c.fit = fit_progressively(*c.system, c.fit.theta, study_.train, fixed_fit(study_, 40, 1e-4, c.fit.substeps));
      c.minimum_left = false;
    });
    std::erase_if(sets,
                  [&](const Candidate& c) { return !c.ran() || !(rms_error(c.fit) < 2 * study_.sensor_noise()); });
    if (sets.empty()) return;
    Grown known = round.found.grown;
    for (Candidate& c : sets) {
      std::erase_if(known.sets, [&](const Candidate& other) { return same(other.choices, c.choices); });
      known.sets.push_back(std::move(c));
    }
    progress("the whole records", done_);
    if (Round whole = look(catalogue_.size(), known, 0.9); whole.names()) round = std::move(whole);
  }

  /// Noise alone takes the run a tenth of the motion and more away, far more than the sensor shows.
  static bool noise_leads_astray(const Study& study, const Gap& gap) {
    constexpr double part = 0.1, times = 3;
    return gap.floor > std::max(part, times * study.noise_gap()) && gap.value < runaway_gap;
  }

  /// And that is most of the gap.
  static bool lost_to_noise(const Study& study, const Gap& gap) {
    return noise_leads_astray(study, gap) && gap.value < 2 * gap.floor;
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
    const auto search_part = [&](const Grown& grown, bool ask_reading) {
      round.found = search(study_, model_, baseline_, part, grown, ask_reading, step);
      remember(round.found.grown);
    };
    const auto search_again = [&] {
      fit(study_, baseline_, full_fit(study_, 40));
      search_part(grown_so_far(), false);
    };
    search_part(known, true);
    if (const std::optional<BetweenSamples> reading = round.found.grown.reading) {
      ground_.read_force(*reading);
      search_again();
    }
    const BetweenSamples before = study_.between;
    const std::optional<double> left = reads_otherwise(ground_, round.found);
    constexpr double near = 2, most = 0.5;  // times the sensor's noise; of what is left before
    const double least = std::max(near * study_.sensor_noise(), most * rms_error(round.found.chosen.fit));
    if (left && entries < catalogue_.size() && *left > least) {
      ground_.read_force(before);  // no reading explains it: asked again beside all entries
    } else if (left) {
      search_again();
    } else if (study_.between != before) {
      judge_again(study_, round.found);
    }
    if (lower_noise(ground_.whole, round.found.chosen)) {
      ground_.take_noise();
      judge_again(study_, round.found);
    }
    tried_ = std::max(tried_, round.found.grown.tried);
    progress("decide", until);
    round.between = study_.between;
    decide(study_, round);
    return round;
  }

  /// Sets that were fitted while the force was read as now between its samples.
  Grown grown_so_far() const {
    const auto at = std::ranges::find(grown_, study_.between, &std::pair<BetweenSamples, Grown>::first);
    return at != grown_.end() ? at->second : Grown{};
  }

  void remember(const Grown& grown) {
    std::erase_if(grown_, [&](const auto& known) { return known.first == study_.between; });
    grown_.emplace_back(study_.between, grown);
    grown_.back().second.reading.reset();
  }

  /// What the first entries leave open is held against all, what they name against the faults of sensors and of the
  /// input, and against all that runs fast, without which no physics is named. Names that were found stand unless
  /// others take their place.
  void look_further(Round& round, const std::string& stage, std::size_t entries) {
    progress(stage, done_);
    const BetweenSamples before = study_.between;
    const Candidate baseline = baseline_;
    if (before != BetweenSamples{study_.guesses.front()}) {  // chosen beside a model that was not the right one
      ground_.read_force({study_.guesses.front()});
      fit(study_, baseline_, full_fit(study_, 40));
      round.found.grown = grown_so_far();
    }
    constexpr double near = 1.5;  // times the sensor's noise, which colour hides
    const Candidate& chosen = round.found.chosen;
    if (chosen.choices.size() > 1 && !round.left.seen && rms_error(chosen.fit) < near * study_.sensor_noise())
      round.found.grown.settled = chosen.choices;
    round.found.grown.quiet = is_quiet(round);
    Round further = look(entries, round.found.grown, 0.9);
    if (std::optional<Round> other = what_takes_the_place(further, round)) {
      if (round.names()) other->displaced = std::make_shared<Round>(std::move(round));
      round = *std::move(other);
    } else {
      if (round.names() && further.names()) round.displaced = std::make_shared<Round>(std::move(further));
      ground_.read_force(before);
      baseline_ = baseline;
    }
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

  /// What the first entries say may stand in for another entry: where the free run stays above its floor, where generic
  /// forces see more, where it takes several of them, and where others are simpler forms of what was named.
  bool leaves_open(const Round& round) const {
    const Closure& generic = round.left.closure;
    const bool hints = generic.p_value < options_.alpha / 10 && generic.gain > options_.minimum_gain;
    return leaves_anything(round) || hints || round.found.chosen.choices.size() > 1 ||
           has_simpler_form(round.found.chosen.choices);
  }

  static bool near_the_floor(const Gap& gap) { return gap.value < 1.2 * gap.floor; }

  bool has_simpler_form(const Choices& named) const {
    const auto others = std::span<const Effect>(catalogue_).subspan(first_);
    return std::any_of(others.begin(), others.end(), [&](const Effect& e) {
      return std::any_of(named.begin(), named.end(), [&](const Choice& c) { return e.is_special_case(*c.effect); });
    });
  }

  /// All that was found, or the first of several names where these alone do what the common ones do.
  std::optional<Round> what_takes_the_place(const Round& further, const Round& round) const {
    if (takes_the_place(further, round)) return further;
    for (std::size_t count = further.found.steps.size(); count-- > 1;) {
      const Candidate& model = further.found.steps[count - 1].model;
      if (same(model.choices, round.found.chosen.choices) || !may_be_named(study_, model)) continue;
      Round first = first_names(study_, further, count, "fits better, by less than more effects have to");
      if (takes_the_place(first, round)) return first;
    }
    return {};
  }

  /// Rare effects take the place of common ones where they are no more than those and fit as well, where they are fewer
  /// and fit better, or, as of a baseline that lacks nothing, where they close what is left: most of it where they are
  /// no more effects, a third where they are a more general form of the same. A record with disturbances of its own (a
  /// loop that is closed, a foundation that moves) would otherwise be followed by ever more of them.
  bool takes_the_place(const Round& further, const Round& round) const {
    if (round.verdict == Verdict::unknown_effect) return true;
    if (!further.names()) return false;
    const Candidate &rare = further.found.chosen, &common = round.found.chosen;
    constexpr double as_well = 1.02;
    const bool fits_as_well =
        rms_error(rare.fit) <= as_well * rms_error(common.fit) || rare.left_out_gap <= as_well * common.left_out_gap;
    if (round.names() && rare.free_parameters() <= common.free_parameters() && fits_as_well) return true;
    const bool simpler = rare.free_parameters() < common.free_parameters(),
               fewer = rare.choices.size() < common.choices.size();
    if (round.names() && (simpler || fewer)) {
      Candidate as_heard = common;  // under the force between samples and the colour of the noise of the other search
      judge(study_, as_heard, further.found.whitening);
      if (simpler && !fits_worse(study_, rare, as_heard)) return true;
      if (fewer && fits_worse(study_, as_heard, rare)) return true;
    }
    const bool grown = is_general_form(rare.choices, common.choices);
    const double floor = std::max(study_.noise_gap(), further.left.gap.floor);
    const double least = grown ? 0.33 : rare.choices.size() <= common.choices.size() ? 0.8 : 0.95;
    return closed_share(common.left_out_gap, rare.left_out_gap, floor) > least;
  }

  void say_what_was_left_aside(const SearchResult& found) {
    if (!found.grown.left_aside.empty())
      out_.warnings.push_back("not tried, since this record cannot show them beside the baseline's own terms: " +
                              joined(found.grown.left_aside));
    if (!untested_.empty()) out_.warnings.push_back(untested_);
    constexpr std::size_t shown = 5;
    const std::span<const std::string> refused = found.refused;
    if (refused.empty()) return;
    const std::size_t more = refused.size() - std::min(shown, refused.size());
    out_.warnings.push_back("refused by the criterion: " + joined(refused.first(refused.size() - more)) +
                            (more > 0 ? " and " + std::to_string(more) + " more" : ""));
  }

  const DiscoverOptions& options_;
  const std::vector<Effect>& given_;
  std::vector<Effect> catalogue_;   ///< of the given, what these records can show
  std::size_t first_ = 0;           ///< so many of them are tried first
  std::size_t without_states_ = 0;  ///< the same, and those without internal states that come behind them
  std::string untested_;
  Model model_;
  Ground ground_;
  Study& study_ = ground_.study;
  Candidate& baseline_ = ground_.baseline;
  std::vector<std::pair<BetweenSamples, Grown>> grown_;  ///< of each reading of the force, over the present rows
  double done_ = 0;                                      ///< part of the work
  int tried_ = 0;                                        ///< start points of entries, of all rounds
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

Outset before_discovery(const Model& baseline, const std::vector<Record>& train, const std::vector<Record>& test,
                        const DiscoverOptions& options) {
  validate(options);
  const Frame frame(baseline);
  check_baseline(frame.model());
  const std::vector<Record> seen_train = frame.seen(train), seen_test = frame.seen(test);  // what both lack is of train
  const Spine spine(frame.model(), {}, seen_train, seen_test, options);
  Outset out{words_of_baseline(baseline, frame.moves(), train, test), spine.notes()};
  if (frame.moves()) out.notes.insert(out.notes.begin(), frame.note());
  std::ranges::move(remarks(spine.whole(), train, test), std::back_inserter(out.notes));
  return out;
}

Discovery discover(const Model& baseline, const std::vector<Effect>& catalogue, const std::vector<Record>& train,
                   const std::vector<Record>& test, const DiscoverOptions& options) {
  validate(options);
  const Frame frame(baseline);
  check_baseline(frame.model());
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Effect> entries = frame.seen(catalogue);
  const std::vector<Record> seen_train = frame.seen(train), seen_test = frame.seen(test);
  DiscoverOptions seen = options;
  if (options.criterion)
    seen.criterion = [&](FittedSet set) {
      set.model = frame.as_given(set.model);
      return options.criterion(set);
    };
  Discovery out = frame.as_given(Spine(frame.model(), entries, seen_train, seen_test, seen).run());
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace lunid
