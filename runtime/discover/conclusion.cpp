#include "discover/conclusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "discover/between_samples.hpp"
#include "discover/closed_loop.hpp"
#include "discover/gap.hpp"
#include "discover/locate.hpp"
#include "discover/naming.hpp"
#include "discover/one_motion.hpp"
#include "discover/places.hpp"
#include "discover/removable.hpp"
#include "discover/sensor.hpp"
#include "discover/unknown_force.hpp"
#include "expr/digits.hpp"
#include "expr/joined.hpp"

namespace lunid {

namespace {

/// Which of the named effects are faults of a sensor or of the input: "" where all are physics.
std::string not_physics(const Choices& named) {
  std::string sensors, inputs;
  for (const auto& choice : named) {
    if (is_physics(*choice.effect)) continue;
    std::string& list = choice.effect->family == "sensor" ? sensors : inputs;
    append_item(list, choice.effect->name);
  }
  if (sensors.empty() && inputs.empty()) return "";
  const std::string what = inputs.empty() ? "the sensor" : sensors.empty() ? "the input" : "the sensor and the input";
  const bool all = physics_in(named) == 0;
  return " (" + what + ", not the physics" +
         (all ? "" : ": " + sensors + (sensors.empty() || inputs.empty() ? "" : ", ") + inputs) + ")";
}

std::string in_brackets(const std::string& words) { return words.empty() ? "" : " (" + words + ")"; }

/// What lowers the left-out gap beyond chance, by how much, and why it is not named all the same.
std::string below_what_is_asked(const Study& study, const SearchResult& found) {
  if (!found.faint) return "";
  const double before = found.baseline.left_out_gap, after = found.faint->left_out_gap, gain = 1 - after / before,
               asked = required_gain(study, after), closed = closed_share(before, after, study.noise_gap());
  const std::string why = gain < asked    ? ": less than the least gain of " + number(100 * asked, 2) + " %"
                          : closed <= 0.5 ? ", " + number(100 * closed, 2) +
                                                " % of what is above the noise: half of that is asked of a name"
                                          : "; the sets that follow best hold other effects, which do not stand";
  return found.faint->name() + " lowers it beyond chance, but by " + number(100 * gain, 2) + " %" + why;
}

/// What forces without a name do on the test records.
std::string by_nameless_forces(const Discovery& out) {
  if (!out.unknown || !out.unknown->closure) return "";
  char text[120];
  std::snprintf(text, sizeof text, "; forces without a name lower the gap on test from %.2g to %.2g",
                out.final_test.value, out.unknown->closure->test.value);
  return text;
}

/// What would tell an ambiguous class apart, within the force, displacement and band that these records had; of a
/// Discovery whose verdict, final model and rivals are there.
void design_next(const Study& study, const SearchResult& found, Discovery& out) {
  const ExperimentOptions options = same_experiment(study);
  out.same_experiment = options;
  out.units = options.units;
  out.same_experiment.cancelled = nullptr;  // it outlives the run
  const bool driven = study.imposed || options.limits.force > 0;
  if (out.verdict != Verdict::ambiguous || !driven || study.forces.size() > 1) return;
  std::vector<Model> models{out.final};
  std::vector<std::string> names{found.chosen.name()};
  for (std::size_t i = 0; i < out.rivals.size(); ++i) {
    const Rival& rival = out.rivals[i];  // that of found.rivals[i]
    // No experiment tells one force in two notations apart.
    if (!holds_name(found.ties.rivals, rival.name) || same_force_before(found.rivals, i)) continue;
    models.push_back(rival.model);
    names.push_back(rival.name);
  }
  if (models.size() < 2) return;
  out.experiment = design_experiment(models, names, options);
  if (!out.experiment.best().decides()) {
    ExperimentOptions more = options;
    more.limits.force *= 2;
    more.limits.displacement *= 2;
    ExperimentDesign beyond = design_experiment(models, names, more);
    beyond.beyond = 2;
    if (beyond.best().decides() || beyond.best().expected_z > 2 * out.experiment.best().expected_z)
      out.experiment = std::move(beyond);
  }
  out.experiment.options.cancelled = nullptr;
}

/// Parameters that sit at their bounds are warned of; the baseline's own were before all else (fit_baseline).
void warn_of_bounds(const Candidate& baseline, const Candidate& c, Discovery& out) {
  const auto& table = c.system->model().parameters;
  const auto sits = [](const FitResult& fit, std::size_t i) { return i < fit.at_bound.size() && fit.at_bound[i]; };
  for (std::size_t i = 0; i < table.size(); ++i)
    if (sits(c.fit, i) && !table[i].fixed && !sits(baseline.fit, i))
      out.warnings.push_back("parameter " + table[i].name + " sits at its bound " +
                             number(c.fit.theta[static_cast<Eigen::Index>(i)], 4));
}

void warn_of_unidentifiable(const Candidate& c, Discovery& out) {
  if (const std::string names = unidentifiable(c); !names.empty())
    out.warnings.push_back(
        names +
        " are not identifiable and have no intervals: other values of these, together, make the same motion on the "
        "training records. Give one of them as a number, or train under a force that is known");
}

void say_what_the_baseline_holds(const Candidate& c, Discovery& out) {
  for (const Choice& choice : c.choices)
    for (const auto& [own, baseline] : choice.effect->twins)
      out.warnings.push_back(baseline + " holds " + own + " of " + choice.effect->label() +
                             " as well: only the two together can be seen, and have either sign");
}

/// What belongs to one record is another thing on a test record, which the parameters of the final model do not show.
void say_what_the_test_has_of_its_own(const Study& study, const Candidate& c, Discovery& out) {
  for (const Record& record : study.test) {
    const Eigen::VectorXd theta = theta_on(study, c, record);
    std::string list;
    for (int i = 0; i < c.parameters(); ++i)
      if (theta[i] != c.fit.theta[i]) {
        const Parameter& p = c.system->model().parameters[static_cast<std::size_t>(i)];
        append_item(list, p.name + " = " + number(theta[i], 4) + (p.unit.empty() ? "" : " " + p.unit));
      }
    if (!list.empty())
      out.warnings.push_back(record.name() + " has its own " + list + ": found on it, all other parameters held");
  }
}

/// The unit that was left out where this is what it makes of a number, with powers of a thousand or without; "" where
/// it is none. No real gain is so far from one.
std::string unit_of_ratio(double ratio) {
  constexpr double near = 0.03, nearer = 0.01;
  const auto apart = [&](double of) {  // from the next power of a thousand, and which that is
    const double powers = std::log10(std::abs(ratio) / of) / 3, whole = std::round(powers);
    return std::pair{std::abs(std::pow(1000.0, powers - whole) - 1), whole};
  };
  if (const auto [off, whole] = apart(1); off < near && whole != 0) return "mm for m, kN for N, ms for s, g for kg";
  constexpr std::pair<double, const char*> units[] = {
      {9.80665, "g for m/s^2"}, {180 / M_PI, "degrees for rad"}, {25.4, "inches for m"}, {4.448222, "lbf for N"}};
  for (const auto& [factor, words] : units)
    for (const double of : {factor, 1 / factor})
      if (apart(of).first < nearer) return words;
  return "";
}

/// A gain, or a mass beside that of the baseline, that is rather a unit or a sign.
std::string unit_or_sign(const NamedEffect& e, const Model& baseline) {
  constexpr double near = 0.03;
  double ratio = 0;
  for (const Parameter& p : e.parameters) {
    if (p.name == "g" && (e.family == "sensor" || e.family == "input")) ratio = p.value;
    if (e.name == "added_mass" && e.place.empty() && baseline.mass.is_constant())
      ratio = 1 + p.value / baseline.mass.value();
  }
  if (ratio == 0) return "";
  const std::string is = e.name + " makes it " + number(ratio, 4) + " times what is given: ";
  if (std::abs(ratio + 1) < near) return is + "is the sign of the force, or of the motion, reversed?";
  const std::string unit = unit_of_ratio(ratio);
  return unit.empty() ? "" : is + "is a unit (" + unit + ") not said?";
}

/// The fast path's last run again by SUNDIALS: tests the integration only (same tape, same force between samples).
void check_by_sundials(const Study& study, const Candidate& c, Discovery& out) {
  if (study.imposed || !c.ran()) return;
  const auto& record = study.train.front().record;
  const auto& segment = c.fit.segments.front();
  const Eigen::Index rows = std::min<Eigen::Index>(record.rows(), 2000);
  SimulateOptions options;
  options.solver = Solver::fixed;
  options.substeps = c.fit.substeps;
  const std::span<const double> theta = view(c.fit.theta);
  const Excitations part = study.train.front().excitation.part(0, rows);
  const Run fast = simulate(*c.system, theta, part, segment.x0, options);
  options.solver = Solver::bdf;
  options.rtol = 1e-7;
  const Run reference = simulate(*c.system, theta, part, segment.x0, options);
  out.check_solver = reference.summary.solver;
  if (fast.summary.completed && reference.summary.completed)
    for (const std::string& output : study.outputs())
      out.check_error = std::max(
          out.check_error,
          (shown(*c.system, theta, fast, output) - shown(*c.system, theta, reference, output)).cwiseAbs().maxCoeff() /
              (study.degrees() == 1 ? study.measured_std() : standard_deviation(record[output])));
  else
    out.warnings.push_back("the check by SUNDIALS stopped early: " + fast.summary.cause + reference.summary.cause);
}

/// "one_sided_stop (twice) and coulomb_friction"
std::string words_of(const std::vector<NamedEffect>& effects) {
  constexpr std::array often{"", " (twice)", " (three times)"};
  std::string text;
  for (auto e = effects.begin(); e != effects.end(); ++e) {
    const auto is_same = [&](const NamedEffect& other) { return other.label == e->label; };
    if (std::any_of(effects.begin(), e, is_same)) continue;
    const auto count = static_cast<std::size_t>(std::count_if(e, effects.end(), is_same));
    text += (text.empty() ? "" : " and ") + e->label + often.at(count - 1);
  }
  return text;
}

/// Of names that were taken back: whether by the test records.
std::string by_the_test(const Round& round) {
  const std::vector<Beaten>& rivals = round.found.rivals;
  const bool tested = !rivals.empty() && rivals.front().by == Beaten::By::test;
  return tested ? ", which the test record does not bear out" : "";
}

/// An unknown effect of which the baseline's run, lost, says nothing.
void warn_of_a_lost_baseline(Discovery& out) {
  constexpr double lost = 0.9;
  if (out.verdict != Verdict::unknown_effect || !(out.baseline_train.value > lost)) return;
  out.warnings.push_back(
      "the baseline does not follow the motion at all (gap " + number(out.baseline_train.value, 2) +
      " on train): its values, and what it leaves, say little of the machine. Without a spring, or in a "
      "loop, small errors of the force add up: try shorter windows, or a baseline that holds what is "
      "surely there");
}

/// Of what is named, or was.
void warn_of_one_motion(const Study& study, const Round& round, Discovery& out) {
  if (!round.names() && round.withdrawn.empty()) return;
  std::vector<Record> all = study.full;
  all.insert(all.end(), study.test.begin(), study.test.end());
  const double omega = one_motion(study, all);
  if (!(omega > 0)) return;
  out.warnings.push_back("all records, the test too, hold one tone (" + number(omega / (2 * M_PI), 3) +
                         " Hz) at one level: laws that part at other levels or frequencies cannot be told apart, and "
                         "more than two names are not given: measure at another level and another frequency");
}

std::string what_is_left(const Discovery& out) {
  char text[100];
  std::snprintf(text, sizeof text, "what is left (gap %.2g on test, %.2g from noise alone)", out.final_test.value,
                out.final_test.floor);
  return text;
}

/// The verdict in a sentence, without its first word; of a Discovery whose verdict, effects, gaps and experiment are
/// there.
std::string sentence(const Study& study, const Round& round, const Discovery& out) {
  const SearchResult& found = round.found;
  const Left& left = round.left;
  char text[160];
  if (out.verdict == Verdict::explained || out.verdict == Verdict::ambiguous) {
    std::string names = words_of(out.effects) + not_physics(found.chosen.choices);
    const bool in_runs = out.short_test.seconds > 0;
    const Gap& last = in_runs ? out.short_test.final : out.final_test;
    const double first = at_most_all(in_runs ? out.short_test.baseline.value : out.baseline_test.value);
    const double excess = first - last.floor;
    const double share = excess > 0 ? (first - last.value) / excess : 0;
    char part[40] = "";
    if (in_runs) std::snprintf(part, sizeof part, ", in runs of %.3g s", out.short_test.seconds);
    std::snprintf(text, sizeof text, ": on data %s%s, %.0f %% of what the noise allows is closed",
                  study.test_is_known ? "that the fit knows" : "not used in the fit", part,
                  100 * std::clamp(share, 0.0, 1.0));
    char open[160] = "";
    if (last.floor > 0 && last.value > 1.5 * last.floor)
      std::snprintf(open, sizeof open, " (%.*f times what noise alone leaves stays open%s)",
                    last.value < 10 * last.floor ? 1 : 0, last.value / last.floor,
                    left.seen ? "" : ", in which generic forces of the motion see nothing");
    std::string said = names;
    for (const Choices& tie : found.ties.rivals) said += " or " + name_of(tie);
    if (!found.ties.rivals.empty()) said += " (this record cannot tell them apart)";
    if (!std::isfinite(out.baseline_test.value))
      return said + ": the baseline cannot be run on the test record, the final model can";
    said += std::string(text) + open;
    if (left.material) said += "; a small repeatable force is left" + in_brackets(left.closure.words());
    return out.experiment.empty() ? said : said + ". To tell: " + sentence_of(out.experiment);
  }
  if (out.verdict == Verdict::nothing_missing && !found.reading.empty()) {
    return what_is_left(out) + " is gone where the force is read " + found.reading +
           ": what a force may do between its samples, such as a controller's part that is held, or channels that are "
           "read a part of a sample apart; no effect is named";
  }
  if (out.verdict == Verdict::nothing_missing) {
    const bool rough = out.final_test.value > 1.5 * out.final_test.floor;
    std::string said = "no effect of the catalogue and no generic force of the motion lowers the left-out gap ";
    if (!round.withdrawn.empty())
      said += "and is confirmed; nearest: " + round.withdrawn;
    else if (!found.as_read.empty())
      said +=
          "beyond what the force may do between its samples, which " + found.as_read.front() + " does no better than";
    else if (const std::string small = below_what_is_asked(study, found); !small.empty())
      said += "enough; " + small;
    else
      said += "beyond chance";
    if (!rough) return said;
    return said + "; " + what_is_left(out) + " is " +
           (round.loose_test ? "no more than three deviations of the parameters make of that record"
                             : "removed by no such force in free runs");
  }
  if (!found.baseline.ran()) return "the baseline cannot be run, and no entry of the catalogue makes it run";
  const std::string nearest = round.withdrawn.empty() ? "" : "; nearest: " + round.withdrawn + by_the_test(round);
  if (!left.seen && round.driven > 0) {
    std::snprintf(text, sizeof text, "%.0f %% of ", 100 * round.driven);
    return text + what_is_left(out) +
           " follows the force linearly: dynamics that the model lacks, such as a further mode, or a part that gives "
           "way between the force and the sensor; no entry of the catalogue explains them" +
           nearest;
  }
  const bool follows = !leaves_motion_open(study, out.final_train) && !far_from_the_floor(out.final_train, 0);
  if (!left.seen && follows && leaves_motion_open(study, out.final_test))
    return "the model follows the training records (gap " + number(out.final_train.value, 2) + ", " +
           number(out.final_train.floor, 2) + " from noise alone) and not the test records (" +
           number(out.final_test.value, 2) + ", " + number(out.final_test.floor, 2) +
           "): these show what the former do not, a larger motion or another band. Train on records like both" +
           nearest;
  if (!left.seen && !leaves_motion_open(study, out.final_train) && !leaves_motion_open(study, out.final_test))
    return what_is_left(out) + " is repeatable, and no entry of the catalogue explains it" + nearest;
  if (!left.seen)
    return "much of the motion is not explained, by no entry of the catalogue nor by generic forces of y and v" +
           nearest;
  return "something repeatable is missing" + in_brackets(left.closure.words()) +
         " that no entry of the catalogue explains" + by_nameless_forces(out) + nearest;
}

/// Two estimates of a parameter are further apart than their deviations allow, and than matters.
bool disagree(const Parameter& a, const Parameter& b) {
  constexpr double deviations = 4, part = 0.05;
  const double apart = std::abs(a.value - b.value);
  return apart > deviations * std::hypot(a.std, b.std) && apart > part * std::abs(b.value);
}

/// Fills a Discovery whose gaps are there.
class Conclusion {
 public:
  Conclusion(const Study& study, const std::vector<Effect>& catalogue, const Round& round, const ModelRuns& runs,
             int tried, const std::function<void(const std::string&, double)>& progress, Discovery& out)
      : study_(study),
        catalogue_(catalogue),
        round_(round),
        runs_(runs),
        tried_(tried),
        progress_(progress),
        out_(out) {}

