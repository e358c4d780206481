#include "discover/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "discover/between_samples.hpp"
#include "discover/level_fits.hpp"
#include "discover/proposal_fits.hpp"
#include "discover/sensor.hpp"
#include "expr/digits.hpp"
#include "record/parallel.hpp"

namespace lunid {

namespace {

constexpr int finalists = 3;   // sets of one size that are judged under the common noise colour
constexpr int most = 6;        // the same where they come near to the best
constexpr double near = 1.15;  // in squared error

class Search {
 public:
  Search(const Study& study, const Model& model, const Candidate& baseline, std::span<const Effect> catalogue,
         const std::function<void(const std::string&, double)>& progress)
      : study_(study), model_(model), catalogue_(catalogue), progress_(progress) {
    result_.baseline = baseline;
  }

  SearchResult run(const Grown& known, bool ask_reading) {
    result_.grown = grow(study_, model_, result_.baseline, catalogue_, known, ask_reading, progress_);
    if (result_.grown.reading) return std::move(result_);
    progress_("compare", 0.7);
    decide();
    return std::move(result_);
  }

 private:
  /// All a little, then to the end those that may be rivals of the best; the others are lines in the report.
  void judge_all(std::vector<Candidate*> list) {
    constexpr int first_iterations = 6;
    constexpr double as_good = 1.1;  // in squared error
    const auto each = [&](int iterations, bool force_noise) {
      parallel_for(static_cast<int>(list.size()), study_.options->threads, [&](int i) {
        judge(study_, *list[static_cast<std::size_t>(i)], result_.whitening, iterations, force_noise);
      });
    };
    each(first_iterations, false);
    std::erase_if(list, [](const Candidate* c) { return !c->ran(); });
    if (list.empty()) return;
    const Candidate& best = **std::ranges::min_element(list, {}, &Candidate::likelihood_cost);
    std::erase_if(list, [&](const Candidate* c) {
      return !c->choices.empty() && c->likelihood_cost > as_good * best.likelihood_cost && fits_worse(study_, *c, best);
    });
    each(judge_iterations, true);
  }

  void judge_from(std::size_t first, std::vector<Candidate>& field) const {
    parallel_for(static_cast<int>(field.size() - first), study_.options->threads,
                 [&](int i) { judge(study_, field[first + static_cast<std::size_t>(i)], result_.whitening); });
  }

  /// Remembers what the user's criterion refuses.
  bool may_be_named(const Candidate& c) {
    const bool may = lunid::may_be_named(study_, c);
    const std::string name = c.name();
    if (!may && std::ranges::find(result_.refused, name) == result_.refused.end()) result_.refused.push_back(name);
    return may;
  }

  void decide() {
    auto& sets = result_.grown.sets;
    std::erase_if(sets, [&](const Candidate& c) { return !may_be_named(c); });
    const bool worth_comparing = may_come_down();
    if (worth_comparing) look_beside();
    const Candidate& baseline = result_.baseline;
    const bool better = !sets.empty() && !(baseline.ran() && baseline.fit.cost < sets.front().fit.cost);
    result_.whitening = residual_colour(study_, better ? sets.front() : baseline);
    std::vector<Candidate> field = worth_comparing ? contenders() : std::vector<Candidate>();
    if (const auto best = std::ranges::min_element(
            field, {}, [](const Candidate& c) { return c.choices.size() > 1 ? priced(c) : INFINITY; });
        best != field.end())
      hear_faults_in_place(*best, field);
    std::vector<Candidate*> list{&result_.baseline};
    for (auto& c : field) list.push_back(&c);
    judge_all(list);
    while (drop_those_at_limits(field)) hear_the_next(field);
    std::erase_if(field, [&](const Candidate& c) { return !may_be_named(c); });
    if (field.empty()) {
      run_left_out(study_, result_.baseline);
      result_.chosen = result_.baseline;
      return;
    }
    refit_baseline(field.front());  // a single effect
    std::stable_sort(field.begin(), field.end(),
                     [](const Candidate& a, const Candidate& b) { return bic(a) < bic(b); });
    refit_baseline(field.front());
    choose(field);
  }

