#include "discover/conclusion.hpp"

#include <algorithm>
#include <cmath>

#include "discover/sensor.hpp"

namespace lunid {

namespace {

/// Which of the named effects are faults of a sensor or of the input: "" where all are physics.
std::string not_physics(const Choices& named) {
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

/// What lowers the left-out gap beyond chance, though by less than is asked of a name: the best such rival, and by how
/// much.
std::string below_the_least_gain(const Study& study, const SearchResult& found) {
  constexpr std::size_t most = 5;
  constexpr double chance = 0.01;
  std::string name;
  double best = found.baseline.left_out_gap;
  for (std::size_t i = 0; i < std::min(most, found.rivals.size()); ++i) {
    Candidate rival = found.rivals[i];
    if (corrected(improvement_p_value(found.baseline, rival), found.grown.tried) > study.options->alpha) continue;
    if (rival.left_out.size() == 0) run_left_out(study, rival);
    if (!(rival.left_out_gap < best && left_out_p_value(study, found.baseline, rival) < chance)) continue;
    best = rival.left_out_gap;
    name = rival.name();
  }
  const double gain = 1 - best / found.baseline.left_out_gap;
  if (name.empty() || gain >= study.options->minimum_gain) return "";
  char text[160];
  std::snprintf(text, sizeof text, " lowers it beyond chance, but by %.2g %%: less than the least gain of %.2g %%",
                100 * gain, 100 * study.options->minimum_gain);
  return name + text;
}

/// What the forces without a name do on the test records; "" where they do not lower the gap there.
std::string by_generic_forces(const Study& study, const Left& left, const Gap& without) {
  if (!left.closure.system || !std::isfinite(left.closure.fit.cost)) return "";
  const double with = pool_gap(runs(study, *left.closure.system, left.closure.fit, study.test, false), 0).value;
  if (!(with < without.value)) return "";
  char text[120];
  std::snprintf(text, sizeof text, "; forces without a name lower the gap on test from %.2g to %.2g", without.value,
                with);
  return text;
}

}  // namespace

void design_next(const Study& study, const SearchResult& found, Discovery& out) {
  const ExperimentOptions options = same_experiment(study);
  out.same_experiment = options;
  out.same_experiment.cancelled = nullptr;  // it outlives the run
  const bool driven = study.imposed || options.limits.force > 0;
  if (out.verdict != "ambiguous" || !driven || study.forces.size() > 1) return;
  std::vector<Model> models{out.final};
  std::vector<std::string> names{found.chosen.name()};
  for (const Rival& rival : out.rivals) {
    if (!holds_name(found.ties.rivals, rival.name)) continue;
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

void warn_of_bounds(const Candidate& c, Discovery& out) {
  const auto& table = c.system->model().parameters;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (i < c.fit.at_bound.size() && c.fit.at_bound[i] && !table[i].fixed)
      out.warnings.push_back("parameter " + table[i].name + " sits at its bound " +
                             std::to_string(c.fit.theta[static_cast<Eigen::Index>(i)]));
}

void check_by_sundials(const Study& study, const Candidate& c, Discovery& out) {
  if (study.imposed || !c.ran()) return;
  const auto& record = study.train.front().record;
  const auto& segment = c.fit.segments.front();
  const Eigen::Index rows = std::min<Eigen::Index>(record.rows(), 2000);
  SimulateOptions options;
  options.solver = Solver::fixed;
  options.substeps = c.fit.substeps;
  const std::span<const double> theta(c.fit.theta.data(), static_cast<std::size_t>(c.fit.theta.size()));
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

std::string sentence(const Study& study, const Round& round, const Discovery& out) {
  const SearchResult& found = round.found;
  const Left& left = round.left;
  char text[160];
  if (out.verdict == "explained" || out.verdict == "ambiguous") {
    std::string names;
    for (const auto& e : out.effects) names += (names.empty() ? "" : " and ") + e.label;
    names += not_physics(found.order);
    const bool in_runs = out.short_test.seconds > 0;
    const Gap& last = in_runs ? out.short_test.final : out.final_test;
    const double first = at_most_all(in_runs ? out.short_test.baseline.value : out.baseline_test.value);
    const double excess = first - last.floor;
    const double share = excess > 0 ? (first - last.value) / excess : 0;
    char part[40] = "";
    if (in_runs) std::snprintf(part, sizeof part, ", in runs of %.3g s", out.short_test.seconds);
    std::snprintf(text, sizeof text, ": on data not used in the fit%s, %.0f %% of what the noise allows is closed",
                  part, 100 * std::clamp(share, 0.0, 1.0));
    std::string said = names;
    for (const Choices& tie : found.ties.rivals) said += " or " + name_of(tie);
    if (!found.ties.rivals.empty()) said += " (this record cannot tell them apart)";
    if (!std::isfinite(out.baseline_test.value))
      return said + ": the baseline cannot be run on the test record, the final model can";
    if (left.material)
      said += std::string(text) + "; a small repeatable force is left (" + left.closure.words() + ")";
    else
      said += text;
    return out.experiment.empty() ? said : said + ". To tell: " + sentence_of(out.experiment);
  }
  if (out.verdict == "nothing-missing" && !found.reading.empty()) {
    std::snprintf(text, sizeof text, "what is left (gap %.2g on test, %.2g from noise alone) ", out.final_test.value,
                  out.final_test.floor);
    return text + std::string("is gone where the force is read ") + found.reading +
           ": what a force may do between its samples, such as a controller's part that is held; no effect is named";
  }
  if (out.verdict == "nothing-missing") {
    std::snprintf(text, sizeof text,
                  "; what is left (gap %.2g on test, %.2g from noise alone) is removed by no such force in free runs",
                  out.final_test.value, out.final_test.floor);
    const bool rough = out.final_test.value > 1.5 * out.final_test.floor;
    std::string said = "no effect of the catalogue and no generic force of the motion lowers the left-out gap ";
    if (!round.withdrawn.empty())
      said += "and is confirmed; nearest: " + round.withdrawn;
    else if (!found.as_read.empty())
      said += "beyond what the force may do between its samples, which " + found.as_read.front() + " does no better than";
    else if (const std::string small = below_the_least_gain(study, found); !small.empty())
      said += "enough; " + small;
    else
      said += "beyond chance";
    return said + (rough ? text : "");
  }
  if (!found.baseline.ran()) return "the baseline cannot be run, and no entry of the catalogue makes it run";
  const std::string nearest = round.withdrawn.empty() ? "" : "; nearest: " + round.withdrawn;
  if (!left.seen)
    return "much of the motion is not explained, by no entry of the catalogue nor by generic forces of y and v" +
           nearest;
  return "something repeatable is missing (" + left.closure.words() + ") that no entry of the catalogue explains" +
         by_generic_forces(study, left, out.final_test) + nearest;
}

}  // namespace lunid
