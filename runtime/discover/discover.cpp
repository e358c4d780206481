#include "discover/discover.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "discover/closure.hpp"
#include "discover/gap.hpp"
#include "discover/locate.hpp"
#include "discover/naming.hpp"
#include "discover/removable.hpp"
#include "discover/search.hpp"
#include "discover/sensor.hpp"
#include "record/parallel.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

/// Drop of the squared error at which a force that is read otherwise between its samples is worth a new search.
constexpr double interpolation_gain = 0.02;

class Spine {
 public:
  Spine(const Model& baseline, const std::vector<Effect>& catalogue, const std::vector<Record>& train,
        const std::vector<Record>& test, const DiscoverOptions& options)
      : options_(options), model_(complete(baseline)) {
    progress("check the data", 0.0);
    whole_ = prepare(model_, train, test, options_);
    study_ = shortened(whole_);
    out_.warnings = study_.warnings;
    for (const auto& data : study_.train)
      for (const auto& w : data.record.warnings()) out_.warnings.push_back(w);
    out_.baseline_before = model_.parameters;
    std::vector<std::string> left;
    const auto many =
        options_.first > 0 ? std::min<std::ptrdiff_t>(options_.first, std::ssize(catalogue)) : std::ssize(catalogue);
    catalogue_ = testable(study_, {catalogue.begin(), catalogue.begin() + many}, left);
    first_ = catalogue_.size();
    for (Effect& effect : testable(study_, {catalogue.begin() + many, catalogue.end()}, left))
      catalogue_.push_back(std::move(effect));
    for (std::size_t i = 0; i < left.size(); ++i) (i == 0 ? untested_ = "not tried: " : untested_ += ", ") += left[i];
  }

  Discovery run() {
    refit_baseline();
    Round round = look(first_, {});
    if (first_ < catalogue_.size() && leaves_open(round)) look_further(round);
    fit_all_rows(round);
    progress("open the test record", 0.94);
    validate_on_test(round);
    show(round);
    progress("done", 1.0);
    return std::move(out_);
  }

 private:
  /// What generic forces of the motion would explain beside a model, and whether that counts.
  struct Left {
    Gap gap;  ///< of the model itself over the training records
    Closure closure;
    bool seen = false;      ///< it is there beyond chance, and free runs over the training records get better by it
    bool material = false;  ///< and it is more than what is asked of an effect
    bool whole = false;     ///< and these forces explain it down to the noise
  };

  /// A search and what was decided on it, the test records closed.
  struct Round {
    SearchResult found;
    Left left;
    std::vector<FreeRun> train;  ///< of the chosen model over the training records
    std::string verdict, withdrawn;
    bool names() const { return !found.chosen.choices.empty(); }
  };

  /// Searches the first entries of the catalogue. What is found may show how the force is to be read between its
  /// samples; where that matters the search is made again.
  Round look(std::size_t entries, const Grown& known) {
    const std::span<const Effect> part(catalogue_.data(), entries);
    Round round;
    round.found = search(study_, model_, baseline_, part, known, step());
    const Interpolation before = study_.interpolation;
    const double gain = rechoose_interpolation(round.found.chosen);
    if (gain > interpolation_gain) {
      fit(study_, baseline_, fit_options(40));
      round.found = search(study_, model_, baseline_, part, {}, step());
    } else if (study_.interpolation != before) {
      refit_on_current_force(round.found);
    }
    progress("decide", 0.88);
    decide(round);
    return round;
  }

  /// What the first entries leave open is held against all. Names that were found stand unless others take their place.
  void look_further(Round& round) {
    progress("the whole catalogue", 0.1);
    const Interpolation before = study_.interpolation;
    const Candidate baseline = baseline_;
    if (before != study_.guesses.front()) {  // chosen beside a model that was not the right one
      take_interpolation(study_.guesses.front());
      fit(study_, baseline_, fit_options(40));
      round.found.grown.sets.clear();
    }
    Round further = look(catalogue_.size(), round.found.grown);
    if (takes_the_place(further, round)) {
      round = std::move(further);
    } else {
      take_interpolation(before);
      baseline_ = baseline;
    }
  }

