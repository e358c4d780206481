#include "discover/level_fits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "discover/sensor.hpp"
#include "record/parallel.hpp"

namespace lunid {

namespace {

constexpr int long_fits = 5;  // sets that are fitted to the end
constexpr int promising = 3;  // and those that explain most of the force, with all that are nearly as good
constexpr int most_promising = 6;
constexpr double as_good = 1.5;        // times the least squared misfit of the force
constexpr int ended_faults = 2;        // and of faults of a channel
constexpr int led_out = 4;             // single effects above the noise that begin again from other guesses
constexpr int led_out_of_several = 2;  // sets of several that begin again in short runs
constexpr double hopeless = 3;         // times the best squared error after the first iterations: not fitted to the end
constexpr double far_behind = 10;      // the same of single effects: not fitted further at all
constexpr int middle_iterations = 8;   // of those that are

}  // namespace

void sort_by_cost(std::vector<Candidate>& sets) {
  std::stable_sort(sets.begin(), sets.end(),
                   [](const Candidate& a, const Candidate& b) { return a.fit.cost < b.fit.cost; });
}

std::vector<Candidate> once_each(std::vector<Candidate> sorted) {
  std::vector<Candidate> out;
  for (Candidate& c : sorted)
    if (!find_in(out, c.choices)) out.push_back(std::move(c));
  return out;
}

std::vector<Candidate> LevelFits::fit(const std::vector<Offer>& offers, const std::vector<std::size_t>& list, int size,
                                      std::span<const Candidate> parents, std::size_t fewest) {
  std::vector<Candidate> level;
  std::vector<const Candidate*> grown_from;
  std::vector<const Shape*> proposed;  // the proposals come first
  for (const auto i : list) {
    const Offer& o = offers[i];
    proposed.push_back(o.standing.shape);
    Candidate c = compile(study_, model_, o.set());
    Eigen::VectorXd start(o.standing.parent.size() + o.standing.own.size());
    start << o.standing.parent, o.standing.own;
    c.starts.push_back(std::move(start));
    const Candidate& parent = *o.parent;
    const int before = parent.ran() ? std::min(parent.state_substeps, parent.fit.substeps) : parent.state_substeps;
    c.state_substeps = std::max(before, o.standing.substeps);
    c.force_cost = o.standing.cost;
    c.force_misfit = o.misfit;
    level.push_back(std::move(c));
    grown_from.push_back(o.parent);
  }
  for (const Candidate& parent : parents) add_faults(parent, fewest, level, grown_from);
  parallel_for(static_cast<int>(level.size()), study_.options->threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    fits_.begin(level[k], *grown_from[k]);
    if (size == 1 && k < proposed.size()) fits_.leave_limits(level[k], *proposed[k], *grown_from[k]);
  });
  sort_by_cost(level);
  std::erase_if(level, [](const Candidate& c) { return !c.ran() && c.choices.size() > 1; });
  if (size == 1 && !study_.imposed) go_on(level);
  const std::vector<std::size_t> ahead = to_the_end(level);
  const double reached = level.empty() || !level.front().ran() ? INFINITY : rms(level.front());
  parallel_for(static_cast<int>(ahead.size()), study_.options->threads, [&](int i) {
    Candidate& c = level[ahead[static_cast<std::size_t>(i)]];
    fits_.end(c, reached);
    leave_limits(c, reached);
  });
  std::erase_if(level, [](const Candidate& c) { return !c.ran(); });
  for (const Candidate* known : known_.of_size(static_cast<std::size_t>(size))) level.push_back(*known);
  sort_by_cost(level);
  return once_each(std::move(level));
}

/// No force to be proposed, but few, and fitted beside all that runs fast.
void LevelFits::add_faults(const Candidate& parent, std::size_t fewest, std::vector<Candidate>& level,
                           std::vector<const Candidate*>& grown_from) {
  if (many_states(parent.choices)) return;
  const bool single = parent.choices.empty();
  std::vector<Candidate> found;
  std::vector<std::vector<Guess>> guesses;
  for (const auto& fault : offers_.faults()) {
    if (!may_join(parent.choices, *fault.choice.effect)) continue;
    if (known_.find(with(parent.choices, fault.choice))) continue;
    if (!goes_with(parent.choices, fault.choice)) continue;
    if (parent.added() + fault.choice.parameters().size() >= fewest) continue;
    found.push_back(compile(study_, model_, with(parent.choices, fault.choice)));
    guesses.push_back(fault.guesses);
    out_.tried += std::max<int>(1, static_cast<int>(fault.guesses.size()));
  }
  std::vector<std::uint8_t> there(found.size(), 0);
  parallel_for(static_cast<int>(found.size()), study_.options->threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    if (!single && parent.ran())
      start_beside(study_, found[k], parent, guesses[k]);
    else
      find_starts(study_, found[k], parent.best_theta(), {guesses[k]});
    there[k] = !found[k].starts.empty() && shows_beside(study_, found[k], parent);
  });
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::string name = found[k].choices.back().effect->label();
    if (!there[k] && single && (out_.left_aside.empty() || out_.left_aside.back() != name))
      out_.left_aside.push_back(name);
    if (!there[k]) continue;
    found[k].force_cost = INFINITY;  // not what a proposal's is
    level.push_back(std::move(found[k]));
    grown_from.push_back(&parent);
  }
}

