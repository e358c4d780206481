#include "discover/ground.hpp"

#include <algorithm>
#include <cmath>

#include "discover/baseline.hpp"
#include "discover/between_samples.hpp"
#include "discover/proposal_fits.hpp"
#include "record/parallel.hpp"

namespace lunid {

namespace {

/// The force is left as this model would have it read, and the model as fitted then. The rms error that it leaves; none
/// where that is not worth a new search: by what the error drops, and where it is not below this squared error.
std::optional<double> reading_shows_beside(Ground& ground, Candidate& model, double error) {
  constexpr double least_gain = 0.02, part_of_what_is_open = 0.1;  // of the squared error
  const double squared = squared_error(model.fit), rms = rms_error(model.fit);
  const double least = std::max(least_gain, part_of_what_is_open * part_above_noise(ground.study, model));
  const double gain = rechoose_interpolation(ground.study, model, [&ground](BetweenSamples between) -> const Study& {
    ground.read_force(between);
    return ground.study;
  });
  if (!(gain > least) || !((1 - gain) * squared < error)) return {};
  return std::sqrt(1 - gain) * rms;
}

/// All that were judged, baseline and chosen set first; the last step is the chosen set.
std::vector<Candidate*> models_of(SearchResult& found) {
  std::vector<Candidate*> all{&found.baseline, &found.chosen};
  for (std::size_t i = 0; i + 1 < found.steps.size(); ++i) all.push_back(&found.steps[i].model);
  for (Beaten& rival : found.rivals) all.push_back(&rival.model);
  if (found.faint) all.push_back(&*found.faint);
  return all;
}

void drop_those_that_do_not_run(SearchResult& found) {
  std::erase_if(found.rivals, [](const Beaten& rival) { return !rival.model.ran(); });
  if (found.faint && !found.faint->ran()) found.faint.reset();
}

/// The simplest of the rivals of one effect and no more parameters than the chosen set that follow all rows better,
/// each beyond chance: those that are not rejected against the likeliest of them.
const Candidate* better_on_all_rows(const Study& study, const SearchResult& found) {
  std::vector<const Candidate*> better;
  for (const Beaten& rival : found.rivals) {
    const Candidate& c = rival.model;
    const bool simple = c.choices.size() == 1 && !(simplicity(found.chosen) < simplicity(c));
    if (simple && !c.degenerate() && fits_worse(study, found.chosen, c)) better.push_back(&c);
  }
  if (better.empty()) return nullptr;
  const Candidate& best = **std::ranges::min_element(better, {}, &Candidate::likelihood_cost);
  std::erase_if(better, [&](const Candidate* c) { return !not_rejected(study, *c, best, found.grown.tried); });
  return *std::ranges::min_element(better, {}, [](const Candidate* c) { return simplicity(*c); });
}

/// Pieces do not show where the states of an entry begin: what they put behind may follow all rows better.
void name_what_all_rows_show(const Study& study, SearchResult& found) {
  if (found.chosen.choices.empty()) return;
  const Candidate* better = better_on_all_rows(study, found);
  if (!better) return;
  Candidate before = std::move(found.chosen);
  name_steps(study, found, {{better->choices.front(), *better}});
  found.rivals.insert(found.rivals.begin(), Beaten{std::move(before), Beaten::By::training, "fits all rows worse"});
  judge_again(study, found);
  find_ties_again(study, found);
}

/// Of several effects: a set of fewer that follows as well with the force read otherwise, which it is left as then.
std::optional<double> fewer_show_reading(Ground& ground, const SearchResult& found) {
  constexpr std::size_t asked_sets = 8;
  constexpr int iterations = 20;  // where the force is read otherwise, the present values are no more than a start
  const BetweenSamples chosen = ground.study.between;
  const double error = squared_error(found.chosen.fit);
  std::size_t asked = 0;
  for (const Candidate& smaller : found.grown.sets) {
    if (smaller.choices.size() >= found.chosen.choices.size()) continue;
    if (asked++ == asked_sets) break;
    Candidate set = smaller;
    if (reading_shows_beside(ground, set, INFINITY)) {
      const FitResult fit = fit_near(ground.study, set, set.fit.theta, iterations, set.fit.substeps);
      if (std::isfinite(fit.cost) && squared_error(fit) < error) return rms_error(fit);
    }
    ground.read_force(chosen);
  }
  return {};
}

}  // namespace

void Ground::read_force(BetweenSamples between) {
  lunid::read_force(whole, between);
  study = shortened(whole, searched);
}

void Ground::take_noise() {
  study = shortened(whole, searched);
  if (study.degrees() > 1) fit(study, baseline, full_fit(study, 40));
}

bool Ground::take_more_rows(int most_effects) {
  const Study before = shortened(whole, searched);
  searched = Searched::again;
  whole.most_effects = std::min(whole.most_effects, most_effects);
  Study more = shortened(whole, searched);
  if (more.rows() == before.rows()) return false;
  study = std::move(more);
  return true;
}

void Ground::take_rows_as_recorded(Interpolation between) {
  std::ranges::replace(whole.guesses, Interpolation(whole.guesses.front()), between);
  whole.between.kind = between;
  whole = as_recorded(whole);
  study = shortened(whole, searched);
}

std::optional<Interpolation> joined_rows_mislead(const Ground& ground, const Candidate& model) {
  constexpr double open = 1.5, far_less = 0.25;  // times the noise; of the squared excess over it
  constexpr int iterations = 10;
  const Study& whole = ground.whole;
  const bool joined = std::ranges::any_of(whole.recorded, [](const auto& record) { return record != nullptr; });
  const double noise = ground.study.sensor_noise();
  if (!joined || !model.ran() || !(rms_error(model.fit) > open * noise)) return {};
  std::vector<Interpolation> ways{whole.between.kind};
  if (!is_said(whole)) ways.assign(std::begin(every_interpolation), std::end(every_interpolation));
  Study recorded = whole;
  recorded.train.clear();
  for (const Record& record : whole.full) recorded.train.push_back({record, {}, {}});
  std::vector<double> errors(ways.size());  // mean squares
  parallel_for(static_cast<int>(ways.size()), whole.options->threads, [&](int i) {
    Study read = whole;
    read.between.kind = ways[static_cast<std::size_t>(i)];
    std::vector<FitData> data;
    for (const Record& record : whole.full) data.push_back(fit_data(read, record));
    const FitResult fit =
        fit_trajectory(*model.system, model.fit.theta, data, fixed_fit(whole, iterations, 1e-4, model.fit.substeps));
    errors[static_cast<std::size_t>(i)] = std::isfinite(fit.cost) ? std::pow(rms_error(fit), 2) : INFINITY;
  });
  const auto least = std::ranges::min_element(errors);
  const double excess = *least - std::pow(recorded.sensor_noise(), 2);
  if (!(excess < far_less * (std::pow(rms_error(model.fit), 2) - noise * noise))) return {};
  return ways[static_cast<std::size_t>(least - errors.begin())];
}

std::optional<double> reads_otherwise(Ground& ground, SearchResult& found) {
  constexpr double left_open = 0.1;  // part of the squared error, at which more models are asked
  constexpr std::size_t asked_sets = 3;
  constexpr double follows_better = 0.5;  // of the squared error of what was chosen, that they have to leave then
  const double error = squared_error(found.chosen.fit);
  if (const auto left = reading_shows_beside(ground, found.chosen, error)) return left;
  if (const auto left = fewer_show_reading(ground, found)) return left;
  if (!(part_above_noise(ground.study, found.chosen) > left_open)) return {};
  const BetweenSamples chosen = ground.study.between;
  const std::vector<Candidate>& sets = found.grown.sets;
  for (std::size_t i = 0; i < std::min(sets.size(), asked_sets); ++i) {
    Candidate set = sets[i];
    if (const auto left = reading_shows_beside(ground, set, follows_better * error)) return left;
    ground.read_force(chosen);
  }
  return {};
}

void judge_again(const Study& study, SearchResult& found) {
  const std::vector<Candidate*> all = models_of(found);
  parallel_for(static_cast<int>(all.size()), study.options->threads, [&](int i) {
    Candidate& c = *all[static_cast<std::size_t>(i)];
    c.left_out.resize(0);
    judge(study, c, found.whitening, i < 2 ? judge_iterations : 2);
  });
  for (Candidate* c : {&found.baseline, &found.chosen}) run_left_out(study, *c);
  if (found.faint) run_left_out(study, *found.faint);
  if (!found.steps.empty()) found.steps.back().model = found.chosen;
}

void fit_all_rows(Ground& ground, Round& round) {
  if (!ground.study.in_pieces) return;
  const Study& study = ground.study = ground.whole;
  SearchResult& found = round.found;
  const std::vector<Candidate*> all = models_of(found);
  parallel_for(static_cast<int>(all.size()), study.options->threads, [&](int i) {
    Candidate& c = *all[static_cast<std::size_t>(i)];
    if (c.ran()) c.fit = fit_near(study, c, c.fit.theta, 12, c.fit.substeps);
  });
  drop_those_that_do_not_run(found);
  found.whitening = residual_colour(study, found.chosen.ran() ? found.chosen : found.baseline);
  judge_again(study, found);
  name_what_all_rows_show(study, found);
  ground.baseline = found.baseline;
  decide(study, round);
}

}  // namespace lunid
