#include "discover/grow.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "discover/judge.hpp"
#include "discover/linearised.hpp"
#include "discover/places.hpp"
#include "discover/proposal_fits.hpp"
#include "discover/propose.hpp"
#include "discover/sensor.hpp"
#include "record/parallel.hpp"

namespace lunid {

namespace {

constexpr int beam = 2;                // sets that grow by one more effect for their free run
constexpr std::size_t force_beam = 3;  // and for what they explain of the force, one each of 1, 2 and more parameters
constexpr int refined = 24;            // proposals whose shape parameters are refined on the force
constexpr int later_refined = 12;
constexpr int per_size = 3;  // proposals of one number of parameters that are run; of short records more
constexpr int most_per_size = 9;
constexpr double rows_of_runs = 12000;  // so many rows are run for the proposals of one number of parameters
constexpr int first_runs = 4;           // the best proposals that are run in any case
constexpr int later_runs = 6;           // the same of sets of two and more
constexpr int heavy_runs = 3;           // beside an entry of many states, which takes no more than one other
constexpr double explained = 0.999;  // share of the squared error that such an entry closes, beyond which none is added
constexpr int long_fits = 5;         // sets that are fitted to the end
constexpr int promising = 3;         // and those that explain most of the force, with all that are nearly as good
constexpr int most_promising = 6;
constexpr int ended_faults = 2;  // and of faults of a channel
constexpr double as_good = 1.5;  // times the best squared misfit of the force: as far as entries of many states are run
constexpr double far = 40;       // the same as far as they are refined, and run where no other reaches the noise
constexpr std::size_t slow_runs = 2;
constexpr std::size_t runs_by_motion = 3;  // of what the force does not show
constexpr double near_enough = 0.5;        // of the motion, for that
constexpr int led_out = 4;                 // single effects above the noise that begin again from other guesses
constexpr double nearly = 1.15;            // as good, in squared error
constexpr double reached = 1.05;           // of the sensor's noise: nothing is left
constexpr double hopeless = 3;        // times the best squared error after the first iterations: not fitted to the end
constexpr double far_behind = 10;     // the same of single effects: not fitted further at all
constexpr int middle_iterations = 8;  // of those that are

bool many_states(const Choices& set) {
  return std::any_of(set.begin(), set.end(),
                     [](const Choice& c) { return lunid::many_states(c.effect->states.size()); });
}

int runs_per_size(const Study& study) {
  double rows = 0;
  for (const FitData& data : study.train) rows += static_cast<double>(data.record.rows());
  return static_cast<int>(std::clamp<double>(rows_of_runs / rows, per_size, most_per_size));
}

class Grower {
 public:
  Grower(const Study& study, const Model& model, const Candidate& baseline, std::span<const Effect> catalogue,
         const Grown& known, const std::function<void(const std::string&, double)>& progress)
      : study_(study),
        model_(model),
        baseline_(baseline),
        catalogue_(catalogue),
        known_(known),
        progress_(progress),
        proposer_(study, baseline),
        plain_(study, baseline, false),
        fits_(study, baseline, proposer_.rows()),
        per_size_(runs_per_size(study)) {}

  Grown run() {
    out_.tried = known_.tried;
    progress_("run the catalogue along the motion", 0.12);
    make_shapes();
    std::vector<Candidate> parents{baseline_};
    Candidate best = baseline_;
    for (int size = 1; size <= study_.options->max_effects; ++size) {
      progress_("propose and fit, " + std::to_string(size) + (size == 1 ? " effect" : " effects"), 0.15 + 0.12 * size);
      std::vector<Candidate> level = add_one(parents, size);
      if (level.empty()) break;
      const bool better = worth_growing(best, level.front());
      const bool masked = size == 1 && may_mask_a_pair(level);
      for (const auto& c : level)
        if (!c.degenerate()) out_.sets.push_back(c);
      if (!better && !masked) break;
      best = level.front();
      parents = parents_of(std::move(level));
      if (parents.empty()) break;
    }
    sort_by_cost(out_.sets);
    contest_the_best();
    return std::move(out_);
  }

 private:
  static void sort_by_cost(std::vector<Candidate>& list) {
    std::stable_sort(list.begin(), list.end(),
                     [](const Candidate& a, const Candidate& b) { return a.fit.cost < b.fit.cost; });
  }

  /// Growing goes on while the error falls visibly and is not yet what the sensor alone leaves.
  bool worth_growing(const Candidate& before, const Candidate& after) const {
    if (!after.ran()) return false;
    if (!before.ran()) return true;
    if (closes_nearly_all(before, after)) return false;
    return rms(after) < (1 - required_gain(study_, gap(after))) * rms(before) && !is_whole(after);
  }