  /// Short runs are asked for what comes down to the sensor's noise in them: where no set comes near to it nothing is
  /// compared.
  bool may_come_down() const {
    constexpr double near_noise = 4;
    const auto& sets = result_.grown.sets;
    return study_.run_length == 0 || sets.empty() || rms_error(sets.front().fit) < near_noise * study_.sensor_noise();
  }

  /// What the colour of the noise has led to a limit is no contender, nor what others were held against. False where
  /// there is none.
  bool drop_those_at_limits(std::vector<Candidate>& field) {
    const auto is_there = [&](const Candidate& set) {
      const Candidate* judged = find_in(field, set.choices);
      return judged && judged->degenerate();
    };
    std::erase_if(result_.grown.sets, is_there);
    return std::erase_if(field, [](const Candidate& c) { return c.degenerate(); }) > 0;
  }

  void hear_the_next(std::vector<Candidate>& field) {
    const std::size_t judged = field.size();
    for (Candidate& c : contenders())
      if (!find_in(field, c.choices)) field.push_back(std::move(c));
    judge_from(judged, field);
  }

  /// An effect may look needed only because the baseline's own fit ended in a worse place than that beside it: from
  /// there the baseline is fitted again, parameters and first states.
  void refit_baseline(const Candidate& beside) {
    if (!beside.ran()) return;
    Candidate again = result_.baseline;
    again.fit = fit_near(study_, again, beside.fit.theta.head(again.parameters()), 20, beside.fit.substeps,
                         beside.fit.segments);
    const bool ran = result_.baseline.ran();
    if (!again.ran() || (ran && !(squared_error(again.fit) < 0.98 * squared_error(result_.baseline.fit)))) return;
    judge(study_, again, result_.whitening);
    result_.baseline = std::move(again);
  }

  /// What slips or opens some tens of times in a record has minima side by side: the best sets with memory are fitted
  /// from beside where they ended, too. Not those that leave a good part of what the baseline leaves.
  void look_beside() {
    constexpr int as_many = 4;
    constexpr double least = 0.9;  // closed, of the squared excess over the noise
    auto& sets = result_.grown.sets;
    if (sets.empty() || (result_.baseline.ran() && closed_share(study_, result_.baseline, sets.front()) < least))
      return;
    const double far = near * sets.front().fit.cost;
    int looked = 0;
    for (Candidate& c : sets) {
      if (looked == as_many || !(c.fit.cost < far)) break;
      if (c.system->states() == 2 * c.system->degrees() || many_states(c.choices)) continue;
      ++looked;
      if (!std::exchange(c.looked_beside, true)) fit_from_beside(c);
    }
    sort_by_cost(sets);
  }

  /// As long as that leads anywhere.
  void fit_from_beside(Candidate& c) const {
    constexpr int rounds = 5;
    for (int i = 0; i < rounds && fit_once_from_beside(c); ++i) {
    }
  }

  bool fit_once_from_beside(Candidate& c) const {
    constexpr std::array factors{0.6, 0.85, 1.2, 1.7};
    constexpr int first_iterations = 8, iterations = 24;
    constexpr double visibly = 0.999;  // in squared error
    std::vector<FitResult> fits;
    for (const auto& [j, range] : c.shown)
      for (const double factor : factors) {
        const auto at = static_cast<Eigen::Index>(j);
        FitResult other = c.fit;
        other.theta[at] = std::clamp(factor * other.theta[at], range.first, range.second);
        if (other.theta[at] != c.fit.theta[at]) fits.push_back(std::move(other));
      }
    parallel_for(static_cast<int>(fits.size()), study_.options->threads, [&](int i) {
      FitResult& other = fits[static_cast<std::size_t>(i)];
      other = fit_near(study_, c, other.theta, first_iterations, c.fit.substeps, c.fit.segments);
    });
    const auto best = std::ranges::min_element(fits, {}, &FitResult::cost);
    if (best == fits.end() || !(best->cost < c.fit.cost)) return false;
    Candidate other = c;
    other.fit = fit_near(study_, c, best->theta, iterations, best->substeps, best->segments);
    if (!other.ran() || !(other.fit.cost < visibly * c.fit.cost) || other.degenerate()) return false;
    c = std::move(other);
    return true;
  }

