#include "discover/grow.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "discover/between_samples.hpp"
#include "discover/contest.hpp"
#include "discover/judge.hpp"
#include "discover/level_fits.hpp"

namespace lunid {

namespace {

constexpr int beam = 2;                // sets that grow by one more effect for their free run
constexpr std::size_t force_beam = 3;  // and for what they explain of the force, one each of 1, 2 and more parameters
constexpr double explained = 0.999;    // of the squared error, by an entry of many states: no other is added beside it

class Grower {
 public:
  Grower(const Study& study, const Model& model, const Candidate& baseline, std::span<const Effect> catalogue,
         const Grown& known, bool ask_reading, const std::function<void(const std::string&, double)>& progress)
      : study_(study),
        model_(model),
        baseline_(baseline),
        known_(known),
        ask_reading_(ask_reading),
        progress_(progress),
        offers_(study, model, baseline, catalogue, known, out_),
        fits_(study, model, baseline, offers_, known, out_) {}

  Grown run() {
    out_.tried = known_.tried;
    progress_("run the catalogue along the motion", 0.12);
    offers_.run_along_the_motion();
    std::vector<Candidate> parents{baseline_};
    Candidate best = baseline_;
    for (int size = 1; size <= study_.most_effects; ++size) {
      progress_("propose and fit, " + std::to_string(size) + (size == 1 ? " effect" : " effects"), 0.15 + 0.12 * size);
      std::vector<Candidate> level = add_one(parents, size);
      if (level.empty()) break;
      for (const auto& c : level) (c.degenerate() ? out_.at_limits : out_.sets).push_back(c);
      if (is_read_otherwise(level)) return std::move(out_);
      const bool better = worth_growing(best, level.front(), size);
      const bool masked = size == 1 && !known_.quiet && may_mask_a_pair(level);
      if (!better && !masked) break;
      best = level.front();
      parents = parents_of(std::move(level));
      if (size == 1) add_half_of_a_masked_pair(parents);
      if (parents.empty()) break;
    }
    sort_by_cost(out_.sets);
    sort_by_cost(out_.at_limits);
    contest_the_best(study_, model_, baseline_, known_, offers_, fits_, out_);
    return std::move(out_);
  }

 private:
  /// By the best of a level, whenever that is another one than was asked last.
  bool is_read_otherwise(const std::vector<Candidate>& level) {
    if (!ask_reading_ || out_.reading || level.empty()) return out_.reading.has_value();
    const Candidate& best = level.front();
    if (best.fit.cost == asked_cost_ || !nearly_follows(best)) return false;
    asked_cost_ = best.fit.cost;
    out_.reading = far_better_reading(study_, best);
    return out_.reading.has_value();
  }

  /// It closes nearly all that the baseline leaves, but is not down to the noise.
  bool nearly_follows(const Candidate& c) const {
    constexpr double nearly = 0.9;
    return c.ran() && !c.degenerate() && is_above_noise(study_, c) &&
           closed_share(baseline_.ran() ? gap(baseline_) : INFINITY, gap(c), study_.noise_gap()) > nearly;
  }

  /// Growing goes on while the error falls visibly, beyond two effects to a half, and is not yet what the sensor alone
  /// leaves: what no entry describes is followed ever more closely by ever more of them.
  bool worth_growing(const Candidate& before, const Candidate& after, int size) const {
    const double least_gain = size > 2 ? 0.5 : required_gain(study_, gap(after));
    if (!after.ran()) return false;
    if (!before.ran()) return true;
    if (closes_nearly_all(before, after) || known_.is_settled(after)) return false;
    return rms(after) < (1 - least_gain) * rms(before) && !leaves_noise(after);
  }

  /// Beside it nothing more could be named.
  bool leaves_noise(const Candidate& c) const {
    return !is_above_noise(study_, c, 1 / (1 - required_gain(study_, 0)) - 1);
  }

  /// Two effects may be needed where one alone leaves the error above the sensor's noise, and may be the simpler words
  /// where one needs more parameters than two of them.
  bool may_mask_a_pair(const std::vector<Candidate>& singles) const {
    constexpr double near = 0.3;
    if (!is_above_noise(study_, baseline_, near) || closes_nearly_all(baseline_, singles.front())) return false;
    return std::ranges::none_of(singles, [&](const Candidate& one) {
      return one.ran() && !one.degenerate() && one.added() <= 2 && !is_above_noise(study_, one, near);
    });
  }