  /// Beside it nothing more could be named.
  bool is_whole(const Candidate& c) const {
    return c.ran() && !c.degenerate() && (1 - required_gain(study_, 0)) * rms(c) <= study_.sensor_noise();
  }

  /// Two effects may be needed where one alone leaves the error above the sensor's noise, and may be the simpler words
  /// where one needs more parameters than two of them.
  bool may_mask_a_pair(const std::vector<Candidate>& singles) const {
    const double noise = 1.3 * study_.sensor_noise();
    if (!(rms(baseline_) > noise) || closes_nearly_all(baseline_, singles.front())) return false;
    return std::ranges::none_of(singles, [&](const Candidate& one) {
      return one.ran() && !one.degenerate() && rms(one) <= noise && one.added() <= 2;
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
      if (is_whole(c)) fewest_ = std::min(fewest_, c.added());
    std::erase_if(level, [&](const Candidate& c) { return is_whole(c) || c.added() + 1 >= fewest_; });
    std::vector<Candidate> parents = parents_among(level);
    std::erase_if(parents, [](const Candidate& c) { return c.choices.size() > 1 && many_states(c.choices); });
    return parents;
  }

  // ---- the catalogue along the motion ----
  void make_shapes() {
    for (const auto& effect : catalogue_) {
      if (in_baseline(effect)) {
        out_.left_aside.push_back(effect.label() + " (is in the baseline already)");
        continue;
      }
      for (int variant = 0; variant < static_cast<int>(effect.variants.size()); ++variant) {
        const Choice choice{&effect, variant};
        if (effect.variants[static_cast<std::size_t>(variant)].force.valid())
          shapes_.push_back(proposer_.shape(model_, choice, scales_.at(effect.place)));
        else
          faults_.push_back({choice, scales_.guesses(choice)});
      }
    }
    run_shapes([](const Shape& shape) { return !many_states(shape); });
  }

  void run_shapes(const std::function<bool(const Shape&)>& wanted) {
    parallel_for(static_cast<int>(shapes_.size()), study_.options->threads, [&](int i) {
      Shape& shape = shapes_[static_cast<std::size_t>(i)];
      if (wanted(shape)) proposer_.run(shape);
    });
  }

  /// An entry that is an element of the baseline has its names there.
  bool in_baseline(const Effect& effect) const {
    for (const Parameter& own : effect.parameters)
      if (model_.find(own.name)) return true;
    return std::any_of(effect.states.begin(), effect.states.end(), [&](const InternalState& own) {
      return std::any_of(model_.states.begin(), model_.states.end(),
                         [&](const InternalState& known) { return known.symbol.name() == own.symbol.name(); });
    });
  }

  // ---- one more effect ----
  struct Offer {
    const Candidate* parent;
    const Proposer::Parent* space;
    Standing standing;
    double misfit = INFINITY;  ///< of the force as it is
  };

  void add_offer(std::vector<Offer>& offers, const Candidate& parent, const Proposer::Parent& space,
                 const Shape& shape) {
    offers.push_back({&parent, &space, {}});
    offers.back().standing.shape = &shape;
    out_.tried += static_cast<int>(shape.guesses.size());
  }

  std::vector<Candidate> add_one(const std::vector<Candidate>& parents, int size) {
    std::vector<Proposer::Parent> spaces(parents.size());
    parallel_for(static_cast<int>(parents.size()), study_.options->threads, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      spaces[k] = proposer_.parent(parents[k], parents[k].best_theta());
    });
    std::vector<Offer> offers;
    for (std::size_t k = 0; k < parents.size(); ++k)
      for (const auto& shape : shapes_) {
        if (holds(parents[k].choices, shape.choice.effect) || is_known(parents[k], shape.choice)) continue;
        if (parents[k].added() + shape.linear.size() >= fewest_) continue;
        add_offer(offers, parents[k], spaces[k], shape);
      }
    const auto each = [&](const std::vector<std::size_t>& list, const std::function<void(Offer&)>& job) {
      parallel_for(static_cast<int>(list.size()), study_.options->threads,
                   [&](int i) { job(offers[list[static_cast<std::size_t>(i)]]); });
    };
    std::vector<std::size_t> order(offers.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    each(order, [&](Offer& o) { o.standing = proposer_.score(*o.standing.shape, *o.space); });
    if (size == 1) {
      std::vector<std::optional<Place>> near;
      for (const auto& place : scales_.places())
        if (memory_comes_near(offers, place)) near.push_back(place);
      const auto wanted = [&](const Shape& shape) {
        return many_states(shape) && std::find(near.begin(), near.end(), shape.choice.effect->place) != near.end();
      };
      run_shapes(wanted);
      each(order, [&](Offer& o) {
        if (wanted(*o.standing.shape)) o.standing = proposer_.score(*o.standing.shape, *o.space);
      });
    }
    if (size == 1) {
      leave_aside(offers);
      const Proposer::Parent space = plain_.parent(parents.front(), parents.front().best_theta());
      each(order, [&](Offer& o) { o.misfit = misfit(*o.standing.shape, space); });
    }
    std::erase_if(order,
                  [&](std::size_t i) { return !offers[i].standing.shown || !std::isfinite(offers[i].standing.cost); });
    const auto by_cost = [&](std::size_t a, std::size_t b) {
      return offers[a].standing.cost < offers[b].standing.cost;
    };
    std::stable_sort(order.begin(), order.end(), by_cost);
    refine_the_best(offers, order, size, each);
    std::stable_sort(order.begin(), order.end(), by_cost);
    std::vector<std::size_t> slow;
    std::vector<std::size_t> list = shortlist(offers, order, size, slow);
    if (size == 1 && !list.empty()) add_other_places(offers, order, list);
    std::vector<Candidate> level = fit_list(offers, list, parents, size);
    if (is_open(level)) size == 1 ? leave_minima(level) : leave_ridges(level);
    const bool open = is_open(level);
    if (size == 1 || open) fit_too(offers, best_on_motion(offers, list, parents.front(), open), size, level);
    if (is_open(level)) fit_too(offers, slow, size, level);
    return level;
  }

  void fit_too(const std::vector<Offer>& offers, const std::vector<std::size_t>& more, int size,
               std::vector<Candidate>& level) {
    if (more.empty()) return;
    std::vector<Candidate> others = fit_list(offers, more, {}, size);
    level.insert(level.end(), std::make_move_iterator(others.begin()), std::make_move_iterator(others.end()));
    sort_by_cost(level);
    level = once_each(level);
  }

  /// The force along a noisy motion, or along one that was integrated, may not show what the free run does: of those
  /// that were not fitted, the best on the motion to first order. Says nothing where the parent's run is not near.
  /// `open`: something is left by what was fitted; else entries without states are asked alone, of a parent above the
  /// noise.
  std::vector<std::size_t> best_on_motion(const std::vector<Offer>& offers, const std::vector<std::size_t>& fitted,
                                          const Candidate& parent, bool open = true) const {
    if (!parent.ran() || !(rms(parent) < near_enough * study_.measured_std())) return {};
    if (!open && !is_above_noise(parent)) return {};
    std::vector<std::size_t> others;
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < offers.size(); ++i) {
      const Offer& o = offers[i];
      if (o.parent->choices != parent.choices || !o.standing.shown || o.standing.own.size() == 0) continue;
      if (!open && !o.standing.shape->choice.effect->states.empty()) continue;
      if (many_states(*o.standing.shape) || std::find(fitted.begin(), fitted.end(), i) != fitted.end()) continue;
      Choices set = parent.choices;
      set.push_back(o.standing.shape->choice);
      others.push_back(i);
      candidates.push_back(compile(study_, model_, set));
    }
    const Whitening whitening = residual_colour(study_, parent);
    std::vector<double> gains(others.size());
    parallel_for(static_cast<int>(others.size()), study_.options->threads, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      const Standing& s = offers[others[k]].standing;
      Eigen::VectorXd theta(candidates[k].parameters());
      theta << parent.fit.theta, s.own;
      gains[k] = gain_on_motion(study_, whitening, parent, candidates[k], theta).gain;
    });
    std::vector<std::size_t> order(others.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return gains[a] > gains[b]; });
    std::vector<std::size_t> out;
    for (const std::size_t k : order)
      if (gains[k] > study_.options->minimum_gain && out.size() < runs_by_motion) out.push_back(others[k]);
    return out;
  }