  /// The best sets of each size, and those that come near to them: few enough to be judged. Faults of sensors and of
  /// the input are heard whatever physics does better.
  std::vector<Candidate> contenders() {
    auto& sets = result_.grown.sets;
    std::stable_sort(sets.begin(), sets.end(),
                     [](const Candidate& a, const Candidate& b) { return priced(a) < priced(b); });
    std::vector<Candidate> field;
    for (int size = 1; size <= study_.most_effects; ++size) {
      int taken = 0;
      double best = INFINITY;
      for (const auto& c : sets) {
        if (static_cast<int>(c.choices.size()) != size) continue;
        best = std::min(best, c.fit.cost);
        const bool hopeless = size > 1 && c.fit.cost > near * sets.front().fit.cost;
        if (hopeless || taken >= (c.fit.cost < near * best ? most : finalists)) continue;
        field.push_back(c);
        ++taken;
      }
      if (size == 1) hear_other_places(sets, field);
      const auto fault = std::find_if(sets.begin(), sets.end(), [&](const Candidate& c) {
        return static_cast<int>(c.choices.size()) == size && physics_in(c.choices) == 0;
      });
      if (fault == sets.end()) continue;
      constexpr double no_other = 0.01;  // in squared error: what does the same as the fault is heard beside it
      const double cost = fault->fit.cost;
      for (const Candidate& c : sets) {
        if (c.choices.size() != fault->choices.size() || c.free_parameters() != fault->free_parameters()) continue;
        if (!(std::abs(c.fit.cost - cost) <= no_other * cost)) continue;
        const auto heard = [&](const Candidate& known) { return same(known.choices, c.choices); };
        if (std::none_of(field.begin(), field.end(), heard)) field.push_back(c);
      }
    }
    return field;
  }

  /// Where a fault of a channel alone does what an effect of a larger set does alone, it is heard in that one's place
  /// too: constant_force beside another effect may be the displacement's offset. By value: the field grows.
  void hear_faults_in_place(Candidate whole, std::vector<Candidate>& field) {
    constexpr double alike = 0.05;  // in squared error
    if (whole.choices.size() < 2) return;
    for (const Candidate& physics : result_.grown.sets) {
      if (physics.choices.size() != 1 || physics_in(physics.choices) == 0) continue;
      const Choice& old = physics.choices.front();
      if (!holds(whole.choices, old.effect)) continue;
      for (const Candidate& fault : result_.grown.sets)
        if (fault.choices.size() == 1 && physics_in(fault.choices) == 0 &&
            std::abs(fault.fit.cost / physics.fit.cost - 1) < alike)
          hear_in_place(old, fault.choices.front(), fault, whole, field);
    }
  }

  /// A set that was part of a larger one may do with a simpler form of an entry, which the larger one did not.
  void hear_special_cases(const Candidate& whole, std::vector<Candidate>& field) {
    const auto& sets = result_.grown.sets;
    for (const Choice& old : whole.choices)
      for (const Candidate& alone : sets) {
        const Choice& simple = alone.choices.front();
        if (alone.choices.size() > 1 || !simple.is_special_case(old)) continue;
        const auto has_it = [&](const Candidate& c) { return within(alone.choices, c.choices); };
        hear_in_place(old, simple, *std::ranges::find_if(sets, has_it), whole, field);
      }
  }

  /// `as_in`: the fitted set from which `other` has its values.
  void hear_in_place(const Choice& old, const Choice& other, const Candidate& as_in, const Candidate& whole,
                     std::vector<Candidate>& field) {
    Choices set = whole.choices;
    std::erase(set, old);
    if (holds(set, other.effect) || !goes_with(set, other)) return;
    set.push_back(other);
    if (find_in(field, set)) return;
    Candidate c = compile(study_, model_, set);
    c.starts = {values_of(c, {&as_in, &whole})};
    c.fit = fit_near(study_, c, c.starts.front(), 20, whole.fit.substeps);
    if (c.ran() && !c.degenerate() && may_be_named(c)) field.push_back(std::move(c));
  }

  /// The best single effect at the other places where it was fitted.
  static void hear_other_places(const std::vector<Candidate>& sets, std::vector<Candidate>& field) {
    if (field.empty()) return;
    const Effect& best = *field.front().choices.front().effect;
    for (const auto& c : sets) {
      const Effect& other = *c.choices.front().effect;
      if (c.choices.size() != 1 || other.name != best.name || other.place == best.place) continue;
      const auto heard = [&](const Candidate& f) { return same(f.choices, c.choices); };
      if (std::none_of(field.begin(), field.end(), heard)) field.push_back(c);
    }
  }