  /// What was found on pieces of long records is fitted to all their rows. The names stay.
  void fit_all_rows(Round& round) {
    if (study_.train.size() == whole_.train.size()) return;
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
    decide(round);
  }

  void progress(const std::string& stage, double fraction) const {
    if (options_.cancelled && *options_.cancelled)
      throw InputError("interrupted while: " + stage, {}, Fault::interrupted);
    if (options_.progress) options_.progress(stage, fraction);
  }
  std::function<void(const std::string&, double)> step() const {
    return [this](const std::string& stage, double fraction) { progress(stage, fraction); };
  }

  FitOptions fit_options(int iterations) const {
    FitOptions o;
    o.max_iterations = iterations;
    o.tolerance = 1e-6;
    o.cancelled = options_.cancelled;
    return o;
  }

  // ---- baseline ----
  void refit_baseline() {
    progress("refit the baseline", 0.05);
    baseline_ = compile(study_, model_, {});
    find_starts(study_, baseline_, Eigen::VectorXd(), {});
    if (baseline_.starts.empty())
      throw InputError(
          "discover: the baseline's force is not finite along the measured motion; check its terms and first guesses");
    check_excitation();
    fit(study_, baseline_, fit_options(40));
    from_given_guess();
    say_first(baseline_);
  }

  /// A baseline that cannot be run, or whose parameters sit at bounds, is said before anything else.
  void say_first(const Candidate& c) {
    std::vector<std::string> said;
    if (!c.ran()) said.push_back("the baseline cannot be simulated over the training records (" + c.fit.stopped + ")");
    const auto& table = c.system->model().parameters;
    for (std::size_t i = 0; i < table.size(); ++i)
      if (i < c.fit.at_bound.size() && c.fit.at_bound[i] && !table[i].fixed) {
        char value[32];
        std::snprintf(value, sizeof value, "%.4g", c.fit.theta[static_cast<Eigen::Index>(i)]);
        said.push_back("the baseline's " + table[i].name + " sits at its bound " + value +
                       ": widen it, or see what the baseline's other terms leave to it");
      }
    out_.warnings.insert(out_.warnings.begin(), said.begin(), said.end());
  }

  void from_given_guess() {
    const std::vector<double> values = model_.values();
    if (values.empty() || !std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) return;
    const Eigen::VectorXd guess =
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    FitResult again = fit_trajectory(*baseline_.system, guess, study_.train, fit_options(40));
    if (again.cost < baseline_.fit.cost) baseline_.fit = std::move(again);
  }

  /// The names stay; what was fitted is fitted again with the force between its samples as it is now.
  void refit_on_current_force(SearchResult& found) const {
    for (Candidate* c : {&found.baseline, &found.chosen}) {
      judge(study_, *c, found.whitening);
      run_left_out(study_, *c);
    }
    for (auto& c : found.steps) judge(study_, c, found.whitening);
  }

  /// Parameters that this record does not excite, and columns that are one on it, are said before anything is fitted.
  void check_excitation() {
    const auto& table = baseline_.system->model().parameters;
    const Eigen::Index p = baseline_.parameters();
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(p, p);
    double force = 0;
    for (const auto& data : study_.force) {
      Eigen::MatrixXd jacobian;
      const Eigen::VectorXd& theta = baseline_.starts.front();
      imposed_force(*baseline_.force_system, {theta.data(), static_cast<std::size_t>(p)}, data.record, &jacobian);
      gram += jacobian.transpose() * jacobian;
      for (const double f : data.record["F"]) force += f * f;
    }
    bool mass_free = false;
    for (Eigen::Index j = 0; j < p; ++j) {
      const auto& name = table[static_cast<std::size_t>(j)].name;
      mass_free = mass_free || depends_on(model_.mass, model_.pool->parameter(name));
      if (table[static_cast<std::size_t>(j)].fixed) continue;
      if (!(gram(j, j) > 0))
        throw InputError("discover: the data do not excite parameter '" + name +
                             "': its term is zero on every row of the training records; fix it, leave it out, or use a "
                             "record that reaches it",
                         {}, Fault::data);
    }
    if (mass_free && !(force > 0))
      throw InputError("discover: with F = 0 throughout only ratios to the mass can be seen; give --mass as a number",
                       {}, Fault::data);
    for (Eigen::Index j = 0; j < p; ++j) warn_of_collinear(gram, j, table);
  }

