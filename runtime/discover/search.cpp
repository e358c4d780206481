#include "discover/search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>

#include "discover/sensor.hpp"
#include "record/parallel.hpp"

namespace lunid {

namespace {

constexpr int beam = 2;       // sets that grow by one more effect
constexpr int full_fits = 6;  // sets of one size that are fitted on the trajectory
constexpr int finalists = 3;  // sets that are judged under the common noise colour

class Search {
 public:
  Search(const Study& study, const Model& model, const Candidate& baseline, const std::vector<Effect>& catalogue,
         const std::function<void(const std::string&, double)>& progress)
      : study_(study), model_(model), catalogue_(catalogue), progress_(progress) {
    result_.baseline = baseline;
  }

  SearchResult run() {
    std::vector<Candidate> previous{result_.baseline};
    for (int size = 1; size <= study_.options->max_effects; ++size) {
      progress_("propose and fit, " + std::to_string(size) + (size == 1 ? " effect" : " effects"), 0.15 + 0.12 * size);
      std::vector<Candidate> level = grow(previous, size);
      if (level.empty()) break;
      sort_by_cost(level);
      const bool better = worth_growing(previous.front(), level.front());
      for (const auto& c : level)
        if (!c.degenerate()) all_.push_back(c);
      const bool masked = size == 1 && rms(result_.baseline) > 1.3 * study_.sensor_noise();
      if (!better && !masked) break;
      previous = parents_among(level);
    }
    progress_("compare", 0.7);
    decide();
    return std::move(result_);
  }

 private:
  static void sort_by_cost(std::vector<Candidate>& list) {
    std::stable_sort(list.begin(), list.end(),
                     [](const Candidate& a, const Candidate& b) { return a.fit.cost < b.fit.cost; });
  }

  /// The sets that grow by one more effect: the best on the trajectory, and the one that explains most of the force.
  /// The two differ where one missing effect makes free runs drift so far that another does not show in them.
  static std::vector<Candidate> parents_among(const std::vector<Candidate>& sorted) {
    std::vector<Candidate> parents(sorted.begin(), sorted.begin() + std::min<std::ptrdiff_t>(beam, std::ssize(sorted)));
    const auto by_force = std::min_element(sorted.begin(), sorted.end(), [](const Candidate& a, const Candidate& b) {
      return a.force_cost < b.force_cost;
    });
    if (by_force - sorted.begin() >= beam) {
      parents.push_back(*by_force);
      parents.back().fit.theta = by_force->starts.front();
    }
    return parents;
  }

  double rms(const Candidate& c) const { return std::sqrt(c.fit.cost / static_cast<double>(c.fit.rows)); }

  /// Growing goes on while the error falls visibly and is not yet what the sensor alone leaves.
  bool worth_growing(const Candidate& before, const Candidate& after) const {
    if (!after.ran()) return false;
    if (!before.ran()) return true;
    return rms(after) < (1 - required_gain(study_, rms(after) / study_.measured_std())) * rms(before) &&
           rms(after) > 1.02 * study_.sensor_noise();
  }

  static bool holds(const Choices& set, const Effect* effect) {
    return std::any_of(set.begin(), set.end(), [&](const Choice& c) { return c.effect == effect; });
  }

  static bool same(Choices a, Choices b) {
    auto order = [](const Choice& x, const Choice& y) {
      return std::make_pair(x.effect, x.variant) < std::make_pair(y.effect, y.variant);
    };
    std::sort(a.begin(), a.end(), order);
    std::sort(b.begin(), b.end(), order);
    return a == b;
  }

  /// What the study and a model's misfit tell an entry that guesses.
  RecordScales scales_beside(const Candidate& parent) const {
    RecordScales s = scales(study_, residual_force(parent));
    s.lines = residual_lines(study_, parent);
    return s;
  }

  static std::vector<Guess> guesses_of(const Choice& choice, const RecordScales& scales) {
    if (!choice.effect->guess) return {};
    return choice.effect->guess(scales, choice.variant);
  }