  bool is_open(const std::vector<Candidate>& sorted) const {
    const auto best = std::ranges::find_if_not(sorted, &Candidate::degenerate);
    return best == sorted.end() || is_above_noise(*best);
  }
  bool is_above_noise(const Candidate& c) const { return rms(c) > reached * study_.sensor_noise(); }

  /// Of the best single effects, and of their special cases: noise may have led the force to a minimum that is far from
  /// the trajectory's.
  void leave_minima(std::vector<Candidate>& sorted) const {
    const std::span<const Candidate> best(sorted.data(), std::min<std::size_t>(led_out, sorted.size()));
    const auto is_simpler_than_the_best = [&](const Candidate& c) {
      return std::ranges::any_of(best, [&](const Candidate& b) {
        return c.choices.front().effect->is_special_case(*b.choices.front().effect);
      });
    };
    std::vector<std::size_t> list;
    for (std::size_t i = 0; i < sorted.size(); ++i)
      if (i < best.size() || is_simpler_than_the_best(sorted[i])) list.push_back(i);
    parallel_for(static_cast<int>(list.size()), study_.options->threads, [&](int i) {
      Candidate& c = sorted[list[static_cast<std::size_t>(i)]];
      if (const Shape* shape = shape_of(c.choices.front())) fits_.leave_minimum(c, *shape);
    });
    sort_by_cost(sorted);
  }