  double corrected(double p) const { return lunid::corrected(p, result_.grown.tried); }

  void choose(std::vector<Candidate>& field) {
    const Candidate best = field.front();
    std::vector<std::size_t> alike;
    for (std::size_t i = 0; i < field.size(); ++i)
      if (i == 0 || not_rejected(study_, field[i], best, result_.grown.tried)) alike.push_back(i);
    // The simplest member that is not rejected; among equals a faulty sensor or input before physics, then the
    // likelier.
    std::stable_sort(alike.begin(), alike.end(),
                     [&](std::size_t a, std::size_t b) { return simplicity(field[a]) < simplicity(field[b]); });
    std::size_t pick = in_the_usual_words(result_.baseline, field, alike);
    for (const auto i : alike)
      if (outgrows(study_, field[i], field[pick], result_.grown.tried)) pick = i;
    pick = in_special_form(field, pick);
    const std::size_t judged = field.size();
    hear_faults_in_place(field[pick], field);
    judge_from(judged, field);
    prefer_the_same_fault(field, alike, pick);
    prune(field, pick);
    Candidate chosen = field[pick];
    progress_("free runs over left-out blocks", 0.8);
    accept(field, chosen, alike, pick);
  }

  /// A general form whose one further number may be zero, by chance among all start points that were tried, is its
  /// special case, a stop that moves by nothing: colour that no whitening takes away is followed by any further number.
  /// Of several that hang on each other the general form has to outgrow the special one, or to take most of what that
  /// leaves above the sensor's noise.
  std::size_t in_special_form(const std::vector<Candidate>& field, std::size_t pick) const {
    const Candidate& general = field[pick];
    for (std::size_t i = 0; i < field.size(); ++i) {
      const Candidate& special = field[i];
      if (special.added() >= general.added() || !is_general_form(general.choices, special.choices)) continue;
      const std::size_t further = general.added() - special.added();
      const double level = study_.options->alpha / std::max(1, result_.grown.tried);
      const bool may_be_zero = added_near_zero(general, level) >= further;
      if (!may_be_zero) continue;
      const int tried = result_.grown.tried;
      const bool is_worth_it = outgrows(study_, general, special, tried) || takes_most(study_, general, special, tried);
      if (further == 1 || !is_worth_it) return i;
    }
    return pick;
  }

  /// Drops effects without which a fitted set is not worse.
  void prune(const std::vector<Candidate>& field, std::size_t& pick) const {
    for (bool again = true; again;) {
      again = false;
      for (std::size_t i = 0; i < field.size(); ++i) {
        if (field[i].choices.size() + 1 != field[pick].choices.size()) continue;
        if (within(field[i].choices, field[pick].choices) &&
            corrected(improvement_p_value(field[i], field[pick])) > study_.options->alpha) {
          pick = i;
          again = true;
          break;
        }
      }
    }
  }

  /// Every effect of the chosen set must lower the left-out gap; sets shrink until that holds. What a set has lost had
  /// made simpler sets look worse than they are: those are held against what is left.
  void accept(std::vector<Candidate>& field, Candidate chosen, const std::vector<std::size_t>& alike,
              std::size_t pick) {
    run_left_out(study_, result_.baseline);
    run_left_out(study_, chosen);
    chosen = what_earns(field, std::move(chosen));
    if (chosen.choices.size() < field[pick].choices.size()) {
      const std::size_t judged = field.size();
      hear_special_cases(chosen, field);
      judge_from(judged, field);
      if (std::optional<Candidate> simpler = simpler_than(field, chosen)) chosen = std::move(*simpler);
    }
    if (!chosen.choices.empty() && (!explains_most(chosen) || !may_be_named(chosen))) chosen = result_.baseline;
    const bool named = !chosen.choices.empty();
    if (named) {
      // A set that the best one holds is tested harder than one beside it: the same run is heard all the same.
      const bool as_picked = same(chosen.choices, field[pick].choices);
      std::vector<const Candidate*> among;
      for (std::size_t i = 0; i < field.size(); ++i)
        if (!as_picked || std::ranges::find(alike, i) != alike.end() || same_runs(field[i], chosen))
          among.push_back(&field[i]);
      result_.ties = find_ties(study_, result_.baseline, chosen, among);
      hear_other_channels(among, chosen);
      order_steps(field, chosen);
    }
    if (!named) {
      read_between_samples();
      hear_faint(field);
    }
    collect_rivals(field, chosen);
    result_.chosen = std::move(chosen);
  }