  /// An entry of many states beside which others cost much and could close little.
  bool closes_nearly_all(const Candidate& before, const Candidate& after) const {
    return before.ran() && after.ran() && many_states(after.choices) &&
           closed_share(gap(before), gap(after), study_.noise_gap()) > explained;
  }

  double gap(const Candidate& c) const { return rms(c) / study_.measured_std(); }

  /// What others are added to. Where single effects leave no more than the noise, with many parameters, sets of others
  /// are sought that have fewer.
  std::vector<Candidate> parents_of(std::vector<Candidate> level) {
    for (const Candidate& c : level)
      if (leaves_noise(c) && !c.degenerate()) fewest_ = std::min(fewest_, c.added());
    std::erase_if(level, [&](const Candidate& c) { return leaves_noise(c) || c.added() + 1 >= fewest_; });
    std::vector<Candidate> parents = parents_among(level);
    std::erase_if(parents, [](const Candidate& c) {
      return (c.choices.size() > 1 && many_states(c.choices)) ||
             is_series(c.choices);  // is no name, nor is what holds it
    });
    return parents;
  }

  /// Neither of two effects may be among the best singles, where one takes back most of what the other does.
  void add_half_of_a_masked_pair(std::vector<Candidate>& parents) {
    const Proposer::Parent space = offers_.space_of(baseline_, baseline_.best_theta());
    const Shape* half = offers_.half_of_a_masked_pair(space, parents);
    if (!half || static_cast<std::size_t>(half->linear.size()) + 1 >= fewest_) return;
    const std::vector<Offer> offers = offers_.beside(baseline_, space, [&](const Shape& s) { return &s == half; });
    if (offers.empty()) return;
    for (const Candidate& c : fits_.fit(offers, {0}, 1))
      if (same(c.choices, {half->choice})) take_from_force(c, parents);
  }

  std::vector<Candidate> add_one(const std::vector<Candidate>& parents, int size) {
    const Offers::Round round = offers_.beside(parents, fewest_);
    const std::span<const Candidate> best(parents.data(), std::min<std::size_t>(parents.size(), beam));
    std::vector<Candidate> level = fits_.fit(round.all, round.worth_runs, size, best, fewest_);
    if (is_read_otherwise(level)) return level;
    if (is_open(level)) size == 1 ? fits_.leave_minima(level) : fits_.begin_in_short_runs(level);
    fit_too(round.all, best_on_motion(round, parents, size, is_open(level)), size, level);
    fit_too(round.all, is_open(level) ? round.slow : rivals_in_memory(round, level), size, level);
    return level;
  }

  /// Of pairs beside each parent, not the best alone: where two effects are missing, each of them may run worse than an
  /// effect that stands for both.
  std::vector<std::size_t> best_on_motion(const Offers::Round& round, const std::vector<Candidate>& parents, int size,
                                          bool open) const {
    if (size > 2 && !open) return {};
    std::vector<std::size_t> out;
    std::vector<Choices> seen;
    for (std::size_t k = 0; k < (size == 2 ? parents.size() : 1); ++k)
      for (const std::size_t i : offers_.best_on_motion(round.all, round.worth_runs, parents[k], open)) {
        Choices set = round.all[i].set();
        if (is_among(seen, set)) continue;
        seen.push_back(std::move(set));
        out.push_back(i);
      }
    return out;
  }

  /// Where a single effect with memory is down to the noise, those of many states that need no more parameters: a Prony
  /// sum follows where one relaxation does.
  static std::vector<std::size_t> rivals_in_memory(const Offers::Round& round, const std::vector<Candidate>& sorted) {
    const auto best = std::ranges::find_if_not(sorted, &Candidate::degenerate);
    if (best == sorted.end() || best->choices.front().effect->states.empty()) return {};
    std::vector<std::size_t> out = round.slow;
    std::erase_if(out, [&](std::size_t i) {
      const Model& own = round.all[i].standing.shape->system->model();
      return free_parameters(own.parameters) > static_cast<int>(best->added());
    });
    return out;
  }