  /// Of the best sets of several.
  void leave_ridges(std::vector<Candidate>& sorted) const {
    parallel_for(std::min<int>(led_out, static_cast<int>(sorted.size())), study_.options->threads,
                 [&](int i) { fits_.leave_ridge(sorted[static_cast<std::size_t>(i)]); });
    sort_by_cost(sorted);
  }

  /// Null of a fault.
  const Shape* shape_of(const Choice& choice) const {
    const auto at = std::ranges::find_if(shapes_, [&](const Shape& s) { return s.choice == choice; });
    return at != shapes_.end() ? &*at : nullptr;
  }

  /// Of a set that ended at a limit of what its last entry can show: that one's other guesses beside the parent.
  void leave_limits(Candidate& c) const {
    if (!c.degenerate()) return;
    const Shape* shape = shape_of(c.choices.back());
    const Candidate* parent = parent_of(c);
    if (!shape || !parent) return;
    const double cost = c.fit.cost;
    fits_.leave_limits(c, *shape, *parent);
    if (c.fit.cost < cost) fits_.end(c);
  }

  /// The fitted set without the last entry; null where there is none.
  const Candidate* parent_of(const Candidate& c) const {
    if (c.choices.size() == 1) return &baseline_;
    return find_in(out_.sets, {c.choices.begin(), c.choices.end() - 1});
  }

  /// Null where the set is not among them.
  static auto find_in(auto& sets, const Choices& set) -> decltype(sets.data()) {
    const auto at = std::ranges::find_if(sets, [&](const Candidate& c) { return same(c.choices, set); });
    return at != sets.end() ? &*at : nullptr;
  }

  using Each = std::function<void(const std::vector<std::size_t>&, const std::function<void(Offer&)>&)>;

  /// Shape parameters of the best proposals; of many states only where they come near, from a first guess that is
  /// coarse.
  void refine_the_best(std::vector<Offer>& offers, const std::vector<std::size_t>& sorted, int size, const Each& each) {
    std::vector<std::size_t> leaders;
    for (const auto i : sorted) {
      const Standing& s = offers[i].standing;
      const bool too_far = many_states(*s.shape) && s.cost > far * offers[sorted.front()].standing.cost;
      if (std::ssize(leaders) < (size == 1 ? refined : later_refined) && !all_linear(*s.shape) && !too_far)
        leaders.push_back(i);
    }
    each(leaders, [&](Offer& o) { proposer_.refine(o.standing, *o.space, 10); });
  }

  /// The best proposal at other places: a rival of itself.
  static void add_other_places(const std::vector<Offer>& offers, const std::vector<std::size_t>& order,
                               std::vector<std::size_t>& list) {
    const Choice& best = offers[list.front()].standing.shape->choice;
    std::vector<std::optional<Place>> seen;
    for (const auto i : list)
      if (const Effect& e = *offers[i].standing.shape->choice.effect; e.name == best.effect->name)
        seen.push_back(e.place);
    for (const auto i : order) {
      const Effect& other = *offers[i].standing.shape->choice.effect;
      if (other.name != best.effect->name || std::find(seen.begin(), seen.end(), other.place) != seen.end()) continue;
      seen.push_back(other.place);
      list.push_back(i);
    }
  }

  /// Entries of many states take longer along the motion than all others together: they are looked at where one of few
  /// states comes near to the best, at the same place.
  bool memory_comes_near(const std::vector<Offer>& offers, const std::optional<Place>& place) const {
    double best = INFINITY, memory = INFINITY;
    const auto hear = [&](double cost, const Effect& effect, bool remembers) {
      best = std::min(best, cost);
      if (remembers && effect.place == place) memory = std::min(memory, cost);
    };
    for (const auto& o : offers)
      if (o.standing.shown)
        hear(o.standing.cost, *o.standing.shape->choice.effect, !o.standing.shape->system->model().states.empty());
    for (const auto& c : known_.sets) {
      if (c.choices.size() != 1) continue;
      const Effect& effect = *c.choices.front().effect;
      hear(c.force_cost, effect, !effect.states.empty());
    }
    return memory <= as_good * best;
  }

  /// What an entry without memory would leave of the force itself.
  double misfit(const Shape& shape, const Proposer::Parent& space) const {
    if (!shape.system->model().states.empty()) return INFINITY;
    Shape alone{shape.choice, shape.system, shape.linear, shape.guesses};
    plain_.run(alone);
    const Standing standing = plain_.score(alone, space);
    return standing.shown && std::isfinite(standing.cost) ? standing.cost : INFINITY;
  }