/// Twice as many as are fitted to the end, a little further: a steep spring still has far to go where the first
/// iterations of others are nearly through; along an imposed motion none drifts (successive halving; Jamieson &
/// Talwalkar 2016, AISTATS 51, 240).
void LevelFits::go_on(std::vector<Candidate>& sorted) const {
  const auto most = static_cast<std::size_t>(offers_.as_affordable(2 * long_fits));
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < sorted.size() && list.size() < most; ++i)
    if (sorted[i].ran() && sorted[i].fit.cost <= far_behind * sorted.front().fit.cost) list.push_back(i);
  if (list.size() <= most / 2) return;  // all of these are fitted to the end
  parallel_for(static_cast<int>(list.size()), study_.options->threads,
               [&](int i) { fits_.go_on(sorted[list[static_cast<std::size_t>(i)]], middle_iterations); });
  sort_by_cost(sorted);
}

/// The best after the first iterations, and those that explain most of the force: their free runs may have lost the
/// measured motion at once (several attractors, chaos), and find it again from short runs on. Of single faults the
/// best in any case: they begin at a guess, which no force along the motion has bettered.
std::vector<std::size_t> LevelFits::to_the_end(const std::vector<Candidate>& sorted) const {
  std::vector<std::size_t> list;
  const auto take = [&](std::size_t i) {
    if (std::ranges::find(list, i) == list.end()) list.push_back(i);
  };
  for (std::size_t i = 0; i < sorted.size() && std::ssize(list) < offers_.as_affordable(long_fits); ++i)
    if (sorted[i].fit.cost <= hopeless * sorted.front().fit.cost || !sorted[i].ran()) list.push_back(i);
  std::vector<std::size_t> by_force(sorted.size());
  std::iota(by_force.begin(), by_force.end(), std::size_t{0});
  std::stable_sort(by_force.begin(), by_force.end(),
                   [&](std::size_t a, std::size_t b) { return sorted[a].force_cost < sorted[b].force_cost; });
  int taken = 0;
  for (const auto i : by_force) {
    const bool near = sorted[i].force_cost <= as_good * sorted[by_force.front()].force_cost;
    if (!std::isfinite(sorted[i].force_cost) || taken >= (near ? most_promising : promising)) break;
    ++taken;
    take(i);
  }
  int faults = 0;
  for (std::size_t i = 0; i < sorted.size() && faults < ended_faults; ++i) {
    if (sorted[i].choices.size() > 1 || physics_in(sorted[i].choices) > 0) continue;
    ++faults;
    take(i);
  }
  return list;
}

void LevelFits::leave_minima(std::vector<Candidate>& sorted) const {
  const std::span<const Candidate> best(sorted.data(), std::min<std::size_t>(led_out, sorted.size()));
  const auto is_simpler_than_the_best = [&](const Candidate& c) {
    return std::ranges::any_of(
        best, [&](const Candidate& b) { return c.choices.front().is_special_case(b.choices.front()); });
  };
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    if (i < best.size() || is_simpler_than_the_best(sorted[i])) list.push_back(i);
  parallel_for(static_cast<int>(list.size()), study_.options->threads, [&](int i) {
    Candidate& c = sorted[list[static_cast<std::size_t>(i)]];
    if (const Shape* shape = offers_.shape_of(c.choices.front())) fits_.leave_minimum(c, *shape);
  });
  sort_by_cost(sorted);
}

void LevelFits::begin_in_short_runs(std::vector<Candidate>& sorted) const {
  parallel_for(std::min<int>(led_out_of_several, static_cast<int>(sorted.size())), study_.options->threads,
               [&](int i) { fits_.begin_in_short_runs(sorted[static_cast<std::size_t>(i)]); });
  sort_by_cost(sorted);
}

/// Of a set that ended at a limit of what its last entry can show: that one's other guesses beside the parent.
void LevelFits::leave_limits(Candidate& c, double to_beat) const {
  if (!c.degenerate()) return;
  const Shape* shape = offers_.shape_of(c.choices.back());
  const Candidate* parent = parent_of(c);
  if (!shape || !parent) return;
  const double cost = c.fit.cost;
  fits_.leave_limits(c, *shape, *parent);
  if (c.fit.cost < cost) fits_.end(c, to_beat);
}

/// The fitted set without the last entry; null where there is none.
const Candidate* LevelFits::parent_of(const Candidate& c) const {
  if (c.choices.size() == 1) return &baseline_;
  return find_in(out_.sets, {c.choices.begin(), c.choices.end() - 1});
}

}  // namespace lunid