  std::vector<Candidate> grow(const std::vector<Candidate>& parents, int size) {
    std::vector<Candidate> level;
    std::vector<const Candidate*> parent_of;
    std::vector<std::vector<Guess>> guesses;
    for (const auto& parent : parents) {
      const RecordScales known = scales_beside(parent);
      for (const auto& effect : catalogue_)
        for (int variant = 0; variant < static_cast<int>(effect.variants.size()); ++variant) {
          if (holds(parent.choices, &effect)) continue;
          Choices set = parent.choices;
          set.push_back({&effect, variant});
          if (std::any_of(level.begin(), level.end(), [&](const Candidate& c) { return same(c.choices, set); }))
            continue;
          level.push_back(compile(study_, model_, set));
          parent_of.push_back(&parent);
          guesses.push_back(guesses_of({&effect, variant}, known));
          result_.tried += std::max<int>(1, static_cast<int>(guesses.back().size()));
        }
    }
    parallel_for(static_cast<int>(level.size()), study_.options->threads, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      find_starts(study_, level[k], parent_of[k]->fit.theta, {guesses[k]});
    });
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (level[i].starts.empty()) continue;
      if (shows(level[i], *parent_of[i])) {
        order.push_back(i);
      } else if (size == 1) {
        result_.left_aside.push_back(level[i].choices.back().effect->name);
      }
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return level[a].force_cost < level[b].force_cost; });
    if (size > 1 && order.size() > full_fits) order.resize(full_fits);
    parallel_for(static_cast<int>(order.size()), study_.options->threads, [&](int i) {
      const std::size_t k = order[static_cast<std::size_t>(i)];
      fit_candidate(level[k], *parent_of[k]);
    });
    std::vector<Candidate> out;
    for (const auto k : order)
      if (level[k].ran()) out.push_back(std::move(level[k]));
    return out;
  }

  double residual_force(const Candidate& parent) const {
    double squares = 0, rows = 0;
    for (const auto& record : study_.smooth) {
      const Eigen::VectorXd model = imposed_force(
          *parent.force_system, {parent.fit.theta.data(), static_cast<std::size_t>(parent.fit.theta.size())}, record);
      const auto f = record["F"];
      squares += (Eigen::Map<const Eigen::VectorXd>(f.data(), model.size()) - model).squaredNorm();
      rows += static_cast<double>(model.size());
    }
    return std::isfinite(squares) ? std::sqrt(squares / rows) : 0;
  }

  /// False when the new parameters' force is a combination of the others' on this record (rank).
  bool shows(const Candidate& candidate, const Candidate& parent) const {
    if (!candidate.seen_by_force) return true;  // a sensor's fault that only the trajectory shows
    const Eigen::Index before = parent.parameters(), p = candidate.parameters();
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(p, p);
    const Eigen::VectorXd& theta = candidate.starts.front();
    for (const auto& data : study_.force) {
      Eigen::MatrixXd jacobian;
      imposed_force(*candidate.force_system, {theta.data(), static_cast<std::size_t>(p)}, data.record, &jacobian,
                    start_substeps);
      gram += jacobian.transpose() * jacobian;
    }
    if (!gram.allFinite()) return true;  // the trajectory will tell
    // an entry without a linear parameter (elastic_slip) shows by any of its parameters
    const bool all_shape =
        std::none_of(candidate.linear.begin() + before, candidate.linear.end(), [](auto l) { return l; });
    for (Eigen::Index j = before; j < p; ++j) {
      if (!(candidate.linear[static_cast<std::size_t>(j)] || all_shape) || !(gram(j, j) > 0)) continue;
      Eigen::VectorXd scale = gram.diagonal().head(before).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd others = scale.asDiagonal() * gram.topLeftCorner(before, before) * scale.asDiagonal();
      const Eigen::VectorXd with = scale.asDiagonal() * gram.col(j).head(before);
      const double left =
          gram(j, j) - with.dot((others + 1e-12 * Eigen::MatrixXd::Identity(before, before)).ldlt().solve(with));
      if (left > 1e-6 * gram(j, j)) return true;
    }
    return before == 0;
  }

  /// From the force's regression (rough start) and from the parent with the new effect at zero; the better one.
  void fit_candidate(Candidate& candidate, const Candidate& parent) const {
    FitOptions options;
    options.max_iterations = 12;
    options.tolerance = 1e-4;
    options.cancelled = study_.options->cancelled;
    if (parent.ran()) options.substeps = std::max(1, (result_.baseline.fit.substeps + 1) / 2);
    if (candidate.choices.size() == 1 || !parent.ran()) {
      fit(study_, candidate, options);
    } else {
      candidate.fit = fit_trajectory(*candidate.system, candidate.starts.front(), study_.train, options);
    }
    if (!parent.ran()) return;
    Eigen::VectorXd warm = candidate.starts.front();
    warm.head(parent.fit.theta.size()) = parent.fit.theta;
    for (Eigen::Index j = parent.fit.theta.size(); j < warm.size(); ++j)
      if (candidate.linear[static_cast<std::size_t>(j)]) warm[j] = 0;
    FitResult again = fit_trajectory(*candidate.system, warm, study_.train, options);
    if (again.cost < candidate.fit.cost) candidate.fit = std::move(again);
  }

  void judge_all(std::vector<Candidate*> list) {
    parallel_for(static_cast<int>(list.size()), study_.options->threads,
                 [&](int i) { judge(study_, *list[static_cast<std::size_t>(i)], result_.whitening); });
  }

  static double bic(const Candidate& c) {
    return -2 * c.log_likelihood + c.parameters() * std::log(static_cast<double>(c.innovations.size()));
  }

  void decide() {
    sort_by_cost(all_);
    result_.chosen = result_.baseline;
    if (all_.empty()) {
      result_.whitening = residual_colour(study_, result_.baseline);
      judge_all({&result_.baseline});
      result_.chosen = result_.baseline;
      return;
    }
    const Candidate& best_raw =
        result_.baseline.ran() && result_.baseline.fit.cost < all_.front().fit.cost ? result_.baseline : all_.front();
    result_.whitening = residual_colour(study_, best_raw);
    std::vector<Candidate> field = contenders();
    std::vector<Candidate*> list{&result_.baseline};
    for (auto& c : field) list.push_back(&c);
    judge_all(list);
    std::stable_sort(field.begin(), field.end(),
                     [](const Candidate& a, const Candidate& b) { return bic(a) < bic(b); });
    choose(field);
  }

  /// The error on the trajectory with Schwarz' price of a parameter: to choose whom to hear.
  static double priced(const Candidate& c) {
    const auto n = static_cast<double>(c.fit.rows);
    return n * std::log(c.fit.cost) + c.parameters() * std::log(n);
  }

  /// The best sets of each size, few enough to be judged.
  std::vector<Candidate> contenders() {
    std::vector<Candidate> field;
    std::stable_sort(all_.begin(), all_.end(),
                     [](const Candidate& a, const Candidate& b) { return priced(a) < priced(b); });
    for (int size = 1; size <= study_.options->max_effects; ++size) {
      int taken = 0;
      for (const auto& c : all_)
        if (static_cast<int>(c.choices.size()) == size && taken < finalists) {
          field.push_back(c);
          ++taken;
        }
      // Faults of sensors and of the input are heard whatever physics does better.
      const auto fault = std::find_if(all_.begin(), all_.end(), [&](const Candidate& c) {
        return static_cast<int>(c.choices.size()) == size && physics_in(c.choices) == 0;
      });
      if (fault != all_.end() &&
          std::none_of(field.begin(), field.end(), [&](const Candidate& c) { return same(c.choices, fault->choices); }))
        field.push_back(*fault);
    }
    return field;
  }

  double corrected(double p) const { return std::min(1.0, p * std::max(1, result_.tried)); }

  /// Not rejected against the best: nested sets by the likelihood ratio, others by Vuong's test.
  bool not_rejected(const Candidate& c, const Candidate& best) const {
    const bool nested = std::all_of(c.choices.begin(), c.choices.end(), [&](const Choice& x) {
      return std::find(best.choices.begin(), best.choices.end(), x) != best.choices.end();
    });
    if (nested) return corrected(improvement_p_value(c, best)) > study_.options->alpha;
    return vuong_z(best, c) < 2.33;
  }

  void choose(std::vector<Candidate>& field) {
    const Candidate best = field.front();
    std::vector<std::size_t> alike;
    for (std::size_t i = 0; i < field.size(); ++i)
      if (i == 0 || not_rejected(field[i], best)) alike.push_back(i);
    // The simplest member that is not rejected; among equals a faulty sensor or input before physics, then the
    // likelier.
    const auto order = [&](std::size_t i) {
      return std::make_tuple(field[i].parameters(), field[i].choices.size(), physics_in(field[i].choices));
    };
    std::stable_sort(alike.begin(), alike.end(), [&](std::size_t a, std::size_t b) { return order(a) < order(b); });
    std::size_t pick = alike.front();
    prune(field, pick);
    Candidate chosen = field[pick];
    progress_("free runs over left-out blocks", 0.8);
    accept(field, chosen, alike, pick);
  }

  /// Drops effects without which a fitted set is not worse.
  void prune(const std::vector<Candidate>& field, std::size_t& pick) const {
    for (bool again = true; again;) {
      again = false;
      for (std::size_t i = 0; i < field.size(); ++i) {
        if (field[i].choices.size() + 1 != field[pick].choices.size()) continue;
        const bool subset = std::all_of(field[i].choices.begin(), field[i].choices.end(), [&](const Choice& x) {
          return std::find(field[pick].choices.begin(), field[pick].choices.end(), x) != field[pick].choices.end();
        });
        if (subset && corrected(improvement_p_value(field[i], field[pick])) > study_.options->alpha) {
          pick = i;
          again = true;
          break;
        }
      }
    }
  }

  /// Every effect of the chosen set must lower the left-out gap; sets shrink until that holds.
  void accept(std::vector<Candidate>& field, Candidate chosen, const std::vector<std::size_t>& alike,
              std::size_t pick) {
    run_left_out(study_, result_.baseline);
    run_left_out(study_, chosen);
    while (!chosen.choices.empty()) {
      std::vector<Candidate> smaller = one_less(field, chosen);
      parallel_for(static_cast<int>(smaller.size()), study_.options->threads, [&](int i) {
        auto& c = smaller[static_cast<std::size_t>(i)];
        if (c.left_out.size() == 0) run_left_out(study_, c);
      });
      const Candidate* weakest = nullptr;
      for (const auto& c : smaller)
        if (!earns(c, chosen) && (!weakest || c.left_out_gap < weakest->left_out_gap)) weakest = &c;
      if (!weakest) break;
      chosen = *weakest;
    }
    const bool named = !chosen.choices.empty();
    if (named) order_steps(field, chosen);
    result_.p_value = named ? corrected(improvement_p_value(result_.baseline, chosen)) : 1;
    if (named && same(chosen.choices, field[pick].choices)) find_ties(field, alike, pick);
    collect_rivals(field, chosen);
    result_.chosen = std::move(chosen);
  }

  bool earns(const Candidate& without, const Candidate& with) const {
    if (!without.ran()) return true;
    if (!(with.left_out_gap < (1 - required_gain(study_, with.left_out_gap)) * without.left_out_gap)) return false;
    if (corrected(improvement_p_value(without, with)) > study_.options->alpha) return false;
    return left_out_p_value(study_, without, with) < std::max(study_.options->alpha, 0.05);
  }

  /// The chosen set without each of its effects, fitted and judged (from the field where it is there).
  std::vector<Candidate> one_less(const std::vector<Candidate>& field, const Candidate& chosen) {
    std::vector<Candidate> out;
    for (std::size_t drop = 0; drop < chosen.choices.size(); ++drop) {
      Choices set = chosen.choices;
      set.erase(set.begin() + static_cast<std::ptrdiff_t>(drop));
      out.push_back(set.empty() ? result_.baseline : obtain(field, set));
    }
    return out;
  }

  Candidate obtain(const std::vector<Candidate>& field, const Choices& set) {
    for (const auto& c : field)
      if (same(c.choices, set)) return c;
    Candidate c = compile(study_, model_, set);
    std::vector<std::vector<Guess>> guesses;
    for (const auto& choice : set) guesses.push_back(guesses_of(choice, scales_beside(result_.baseline)));
    find_starts(study_, c, result_.baseline.fit.theta, guesses);
    if (!c.starts.empty()) fit_candidate(c, result_.baseline);
    judge(study_, c, result_.whitening);
    return c;
  }

  /// Orders the effects by what each adds, and keeps the models between.
  void order_steps(const std::vector<Candidate>& field, Candidate& chosen) {
    Choices rest = chosen.choices, ordered;
    while (rest.size() > 1) {
      Candidate best;
      std::size_t which = 0;
      for (std::size_t i = 0; i < rest.size(); ++i) {
        Choices set = ordered;
        set.push_back(rest[i]);
        Candidate c = obtain(field, set);
        if (i == 0 || c.fit.cost < best.fit.cost) {
          best = std::move(c);
          which = i;
        }
      }
      ordered.push_back(rest[which]);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(which));
      result_.steps.push_back(std::move(best));
    }
    ordered.push_back(rest.front());
    // The chosen model's effects in the order of the steps.
    result_.steps.push_back(chosen);
    result_.order = std::move(ordered);
  }

  /// Related by special_case_of, either way: the simpler is named without doubt.
  static bool related(const Choices& a, const Choices& b) {
    for (const auto& x : a)
      for (const auto& y : b)
        for (const auto& [one, other] : {std::make_pair(x.effect, y.effect), std::make_pair(y.effect, x.effect)})
          if (std::find(one->special_case_of.begin(), one->special_case_of.end(), other->name) !=
              one->special_case_of.end())
            return true;
    return false;
  }

  void find_ties(const std::vector<Candidate>& field, const std::vector<std::size_t>& alike, std::size_t pick) {
    for (const auto i : alike)
      if (i != pick && field[i].parameters() == field[pick].parameters() &&
          !same(field[i].choices, field[pick].choices) && !related(field[i].choices, field[pick].choices) &&
          field[i].name() != field[pick].name() && std::abs(vuong_z(field[pick], field[i])) < 2.33 &&
          improvement_p_value(result_.baseline, field[i]) < study_.options->alpha)
        result_.ties.push_back(field[i].name());
  }

  /// Other sets first, best first; then those that only add to the chosen one.
  void collect_rivals(std::vector<Candidate> field, const Candidate& chosen) {
    std::stable_partition(field.begin(), field.end(), [&](const Candidate& c) {
      return chosen.choices.empty() || !std::all_of(chosen.choices.begin(), chosen.choices.end(),
                                                    [&](const Choice& x) { return holds(c.choices, x.effect); });
    });
    std::vector<std::string> seen{chosen.name()};
    for (const auto& c : field) {
      if (std::find(seen.begin(), seen.end(), c.name()) != seen.end()) continue;
      seen.push_back(c.name());
      std::string remark;
      const bool tie = std::find(result_.ties.begin(), result_.ties.end(), c.name()) != result_.ties.end();
      if (tie)
        remark = "this record cannot tell it from " + chosen.name();
      else if (corrected(improvement_p_value(result_.baseline, c)) > study_.options->alpha)
        remark = "no better than the baseline";
      else if (chosen.choices.empty())
        remark = "does not lower the left-out gap by the least gain";
      else if (c.parameters() > chosen.parameters() && c.likelihood_cost <= chosen.likelihood_cost)
        remark = "not better by what its extra parameters cost";
      else if (vuong_z(chosen, c) > 2.33)
        remark = "fits worse";
      else
        remark = "fits no better";
      result_.rivals.push_back(c);
      result_.remarks.push_back(remark);
    }
  }

  const Study& study_;
  const Model& model_;
  const std::vector<Effect>& catalogue_;
  const std::function<void(const std::string&, double)>& progress_;
  std::vector<Candidate> all_;
  SearchResult result_;
};

}  // namespace

SearchResult search(const Study& study, const Model& model, const Candidate& baseline,
                    const std::vector<Effect>& catalogue,
                    const std::function<void(const std::string&, double)>& progress) {
  return Search(study, model, baseline, catalogue, progress).run();
}

}  // namespace lunid