  /// Another channel that was measured may tell apart what is one in the channel that is fitted, where it bears out a
  /// fault of that one. One that agrees with the fitted channel says nothing where it may have been computed from it.
  void hear_other_channels(const std::vector<const Candidate*>& among, Candidate& chosen) {
    Ties& ties = result_.ties;
    const auto is_alias = [&](const Candidate& c) {
      return std::ranges::find(ties.aliases, c.name()) != ties.aliases.end();
    };
    std::vector<const Candidate*> alike{&chosen};
    for (const Candidate* c : among)
      if (is_alias(*c) || (holds_name(ties.rivals, c->name()) && same_runs(*c, chosen))) alike.push_back(c);
    const std::vector<const Candidate*> borne_out = borne_out_by_other_channels(study_, alike);
    const auto is_of_sensor = [](const Choice& choice) { return choice.effect->family == "sensor"; };
    if (borne_out.empty()) return;
    const Candidate& nearest = *borne_out.front();
    if (std::ranges::none_of(nearest.choices, is_of_sensor) && !were_measured_apart(study_, nearest)) return;
    for (const Candidate* c : alike)
      if (std::ranges::find(borne_out, c) == borne_out.end()) result_.denied.push_back(c->choices);
    if (holds_name(result_.denied, chosen.name())) {
      chosen = nearest;
      if (chosen.left_out.size() == 0) run_left_out(study_, chosen);
      ties = find_ties(study_, result_.baseline, chosen, among);
    }
    std::erase_if(ties.aliases, [&](const std::string& name) { return holds_name(result_.denied, name); });
    std::erase_if(ties.rivals, [&](const Choices& set) { return holds_name(result_.denied, name_of(set)); });
  }

  /// The set without the effects that do not earn their place in it.
  Candidate what_earns(const std::vector<Candidate>& field, Candidate chosen) {
    while (!chosen.choices.empty()) {
      std::vector<Candidate> smaller = one_less(field, chosen);
      parallel_for(static_cast<int>(smaller.size()), study_.options->threads, [&](int i) {
        auto& c = smaller[static_cast<std::size_t>(i)];
        if (c.left_out.size() == 0) run_left_out(study_, c);
      });
      const Candidate* weakest = nullptr;
      for (const auto& c : smaller)
        if (!earns(c, chosen) && (!weakest || c.left_out_gap < weakest->left_out_gap)) weakest = &c;
      if (!weakest) break;
      chosen = under_first_names(*weakest);
    }
    return chosen;
  }

  /// Of an entry that stood several times a repetition may be left: the same fit as that of the first.
  Candidate under_first_names(Candidate c) const {
    Choices set;
    for (const auto& [effect, variant] : c.choices) {
      const auto earlier = std::ranges::find_if(catalogue_, [&](const Effect& other) {
        return other.number < effect->number && other.label() == effect->label() && !holds(c.choices, &other) &&
               may_join(set, other);
      });
      set.push_back({earlier != catalogue_.end() ? &*earlier : effect, variant});
    }
    if (set == c.choices) return c;
    Candidate renamed = compile(study_, model_, set);
    c.choices = std::move(set);
    c.system = std::move(renamed.system);
    c.force_system = std::move(renamed.force_system);
    return c;
  }

  /// The simplest set that fits as well as this one and that earns its place.
  std::optional<Candidate> simpler_than(const std::vector<Candidate>& field, const Candidate& chosen) {
    std::optional<Candidate> out;
    for (const Candidate& c : field) {
      if (c.choices.empty() || !c.ran() || within(c.choices, chosen.choices) || fits_worse(study_, c, chosen)) continue;
      if (!(simplicity(c) < simplicity(out ? *out : chosen))) continue;
      Candidate heard = c;
      run_left_out(study_, heard);
      if (const Candidate kept = what_earns(field, heard); same(kept.choices, c.choices)) out = std::move(heard);
    }
    return out;
  }