  void leave_aside(const std::vector<Offer>& offers) {
    for (const auto& o : offers) {
      if (o.standing.shape->columns.empty()) continue;  // not looked at
      const std::string name = o.standing.shape->choice.effect->label();
      const bool other = std::any_of(offers.begin(), offers.end(), [&](const Offer& x) {
        return x.standing.shown && x.standing.shape->choice.effect == o.standing.shape->choice.effect;
      });
      if (!other && (out_.left_aside.empty() || out_.left_aside.back() != name)) out_.left_aside.push_back(name);
    }
  }

  /// The best on the force, and the best of each number of parameters: a set with more of them often comes first there
  /// where a simpler one is as good. Simple ones first where the same effect stands twice (its variants). `slow` gets
  /// single effects of many states that are farther from the best, for where no other reaches the noise: what memory
  /// makes of a noisy motion says little.
  std::vector<std::size_t> shortlist(const std::vector<Offer>& offers, const std::vector<std::size_t>& order, int size,
                                     std::vector<std::size_t>& slow) const {
    std::vector<std::size_t> list;
    std::vector<int> count(9, 0);
    std::vector<Choices> seen;
    int heavy = 0;
    const int always = size == 1 ? first_runs : later_runs;
    const double plainly = plain_limit(offers, order);
    const double best = order.empty() ? INFINITY : offers[order.front()].standing.cost;
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
      const Offer& o = offers[order[rank]];
      Choices set = o.parent->choices;
      set.push_back(o.standing.shape->choice);
      const bool again = std::any_of(seen.begin(), seen.end(), [&](const Choices& c) { return same(c, set); });
      if (again) continue;
      const auto parameters =
          std::min<std::size_t>(size == 1 ? 4 : 8, o.parent->added() + static_cast<std::size_t>(o.standing.own.size()));
      const bool gains = o.standing.cost < (1 - 10.0 / static_cast<double>(proposer_.rows())) * o.space->cost;
      const bool first = static_cast<int>(list.size()) < always;
      if (many_states(*o.standing.shape) && o.standing.cost > as_good * best) {
        if (size == 1 && slow.size() < slow_runs && o.standing.cost < far * best) slow.push_back(order[rank]);
        continue;
      }
      if (many_states(o.parent->choices) && ++heavy > heavy_runs) continue;
      if (!first && !(o.misfit <= plainly) && !(gains && count[parameters] < (size == 1 ? per_size_ : 1))) continue;
      ++count[parameters];
      seen.push_back(std::move(set));
      list.push_back(order[rank]);
    }
    return list;
  }

  /// The misfit of the second best on the force as it is; those are run in any case.
  static double plain_limit(const std::vector<Offer>& offers, const std::vector<std::size_t>& order) {
    std::vector<double> all;
    for (const auto i : order)
      if (std::isfinite(offers[i].misfit)) all.push_back(offers[i].misfit);
    std::sort(all.begin(), all.end());
    return all.empty() ? -1 : all[std::min<std::size_t>(1, all.size() - 1)];
  }

  // ---- simpler words ----
  /// A set grows by what is best beside its parents, which may be an entry with more parameters than are needed: its
  /// special cases, and in the best sets those that are as simple and do most on the trajectory, are fitted in its
  /// place.
  void contest_the_best() {
    std::vector<Choices> contested;
    for (int pass = 0; pass < study_.options->max_effects; ++pass) {
      std::vector<Candidate> more;
      for (const Candidate& whole : out_.sets) {
        if (whole.fit.cost > as_good * out_.sets.front().fit.cost) break;
        for (const Choice& old : whole.choices) fit_special_cases(whole, old, more);
      }
      for (const Candidate* best : best_of_several()) {
        if (is_among(contested, best->choices)) continue;
        contested.push_back(best->choices);
        for (const Choice& old : best->choices) fit_as_simple(*best, old, more);
      }
      const bool found = !more.empty();
      std::ranges::move(more, std::back_inserter(out_.sets));
      sort_by_cost(out_.sets);
      if (!found) return;
    }
  }

  /// The best set, and the best of fewer effects that fits nearly as well: the simpler one may be named.
  std::vector<const Candidate*> best_of_several() const {
    std::vector<const Candidate*> out;
    const Candidate* best = best_below(SIZE_MAX);
    for (; best; best = best_below(best->choices.size()))
      if (best->fit.cost < nearly * out_.sets.front().fit.cost) out.push_back(best);
    return out;
  }

  /// Of two effects and more, and of fewer than this.
  const Candidate* best_below(std::size_t most) const {
    const Candidate* best = nullptr;
    for (const Candidate& c : out_.sets)
      if (c.choices.size() > 1 && c.choices.size() < most && (!best || priced(c) < priced(*best))) best = &c;
    return best;
  }

