#include "discover/refute.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "discover/baseline.hpp"
#include "discover/judge.hpp"
#include "discover/locate.hpp"
#include "discover/proposal_fits.hpp"
#include "statistics/distributions.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

bool test_shows_structure(const Study& study, const Candidate& model, const Whitening& whitening) {
  Study own = study;
  own.full = study.test;
  own.train.clear();
  for (const Record& record : study.test) own.train.push_back(fit_data(study, record));
  smooth_all(own);
  Candidate c = model;
  c.fit = fit_trajectory(*c.system, model.fit.theta, own.train, full_fit(study, 20));
  judge(own, c, whitening);
  run_left_out(own, c);
  return look_for_structure(own, c, runs(own, c, own.full), whitening).material;
}

bool gone_on_test(const Study& study, const Round& round, const std::vector<FreeRun>& before) {
  const Closure& closure = round.left.closure;
  if (closure.fit.theta.size() == 0 || !std::isfinite(closure.fit.cost)) return false;
  const std::vector<FreeRun> with = runs(study, *closure.system, closure.fit, study.test, false);
  return std::isfinite(pool_gap(with, 0).value) && !lowers_the_gap(study, before, with) &&
         !test_shows_structure(study, round.found.chosen, round.found.whitening);
}

double test_p_value(const Study& study, const std::vector<FreeRun>& before, const std::vector<FreeRun>& after) {
  std::vector<double> a, b;
  for (std::size_t r = 0; r < before.size(); ++r) {
    const Record& record = study.test[r / study.outputs().size()];
    const double weight = study.weights(record)[r % study.outputs().size()];
    const auto channel = record[before[r].output];
    if (!after[r].cause.empty()) return 1;
    if (!before[r].cause.empty()) return 0;
    for (Eigen::Index i = before[r].lead; i < before[r].model.size(); ++i) {
      a.push_back(weight * (channel[static_cast<std::size_t>(i)] - before[r].model[i]));
      b.push_back(weight * (channel[static_cast<std::size_t>(i)] - after[r].model[i]));
    }
  }
  return p_value_of_lower_error(a, b, bootstrap_block(study), study.options->seed);
}

namespace {

/// What three deviations of the parameters do not explain of a gap on the test records.
Gap beyond_parameters(const Study& study, const Candidate& model, Gap gap) {
  const double spread = parameter_spread(study, model, study.test);
  gap.value = std::sqrt(std::max(0.0, gap.value * gap.value - 9 * spread * spread));
  return gap;
}

}  // namespace

bool hangs_on_parameters(const Study& study, const Candidate& model, const Gap& train, const Gap& test) {
  constexpr double followed = 1.5;  // times the floor
  return leaves_motion_open(study, test) && train.value < followed * train.floor &&
         !leaves_motion_open(study, beyond_parameters(study, model, test));
}

namespace {

bool surely_lowers(const Study& study, double p_value, const std::vector<FreeRun>& before,
                   const std::vector<FreeRun>& after) {
  return lowers_the_gap(study, before, after) && p_value < 0.2;
}

/// A friction that does more work on the motion than it takes from it, along the first training record.
const Effect* friction_that_drives(const Study& study, const Candidate& named) {
  if (!named.ran()) return nullptr;
  for (const Choice& choice : named.choices) {
    if (choice.effect->family != "friction") continue;
    const Eigen::VectorXd force = named_force(study, named, *choice.effect, 0);
    if (force.dot(motion_at(study.smooth.front(), choice.effect->place, 'v')) < 0) return choice.effect;
  }
  return nullptr;
}

}  // namespace

