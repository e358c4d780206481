#include "discover/contest.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "discover/places.hpp"

namespace lunid {

namespace {

constexpr double as_good = 1.5;  // times the least squared error: as far as special cases are heard
constexpr double nearly = 1.15;  // as good, in squared error

class Contest {
 public:
  Contest(const Study& study, const Model& model, const Candidate& baseline, const Grown& known, Offers& offers,
          LevelFits& fits, Grown& out)
      : study_(study), model_(model), baseline_(baseline), known_(known), offers_(offers), fits_(fits), out_(out) {}

  void run() {
    std::vector<Choices> generalised, contested;
    for (int pass = 0; pass < study_.most_effects; ++pass) {
      std::vector<Candidate> more;
      for (const Candidate& whole : out_.sets) {
        if (whole.fit.cost > as_good * out_.sets.front().fit.cost) break;
        for (const Choice& old : whole.choices) fit_special_cases(whole, old, more);
      }
      for (const Candidate* whole : best_at_limits())
        for (const Choice& old : whole->choices) fit_special_cases(*whole, old, more);
      for (const Candidate* best : open_of_several()) {
        if (is_among(generalised, best->choices)) continue;
        generalised.push_back(best->choices);
        for (const Choice& old : best->choices) {
          fit_general_forms(*best, old, more);
          fit_others(*best, old, more);
        }
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

 private:
  /// Degenerate sets that come down to the noise, where no other does: they are none, but what they have grown into is
  /// one with a simpler entry. A clearance without a gap beside a damping is a spring beside it. Of those that do not,
  /// a part that fits better would only make other names of what no set explains (EMPS).
  std::vector<const Candidate*> best_at_limits() const {
    constexpr std::size_t most = 4;
    std::vector<const Candidate*> out;
    if (!out_.sets.empty() && !is_above_noise(study_, out_.sets.front())) return out;
    for (const Candidate& c : out_.at_limits)
      if (out.size() < most && c.ran() && !is_above_noise(study_, c)) out.push_back(&c);
    return out;
  }

  /// The best of each number of effects from two on, and of those that were known before, where it leaves more than
  /// the noise: a common entry may stand for its general form, which is not among the common ones, and what many
  /// parameters follow leave less than both.
  std::vector<const Candidate*> open_of_several() const {
    std::vector<const Candidate*> out;
    const auto size_of = [](const Candidate& c) { return c.choices.size(); };
    for (std::size_t size = 2; size <= static_cast<std::size_t>(study_.most_effects); ++size) {
      const auto best = std::ranges::find(out_.sets, size, size_of);
      if (best == out_.sets.end() || !is_above_noise(study_, *best)) continue;
      out.push_back(&*best);
      const auto known = std::ranges::find(known_.sets, size, size_of);
      if (known == known_.sets.end() || known->choices == best->choices) continue;
      if (const Candidate* fitted = find_in(out_.sets, known->choices)) out.push_back(fitted);
    }
    return out;
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

  using Wanted = std::function<bool(const Shape&)>;

  /// `more`: sets that are fitted already, beside those of out_, which are fitted once more where they cost more than
  /// `badly`.
  std::vector<Offer> offers_beside(const Candidate& rest, const Proposer::Parent& space,
                                   const std::vector<Candidate>& more, double badly, const Wanted& wanted) {
    return offers_.beside(rest, space, [&](const Shape& shape) {
      if (!may_join(rest.choices, *shape.choice.effect) || many_states(shape) || !wanted(shape)) return false;
      if (are_too_many(rest, shape)) return false;
      const Choices set = with(rest.choices, shape.choice);
      if (find_in(more, set)) return false;
      const Candidate* fitted = find_in(out_.sets, set);
      const bool again = fitted && fitted->fit.cost > badly && !is_among(heard_again_, set);
      if (again) heard_again_.push_back(set);
      return again || (!fitted && !find_in(known_.sets, set));
    });
  }

  /// A set that is there already is replaced where it now fits better. From one start it is fitted once, whatever came
  /// of it: what ended at a limit, or worse, is not among the sets.
  void fit_in_place(const std::vector<Offer>& offers, std::vector<std::size_t> list, std::vector<Candidate>& more) {
    std::erase_if(list, [&](std::size_t i) { return has_begun(offers[i]); });
    if (list.empty()) return;
    for (Candidate& c : fits_.fit(offers, list, static_cast<int>(offers.front().set().size()))) {
      if (c.degenerate()) continue;
      Candidate* known = find_in(out_.sets, c.choices);
      if (!known)
        more.push_back(std::move(c));
      else if (c.fit.cost < known->fit.cost)
        *known = std::move(c);
    }
  }

  bool has_begun(const Offer& offer) {
    Start start{offer.set(), offer.standing.parent, offer.standing.own};
    if (std::ranges::find(begun_, start) != begun_.end()) return true;
    begun_.push_back(std::move(start));
    return false;
  }

  /// Beside the other effects as they are in the whole set; no more than `most`, those that explain most of the force.
  /// `alone`: and as they were fitted without it, where they were: in the whole set they may stand for a part of what
  /// the wanted one does.
  void fit_in_its_place(const Candidate& whole, const Choice& old, double badly, const Wanted& wanted,
                        std::vector<Candidate>& more, std::size_t most = SIZE_MAX, bool alone = false) {
    if (std::ranges::none_of(offers_.shapes(), wanted)) return;
    const Candidate own = without(whole, old);
    std::vector<Candidate> rests{own};
    rests.front().fit.theta = values_of(own, {&whole});
    rests.front().fit.cost = INFINITY;  // of no run
    if (alone && own.fit.theta.size() > 0 && own.ran()) rests.push_back(own);
    std::vector<Proposer::Parent> spaces;
    for (const Candidate& rest : rests) spaces.push_back(offers_.space_of(rest, rest.fit.theta));
    std::vector<Offer> offers;
    for (std::size_t k = 0; k < rests.size(); ++k)
      std::ranges::move(offers_beside(rests[k], spaces[k], more, badly, wanted), std::back_inserter(offers));
    std::vector<std::size_t> list(offers.size());
    std::iota(list.begin(), list.end(), std::size_t{0});
    if (list.size() > most) {
      std::ranges::stable_sort(list, {}, [&](std::size_t i) { return offers[i].standing.cost; });
      list.resize(most);
    }
    fit_in_place(offers, list, more);
  }

  void fit_general_forms(const Candidate& whole, const Choice& old, std::vector<Candidate>& more) {
    const auto is_general = [&](const Shape& shape) { return old.is_special_case(shape.choice); };
    fit_in_its_place(whole, old, whole.fit.cost, is_general, more, SIZE_MAX, true);
  }

  /// Those of no more parameters that explain most of the force in its place: what came first beside a parent that
  /// lacked the rest (a sine for a cubic spring whose sensor is off its zero) may be second to others beside it.
  void fit_others(const Candidate& whole, const Choice& old, std::vector<Candidate>& more) {
    const auto is_as_simple = [&, own = old.parameters().size()](const Shape& shape) {
      return shape.linear.size() <= own && shape.choice != old;
    };
    fit_in_its_place(whole, old, whole.fit.cost, is_as_simple, more, 2);
  }

  void fit_special_cases(const Candidate& whole, const Choice& old, std::vector<Candidate>& more) {
    const auto is_special = [&](const Shape& shape) { return shape.choice.is_special_case(old); };
    const double badly = nearly * whole.fit.cost;
    fit_in_its_place(whole, old, badly, is_special, more);
    const Choices rest = without(whole, old).choices;
    for (const Shape& shape : offers_.shapes())
      if (is_special(shape) && find_in(out_.sets, with(rest, shape.choice)))
        fit_as_named(shape.choice, rest, whole, old, badly, more);
    for (const auto& fault : offers_.faults())  // along an imposed motion an offset is no more than a constant force
      if (!study_.imposed && fault.choice.is_special_case(old))
        fit_as_named(fault.choice, rest, whole, old, badly, more);
  }

  /// Where an entry that was fitted badly, or not at all, has the names of its more general form (Fc of friction, k of
  /// a spring, b of an offset): from that one's values.
  void fit_as_named(const Choice& special, const Choices& rest, const Candidate& whole, const Choice& general,
                    double badly, std::vector<Candidate>& more) {
    const Choices set = with(rest, special);
    Candidate* known = find_in(out_.sets, set);
    if (!may_join(rest, *special.effect) || find_in(more, set) || (known && !(known->fit.cost > badly))) return;
    Candidate c = compile(study_, model_, set);
    Eigen::VectorXd start = known ? values_of(c, {known, &whole}) : values_of(c, {&whole});
    const auto& all = c.system->model().parameters;
    const auto& values = whole.system->model().parameters;
    for (const Parameter& own : special.parameters())
      for (const Parameter& other : general.parameters()) {
        if (own_name(*special.effect, own.name) != own_name(*general.effect, other.name)) continue;
        const auto to = std::ranges::find(all, own.name, &Parameter::name) - all.begin();
        const auto from = std::ranges::find(values, other.name, &Parameter::name) - values.begin();
        start[to] = whole.fit.theta[from];
      }
    c.starts = {start};
    c.fit = fit_near(study_, c, start, 20, whole.fit.substeps);
    if (!c.ran() || c.degenerate()) return;
    if (!known)
      more.push_back(std::move(c));
    else if (c.fit.cost < known->fit.cost)
      *known = std::move(c);
  }

  /// Where the entry that is left out was the spring, the baseline's own has to take over.
  void fit_part(Candidate& rest, const Candidate& whole) const {
    rest.fit = fit_near(study_, rest, values_of(rest, {&whole}), 20, whole.fit.substeps);
    if (rest.ran() || !baseline_.ran()) return;
    rest.fit = fit_near(study_, rest, values_of(rest, {&whole, &baseline_}), 20, whole.fit.substeps);
  }

  void fit_as_simple(const Candidate& whole, const Choice& old, std::vector<Candidate>& more) {
    const std::size_t own = old.parameters().size();
    const auto is_as_simple = [&](const Shape& shape) { return shape.linear.size() <= own; };
    if (std::ranges::none_of(offers_.shapes(), is_as_simple)) return;
    Candidate rest = without(whole, old);
    if (rest.fit.theta.size() == 0) fit_part(rest, whole);
    if (!rest.ran()) return;
    const Proposer::Parent space = offers_.space_of(rest, rest.fit.theta);
    const std::vector<Offer> offers = offers_beside(rest, space, more, INFINITY, is_as_simple);
    fit_in_place(offers, offers_.best_on_motion(offers, {}, rest), more);
  }

  const Study& study_;
  const Model& model_;
  const Candidate& baseline_;
  const Grown& known_;
  Offers& offers_;
  LevelFits& fits_;
  Grown& out_;
  struct Start {
    Choices set;
    Eigen::VectorXd parent, own;  // parameters
    bool operator==(const Start&) const = default;
  };
  std::vector<Start> begun_;
  std::vector<Choices> heard_again_;  ///< special cases that were fitted badly beside a more general form
};

}  // namespace

void contest_the_best(const Study& study, const Model& model, const Candidate& baseline, const Grown& known,
                      Offers& offers, LevelFits& fits, Grown& out) {
  Contest(study, model, baseline, known, offers, fits, out).run();
}

}  // namespace lunid
