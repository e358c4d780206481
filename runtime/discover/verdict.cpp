#include "discover/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>
#include <string>

#include "discover/accept.hpp"
#include "discover/baseline.hpp"
#include "discover/closed_loop.hpp"
#include "discover/judge.hpp"
#include "discover/locate.hpp"
#include "discover/one_motion.hpp"
#include "discover/proposal_fits.hpp"
#include "statistics/distributions.hpp"
#include "statistics/statistics.hpp"

namespace lunid {
std::vector<FreeRun> runs(const Study& study, const System& system, const FitResult& fit,
                          const std::vector<Record>& records, bool floor) {
  std::vector<FreeRun> out;
  for (const auto& r : records)
    for (FreeRun& run : free_run(study, system, fit.theta, r, std::max(1, fit.substeps), floor))
      out.push_back(std::move(run));
  return out;
}

namespace {

/// The parameters, from 0, that are the same in all records.
std::vector<int> shared_parameters(const Candidate& c) {
  std::set<std::string> separate;
  for (const Choice& choice : c.choices)
    if (choice.effect->separate)
      for (const Parameter& p : choice.parameters()) separate.insert(p.name);
  std::vector<int> out;
  for (int i = 0; i < c.parameters(); ++i)
    if (!separate.contains(c.system->model().parameters[static_cast<std::size_t>(i)].name)) out.push_back(i);
  return out;
}

}  // namespace

std::vector<FreeRun> runs(const Study& study, const Candidate& c, const std::vector<Record>& records, bool floor) {
  std::vector<FreeRun> out;
  for (const Record& record : records)
    std::ranges::move(
        free_run(study, *c.system, theta_on(study, c, record), record, std::max(1, c.fit.substeps), floor),
        std::back_inserter(out));
  return out;
}

Eigen::VectorXd theta_on(const Study& study, const Candidate& c, const Record& record) {
  const std::vector<int> shared = shared_parameters(c);
  if (shared.size() == static_cast<std::size_t>(c.parameters()) || !c.ran() || study.imposed || study.run_length > 0)
    return c.fit.theta;
  FitOptions options = fixed_fit(study, 20, 1e-6, std::max(1, c.fit.substeps));
  options.hold = shared;
  const FitResult own = fit_trajectory(*c.system, c.fit.theta, {fit_data(study, record)}, options);
  return std::isfinite(own.cost) ? own.theta : c.fit.theta;
}

namespace {

/// Of the generic forces as they were fitted: what their slopes at zero promise is another thing where they bend the
/// run.
double left_out_gap(const Study& study, const Closure& closure) {
  Candidate generic;
  generic.system = closure.system;
  generic.fit = closure.fit;
  run_left_out(study, generic);
  return generic.left_out_gap;
}

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::explained: return "explained";
    case Verdict::nothing_missing: return "nothing-missing";
    case Verdict::ambiguous: return "ambiguous";
    case Verdict::unknown_effect: return "unknown-effect";
  }
  return "";
}

Left look_for_structure(const Study& study, const Candidate& c, const std::vector<FreeRun>& train,
                        const Whitening& whitening) {
  // Fitted forces follow a disturbance a good way, over rows that they were not fitted to as well where the motion is
  // lightly damped.
  constexpr double beyond_disturbances = 0.75;
  Left left;
  left.gap = pool_gap(train, 0);
  left.closure = test_closure(study, c, whitening);
  if (!(left.closure.p_value < study.options->alpha / 10)) return left;
  fit_closure(study, c, left.closure);
  if (!c.choices.empty()) refine_closure(study, whitening, left.closure);
  if (!std::isfinite(left.closure.fit.cost)) return left;
  const Gap& now = left.gap;
  const auto with_closure = [&](bool floor) {
    return pool_gap(runs(study, *left.closure.system, left.closure.fit, study.full, floor), 0);
  };
  const Gap with = with_closure(false);
  left.seen = !std::isfinite(now.value) || closed_share(now.value, with.value, now.floor) > 0.5;
  // A model that is at the floor lacks nothing that could be seen, whatever a finer colour of the noise would say. Of
  // names this may be chance: the floor is known to some percent, and they were chosen to be near it.
  const bool above = !(now.value <= now.floor + 3 * now.floor_std), named = !c.choices.empty();
  const double least = study.options->minimum_gain;
  const bool doubtful = !named || !above || left.closure.gain <= least;
  if (left.seen && doubtful && std::isfinite(c.left_out_gap) && c.left_out_gap > 0) {
    const double with_generic = left_out_gap(study, left.closure);
    const double closed = closed_share(c.left_out_gap, with_generic, study.noise_gap());
    left.closure.gain = named || closed > beyond_disturbances ? 1 - with_generic / c.left_out_gap : 0;
  }
  left.material = left.seen && (above || named) && left.closure.gain > least;
  const bool far_above = now.value > 3 * now.floor && closed_share(now.value, with.value, now.floor) > 0.9;
  left.whole = left.material && (far_above || with.value < 1.5 * with_closure(true).floor);
  return left;
}