std::string refuted(const Study& study, const Round& round, double p_value, const std::vector<FreeRun>& before,
                    const std::vector<FreeRun>& after) {
  const Left& left = round.left;
  const Gap first = round.gap(before), last = round.gap(after);
  if (!std::isfinite(last.value)) return "cannot be run on the test record";
  if (!surely_lowers(study, p_value, before, after)) return "did not lower the gap on the test record";
  // Far above the floor with a good part of the motion still open, of several names a smaller one: they patch
  // something else.
  const std::size_t names = round.found.chosen.choices.size();
  const double part = 0.2 / static_cast<double>(names);
  const auto shapes = std::max<std::ptrdiff_t>(1, std::ranges::count_if(round.found.chosen.choices, has_shape));
  const bool far = leaves_motion_open(study, last, 1.0 / static_cast<double>(shapes)) &&
                   last.value - last.floor > part * (at_most_all(first.value) - last.floor);
  const double closed = closed_share(first.value, last.value, last.floor);
  if (far || (last.value > 3 * last.floor && closed < 1 - 0.5 * part) ||
      (last.value > 1.5 * last.floor && closed < 0.5))
    return "left much of the gap on the test record open";
  constexpr double beyond_chance = 0.3;  // light damping answers for longer than the segments of a coherence
  const bool closes_most = closed >= most_closed(round.found.chosen.choices);
  if (!closes_most && lacks_dynamics(study, left.gap, last, round.train, after, beyond_chance) > 0)
    return "left much that follows the force and is no noise";
  // Several forces that follow the training motion as a series follows a curve, and leave it beyond: of three and more
  // all that is above the floor counts.
  const double at_the_floor =
      names > 2 ? std::max(1.1 * last.floor, last.floor + 3 * last.floor_std) : 1.5 * last.floor;
  const bool follows_a_curve = springs_among(round.found.chosen.choices) > 1 && left.material;
  const bool all_closed = closed >= 0.998 && !follows_a_curve;
  // Of two, what the parameters' deviations make of the test counts for nothing: light damping that a jump hangs on.
  // One that is misplaced has wide deviations of its own, and a series always has.
  const bool followed = left.gap.value < 1.3 * left.gap.floor;
  const bool spread = names == 2 && !all_closed && (followed || !follows_a_curve) && last.value > at_the_floor;
  const double unexplained = spread ? beyond_parameters(study, round.found.chosen, last).value : last.value;
  const bool patchwork = names > 1 && unexplained > at_the_floor && !all_closed;
  if (patchwork && followed)
    return "fitted the training records down to their noise by several forces, but not the test record";
  const double deviations = last.value > 3 * last.floor ? 2 : 3;
  if (last.value > 1.5 * last.floor || left.material) {
    if (feeds_the_motion(round.found.baseline, round.found.chosen, deviations))
      return "left something open, and made the baseline's own damping negative";
    if (takes_the_mass(round.found.baseline, round.found.chosen))
      return "left something open, and took the mass away that the baseline has";
    if (const Effect* friction = friction_that_drives(study, round.found.chosen))
      return "left something open, and has a " + friction->name + " that drives the motion";
  }
  if (names == 1 && followed && last.value > 3 * last.floor &&
      far_from_the_floor(beyond_parameters(study, round.found.chosen, last), little_open))
    return "fitted the training records down to their noise, but not the test record";
  if (last.value > 1.5 * last.floor && closed < 0.8) return "left a good part of the gap on the test record open";
  if (names > 2 && last.value > at_the_floor && left.material)
    return "left a repeatable force beside several: they follow another one";
  if (names > 2 && last.value > 3 * last.floor && !all_closed) return "left far more than noise on the test record";
  if (!left.seen || !(unexplained > (left.material ? 1.5 : 3) * last.floor)) return "";
  if (left.whole && !all_closed) return "left a force that is repeatable";
  if (closes_most) return "";  // names that close most stand beside what is left, which is told
  const Gap generic = round.gap(runs(study, *left.closure.system, left.closure.fit, study.test, false));
  return generic.value < 0.5 * last.value ? "did far worse on the test record than forces without a name" : "";
}

std::optional<Round> borne_out(const Study& study, const Round& round) {
  const std::optional<Candidate>& faint = round.found.faint;
  if (round.names() || !faint || !round.found.reading.empty()) return {};
  const Candidate& baseline = round.found.baseline;
  const std::vector<FreeRun> before = runs(study, baseline, study.test);
  const Gap first = round.gap(before);
  if (!far_from_the_floor(first, little_open) || hangs_on_parameters(study, baseline, round.gap(round.train), first))
    return {};
  Round out = round;
  SearchResult& found = out.found;
  name_steps(study, found, {{faint->choices.front(), *faint}});
  std::vector<const Candidate*> others;
  for (const Beaten& rival : round.found.rivals)
    if (rival.model.choices.size() == 1) others.push_back(&rival.model);
  found.ties = find_ties(study, baseline, found.chosen, others);
  out.train = runs(study, found.chosen, study.full);
  out.left = look_for_structure(study, found.chosen, out.train, found.whitening);
  const std::vector<FreeRun> after = runs(study, found.chosen, study.test);
  const double p_value = test_p_value(study, before, after);
  const Gap last = out.gap(after);
  const bool whole = closed_share(first.value, last.value, last.floor) >= most_closed(found.chosen.choices);
  if (!whole || !(p_value < study.options->alpha) || !refuted(study, out, p_value, before, after).empty()) return {};
  out.verdict = found.ties.verdict();
  return out;
}

namespace {

/// Tied with what is named, or a more general form of it: that one follows the training records as well.
bool may_stand_instead(const SearchResult& found, const Candidate& rival) {
  return holds_name(found.ties.rivals, rival.name()) ||
         std::ranges::find(found.ties.aliases, rival.name()) != found.ties.aliases.end() ||
         is_general_form(rival.choices, found.chosen.choices);
}

}  // namespace