  /// More of what the baseline leaves above the sensor's noise is closed than stays open. A small part of a disturbance
  /// that comes from elsewhere can be followed by a force of the motion, beyond what a test of chance would allow.
  bool explains_most(const Candidate& chosen) const {
    return !std::isfinite(result_.baseline.left_out_gap) ||
           closed_share(result_.baseline.left_out_gap, chosen.left_out_gap, study_.noise_gap()) > 0.5;
  }

  bool earns(const Candidate& without, const Candidate& with) {
    return earns(without, with, required_gain(study_, with.left_out_gap));
  }

  bool earns(const Candidate& without, const Candidate& with, double least_gain) {
    if (!without.ran()) return true;
    if (!told_from_zero(study_, with, without) || !carries_force(study_, with, without)) return false;
    if (!(with.left_out_gap < (1 - least_gain) * without.left_out_gap)) return false;
    if (corrected(improvement_p_value(without, with)) > study_.options->alpha) return false;
    const double level = std::max(study_.options->alpha, 0.05);
    if (!foretells_nearly_all(without, with) && !(left_out_p_value(study_, without, with) < level)) return false;
    if (!is_between_samples(without, with)) return true;
    result_.as_read.push_back(with.name());
    return false;
  }

  /// Blocks that were left out may hold what is missing in a few rows alone, a peak that was clipped: of a resample
  /// without them nothing is learned, but that they were foretold is no chance.
  bool foretells_nearly_all(const Candidate& without, const Candidate& with) const {
    constexpr double most = 0.5, nearly_all = 0.95;
    return with.left_out_gap < most * without.left_out_gap &&
           closed_share(without.left_out_gap, with.left_out_gap, study_.noise_gap()) > nearly_all;
  }

  /// Of the best single effects the one that would be named but for the least gain.
  void hear_faint(const std::vector<Candidate>& field) {
    int heard = 5;
    for (const Candidate& c : field) {
      if (c.choices.size() != 1 || corrected(improvement_p_value(result_.baseline, c)) > study_.options->alpha)
        continue;
      if (heard-- == 0) break;
      Candidate with = c;
      if (with.left_out.size() == 0) run_left_out(study_, with);
      const bool better = !result_.faint || with.left_out_gap < result_.faint->left_out_gap;
      if (better && earns(result_.baseline, with, 0)) result_.faint = std::move(with);
    }
  }

  /// What the smaller set would do with a force that is read otherwise between its samples is no worse than the larger.
  bool is_between_samples(const Candidate& without, const Candidate& with) const {
    const auto is_as_good = [&](const Candidate& c) { return !fits_worse(study_, c, with); };
    return find_reading(without, with.fit.substeps, is_as_good).has_value();
  }

  /// The first reading that does: under the force's present interpolation, which may stand for a part of a lag (a held
  /// force is half a sample late), and, where that takes most of the set's squared error, under the others.
  std::optional<Reading> find_reading(const Candidate& of, int substeps,
                                      const std::function<bool(const Candidate&)>& does) const {
    constexpr double most = 0.5;
    const std::optional<Effect> effect = between_samples(study_, model_);
    if (!effect || !goes_with(of.choices, {&*effect, 0})) return {};
    Candidate c = compile(study_, model_, with(of.choices, {&*effect, 0}));
    c.starts = {values_of(c, {&of})};
    const auto judged_as = [&](const Study& study) {
      c.fit = fit_near(study, c, c.starts.front(), 20, substeps);
      judge(study, c, result_.whitening);
      return c.ran() && does(c);
    };
    if (judged_as(study_)) return Reading{c.fit.theta.tail<2>(), study_.between.kind};
    if (!(c.fit.cost < most * of.fit.cost)) return {};
    Study other = study_;
    for (const Interpolation kind : every_interpolation) {
      if (kind == study_.between.kind) continue;
      read_force(other, {kind, study_.between.alike});
      if (judged_as(other)) return Reading{c.fit.theta.tail<2>(), kind};
    }
    return {};
  }

