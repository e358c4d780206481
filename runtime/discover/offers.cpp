#include "discover/offers.hpp"

#include <algorithm>
#include <numeric>

#include "discover/judge.hpp"
#include "discover/linearised.hpp"
#include "discover/proposal_fits.hpp"
#include "record/parallel.hpp"

namespace lunid {

namespace {

constexpr int refined = 24;  // proposals whose shape parameters are refined on the force
constexpr int later_refined = 12;
constexpr int least_per_size = 3;  // proposals of one number of parameters that are run; of short records more
constexpr int most_per_size = 9;
constexpr double rows_of_runs = 12000;  // so many rows are run for the proposals of one number of parameters
constexpr int first_runs = 4;           // the best proposals that are run in any case
constexpr int later_runs = 6;           // the same of sets of two and more
constexpr int heavy_runs = 3;           // beside an entry of many states, which takes no more than one other
constexpr double as_good = 1.5;  // times the best squared misfit of the force: as far as entries of many states are run
constexpr double far = 40;       // the same as far as they are refined, and run where no other reaches the noise
constexpr std::size_t slow_runs = 2;
constexpr std::size_t runs_by_motion = 3;  // of what the force does not show
constexpr double near_enough = 0.5;        // of the motion, for that

int runs_per_size(const Study& study) {
  return static_cast<int>(
      std::clamp<double>(rows_of_runs / static_cast<double>(study.rows()), least_per_size, most_per_size));
}

/// The best proposal at other places: a rival of itself.
void add_other_places(const std::vector<Offer>& offers, const std::vector<std::size_t>& order,
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

/// The misfit of the second best on the force as it is; those are run in any case.
double plain_limit(const std::vector<Offer>& offers, const std::vector<std::size_t>& order) {
  std::vector<double> all;
  for (const auto i : order)
    if (std::isfinite(offers[i].misfit)) all.push_back(offers[i].misfit);
  std::sort(all.begin(), all.end());
  return all.empty() ? -1 : all[std::min<std::size_t>(1, all.size() - 1)];
}

bool is_told(const Offer& o) { return o.standing.shown && std::isfinite(o.standing.cost); }

/// Where no force acts a mass that is taken away whole takes all with it.
bool takes_all(const Offer& o) {
  constexpr double nothing = 1e-6;
  const Model& added = o.standing.shape->system->model();
  if (!is_told(o) || !o.parent->ran() || o.standing.cost > nothing * o.space->cost) return false;
  const std::vector<double> own = inertias(o.parent->system->model(), o.parent->fit.theta);
  std::vector<double> left = inertias(added, o.standing.own);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] += own[i];
  return takes_the_mass(own, left);
}

}  // namespace

int Offers::as_affordable(int usual) const { return usual * per_size_ / least_per_size; }

Choices Offer::set() const { return with(parent->choices, standing.shape->choice); }

Offers::Offers(const Study& study, const Model& model, const Candidate& baseline, std::span<const Effect> catalogue,
               const Grown& known, Grown& out)
    : study_(study),
      model_(model),
      known_(known),
      out_(out),
      proposer_(study, baseline),
      plain_(study, baseline, false),
      per_size_(runs_per_size(study)),
      scales_(study, baseline) {
  for (const auto& effect : catalogue) {
    if (is_element_of(model, effect)) {
      out_.left_aside.push_back(effect.label() + " (is in the baseline already)");
      continue;
    }
    for (int variant = 0; variant < static_cast<int>(effect.variants.size()); ++variant) {
      const Choice choice{&effect, variant};
      if (choice.form().force.valid())
        shapes_.push_back(proposer_.shape(model_, choice, scales_.at(effect.place)));
      else
        faults_.push_back({choice, scales_.guesses(choice)});
    }
  }
}

void Offers::run_along_the_motion() {
  run_shapes([](const Shape& shape) { return !many_states(shape); });
}

void Offers::run_shapes(const std::function<bool(const Shape&)>& wanted) {
  parallel_for(static_cast<int>(shapes_.size()), study_.options->threads, [&](int i) {
    Shape& shape = shapes_[static_cast<std::size_t>(i)];
    if (wanted(shape) && shape.choice.effect->number == 1) proposer_.run(shape);
  });
  for (Shape& shape : shapes_)
    if (const Shape* first = wanted(shape) ? first_of(shape) : nullptr) shape.take_runs_of(*first);
}

/// Of an entry that stands several times, the first; null of that.
const Shape* Offers::first_of(const Shape& repetition) const {
  if (repetition.choice.effect->number == 1) return nullptr;
  const auto at = std::ranges::find_if(shapes_, [&](const Shape& s) { return same({s.choice}, {repetition.choice}); });
  return &*at;
}

bool Offers::is_known(const Candidate& parent, const Choice& added) const {
  return known_.find(with(parent.choices, added));
}

const Shape* Offers::shape_of(const Choice& choice) const {
  const auto at = std::ranges::find_if(shapes_, [&](const Shape& s) { return s.choice == choice; });
  return at != shapes_.end() ? &*at : nullptr;
}

void Offers::add(std::vector<Offer>& offers, const Candidate& parent, const Proposer::Parent& space,
                 const Shape& shape) {
  offers.push_back({&parent, &space, {}});
  offers.back().standing.shape = &shape;
  out_.tried += static_cast<int>(shape.guesses.size());
}

void Offers::each(std::vector<Offer>& offers, const std::vector<std::size_t>& list,
                  const std::function<void(Offer&)>& job) const {
  parallel_for(static_cast<int>(list.size()), study_.options->threads,
               [&](int i) { job(offers[list[static_cast<std::size_t>(i)]]); });
}

Offers::Round Offers::beside(const std::vector<Candidate>& parents, std::size_t fewest) {
  const bool single = parents.front().choices.empty();
  Round round;
  round.spaces.resize(parents.size());
  parallel_for(static_cast<int>(parents.size()), study_.options->threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    round.spaces[k] = space_of(parents[k], parents[k].best_theta());
  });
  for (std::size_t k = 0; k < parents.size(); ++k)
    for (const auto& shape : shapes_) {
      if (!may_join(parents[k].choices, *shape.choice.effect) || is_known(parents[k], shape.choice)) continue;
      if (parents[k].added() + shape.linear.size() >= fewest || are_too_many(parents[k], shape)) continue;
      add(round.all, parents[k], round.spaces[k], shape);
    }
  std::vector<std::size_t> order(round.all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  each(round.all, order, [&](Offer& o) { o.standing = proposer_.score(*o.standing.shape, *o.space); });
  for (Offer& o : round.all)
    if (takes_all(o)) o.standing.shown = false;
  if (single) {
    score_many_states(round.all, order);
    leave_aside(round.all);
    const Proposer::Parent space = plain_.parent(parents.front(), parents.front().best_theta());
    each(round.all, order, [&](Offer& o) { o.misfit = misfit(*o.standing.shape, space); });
  }
  std::erase_if(order, [&](std::size_t i) { return !is_told(round.all[i]); });
  const auto by_cost = [&](std::size_t a, std::size_t b) {
    return round.all[a].standing.cost < round.all[b].standing.cost;
  };
  std::stable_sort(order.begin(), order.end(), by_cost);
  refine_the_best(round.all, order, single);
  std::stable_sort(order.begin(), order.end(), by_cost);
  shortlist(round, order, single);
  if (single && !round.worth_runs.empty()) add_other_places(round.all, order, round.worth_runs);
  return round;
}

std::vector<Offer> Offers::beside(const Candidate& parent, const Proposer::Parent& space,
                                  const std::function<bool(const Shape&)>& wanted) {
  std::vector<Offer> offers;
  for (const Shape& shape : shapes_)
    if (wanted(shape)) add(offers, parent, space, shape);
  parallel_for(static_cast<int>(offers.size()), study_.options->threads, [&](int i) {
    Offer& o = offers[static_cast<std::size_t>(i)];
    o.standing = proposer_.score(*o.standing.shape, space);
    if (is_told(o) && !all_linear(*o.standing.shape)) proposer_.refine(o.standing, space, 10);
  });
  std::erase_if(offers, [](const Offer& o) { return !is_told(o); });
  return offers;
}

const Shape* Offers::half_of_a_masked_pair(const Proposer::Parent& space, const std::vector<Candidate>& parents) const {
  constexpr double far_less = 0.5;  // of the squared misfit beside a parent
  std::vector<const Shape*> shapes;
  std::vector<bool> is_parent;
  for (const Shape& shape : shapes_) {
    if (many_states(shape) || shape.columns.empty() || shape.choice.effect->number > 1) continue;
    shapes.push_back(&shape);
    is_parent.push_back(
        std::ranges::any_of(parents, [&](const Candidate& p) { return same(p.choices, {shape.choice}); }));
  }
  const Eigen::MatrixXd costs = proposer_.pair_costs(shapes, space);
  double beside_a_parent = space.cost, least = INFINITY;
  const Shape* half = nullptr;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto at = [&](std::size_t a, std::size_t b) { return costs(Eigen::Index(a), Eigen::Index(b)); };
      if (!may_join({shapes[i]->choice}, *shapes[j]->choice.effect)) continue;
      const double cost = at(i, j);
      if (is_parent[i] || is_parent[j]) {
        beside_a_parent = std::min(beside_a_parent, cost);
      } else if (cost < least) {
        least = cost;
        half = at(i, i) < at(j, j) ? shapes[i] : shapes[j];
      }
    }
  return least < far_less * beside_a_parent ? half : nullptr;
}