  Candidate without(const Candidate& whole, const Choice& old) const {
    Choices set = whole.choices;
    std::erase(set, old);
    const Candidate* known = find_in(out_.sets, set);
    return set.empty() ? baseline_ : known ? *known : compile(study_, model_, set);
  }

  /// `more`: sets that are fitted already, beside those of out_, which are fitted once more where they cost more than
  /// `badly`.
  std::vector<Offer> offers_beside(const Candidate& rest, const Proposer::Parent& space,
                                   const std::vector<Candidate>& more, double badly,
                                   const std::function<bool(const Shape&)>& wanted) {
    std::vector<Offer> offers;
    for (const Shape& shape : shapes_) {
      Choices set = rest.choices;
      set.push_back(shape.choice);
      if (holds(rest.choices, shape.choice.effect) || many_states(shape) || !wanted(shape)) continue;
      if (find_in(more, set)) continue;
      const Candidate* fitted = find_in(out_.sets, set);
      const bool again = fitted && fitted->fit.cost > badly && !is_among(heard_again_, set);
      if (!again && (fitted || is_known(rest, shape.choice))) continue;
      if (again) heard_again_.push_back(set);
      add_offer(offers, rest, space, shape);
    }
    parallel_for(static_cast<int>(offers.size()), study_.options->threads, [&](int i) {
      Standing& s = offers[static_cast<std::size_t>(i)].standing;
      s = proposer_.score(*s.shape, space);
      if (s.shown && std::isfinite(s.cost) && !all_linear(*s.shape)) proposer_.refine(s, space, 10);
    });
    std::erase_if(offers, [](const Offer& o) { return !o.standing.shown || !std::isfinite(o.standing.cost); });
    return offers;
  }

  static bool is_among(const std::vector<Choices>& sets, const Choices& set) {
    return std::ranges::any_of(sets, [&](const Choices& c) { return same(c, set); });
  }

  /// A set that is there already is replaced where it now fits better.
  void fit_in_place(const std::vector<Offer>& offers, const std::vector<std::size_t>& list,
                    std::vector<Candidate>& more) {
    if (list.empty()) return;
    for (Candidate& c : fit_list(offers, list, {}, static_cast<int>(offers.front().parent->choices.size()) + 1)) {
      if (c.degenerate()) continue;
      Candidate* known = find_in(out_.sets, c.choices);
      if (!known)
        more.push_back(std::move(c));
      else if (c.fit.cost < known->fit.cost)
        *known = std::move(c);
    }
  }

