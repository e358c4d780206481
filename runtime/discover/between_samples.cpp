#include "discover/between_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "discover/accept.hpp"
#include "discover/baseline.hpp"
#include "discover/gap.hpp"
#include "discover/judge.hpp"
#include "discover/proposal_fits.hpp"
#include "record/parallel.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

bool force_varies(const Study& study) {
  for (const auto& data : study.train)
    for (const std::string& force : study.forces)
      if (standard_deviation(data.record[force]) > 0) return true;
  return false;
}

FitOptions options_of(const Study& study, const Candidate& model, int iterations) {
  FitOptions options = full_fit(study, iterations);
  options.tolerance = 1e-4;
  options.substeps = model.fit.substeps;
  return options;
}

/// From where the model ended, and, as far as no minimum is reached from there, from where it began: the exponent of a
/// fractional damper that ended beside one force is far along a bent valley from where it ends beside another. From
/// there also under the first way, the present one: another minimum is no merit of a reading. Only of a model that
/// comes down to the noise: of others chance says where they end.
std::vector<FitResult> fits_under(const Study& study, const Candidate& model,
                                  const std::vector<std::vector<FitData>>& ways) {
  constexpr double near = 2, near_noise = 1.5;  // in squared error; times the sensor's noise
  std::vector<FitResult> out(ways.size());
  parallel_for(static_cast<int>(ways.size()), study.options->threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    FitOptions options = options_of(study, model, 6);
    options.first_states = model.fit.segments;
    out[k] = fit_trajectory(*model.system, model.fit.theta, ways[k], options);
  });
  if (model.starts.empty() || !(rms_error(model.fit) < near_noise * study.sensor_noise())) return out;
  std::vector<std::size_t> open;
  for (std::size_t k = 1; k < ways.size(); ++k)
    if (!out[k].converged && out[k].cost < near * squared_error(model.fit)) open.push_back(k);
  if (open.empty()) return out;
  open.push_back(0);
  parallel_for(static_cast<int>(open.size()), study.options->threads, [&](int i) {
    const std::size_t k = open[static_cast<std::size_t>(i)];
    FitResult anew = fit_trajectory(*model.system, model.starts.front(), ways[k], options_of(study, model, 40));
    if (anew.cost < out[k].cost) out[k] = std::move(anew);
  });
  return out;
}

}  // namespace

bool one_look(const Study& study) {
  return std::ranges::all_of(study.guesses, [&](Interpolation guess) { return guess == study.guesses.front(); });
}

std::string words_of_interpolation(const Study& study) {
  return study.imposed ? no_free_run : to_string(study.between.kind);
}

bool is_said(const Study& study) { return study.model.interpolation.has_value(); }

double rechoose_interpolation(const Study& study, Candidate& model, const ReadForce& read) {
  if (is_said(study) || study.imposed || !model.ran() || !force_varies(study)) return 0;
  const BetweenSamples before = study.between;
  std::size_t best = 0;
  const double needed = std::exp(-12.0 / static_cast<double>(model.fit.rows));
  const bool as_one = one_look(study);
  std::vector<BetweenSamples> ways{before};
  for (const bool alike : {before.alike, !before.alike})
    for (const auto kind : every_interpolation)
      if (const BetweenSamples way{kind, alike}; (alike == before.alike || !as_one) && way != before)
        ways.push_back(way);
  std::vector<std::vector<FitData>> train;
  for (const BetweenSamples way : ways) train.push_back(read(way).train);
  std::vector<FitResult> fits = fits_under(study, model, train);
  // A model that was judged may be beside its least error: what other steps from there gain is no merit of a reading.
  const double first = std::min(squared_error(model.fit), fits.front().cost);
  double cost = first;
  for (std::size_t k = 1; k < ways.size(); ++k) {
    if (!(fits[k].cost < needed * cost)) continue;
    cost = fits[k].cost;
    best = k;
  }
  read(ways[best]);
  if (best > 0) model.fit = std::move(fits[best]);
  return 1 - cost / first;
}

double part_above_noise(const Study& study, const Candidate& model) {
  return std::max(0.0, 1 - std::pow(noise_alone(study, model) / rms_error(model.fit), 2));
}