/// Entries of many states take longer along the motion than all others together: they are looked at where one of few
/// states comes near to the best, at the same place.
void Offers::score_many_states(std::vector<Offer>& offers, const std::vector<std::size_t>& all) {
  std::vector<std::optional<Place>> near;
  for (const auto& place : scales_.places())
    if (memory_comes_near(offers, place)) near.push_back(place);
  const auto wanted = [&](const Shape& shape) {
    return many_states(shape) && std::find(near.begin(), near.end(), shape.choice.effect->place) != near.end();
  };
  run_shapes(wanted);
  each(offers, all, [&](Offer& o) {
    if (wanted(*o.standing.shape)) o.standing = proposer_.score(*o.standing.shape, *o.space);
  });
}

bool Offers::memory_comes_near(const std::vector<Offer>& offers, const std::optional<Place>& place) const {
  double best = INFINITY, memory = INFINITY;
  const auto hear = [&](double cost, const Effect& effect, bool remembers) {
    best = std::min(best, cost);
    if (remembers && effect.place == place) memory = std::min(memory, cost);
  };
  for (const auto& o : offers)
    if (o.standing.shown)
      hear(o.standing.cost, *o.standing.shape->choice.effect, !o.standing.shape->system->model().states.empty());
  for (const Candidate* known : known_.of_size(1)) {
    const Effect& effect = *known->choices.front().effect;
    hear(known->force_cost, effect, !effect.states.empty());
  }
  return memory <= as_good * best;
}