  void tell() {
    const SearchResult& found = round_.found;
    const std::optional<Place> place = main_place();
    out_.maps_before = maps_at(study_, found.baseline, found.chosen, place);
    name_steps(found);
    out_.verdict = round_.verdict;
    out_.gap_left_out_before = found.baseline.left_out_gap;
    out_.gap_left_out_after = found.chosen.left_out_gap;
    out_.gap_fit = rms_error(found.chosen.fit) / study_.measured_std();
    out_.baseline = fitted(study_, found.baseline);
    out_.final = fitted(study_, found.chosen);
    if (round_.names()) out_.maps_after = maps_at(study_, found.chosen, found.chosen, place);
    const bool hidden =
        out_.maps_before && !out_.maps_before->above_noise && out_.baseline_train.value > 3 * out_.final_train.floor;
    // Physics that explains the record, and a record that lacks nothing, leave no room for a fault of a sensor.
    const bool no_fault = out_.verdict == Verdict::nothing_missing ||
                          (out_.verdict == Verdict::explained &&
                           physics_in(found.chosen.choices) == static_cast<int>(found.chosen.choices.size()));
    out_.where = words_of(out_.maps_before);
    if (hidden) out_.where += " in any one map, though far above it as a whole";
    if (!no_fault) out_.where += sensor_hint(study_, found.baseline);
    for (const auto& [c, by, remark] : found.rivals)
      out_.rivals.push_back({c.name(), rms_error(c.fit) / study_.measured_std(), c.log_likelihood,
                             corrected(improvement_p_value(found.baseline, c)), remark, fitted(study_, c)});
    warn_of_a_lost_baseline(out_);
    warn_of_one_motion(study_, round_, out_);
    warn_of_bounds(found.baseline, found.chosen, out_);
    warn_of_unidentifiable(found.chosen, out_);
    say_what_the_baseline_holds(found.chosen, out_);
    say_what_the_test_has_of_its_own(study_, found.chosen, out_);
    for (const NamedEffect& e : out_.effects)
      if (const std::string words = unit_or_sign(e, out_.baseline); !words.empty()) out_.warnings.push_back(words);
    out_.removable = removable_terms(out_.baseline, found.chosen);
    if (!found.chosen.choices.empty()) {
      progress_("name again on resampled blocks", 0.96);
      out_.naming = bootstrap_naming(study_, found);
    }
    if (out_.verdict == Verdict::ambiguous) progress_("design the experiment that would decide", 0.97);
    design_next(study_, found, out_);
    out_.loop = look_for_loop(study_, found, runs_.after_train);
    if (out_.loop) warn_of_loop(*out_.loop);
    check_by_sundials(study_, found.chosen, out_);
    list_records(study_.full, "train");
    list_records(study_.test, "test");
    compare_all(found, study_.full, runs_.before_train, runs_.after_train, "train");
    compare_all(found, study_.test, runs_.before_test, runs_.after_test, "test");
    out_.map = residual_map(study_, found.baseline, found.chosen, place);
    if (place) out_.map_place = motion_of(*place);
    for (const NamedStep& step : found.steps)
      if (const Effect& effect = *step.added.effect; effect.place)
        out_.forces.push_back(force_of_effect(study_, found.chosen, effect, 0));
    out_.output = study_.output();
    out_.run_length = study_.run_length;
    out_.interpolation = words_of_interpolation(study_);
    out_.solver = study_.imposed ? no_free_run : fixed_solver_name(found.chosen.fit.substeps) + " per sample";
    out_.noise_model = found.whitening.ar.empty()
                           ? "white residual"
                           : "autoregressive residual of order " + std::to_string(found.whitening.ar.size()) +
                                 " on means of " + std::to_string(found.whitening.average) + " rows";
    out_.noise_has_colour = study_.noise_has_colour;
    if (out_.verdict == Verdict::unknown_effect && found.chosen.ran()) {
      progress_("fit forces without a name", 0.98);
      out_.unknown = unknown_force(study_, round_, place, out_.map, out_.final_test);
      if (const auto& left = out_.maps_after ? out_.maps_after : out_.maps_before)
        out_.unknown->harmonics = harmonics_of(*left);
    }
    out_.sentence = sentence(study_, round_, out_);
  }