namespace {

/// Of the squared excess, by names that stand beside a small repeatable force: each has to leave less where they are
/// several, and two springs nothing to speak of, which follow a curve of another kind as a series does.
double most_closed(const Choices& names) {
  if (springs_among(names) > 1) return 0.998;
  return 1 - 0.05 / static_cast<double>(std::max<std::size_t>(1, names.size()));
}

constexpr double much_open = 0.15;    ///< of the motion
constexpr double little_open = 0.05;  ///< the same where less is asked for

}  // namespace

bool is_loose_series(const Choices& names, const Gap& train, double closed) {
  return springs_among(names) > 1 && train.value > 1.5 * train.floor && closed < most_closed(names);
}

bool far_from_the_floor(const Gap& gap, double least, double times) {
  return !(gap.value < std::max(times * gap.floor, least));
}

bool leaves_motion_open(const Study& study, const Gap& gap, double part) {
  const bool decays = !study.imposed && are_free(study, study.full) && are_free(study, study.test);
  // A floor that was read off what is left itself holds what a force outside the catalogue makes beside the motion's
  // band.
  return far_from_the_floor(gap, part * (decays ? little_open : much_open), study.noise_has_colour ? 1.5 : 3);
}

double lacks_dynamics(const Study& study, const Gap& train, const Gap& test, const std::vector<FreeRun>& train_runs,
                      const std::vector<FreeRun>& test_runs, double least) {
  if (!far_from_the_floor(train, little_open) || !far_from_the_floor(test, little_open)) return 0;
  const double of_train = driven_part(study, train_runs, study.full);
  if (!(of_train > least)) return 0;
  const double driven = std::min(of_train, driven_part(study, test_runs, study.test));
  return driven > least && !(answer_of_force(study, train_runs) > 0) ? driven : 0;
}

bool lowers_the_gap(const Study& study, const std::vector<FreeRun>& before, const std::vector<FreeRun>& after) {
  const double first = pool_gap(before, 0).value, last = pool_gap(after, 0).value;
  return !std::isfinite(first) || last < (1 - 0.5 * study.options->minimum_gain) * first;
}

namespace {

/// Several names that leave the training records far above their noise, of which none closes most of what all close:
/// another force, followed. `before`: the baseline's gap over the training records.
bool is_patchwork(const Study& study, const Round& round, double before) {
  const SearchResult& found = round.found;
  const Gap after = round.gap(round.train);
  if (found.steps.size() < 2 || !far_from_the_floor(after, little_open)) return false;
  const auto closes = [&](double gap) { return closed_share(before, gap, after.floor); };
  const double first = pool_gap(runs(study, found.steps.front().model, study.full, false), 0).value;
  return closes(first) < 0.8 * closes(after.value);
}

/// Of the squared excess, by the names: over left-out blocks, whose first states are fitted to each; or in runs over
/// whole training records, where those leave hardly anything of the motion. A free decay that falls behind is far off
/// in the end, which blocks do not show. `before`: the baseline's gap over these.
double share_closed(const Study& study, const Round& round, double before) {
  constexpr double hardly_open = 0.01;
  const SearchResult& found = round.found;
  if (!std::isfinite(found.baseline.left_out_gap)) return 1;
  const double of_blocks = closed_share(found.baseline.left_out_gap, found.chosen.left_out_gap, study.noise_gap());
  const Gap after = round.gap(round.train);
  if (!round.names() || far_from_the_floor(after, hardly_open)) return of_blocks;
  return std::max(of_blocks, closed_share(before, after.value, after.floor));
}

/// A damper of the baseline itself that feeds the motion beside the names, beyond chance, and did not alone.
bool feeds_the_motion(const Candidate& baseline, const Candidate& named, double deviations = 3) {
  for (const Eigen::Index j : turned_negative(baseline, named, deviations)) {
    const Model& model = baseline.system->model();
    const Expr of = model.pool->parameter(model.parameters[static_cast<std::size_t>(j)].name);
    for (int i = 0; i < model.degrees(); ++i)
      if (derivative(model.coordinate(i).restoring, of) == model.pool->channel(model.channel('v', i))) return true;
  }
  return false;
}

/// Linear in the motion and in its own states, at any time alike.
bool is_linear_in_motion(const Choice& choice) {
  std::vector<Expr> parts{choice.form().force};
  for (const InternalState& state : states_of(*choice.effect, choice.variant)) parts.push_back(state.rate);
  const auto moves = [](Expr x) { return x.kind() != SymbolKind::parameter; };
  const auto is_linear = [&](Expr part) {
    return part.valid() && std::ranges::all_of(symbols(part), [&](Expr x) {
             return !moves(x) || std::ranges::none_of(symbols(derivative(part, x)), moves);
           });
  };
  return std::ranges::all_of(parts, is_linear);
}

/// What keeps names that close this share of the squared excess from being the answer; or "". `before`: the baseline's
/// gap over the training records.
std::string why_no_explanation(const Study& study, const Round& round, double before, double closed) {
  const Candidate& named = round.found.chosen;
  const bool several = named.choices.size() > 1;
  if (named.degenerate()) return "a parameter sits where the effect is another one, or none";
  if (several && !sizes_are_told(study, named))
    return "the size of one of them is not told from zero beside another term";
  if (several && std::ranges::all_of(named.choices, is_linear_in_motion) &&
      feeds_the_motion(round.found.baseline, named))
    return "linear forces beside a damper of the baseline that drives the motion follow what acts late";
  if (closed >= most_closed(named.choices)) return "";
  const std::string words = round.left.closure.words();
  if (round.left.material) return "leaves a repeatable force" + (words.empty() ? "" : ": " + words);
  if (is_patchwork(study, round, before))
    return "several forces that leave this far above the noise follow another one";
  return "";
}

}  // namespace