  /// Beside the other effects as they are in the whole set.
  void fit_special_cases(const Candidate& whole, const Choice& old, std::vector<Candidate>& more) {
    const auto is_special = [&](const Shape& shape) { return shape.choice.effect->is_special_case(*old.effect); };
    if (std::ranges::none_of(shapes_, is_special)) return;
    Candidate rest = without(whole, old);
    rest.fit.theta = values_of(rest, {&whole});
    rest.fit.cost = INFINITY;  // of no run
    const Proposer::Parent space = proposer_.parent(rest, rest.fit.theta);
    const double badly = nearly * whole.fit.cost;
    const std::vector<Offer> offers = offers_beside(rest, space, more, badly, is_special);
    std::vector<std::size_t> all(offers.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    fit_in_place(offers, all, more);
    for (const Shape& shape : shapes_)
      if (is_special(shape) && !holds(rest.choices, shape.choice.effect))
        fit_as_named(shape, rest.choices, whole, old, badly);
  }

  /// Where an entry that was fitted badly has the names of its more general form (Fc of friction, k of a spring): from
  /// that one's values.
  void fit_as_named(const Shape& shape, const Choices& rest, const Candidate& whole, const Choice& general,
                    double badly) {
    Choices set = rest;
    set.push_back(shape.choice);
    Candidate* known = find_in(out_.sets, set);
    if (!known || !(known->fit.cost > badly)) return;
    Candidate c = compile(study_, model_, set);
    Eigen::VectorXd start = values_of(c, {known, &whole});
    const auto& all = c.system->model().parameters;
    const auto& values = whole.system->model().parameters;
    for (const Parameter& own : shape.choice.effect->parameters)
      for (const Parameter& other : general.effect->parameters) {
        if (own_name(*shape.choice.effect, own.name) != own_name(*general.effect, other.name)) continue;
        const auto to = std::ranges::find(all, own.name, &Parameter::name) - all.begin();
        const auto from = std::ranges::find(values, other.name, &Parameter::name) - values.begin();
        start[to] = whole.fit.theta[from];
      }
    c.starts = {start};
    c.fit = fit_near(study_, c, start, 20, whole.fit.substeps);
    if (c.ran() && !c.degenerate() && c.fit.cost < known->fit.cost) *known = std::move(c);
  }

  /// Where the entry that is left out was the spring, the baseline's own has to take over.
  void fit_part(Candidate& rest, const Candidate& whole) const {
    rest.fit = fit_near(study_, rest, values_of(rest, {&whole}), 20, whole.fit.substeps);
    if (rest.ran() || !baseline_.ran()) return;
    rest.fit = fit_near(study_, rest, values_of(rest, {&whole, &baseline_}), 20, whole.fit.substeps);
  }

  void fit_as_simple(const Candidate& whole, const Choice& old, std::vector<Candidate>& more) {
    const std::size_t own = old.effect->parameters.size();
    const auto is_as_simple = [&](const Shape& shape) { return shape.linear.size() <= own; };
    if (std::ranges::none_of(shapes_, is_as_simple)) return;
    Candidate rest = without(whole, old);
    if (rest.fit.theta.size() == 0) fit_part(rest, whole);
    if (!rest.ran()) return;
    const Proposer::Parent space = proposer_.parent(rest, rest.fit.theta);
    const std::vector<Offer> offers = offers_beside(rest, space, more, INFINITY, is_as_simple);
    fit_in_place(offers, best_on_motion(offers, {}, rest), more);
  }

  // ---- faults of channels: no force to be proposed, but few, and fitted beside all that runs fast ----
  void add_faults(const Candidate& parent, int size, std::vector<Candidate>& level,
                  std::vector<const Candidate*>& grown_from) {
    if (many_states(parent.choices)) return;
    std::vector<Candidate> found;
    std::vector<std::vector<Guess>> guesses;
    for (const auto& fault : faults_) {
      if (holds(parent.choices, fault.choice.effect) || is_known(parent, fault.choice)) continue;
      if (!goes_with(parent.choices, fault.choice)) continue;
      if (parent.added() + fault.choice.effect->parameters.size() >= fewest_) continue;
      Choices set = parent.choices;
      set.push_back(fault.choice);
      found.push_back(compile(study_, model_, set));
      guesses.push_back(fault.guesses);
      out_.tried += std::max<int>(1, static_cast<int>(fault.guesses.size()));
    }
    std::vector<std::uint8_t> there(found.size(), 0);
    parallel_for(static_cast<int>(found.size()), study_.options->threads, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      if (size > 1 && parent.ran())
        start_beside(study_, found[k], parent, guesses[k]);
      else
        find_starts(study_, found[k], parent.best_theta(), {guesses[k]});
      there[k] = !found[k].starts.empty() && shows_beside(study_, found[k], parent);
    });
    for (std::size_t k = 0; k < found.size(); ++k) {
      const std::string name = found[k].choices.back().effect->label();
      if (!there[k] && size == 1 && (out_.left_aside.empty() || out_.left_aside.back() != name))
        out_.left_aside.push_back(name);
      if (!there[k]) continue;
      found[k].force_cost = INFINITY;  // not what a proposal's is
      level.push_back(std::move(found[k]));
      grown_from.push_back(&parent);
    }
  }