 private:
  /// For all start points of all rounds, whichever stands.
  double corrected(double p) const { return lunid::corrected(p, tried_); }

  void name_steps(const SearchResult& found) {
    for (std::size_t i = 0; i < found.steps.size(); ++i) {
      const auto& [added, model] = found.steps[i];
      const Candidate& before = i == 0 ? found.baseline : found.steps[i - 1].model;
      const Effect& effect = *added.effect;
      NamedEffect named;
      named.name = effect.name;
      named.family = effect.family;
      named.formula = formula_at(added.form().formula, effect.place);
      named.sentence = effect.sentence;
      named.label = effect.label();
      if (effect.place) named.place = motion_of(*effect.place);
      named.where = words_of(i == 0 ? out_.maps_before : maps_at(study_, before, found.chosen, effect.place));
      named.parameters = own_parameters(found.chosen, added);
      const bool last = i + 1 == found.steps.size();
      named.gap_train =
          last ? out_.final_train.value : pool_gap(runs(study_, model, study_.full, false), runs_.share).value;
      named.gap_test =
          last ? out_.final_test.value : pool_gap(runs(study_, model, study_.test, false), runs_.share).value;
      named.p_value = corrected(improvement_p_value(before, model));
      if (last) {
        for (const Choices& tie : found.ties.rivals) named.indistinguishable.push_back(name_of(tie));
        named.same_force = found.ties.aliases;
      }
      if (found.steps.size() > 1)
        for (const Choices& tie : found.ties.rivals)
          if (std::string other = in_place_of(effect, found.chosen.choices, tie); !other.empty())
            named.indistinguishable.push_back(std::move(other));
      for (std::string& other : in_other_words(added)) {
        const bool is_told = std::ranges::find(named.indistinguishable, other) != named.indistinguishable.end() ||
                             std::ranges::find(named.same_force, other) != named.same_force.end();
        if (!is_told) named.same_force.push_back(std::move(other));
      }
      named.indistinguishable.insert(named.indistinguishable.end(), named.same_force.begin(), named.same_force.end());
      out_.effects.push_back(std::move(named));
    }
  }