/// What an entry without memory would leave of the force itself.
double Offers::misfit(const Shape& shape, const Proposer::Parent& space) const {
  if (!shape.system->model().states.empty()) return INFINITY;
  Shape alone{shape.choice, shape.system, shape.linear, shape.guesses};
  plain_.run(alone);
  const Standing standing = plain_.score(alone, space);
  return standing.shown && std::isfinite(standing.cost) ? standing.cost : INFINITY;
}

void Offers::leave_aside(const std::vector<Offer>& offers) {
  for (const auto& o : offers) {
    if (o.standing.shape->columns.empty()) continue;  // not looked at
    const std::string name = o.standing.shape->choice.effect->label();
    const bool other = std::any_of(offers.begin(), offers.end(), [&](const Offer& x) {
      return x.standing.shown && x.standing.shape->choice.effect == o.standing.shape->choice.effect;
    });
    if (!other && (out_.left_aside.empty() || out_.left_aside.back() != name)) out_.left_aside.push_back(name);
  }
}

/// Shape parameters of the best proposals; of many states only where they come near, from a first guess that is
/// coarse.
void Offers::refine_the_best(std::vector<Offer>& offers, const std::vector<std::size_t>& sorted, bool single) const {
  std::vector<std::size_t> leaders;
  for (const auto i : sorted) {
    const Standing& s = offers[i].standing;
    const bool too_far = many_states(*s.shape) && s.cost > far * offers[sorted.front()].standing.cost;
    if (std::ssize(leaders) < (single ? refined : later_refined) && !all_linear(*s.shape) && !too_far)
      leaders.push_back(i);
  }
  each(offers, leaders, [&](Offer& o) { proposer_.refine(o.standing, *o.space, 10); });
}