  /// Where nothing is named and something is left: whether a reading of the force takes nearly all of it.
  void read_between_samples() {
    constexpr double nearly_all = 0.95, at_noise = 1.1;
    const Candidate& baseline = result_.baseline;
    if (!baseline.ran() || !(rms_error(baseline.fit) > at_noise * study_.sensor_noise())) return;
    const auto takes_all = [&](const Candidate& c) { return closed_share(study_, baseline, c) > nearly_all; };
    if (const auto reading = find_reading(baseline, baseline.fit.substeps, takes_all))
      result_.reading = words_of_reading(study_, *reading);
  }

  /// The chosen set without each of its effects, fitted and judged (from the field where it is there).
  std::vector<Candidate> one_less(const std::vector<Candidate>& field, const Candidate& chosen) {
    if (chosen.choices.size() == 1) return {result_.baseline};
    std::vector<Choices> sets;
    for (std::size_t drop = 0; drop < chosen.choices.size(); ++drop) {
      sets.push_back(chosen.choices);
      sets.back().erase(sets.back().begin() + static_cast<std::ptrdiff_t>(drop));
    }
    return obtain(field, sets, chosen);
  }

  /// Parts of a fitted set, fitted from the parameters of that set, and from those with the baseline's own; each as the
  /// field has it where that is likelier (alone it may have ended elsewhere).
  std::vector<Candidate> obtain(const std::vector<Candidate>& field, const std::vector<Choices>& sets,
                                const Candidate& larger) const {
    std::vector<Candidate> out;
    std::vector<const Candidate*> known;
    for (const Choices& set : sets) {
      // Under the same names: of an entry that stood twice its repetition may be left.
      const auto at =
          std::ranges::find_if(field, [&](const Candidate& c) { return std::ranges::is_permutation(c.choices, set); });
      known.push_back(at != field.end() ? &*at : nullptr);
      out.push_back(known.back() ? *known.back() : compile(study_, model_, set));
    }
    parallel_for(static_cast<int>(out.size()), study_.options->threads, [&](int i) {
      Candidate& c = out[static_cast<std::size_t>(i)];
      const Candidate* as_known = known[static_cast<std::size_t>(i)];
      fit_from(c, larger);
      judge(study_, c, result_.whitening);
      if (as_known && (!c.ran() || as_known->likelihood_cost <= c.likelihood_cost)) c = *as_known;
    });
    return out;
  }

  /// The first states of a set's fit as far as a part of it has the same states in the same order.
  static std::vector<FitSegment> first_states_for(const Candidate& part, const Candidate& whole) {
    const auto &own = part.system->model().states, &all = whole.system->model().states;
    const auto differ = std::mismatch(own.begin(), own.end(), all.begin(), all.end(),
                                      [](const auto& a, const auto& b) { return a.symbol.name() == b.symbol.name(); });
    std::vector<FitSegment> out = whole.fit.segments;
    for (FitSegment& s : out)
      s.x0.conservativeResize(
          std::min<Eigen::Index>(s.x0.size(), 2 * part.system->degrees() + (differ.first - own.begin())));
    return out;
  }

  void fit_from(Candidate& c, const Candidate& larger) const {
    Eigen::VectorXd start = values_of(c, {&larger});
    c.starts = {start};
    c.fit = fit_near(study_, c, start, 20, larger.fit.substeps, first_states_for(c, larger));
    if (!result_.baseline.ran()) return;
    start.head(result_.baseline.fit.theta.size()) = result_.baseline.fit.theta;
    FitResult again = fit_near(study_, c, start, 20, larger.fit.substeps);
    if (!c.ran() || again.cost < c.fit.cost) c.fit = std::move(again);
  }

  /// Orders the effects by what each adds, and keeps the models between.
  void order_steps(const std::vector<Candidate>& field, Candidate& chosen) {
    Choices rest = chosen.choices, ordered;
    while (rest.size() > 1) {
      std::vector<Choices> sets;
      for (const Choice& next : rest) {
        sets.push_back(ordered);
        sets.back().push_back(next);
      }
      std::vector<Candidate> with = obtain(field, sets, chosen);
      const auto best = std::ranges::min_element(with, {}, [](const Candidate& c) { return c.fit.cost; });
      const auto which = best - with.begin();
      ordered.push_back(rest[static_cast<std::size_t>(which)]);
      rest.erase(rest.begin() + which);
      result_.steps.push_back({ordered.back(), std::move(*best)});
    }
    result_.steps.push_back({rest.front(), chosen});
  }