void decide(const Study& study, Round& round) {
  SearchResult& found = round.found;
  round.train = runs(study, found.chosen, study.full);
  const std::vector<FreeRun> of_baseline =
      round.names() ? runs(study, found.baseline, study.full, false) : std::vector<FreeRun>();
  if (round.names() && !lowers_the_gap(study, of_baseline, round.train)) {
    withdraw(round, Beaten::By::training, "does not lower the gap of the training record");
    round.train = runs(study, found.chosen, study.full);
  }
  const double before = pool_gap(of_baseline, 0).value;
  const double closed = share_closed(study, round, before);
  const Choices& names = found.chosen.choices;
  const bool one_loop = names.size() > 2 && one_motion(study, study.full) > 0;
  const bool series = one_loop || is_series(names) || is_loose_series(names, round.gap(round.train), closed);
  if (series) {
    withdraw(round, Beaten::By::training,
             one_loop ? "several forces that follow one loop at one level"
                      : "a curve of another kind, followed as by a series");
    round.train = runs(study, found.chosen, study.full);
  }
  round.left = look_for_structure(study, found.chosen, round.train, found.whitening);
  if (series) {
    round.verdict = Verdict::unknown_effect;
  } else if (!round.names()) {
    const bool open = round.left.material || leaves_motion_open(study, round.gap(round.train));
    round.verdict = open && found.reading.empty() ? Verdict::unknown_effect : Verdict::nothing_missing;
  } else if (const std::string fault = why_no_explanation(study, round, before, closed); !fault.empty()) {
    withdraw(round, Beaten::By::training, "nearest, but " + fault);
    round.train = runs(study, found.chosen, study.full);
    round.verdict = Verdict::unknown_effect;
  } else {
    round.verdict = found.ties.verdict();
  }
}

void withdraw(Round& round, Beaten::By by, const std::string& remark) {
  SearchResult& found = round.found;
  round.withdrawn = found.chosen.name();
  found.rivals.insert(found.rivals.begin(), Beaten{std::move(found.chosen), by, remark});
  found.chosen = found.baseline;
  found.steps.clear();
  found.ties = {};
}

void name_steps(const Study& study, SearchResult& found, std::vector<NamedStep> steps) {
  found.chosen = steps.back().model;
  found.steps = std::move(steps);
  const std::string name = found.chosen.name();
  std::erase_if(found.rivals, [&](const Beaten& rival) { return rival.model.name() == name; });
  if (found.chosen.left_out.size() == 0) run_left_out(study, found.chosen);
}

Round first_names(const Study& study, const Round& round, std::size_t count, const std::string& remark) {
  Round out;
  out.found = round.found;
  out.between = round.between;
  SearchResult& found = out.found;
  std::vector<NamedStep> steps(found.steps.begin(), found.steps.begin() + static_cast<std::ptrdiff_t>(count));
  withdraw(out, Beaten::By::training, remark);
  name_steps(study, found, std::move(steps));
  find_ties_again(study, found);
  decide(study, out);
  return out;
}

namespace {

/// Forces that follow the training motion need not hold beyond it: whether the test records show some of their own
/// beside the same model, fitted to them.
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

}  // namespace

bool gone_on_test(const Study& study, const Round& round, const std::vector<FreeRun>& before) {
  const Closure& closure = round.left.closure;
  if (closure.fit.theta.size() == 0 || !std::isfinite(closure.fit.cost)) return false;
  const std::vector<FreeRun> with = runs(study, *closure.system, closure.fit, study.test, false);
  return std::isfinite(pool_gap(with, 0).value) && !lowers_the_gap(study, before, with) &&
         !test_shows_structure(study, round.found.chosen, round.found.whitening);
}

void remark_ties(SearchResult& found) {
  for (std::size_t i = 0; i < found.rivals.size(); ++i) {
    Beaten& rival = found.rivals[i];
    if (!holds_name(found.ties.rivals, rival.model.name())) continue;
    rival.by = Beaten::By::tie;
    rival.remark = tie_remark(found.rivals, i, found.chosen);
  }
}

void find_ties_again(const Study& study, SearchResult& found) {
  std::vector<const Candidate*> rivals;
  for (const Beaten& rival : found.rivals) rivals.push_back(&rival.model);
  found.ties = find_ties(study, found.baseline, found.chosen, rivals);
  remark_ties(found);
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

}  // namespace

namespace {

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