  /// Entries of which this one is a special case with as many parameters: one force in two notations, on any record.
  std::vector<std::string> in_other_words(const Choice& choice) const {
    std::vector<std::string> out;
    for (const Effect& general : catalogue_)
      if (choice.is_special_case({&general, 0}) && parameters_of(general, 0).size() == choice.parameters().size())
        out.push_back(general.label());
    return out;
  }

  /// What a tied set has where the chosen one has this effect: "constant_force" for "displacement_offset" of
  /// "displacement_offset + coulomb_friction" and "constant_force + coulomb_friction"; else "".
  static std::string in_place_of(const Effect& effect, const Choices& chosen, const Choices& tie) {
    const Choices own = beyond(chosen, tie), others = beyond(tie, chosen);
    return own.size() == 1 && others.size() == 1 && own.front().effect == &effect ? name_of(others) : "";
  }

  /// The entry's parameters from the final model, under their own short names.
  static std::vector<Parameter> own_parameters(const Candidate& final_model, const Choice& choice) {
    std::vector<Parameter> out;
    const Model model = fitted(final_model);
    for (const auto& p : choice.parameters()) {
      out.push_back(*model.find(p.name));
      out.back().name = own_name(*choice.effect, p.name);
    }
    return out;
  }

  static std::string words_of(const std::optional<ResidualMaps>& maps) {
    return maps ? maps->sentence : no_residual_maps;
  }