std::vector<TiedRival> tied_that_stand(const Study& study, const Study& tested, const Round& round,
                                       const std::vector<FreeRun>& before) {
  std::vector<TiedRival> standing;
  if (round.found.chosen.choices.size() != 1) return standing;
  for (const auto& [rival, by, remark] : round.found.rivals) {
    if (rival.choices.size() != 1 || !may_stand_instead(round.found, rival)) continue;
    Round other;
    other.found.baseline = round.found.baseline;
    other.found.chosen = rival;
    other.found.whitening = round.found.whitening;
    run_left_out(study, other.found.chosen);
    other.train = runs(study, rival, study.full);
    other.left = look_for_structure(study, rival, other.train, round.found.whitening);
    std::vector<FreeRun> after = runs(tested, rival, tested.test);
    const double p_value = test_p_value(tested, before, after);
    if (!refuted(tested, other, p_value, before, after).empty()) continue;
    standing.push_back(
        {std::move(other.found.chosen), std::move(other.left), std::move(other.train), std::move(after), p_value});
  }
  const auto is_worse = [&](const TiedRival& a) {
    return std::ranges::any_of(
        standing, [&](const TiedRival& b) { return test_p_value(tested, a.test, b.test) < study.options->alpha; });
  };
  std::vector<TiedRival> out;
  std::ranges::copy_if(standing, std::back_inserter(out), std::not_fn(is_worse));
  return out;
}

std::optional<FitToAll> fit_to_all(const Study& study, const Round& round, double p_value,
                                   const std::vector<FreeRun>& before, const std::vector<FreeRun>& after) {
  const Candidate& chosen = round.found.chosen;
  const bool open = !unidentifiable(chosen).empty();
  if (springs_among(chosen.choices) > 1 || !(open || surely_lowers(study, p_value, before, after))) return {};
  std::vector<FitData> all = study.train;
  for (const Record& record : study.test) all.push_back(fit_data(study, record));
  Candidate model = chosen;
  model.fit = fit_trajectory(*model.system, model.fit.theta, all, full_fit(study, 40));
  if (!std::isfinite(model.fit.cost) || feeds_the_motion(round.found.baseline, model)) return {};
  FitToAll out{round.gap(runs(study, model, study.test)), {}};
  if (!(out.test.value < std::max(1.1 * out.test.floor, out.test.floor + 3 * out.test.floor_std))) return {};
  double ratio = 1;
  if (open) {  // first states are more than half of a decay: they are fitted for both, and steps do not go along theta
    out.settled = fit_near(study, chosen, model.fit.theta, 12, chosen.fit.substeps);
    ratio = rms_error(*out.settled) / rms_error(chosen.fit);
  } else {
    ratio = round.gap(runs(study, model, study.full, false)).value / round.gap(round.train).value;
  }
  // chi-square of the parameters where they are the same
  const double rise = chosen.fit.freedom * (ratio * ratio - 1);
  if (!(chi_square_tail(std::max(0.0, rise), model.parameters()) > study.options->alpha / 10)) return {};
  return out;
}

std::size_t steps_that_stand(const Study& study, const Round& round, const std::vector<FreeRun>& before) {
  // Of the motion: three and more that followed another force did so from the first.
  constexpr double hardly_open = 0.02;
  const SearchResult& found = round.found;
  const Gap first = round.gap(before);
  const double least = round.left.material && found.steps.size() > 2 ? hardly_open : little_open;
  for (std::size_t count = found.steps.size(); count-- > 1;) {
    const Candidate& step = found.steps[count - 1].model;
    const std::vector<FreeRun> after = runs(study, step, study.test);
    const Gap last = round.gap(after);
    const bool closes = std::isfinite(last.value) &&
                        closed_share(first.value, last.value, last.floor) > most_closed(step.choices) &&
                        test_p_value(study, before, after) < 0.05;
    const Candidate& before_it = count > 1 ? found.steps[count - 2].model : found.baseline;
    if (!closes || !told_from_zero(study, step, before_it) ||
        (last.value > 1.5 * last.floor && test_shows_structure(study, step, found.whitening)))
      continue;
    if (!far_from_the_floor(last, least)) return count;
    // Its own fit took up what the training records have of their own: beside the names that are taken back it did not.
    FitResult beside = step.fit;
    beside.theta = values_of(step, {&found.chosen});
    if (!far_from_the_floor(round.gap(runs(study, *step.system, beside, study.test)), least)) return count;
  }
  return 0;
}

std::size_t steps_that_help(const Study& study, const Round& round, const std::vector<FreeRun>& after) {
  constexpr double neither = 0.005;  // better nor worse
  const std::vector<NamedStep>& steps = round.found.steps;
  std::size_t count = steps.size();
  for (Gap with = round.gap(after); count > 1; --count) {
    const Gap without = round.gap(runs(study, steps[count - 2].model, study.test, false));
    const bool raised = without.value < (1 - neither) * with.value;
    const bool open = without.value > 1.5 * with.floor && closed_share(without.value, with.value, with.floor) < 0.5;
    if (!raised && !open) break;
    with.value = without.value;
  }
  return count;
}

}  // namespace lunid
