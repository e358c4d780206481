#include "discover/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string>

#include "discover/accept.hpp"
#include "discover/closed_loop.hpp"
#include "discover/judge.hpp"
#include "discover/one_motion.hpp"
#include "discover/proposal_fits.hpp"

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

/// A record holds a channel itself, under whatever name: an angle as one, not as a speed that was added up.
bool is_recorded(const Record& record, const std::string& name) {
  if (name.empty() || !record.has(name)) return false;
  const Channel& channel = record.channel(name);
  return !channel.derived || (record.has(channel.source) && record.channel(channel.source).unit == channel.unit);
}

/// The parameters, from 0, that are the same in this record as in those of the fit.
std::vector<int> shared_parameters(const Candidate& c, const Record& record) {
  std::set<std::string> separate;
  for (const Choice& choice : c.choices)
    for (const auto& [own, unless] : choice.effect->separate)
      for (const Parameter& p : choice.parameters())
        if (own_name(*choice.effect, p.name) == own && !is_recorded(record, unless)) separate.insert(p.name);
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
  const std::vector<int> shared = shared_parameters(c, record);
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

bool may_have_colour(const Study& study, const Round& round) {
  constexpr double above = 1.3;  // times the floor
  return !study.imposed && !round.left.seen && round.left.gap.value > above * round.left.gap.floor;
}

bool may_leave_noise(const Study& study, const Round& round) {
  constexpr double most = 5;  // times the floor: noise that stronger filters have shaped hides a force too
  return may_have_colour(study, round) && round.left.gap.value < most * round.left.gap.floor &&
         !follows_the_forces(study, round.train, study.full);
}

bool follows_the_forces(const Study& study, const std::vector<FreeRun>& runs, const std::vector<Record>& records) {
  constexpr double by_chance = 0.1;
  return driven_part(study, runs, records) > by_chance;
}

double most_closed(const Choices& names) {
  if (springs_among(names) > 1) return 0.998;
  return 1 - 0.05 / static_cast<double>(std::max<std::size_t>(1, names.size()));
}

bool is_loose_series(const Choices& names, const Gap& train, double closed) {
  return springs_among(names) > 1 && train.value > 1.5 * train.floor && closed < most_closed(names);
}

bool far_from_the_floor(const Gap& gap, double least, double times) {
  return !(gap.value < std::max(times * gap.floor, least));
}

bool leaves_motion_open(const Study& study, const Gap& gap, double part) {
  constexpr double much_open = 0.15;  // of the motion
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

bool feeds_the_motion(const Candidate& baseline, const Candidate& named, double deviations) {
  for (const Eigen::Index j : turned_negative(baseline, named, deviations)) {
    const Model& model = baseline.system->model();
    const Expr of = model.pool->parameter(model.parameters[static_cast<std::size_t>(j)].name);
    for (int i = 0; i < model.degrees(); ++i)
      if (derivative(model.coordinate(i).restoring, of) == model.pool->channel(model.channel('v', i))) return true;
  }
  return false;
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
  if (found.steps.size() < 2 || !far_from_the_floor(after, little_open) || may_leave_noise(study, round)) return false;
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

}  // namespace lunid