  /// Where the loop has biased the fit.
  void warn_of_loop(const ClosedLoop& loop) {
    for (const Parameter& p : loop.by_instruments)
      if (const Parameter* fit = out_.final.find(p.name); disagree(p, *fit)) {
        char text[200];
        std::snprintf(text, sizeof text, "%s is %.4g by the fit and %.4g with %s as instrument: ", p.name.c_str(),
                      fit->value, p.value, loop.reference.c_str());
        out_.warnings.push_back(text + std::string("the loop has biased the fit, or the model lacks something"));
      }
  }

  /// With several coordinates: where the first effect was named, or generic forces see most.
  std::optional<Place> main_place() const {
    if (round_.names()) return round_.found.steps.front().added.effect->place;
    if (study_.degrees() == 1) return {};
    return round_.left.closure.place.value_or(Place{});
  }

  /// Short runs of one record follow each other.
  void list_records(const std::vector<Record>& records, const std::string& role) {
    const std::size_t first = out_.records.size();
    double begin = 0;
    int part = 0;
    for (const Record& r : records) {
      const bool same = study_.run_length > 0 && out_.records.size() > first &&
                        out_.records.back().record == r.name() && r.part() == part && r.start() > begin;
      if (!same) {
        begin = r.start();
        part = r.part();
        const int joined = role == "train" ? joined_rows(r) : 1;
        out_.records.push_back({r.name(), role, r.words_of_part(), 0, 0, 1 / r.dt(), 0, joined});
      }
      RecordUsed& used = out_.records.back();
      used.rows += r.rows();
      used.seconds = r.start() + r.duration() - begin;
      ++used.runs;
    }
  }

  int joined_rows(const Record& of) const {
    for (std::size_t i = 0; i < study_.train.size(); ++i) {
      const Record& fitted = study_.train[i].record;
      if (study_.recorded[i] && fitted.name() == of.name()) return static_cast<int>(std::lround(fitted.dt() / of.dt()));
    }
    return 1;
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

  const Study& study_;
  const std::vector<Effect>& catalogue_;
  const Round& round_;
  const ModelRuns& runs_;
  const int tried_;
  const std::function<void(const std::string&, double)>& progress_;
  Discovery& out_;
};

}  // namespace

void conclude(const Study& study, const std::vector<Effect>& catalogue, const Round& round, const ModelRuns& runs,
              int tried, const std::function<void(const std::string&, double)>& progress, Discovery& out) {
  Conclusion(study, catalogue, round, runs, tried, progress, out).tell();
}

}  // namespace lunid