  void warn_of_collinear(const Eigen::MatrixXd& gram, Eigen::Index j, const std::vector<Parameter>& table) {
    for (Eigen::Index i = 0; i < j; ++i) {
      const double cosine = gram(i, j) / std::sqrt(gram(i, i) * gram(j, j));
      const double left = 1 - cosine * cosine;
      const auto &a = table[static_cast<std::size_t>(i)].name, &b = table[static_cast<std::size_t>(j)].name;
      if (left < 1e-12)
        throw InputError(
            "discover: the data do not excite parameters '" + a + "' and '" + b +
                "' separately: their terms are one column on this record; fix one of them, or use a record "
                "with another frequency or amplitude",
            {}, Fault::data);
      if (left < 2e-3)
        out_.warnings.push_back(
            "the terms of " + a + " and " + b +
            " are nearly one column on this record (a single frequency?): only their combination is well seen");
    }
  }

  // ---- force between its samples ----
  void take_interpolation(Interpolation kind) {
    set_interpolation(whole_, kind);
    study_ = shortened(whole_);
  }

  bool force_varies() const {
    for (const auto& data : study_.train)
      if (standard_deviation(data.record["F"]) > 0) return true;
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
      FitOptions options = fit_options(6);
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

  // ---- verdict ----
  /// `train`: the model's runs over the training records.
  Left look_for_structure(const Candidate& c, const std::vector<FreeRun>& train, const Whitening& whitening) const {
    Left left;
    left.gap = pool_gap(train, 0);
    left.closure = test_closure(study_, c, whitening);
    if (!(left.closure.p_value < options_.alpha / 10)) return left;
    fit_closure(study_, c, left.closure);
    if (!std::isfinite(left.closure.fit.cost)) return left;
    const Gap& now = left.gap;
    const auto with_closure = [&](bool floor) {
      return pool_gap(runs(*left.closure.system, left.closure.fit, study_.full, floor), 0);
    };
    const Gap with = with_closure(false);
    left.seen = !std::isfinite(now.value) || closed_share(now.value, with.value, now.floor) > 0.5;
    // A model that is at the floor lacks nothing that could be seen, whatever a finer colour of the noise would say.
    const bool above = !(now.value <= now.floor + 3 * now.floor_std);
    left.material = left.seen && above && left.closure.gain > options_.minimum_gain;
    left.whole = left.material && with.value < 1.5 * with_closure(true).floor;
    return left;
  }

  /// "Nothing missing" cannot be said of a model that leaves a good part of the motion open, whatever the search found.
  static bool far_from_the_floor(const Gap& gap) { return !(gap.value < std::max(3 * gap.floor, 0.15)); }

  void decide(Round& round) const {
    SearchResult& found = round.found;
    round.train = runs(found.chosen, study_.full);
    round.left = look_for_structure(found.chosen, round.train, found.whitening);
    if (!round.names()) {
      round.verdict = round.left.material || far_from_the_floor(round.left.gap) ? "unknown-effect" : "nothing-missing";
    } else if (round.left.material && std::isfinite(found.baseline.left_out_gap) &&
               closed_share(found.baseline.left_out_gap, found.chosen.left_out_gap, study_.noise_gap()) < 0.95) {
      withdraw(round, "nearest, but leaves a repeatable force: " + round.left.closure.shape);
      round.train = runs(found.chosen, study_.full);
      round.verdict = "unknown-effect";
    } else {
      round.verdict = found.ties.empty() ? "explained" : "ambiguous";
    }
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

  /// Rare effects take the place of common ones where they are no more than those and fit as well, or, as of a baseline
  /// that lacks nothing, where they close what is left. A record with disturbances of its own (a loop that is closed, a
  /// foundation that moves) would otherwise be followed by ever more of them.
  bool takes_the_place(const Round& further, const Round& round) const {
    if (round.verdict == "unknown-effect") return true;
    if (!further.names()) return false;
    const Candidate &rare = further.found.chosen, &common = round.found.chosen;
    constexpr double as_well = 1.02;
    if (round.names() && rare.parameters() <= common.parameters() &&
        rms_error(rare.fit) <= as_well * rms_error(common.fit))
      return true;
    return closed_share(common.left_out_gap, rare.left_out_gap, study_.noise_gap()) > 0.95;
  }

  /// Takes the names back; the model is the baseline again.
  static void withdraw(Round& round, const std::string& remark) {
    SearchResult& found = round.found;
    round.withdrawn = found.chosen.name();
    found.rivals.insert(found.rivals.begin(), found.chosen);
    found.remarks.insert(found.remarks.begin(), remark);
    found.chosen = found.baseline;
    found.steps.clear();
    found.ties.clear();
    found.aliases.clear();
  }

  std::vector<FreeRun> runs(const System& system, const FitResult& fit, const std::vector<Record>& records,
                            bool floor = true) const {
    std::vector<FreeRun> out;
    for (const auto& r : records)
      out.push_back(free_run(study_, system, fit.theta, r, std::max(1, fit.substeps), floor));
    return out;
  }
  std::vector<FreeRun> runs(const Candidate& c, const std::vector<Record>& records, bool floor = true) const {
    return runs(*c.system, c.fit, records, floor);
  }

  /// Opens the test record once. It can only take a name back, never choose one.
  void validate_on_test(Round& round) {
    SearchResult& found = round.found;
    after_test_ = runs(found.chosen, study_.test);
    before_test_ = round.names() ? runs(found.baseline, study_.test, false) : after_test_;
    if (round.names()) {
      out_.test_p_value = test_p_value(before_test_, after_test_);
      const std::string fault = refuted(round, before_test_, after_test_);
      if (!fault.empty()) take_back(round, fault);
    } else if (round.verdict == "nothing-missing" && far_from_the_floor(pool_gap(before_test_, 0))) {
      round.verdict = "unknown-effect";
    }
    after_train_ = round.train;
    before_train_ = round.names() ? runs(found.baseline, study_.full, false) : after_train_;
    share_ = input_noise_share(after_train_);
    out_.baseline_train = pool_gap(before_train_, share_);
    out_.baseline_test = pool_gap(before_test_, share_);
    out_.final_train = pool_gap(after_train_, share_);
    out_.final_test = pool_gap(after_test_, share_);
    name_steps(found);
  }

  void take_back(Round& round, const std::string& fault) {
    SearchResult& found = round.found;
    out_.warnings.push_back("the named " + found.chosen.name() + " " + fault + ": the name is withdrawn");
    const bool patched = round.left.seen;
    withdraw(round, "not confirmed by the test record");
    before_test_ = after_test_ = runs(found.baseline, study_.test);
    round.train = runs(found.baseline, study_.full);
    round.left = look_for_structure(found.baseline, round.train, found.whitening);
    const bool open = patched || round.left.material || far_from_the_floor(pool_gap(before_test_, 0));
    round.verdict = open ? "unknown-effect" : "nothing-missing";
  }

  /// Why the test record takes the names back; empty when it does not.
  std::string refuted(const Round& round, const std::vector<FreeRun>& before, const std::vector<FreeRun>& after) const {
    const Left& left = round.left;
    const Gap first = pool_gap(before, 0), last = pool_gap(after, 0);
    if (!std::isfinite(last.value)) return "cannot be run on the test record";
    if (!std::isfinite(first.value)) return "";
    if (!(last.value < (1 - 0.5 * options_.minimum_gain) * first.value && out_.test_p_value < 0.2))
      return "did not lower the gap on the test record";
    // Far above the floor with a good part of the motion still open: the names patch something else.
    const bool far = far_from_the_floor(last) && last.value - last.floor > 0.2 * (first.value - last.floor);
    if (far || (last.value > 5 * last.floor && closed_share(first.value, last.value, last.floor) < 0.9))
      return "left much of the gap on the test record open";
    const bool patchwork = round.found.chosen.choices.size() > 2 && last.value > 2 * last.floor;
    if (patchwork && left.gap.value < 1.3 * left.gap.floor)
      return "fitted the training records down to their noise by many forces, but not the test record";
    if (!left.seen || !(last.value > (left.material ? 1.5 : 3) * last.floor)) return "";
    if (left.whole) return "left a force that is repeatable";
    const Gap generic = pool_gap(runs(*left.closure.system, left.closure.fit, study_.test), 0);
    return generic.value < 0.5 * last.value ? "did far worse on the test record than forces without a name" : "";
  }

  double test_p_value(const std::vector<FreeRun>& before, const std::vector<FreeRun>& after) const {
    std::vector<double> a, b;
    for (std::size_t r = 0; r < before.size(); ++r) {
      const auto channel = study_.test[r][study_.output()];
      if (!after[r].cause.empty()) return 1;
      if (!before[r].cause.empty()) return 0;
      for (Eigen::Index i = before[r].lead; i < before[r].model.size(); ++i) {
        a.push_back(channel[static_cast<std::size_t>(i)] - before[r].model[i]);
        b.push_back(channel[static_cast<std::size_t>(i)] - after[r].model[i]);
      }
    }
    return p_value_of_lower_error(a, b, bootstrap_block(study_), options_.seed);
  }

  void name_steps(const SearchResult& found) {
    for (std::size_t i = 0; i < found.steps.size(); ++i) {
      const Candidate& model = found.steps[i];
      const Effect& effect = *found.order[i].effect;
      NamedEffect named;
      named.name = effect.name;
      named.family = effect.family;
      named.formula = effect.formula;
      named.sentence = effect.sentence;
      named.where = describe_residual(study_, i == 0 ? found.baseline : found.steps[i - 1], found.chosen);
      named.parameters = own_parameters(found.chosen, effect);
      const bool last = i + 1 == found.steps.size();
      named.gap_train = last ? out_.final_train.value : pool_gap(runs(model, study_.full, false), share_).value;
      named.gap_test = last ? out_.final_test.value : pool_gap(runs(model, study_.test, false), share_).value;
      named.p_value = improvement_p_value(i == 0 ? found.baseline : found.steps[i - 1], model);
      if (last) {
        named.indistinguishable = found.ties;
        named.indistinguishable.insert(named.indistinguishable.end(), found.aliases.begin(), found.aliases.end());
      }
      out_.effects.push_back(std::move(named));
    }
  }

  /// The entry's parameters from the final model, under their own short names.
  static std::vector<Parameter> own_parameters(const Candidate& final_model, const Effect& effect) {
    std::vector<Parameter> out;
    const Model model = fitted(final_model);
    for (const auto& p : effect.parameters) {
      Parameter row = *model.find(p.name);
      if (row.name.rfind(effect.name + "_", 0) == 0) row.name = row.name.substr(effect.name.size() + 1);
      out.push_back(row);
    }
    return out;
  }

  // ---- show ----
  void show(const Round& round) {
    const SearchResult& found = round.found;
    out_.verdict = round.verdict;
    out_.gap_left_out_before = found.baseline.left_out_gap;
    out_.gap_left_out_after = found.chosen.left_out_gap;
    out_.baseline = fitted(found.baseline);
    out_.final = fitted(found.chosen);
    out_.where = describe_residual(study_, found.baseline, found.chosen) + sensor_hint(study_, found.baseline);
    for (std::size_t i = 0; i < found.rivals.size(); ++i) {
      const Candidate& c = found.rivals[i];
      out_.rivals.push_back({c.name(), rms_error(c.fit) / study_.measured_std(), c.log_likelihood,
                             improvement_p_value(found.baseline, c), found.remarks[i], fitted(c)});
    }
    if (!found.grown.left_aside.empty()) {
      std::string list;
      for (const auto& name : found.grown.left_aside) list += (list.empty() ? "" : ", ") + name;
      out_.warnings.push_back("not tried, since this record cannot show them beside the baseline's own terms: " + list);
    }
    if (!untested_.empty()) out_.warnings.push_back(untested_);
    check_bounds(found.chosen);
    out_.removable = removable_terms(out_.baseline, found.chosen);
    if (!found.chosen.choices.empty()) {
      progress("name again on resampled blocks", 0.96);
      out_.naming = bootstrap_naming(study_, found);
    }
    design_next(found);
    check_by_sundials(found.chosen);
    for (std::size_t i = 0; i < study_.full.size(); ++i)
      out_.comparisons.push_back(
          compare(study_, found.baseline, found.chosen, study_.full[i], before_train_[i], after_train_[i], "train"));
    for (std::size_t i = 0; i < study_.test.size(); ++i)
      out_.comparisons.push_back(
          compare(study_, found.baseline, found.chosen, study_.test[i], before_test_[i], after_test_[i], "test"));
    out_.map = residual_map(study_, found.baseline, found.chosen);
    out_.output = study_.output();
    out_.interpolation = study_.imposed ? "none: the motion is imposed" : to_string(study_.interpolation);
    out_.solver =
        study_.imposed ? "none: the motion is imposed" : fixed_solver_name(found.chosen.fit.substeps) + " per sample";
    out_.noise_model = found.whitening.ar.empty()
                           ? "white residual"
                           : "autoregressive residual of order " + std::to_string(found.whitening.ar.size()) +
                                 " on means of " + std::to_string(found.whitening.average) + " rows";
    out_.sentence = sentence(round);
  }

  /// What would tell an ambiguous class apart, within the force, displacement and band that these records had.
  void design_next(const SearchResult& found) {
    const ExperimentOptions options = same_experiment(study_);
    out_.same_experiment = options;
    out_.same_experiment.cancelled = nullptr;  // it outlives the run
    const bool driven = study_.imposed || options.limits.force > 0;
    if (out_.verdict != "ambiguous" || !driven) return;
    progress("design the experiment that would decide", 0.97);
    std::vector<Model> models{out_.final};
    std::vector<std::string> names{found.chosen.name()};
    for (const Rival& rival : out_.rivals) {
      if (std::find(found.ties.begin(), found.ties.end(), rival.name) == found.ties.end()) continue;
      models.push_back(rival.model);
      names.push_back(rival.name);
    }
    if (models.size() < 2) return;
    out_.experiment = design_experiment(models, names, options);
    if (!out_.experiment.best().decides()) {
      ExperimentOptions more = options;
      more.limits.force *= 2;
      more.limits.displacement *= 2;
      ExperimentDesign beyond = design_experiment(models, names, more);
      beyond.beyond = 2;
      if (beyond.best().decides() || beyond.best().expected_z > 2 * out_.experiment.best().expected_z)
        out_.experiment = std::move(beyond);
    }
    out_.experiment.options.cancelled = nullptr;
  }

  void check_bounds(const Candidate& c) {
    const auto& table = c.system->model().parameters;
    for (std::size_t i = 0; i < table.size(); ++i)
      if (i < c.fit.at_bound.size() && c.fit.at_bound[i] && !table[i].fixed)
        out_.warnings.push_back("parameter " + table[i].name + " sits at its bound " +
                                std::to_string(c.fit.theta[static_cast<Eigen::Index>(i)]));
  }

  /// The fast path's last run again by SUNDIALS: tests the integration only (same tape, same force between samples).
  void check_by_sundials(const Candidate& c) {
    if (study_.imposed || !c.ran()) return;
    const auto& record = study_.train.front().record;
    const auto& segment = c.fit.segments.front();
    const Eigen::Index rows = std::min<Eigen::Index>(record.rows(), 2000);
    SimulateOptions options;
    options.solver = Solver::fixed;
    options.substeps = c.fit.substeps;
    const std::span<const double> theta(c.fit.theta.data(), static_cast<std::size_t>(c.fit.theta.size()));
    const Excitations part = study_.train.front().excitation.part(0, rows);
    const Run fast = simulate(*c.system, theta, part, segment.x0, options);
    options.solver = Solver::bdf;
    options.rtol = 1e-7;
    const Run reference = simulate(*c.system, theta, part, segment.x0, options);
    out_.check_solver = reference.summary.solver;
    if (fast.summary.completed && reference.summary.completed)
      out_.check_error =
          (shown(*c.system, theta, fast, study_.output()) - shown(*c.system, theta, reference, study_.output()))
              .cwiseAbs()
              .maxCoeff() /
          study_.measured_std();
    else
      out_.warnings.push_back("the check by SUNDIALS stopped early: " + fast.summary.cause + reference.summary.cause);
  }

  /// Which of the named effects are faults of a sensor or of the input: "" where all are physics.
  static std::string not_physics(const Choices& named) {
    std::string sensors, inputs;
    for (const auto& choice : named) {
      if (is_physics(*choice.effect)) continue;
      std::string& list = choice.effect->family == "sensor" ? sensors : inputs;
      list += (list.empty() ? "" : ", ") + choice.effect->name;
    }
    if (sensors.empty() && inputs.empty()) return "";
    const std::string what = inputs.empty() ? "the sensor" : sensors.empty() ? "the input" : "the sensor and the input";
    const bool all = physics_in(named) == 0;
    return " (" + what + ", not the physics" +
           (all ? "" : ": " + sensors + (sensors.empty() || inputs.empty() ? "" : ", ") + inputs) + ")";
  }

  std::string sentence(const Round& round) const {
    const SearchResult& found = round.found;
    const Left& left = round.left;
    char text[160];
    if (out_.verdict == "explained" || out_.verdict == "ambiguous") {
      std::string names;
      for (const auto& e : out_.effects) names += (names.empty() ? "" : " and ") + e.name;
      names += not_physics(found.order);
      const double excess = out_.baseline_test.value - out_.final_test.floor;
      const double share = excess > 0 ? (out_.baseline_test.value - out_.final_test.value) / excess : 0;
      std::snprintf(text, sizeof text, ": on data not used in the fit, %.0f %% of what the noise allows is closed",
                    100 * std::clamp(share, 0.0, 1.0));
      std::string out = names;
      for (const std::string& tie : found.ties) out += " or " + tie;
      if (!found.ties.empty()) out += " (of equal simplicity: this record cannot tell them apart)";
      if (!std::isfinite(out_.baseline_test.value))
        return out + ": the baseline cannot be run on the test record, the final model can";
      if (left.material)
        out += std::string(text) + "; a small repeatable force is left (" + left.closure.shape + ")";
      else
        out += text;
      return out_.experiment.empty() ? out : out + ". To tell: " + sentence_of(out_.experiment);
    }
    if (out_.verdict == "nothing-missing") {
      std::snprintf(text, sizeof text,
                    "; what is left (gap %.2g on test, %.2g from noise alone) is removed by no such force in free runs",
                    out_.final_test.value, out_.final_test.floor);
      const bool rough = out_.final_test.value > 3 * out_.final_test.floor;
      return std::string(
                 "no effect of the catalogue and no generic force of the motion lowers the left-out gap beyond "
                 "chance") +
             (rough ? text : "");
    }
    if (!found.baseline.ran()) return "the baseline cannot be run, and no entry of the catalogue makes it run";
    const std::string nearest = round.withdrawn.empty() ? "" : "; nearest: " + round.withdrawn;
    if (!left.seen)
      return "much of the motion is not explained, by no entry of the catalogue nor by generic forces of y and v" +
             nearest;
    return "something repeatable is missing (" + left.closure.shape + ") that no entry of the catalogue explains" +
           nearest;
  }

  const DiscoverOptions& options_;
  std::vector<Effect> catalogue_;
  std::size_t first_ = 0;  ///< so many of them are tried first
  std::string untested_;
  Model model_;
  Study whole_, study_;  ///< of all rows, and of those that are looked at now: pieces of long records in the search
  Candidate baseline_;
  std::vector<FreeRun> before_train_, after_train_, before_test_, after_test_;  ///< of baseline and final model
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
  if (baseline.degrees() > 1)
    throw InputError("discover: expected a model of one degree of freedom, got " + std::to_string(baseline.degrees()));
  if (baseline.delay.valid()) throw InputError("discover: a baseline with a delayed force is not looked at: shift F");
  for (const std::string& input : baseline.inputs())
    if (input != "F")
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