  // ---- free runs ----
  std::vector<Candidate> fit_list(const std::vector<Offer>& offers, const std::vector<std::size_t>& list,
                                  const std::vector<Candidate>& parents, int size) {
    std::vector<Candidate> level;
    std::vector<const Candidate*> grown_from;
    std::vector<const Shape*> proposed;  // the proposals come first
    for (const auto i : list) {
      const Offer& o = offers[i];
      proposed.push_back(o.standing.shape);
      Choices set = o.parent->choices;
      set.push_back(o.standing.shape->choice);
      Candidate c = compile(study_, model_, set);
      Eigen::VectorXd start(o.standing.parent.size() + o.standing.own.size());
      start << o.standing.parent, o.standing.own;
      c.starts.push_back(std::move(start));
      c.state_substeps = std::max(o.parent->state_substeps, o.standing.substeps);
      c.force_cost = o.standing.cost;
      c.force_misfit = o.misfit;
      level.push_back(std::move(c));
      grown_from.push_back(o.parent);
    }
    for (std::size_t k = 0; k < std::min<std::size_t>(parents.size(), beam); ++k)
      add_faults(parents[k], size, level, grown_from);
    parallel_for(static_cast<int>(level.size()), study_.options->threads, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      fits_.begin(level[k], *grown_from[k]);
      if (size == 1 && k < proposed.size()) fits_.leave_limits(level[k], *proposed[k], *grown_from[k]);
    });
    sort_by_cost(level);
    std::erase_if(level, [](const Candidate& c) { return !c.ran() && c.choices.size() > 1; });
    if (size == 1 && !study_.imposed) go_on(level);
    const std::vector<std::size_t> ahead = to_the_end(level);
    parallel_for(static_cast<int>(ahead.size()), study_.options->threads, [&](int i) {
      Candidate& c = level[ahead[static_cast<std::size_t>(i)]];
      fits_.end(c);
      leave_limits(c);
    });
    std::erase_if(level, [](const Candidate& c) { return !c.ran(); });
    for (const auto& c : known_.sets)
      if (static_cast<int>(c.choices.size()) == size) level.push_back(c);
    sort_by_cost(level);
    return once_each(level);
  }

  /// A set grows from each of its members, and may end in two fits: the better one.
  static std::vector<Candidate> once_each(std::vector<Candidate>& sorted) {
    std::vector<Candidate> out;
    for (Candidate& c : sorted)
      if (std::none_of(out.begin(), out.end(), [&](const Candidate& o) { return same(o.choices, c.choices); }))
        out.push_back(std::move(c));
    return out;
  }

  /// Twice as many as are fitted to the end, a little further: a steep spring still has far to go where the first
  /// iterations of others are nearly through; along an imposed motion none drifts (successive halving; Jamieson &
  /// Talwalkar 2016, AISTATS 51, 240).
  void go_on(std::vector<Candidate>& sorted) const {
    const auto most = static_cast<std::size_t>(2 * long_fits * per_size_ / per_size);
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
  std::vector<std::size_t> to_the_end(const std::vector<Candidate>& sorted) const {
    std::vector<std::size_t> list;
    const auto take = [&](std::size_t i) {
      if (std::ranges::find(list, i) == list.end()) list.push_back(i);
    };
    for (std::size_t i = 0; i < sorted.size() && std::ssize(list) < long_fits * per_size_ / per_size; ++i)
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

  bool is_known(const Candidate& parent, const Choice& added) const {
    Choices set = parent.choices;
    set.push_back(added);
    return find_in(known_.sets, set);
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
    const auto plainest = std::min_element(sorted.begin(), sorted.end(), [](const Candidate& a, const Candidate& b) {
      return a.force_misfit < b.force_misfit;
    });
    if (std::isfinite(plainest->force_misfit)) take_from_force(*plainest, parents);
    return parents;
  }

  static void take_from_force(const Candidate& c, std::vector<Candidate>& parents) {
    if (std::any_of(parents.begin(), parents.end(), [&](const Candidate& p) { return same(p.choices, c.choices); }))
      return;
    parents.push_back(c);
    parents.back().fit.theta = c.starts.front();
  }

  const Study& study_;
  const Model& model_;
  const Candidate& baseline_;
  std::span<const Effect> catalogue_;
  const Grown& known_;
  const std::function<void(const std::string&, double)>& progress_;
  const Proposer proposer_, plain_;
  const ProposalFits fits_;
  const int per_size_;             ///< proposals of one number of parameters that are run
  std::size_t fewest_ = SIZE_MAX;  ///< parameters of a single effect that leaves no more than the noise
  struct ChannelFault {
    Choice choice;
    std::vector<Guess> guesses;
  };
  PlacedScales scales_{study_, baseline_};
  std::vector<Shape> shapes_;
  std::vector<ChannelFault> faults_;
  std::vector<Choices> heard_again_;  ///< special cases that were fitted badly beside a more general form
  Grown out_;
};

}  // namespace

bool holds(const Choices& set, const Effect* effect) {
  return std::any_of(set.begin(), set.end(), [&](const Choice& c) { return c.effect == effect; });
}

bool same(Choices a, Choices b) {
  const auto order = [](const Choice& x, const Choice& y) {
    return std::make_pair(x.effect, x.variant) < std::make_pair(y.effect, y.variant);
  };
  std::sort(a.begin(), a.end(), order);
  std::sort(b.begin(), b.end(), order);
  return a == b;
}

bool within(const Choices& part, const Choices& whole) {
  return std::all_of(part.begin(), part.end(),
                     [&](const Choice& x) { return std::find(whole.begin(), whole.end(), x) != whole.end(); });
}

bool related(const Choices& a, const Choices& b) {
  const auto are = [](const Choice& x, const Choice& y) {
    return x.effect->is_special_case(*y.effect) || y.effect->is_special_case(*x.effect);
  };
  return std::ranges::any_of(
      a, [&](const Choice& x) { return std::ranges::any_of(b, [&](const Choice& y) { return are(x, y); }); });
}

bool is_general_form(const Choices& general, const Choices& special) {
  const auto is_covered = [&](const Choice& s) {
    return std::ranges::any_of(
        general, [&](const Choice& g) { return s.effect == g.effect || s.effect->is_special_case(*g.effect); });
  };
  return general.size() == special.size() && std::ranges::all_of(special, is_covered);
}

Grown grow(const Study& study, const Model& model, const Candidate& baseline, std::span<const Effect> catalogue,
           const Grown& known, const std::function<void(const std::string&, double)>& progress) {
  return Grower(study, model, baseline, catalogue, known, progress).run();
}

}  // namespace lunid