std::optional<BetweenSamples> far_better_reading(const Study& study, const Candidate& model) {
  constexpr std::array smooth_kinds{Interpolation::linear, Interpolation::cubic, Interpolation::band_limited};
  constexpr double least = 0.1, part_of_what_is_open = 0.5;  // of the squared error
  constexpr double far_off = 2;                              // times the squared error
  if (is_said(study) || study.imposed || study.between.kind == Interpolation::hold || !force_varies(study)) return {};
  std::vector<BetweenSamples> ways;
  for (const Interpolation kind : smooth_kinds)
    if (kind != study.between.kind) ways.push_back({kind, study.between.alike});
  std::vector<FitResult> fits(ways.size());
  parallel_for(static_cast<int>(ways.size()), study.options->threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    Study other = study;
    read_force(other, ways[k]);
    fits[k] = fit_near(other, model, model.fit.theta, 12, model.fit.substeps, model.fit.segments);
    if (squared_error(fits[k]) < far_off * squared_error(model.fit)) return;
    // Where small differences grow, the present values are no start under another reading: short runs first.
    FitResult shorter =
        fit_progressively(*model.system, model.fit.theta, other.train, fixed_fit(other, 12, 1e-4, model.fit.substeps));
    if (shorter.cost < fits[k].cost) fits[k] = std::move(shorter);
  });
  std::optional<BetweenSamples> best;
  double cost = squared_error(model.fit) * (1 - std::max(least, part_of_what_is_open * part_above_noise(study, model)));
  for (std::size_t k = 0; k < ways.size(); ++k) {
    if (!std::isfinite(fits[k].cost) || !(squared_error(fits[k]) < cost)) continue;
    cost = squared_error(fits[k]);
    best = ways[k];
  }
  return best;
}

namespace {

Parameter within(const std::string& name, double limit) {
  Parameter row;
  row.name = name;
  row.value = 0;
  row.min = -limit;
  row.max = limit;
  return row;
}

/// y or v so much earlier: to second and first order in the lag, and at this frequency exactly.
Expr earlier(Pool& pool, const std::string& channel, Expr lag, double omega) {
  const Expr y = pool.channel("y"), v = pool.channel("v"), a = pool.channel("a");
  const Expr sine = pool.apply(Op::sin, {lag * omega}) / omega, cosine = pool.apply(Op::cos, {lag * omega});
  return channel == "y" ? y + sine * v + (1.0 - cosine) / (omega * omega) * a : cosine * v + sine * a;
}

}  // namespace

std::optional<Effect> between_samples(const Study& study, const Model& model) {
  const auto drives = [&](const FitData& data) { return !is_free(study, data.record); };
  if (study.imposed || study.degrees() > 1 || std::ranges::none_of(study.train, drives)) return {};
  constexpr double most_damping = 0.1;  // of critical damping, that a controller adds
  const double dt = study.full.front().dt(), phase = study.omega * dt;
  Pool& pool = *model.pool;
  Effect out;
  out.name = "between_samples";
  out.family = "input";
  out.parameters = {within("between_samples_mass", phase * phase / 12 + most_damping * phase),
                    within("between_samples_lag", 0.5 * dt)};
  EffectVariant form = pool.parameter("between_samples_mass") * model.mass * pool.channel("a");
  const Expr lag = pool.parameter("between_samples_lag");
  if (study.measured == "a")
    form.acts = {{"F", pool.channel("F") + lag * pool.channel("force_rate")}};
  else
    form.measures = {{study.measured, earlier(pool, study.measured, lag, study.omega)}};
  out.variants.push_back(form);
  return out;
}

std::string words_of_reading(const Study& study, const Reading& reading) {
  char words[100];
  const double mass = 100 * reading.parameters[0], samples = reading.parameters[1] / study.full.front().dt();
  std::snprintf(words, sizeof words, "%.2g of a sample %s, and a mass that is %.2g %% %s", std::abs(samples),
                samples > 0 ? "earlier" : "later", std::abs(mass), mass < 0 ? "less" : "more");
  if (reading.between == study.between.kind) return words;
  const std::string between = reading.between == Interpolation::hold     ? "held"
                              : reading.between == Interpolation::linear ? "straight"
                              : reading.between == Interpolation::cubic  ? "curved"
                                                                         : "band-limited";
  return between + " between its samples, " + words;
}

}  // namespace lunid