  /// Other sets first, best first; then those that only add to the chosen one.
  void collect_rivals(std::vector<Candidate> field, const Candidate& chosen) {
    std::stable_partition(field.begin(), field.end(), [&](const Candidate& c) {
      return chosen.choices.empty() || !std::all_of(chosen.choices.begin(), chosen.choices.end(),
                                                    [&](const Choice& x) { return holds(c.choices, x.effect); });
    });
    const auto named = [](const Choices& choices) {  // the same set in another order is no other rival
      std::multiset<std::string> labels;
      for (const Choice& choice : choices) labels.insert(choice.effect->label());
      return labels;
    };
    std::set<std::multiset<std::string>> seen{named(chosen.choices)};
    for (const auto& c : field) {
      if (!seen.insert(named(c.choices)).second) continue;
      const bool tie = holds_name(result_.ties.rivals, c.name());
      std::vector<Beaten>& rivals = result_.rivals;
      rivals.push_back({c, tie ? Beaten::By::tie : Beaten::By::training, {}});
      rivals.back().remark = tie ? tie_remark(rivals, rivals.size() - 1, chosen) : why_not(c, chosen);
    }
  }

  std::string why_not(const Candidate& c, const Candidate& chosen) const {
    if (holds_name(result_.denied, c.name()))
      return "the same run, but the other channels that were measured do not bear it out";
    if (std::ranges::find(result_.ties.aliases, c.name()) != result_.ties.aliases.end())
      return "the same force as " + chosen.name() + " on this record, in another notation";
    if (!c.ran()) return "its free run stops early";
    if (result_.baseline.ran() && corrected(improvement_p_value(result_.baseline, c)) > study_.options->alpha)
      return "no better than the baseline";
    if (std::ranges::find(result_.as_read, c.name()) != result_.as_read.end())
      return "no better than what the force may do between its samples";
    if (chosen.choices.empty()) return "does not lower the left-out gap by the least gain";
    if (!not_rejected(study_, chosen, c, result_.grown.tried))
      return "fits better, but not all of its effects earn their place";
    if (c.free_parameters() > chosen.free_parameters() && c.likelihood_cost <= chosen.likelihood_cost)
      return "likelier than " + chosen.name() + " by less than its extra parameters cost";
    const double times = rms_error(c.fit) / rms_error(chosen.fit);
    return (fits_worse(study_, c, chosen) ? "fits worse: leaves " : "fits no better beyond chance: leaves ") +
           (std::abs(times - 1) < 0.005 ? "as much as " : number(times, 3) + " times what ") + chosen.name() +
           " leaves";
  }

  const Study& study_;
  const Model& model_;
  const std::span<const Effect> catalogue_;
  const std::function<void(const std::string&, double)>& progress_;
  SearchResult result_;
};

}  // namespace

bool may_be_named(const Study& study, const Candidate& c) {
  const auto& criterion = study.options->criterion;
  if (!criterion || c.choices.empty() || !c.ran()) return true;
  return criterion({c.name(), rms_error(c.fit) / study.measured_std(), fitted(study, c)});
}

const Beaten* same_force_before(const std::vector<Beaten>& rivals, std::size_t i) {
  for (std::size_t j = 0; j < i; ++j)
    if (rivals[j].by == Beaten::By::tie && same_in_other_words(rivals[j].model, rivals[i].model)) return &rivals[j];
  return nullptr;
}

std::string tie_remark(const std::vector<Beaten>& rivals, std::size_t i, const Candidate& chosen) {
  if (const Beaten* other = same_force_before(rivals, i))
    return "the same force as " + other->model.name() + " on this record, in another notation";
  return "this record cannot tell it from " + chosen.name() + ": their free runs differ by " +
         number(share_apart(rivals[i].model, chosen), 2) + " of what is left";
}

SearchResult search(const Study& study, const Model& model, const Candidate& baseline,
                    std::span<const Effect> catalogue, const Grown& known, bool ask_reading,
                    const std::function<void(const std::string&, double)>& progress) {
  return Search(study, model, baseline, catalogue, progress).run(known, ask_reading);
}

}  // namespace lunid