/// The best on the force, and the best of each number of parameters: a set with more of them often comes first there
/// where a simpler one is as good. Simple ones first where the same effect stands twice (its variants). Single effects
/// of many states that are farther from the best are `slow`: what memory makes of a noisy motion says little.
void Offers::shortlist(Round& round, const std::vector<std::size_t>& order, bool single) const {
  std::vector<int> count(9, 0);
  std::vector<Choices> seen;
  int heavy = 0;
  const std::size_t always = single ? first_runs : later_runs;
  const double plainly = plain_limit(round.all, order);
  const double best = order.empty() ? INFINITY : round.all[order.front()].standing.cost;
  for (const std::size_t i : order) {
    const Offer& o = round.all[i];
    Choices set = o.set();
    if (is_among(seen, set)) continue;
    const auto parameters =
        std::min<std::size_t>(single ? 4 : 8, o.parent->added() + static_cast<std::size_t>(o.standing.own.size()));
    const bool gains = o.standing.cost < (1 - 10.0 / static_cast<double>(rows())) * o.space->cost;
    if (many_states(*o.standing.shape) && o.standing.cost > as_good * best) {
      if (single && round.slow.size() < slow_runs && o.standing.cost < far * best) round.slow.push_back(i);
      continue;
    }
    if (many_states(o.parent->choices) && ++heavy > heavy_runs) continue;
    const bool is_first = round.worth_runs.size() < always;
    if (!is_first && !(o.misfit <= plainly) && !(gains && count[parameters] < (single ? per_size_ : 1))) continue;
    ++count[parameters];
    seen.push_back(std::move(set));
    round.worth_runs.push_back(i);
  }
}

std::vector<std::size_t> Offers::best_on_motion(const std::vector<Offer>& offers,
                                                const std::vector<std::size_t>& fitted, const Candidate& parent,
                                                bool open) const {
  if (!parent.ran() || !(rms(parent) < near_enough * study_.measured_std())) return {};
  if (!open && !is_above_noise(study_, parent)) return {};
  std::vector<std::size_t> others;
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < offers.size(); ++i) {
    const Offer& o = offers[i];
    if (o.parent->choices != parent.choices || !o.standing.shown || o.standing.own.size() == 0) continue;
    if (!open && !o.standing.shape->choice.effect->states.empty()) continue;
    if (many_states(*o.standing.shape) || std::find(fitted.begin(), fitted.end(), i) != fitted.end()) continue;
    others.push_back(i);
    candidates.push_back(compile(study_, model_, o.set()));
  }
  const Whitening whitening = residual_colour(study_, parent);
  std::vector<MotionGain> gains(others.size());
  parallel_for(static_cast<int>(others.size()), study_.options->threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    const Standing& s = offers[others[k]].standing;
    Eigen::VectorXd theta(candidates[k].parameters());
    theta << parent.fit.theta, s.own;
    gains[k] = gain_on_motion(study_, whitening, parent, candidates[k], theta);
  });
  std::vector<std::size_t> order(others.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return gains[a].gain > gains[b].gain; });
  // Of an entry its best form. A small gain is no reason against: beside a poor model the noise has the colour of what
  // is missing, which hides it.
  std::vector<std::size_t> out;
  const auto is_taken = [&](const Effect* effect) {
    return std::ranges::any_of(out, [&](std::size_t i) { return offers[i].standing.shape->choice.effect == effect; });
  };
  for (const std::size_t k : order) {
    if (!(gains[k].p_value < study_.options->alpha) || is_taken(offers[others[k]].standing.shape->choice.effect))
      continue;
    out.push_back(others[k]);
    if (out.size() == runs_by_motion) break;
  }
  return out;
}

}  // namespace lunid