  void fit_too(const std::vector<Offer>& offers, const std::vector<std::size_t>& more, int size,
               std::vector<Candidate>& level) {
    if (more.empty()) return;
    std::vector<Candidate> others = fits_.fit(offers, more, size);
    level.insert(level.end(), std::make_move_iterator(others.begin()), std::make_move_iterator(others.end()));
    sort_by_cost(level);
    level = once_each(std::move(level));
  }

  bool is_open(const std::vector<Candidate>& sorted) const {
    const auto best = std::ranges::find_if_not(sorted, &Candidate::degenerate);
    return best == sorted.end() || is_above_noise(study_, *best);
  }

  /// The best on the trajectory, and those of few and of many parameters that explain most of the force. They differ
  /// where one missing effect makes free runs drift so far that another does not show in them (friction under a
  /// constant force, without a spring): there the force as it is says more than the force as the trajectory feels it.
  static std::vector<Candidate> parents_among(const std::vector<Candidate>& sorted) {
    if (sorted.empty()) return {};
    std::vector<Candidate> parents(sorted.begin(), sorted.begin() + std::min<std::ptrdiff_t>(beam, std::ssize(sorted)));
    for (std::size_t richness = 1; richness <= force_beam; ++richness) {
      const Candidate* best = nullptr;
      for (std::size_t i = 0; i < sorted.size(); ++i) {
        const std::size_t parameters = sorted[i].added() / sorted[i].choices.size();
        if (std::min<std::size_t>(parameters, force_beam) != richness) continue;
        if (!best || sorted[i].force_cost < best->force_cost) best = &sorted[i];
      }
      if (best) take_from_force(*best, parents);
    }
    if (const Candidate* plain = plainest(sorted)) take_from_force(*plain, parents);
    return parents;
  }

  /// Of those that explain nearly as much of the force as any, one with the fewest parameters: friction before its
  /// rounded and its Stribeck form, which sit at their limits beside what is added.
  static const Candidate* plainest(const std::vector<Candidate>& sets) {
    constexpr double nearly = 1.05;
    const auto least = std::ranges::min_element(sets, {}, &Candidate::force_misfit);
    const Candidate* out = nullptr;
    for (const Candidate& c : sets)
      if (std::isfinite(c.force_misfit) && c.force_misfit < nearly * least->force_misfit &&
          (!out || std::pair(c.added(), c.force_misfit) < std::pair(out->added(), out->force_misfit)))
        out = &c;
    return out;
  }

  static void take_from_force(const Candidate& c, std::vector<Candidate>& parents) {
    if (find_in(parents, c.choices)) return;
    parents.push_back(c);
    parents.back().fit.theta = c.starts.front();
  }

  const Study& study_;
  const Model& model_;
  const Candidate& baseline_;
  const Grown& known_;
  const bool ask_reading_;
  double asked_cost_ = -1;  ///< of the fit beside which the reading of the force was asked last
  const std::function<void(const std::string&, double)>& progress_;
  Grown out_;
  Offers offers_;
  LevelFits fits_;
  std::size_t fewest_ = SIZE_MAX;  ///< parameters of a single effect that leaves no more than the noise
};

}  // namespace

std::vector<const Candidate*> Grown::of_size(std::size_t effects) const {
  std::vector<const Candidate*> out;
  for (const auto* all : {&sets, &at_limits})
    for (const Candidate& c : *all)
      if (c.choices.size() == effects) out.push_back(&c);
  return out;
}

bool Grown::is_settled(const Candidate& c) const {
  constexpr double less = 0.95;
  const Candidate* set = settled.empty() ? nullptr : find_in(sets, settled);
  return set && c.choices.size() >= settled.size() && c.ran() && rms(c) > less * rms(*set);
}

Grown grow(const Study& study, const Model& model, const Candidate& baseline, std::span<const Effect> catalogue,
           const Grown& known, bool ask_reading, const std::function<void(const std::string&, double)>& progress) {
  return Grower(study, model, baseline, catalogue, known, ask_reading, progress).run();
}

}  // namespace lunid
