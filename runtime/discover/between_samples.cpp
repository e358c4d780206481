#include "discover/between_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "discover/accept.hpp"

namespace lunid {

namespace {

Parameter within(const std::string& name, double limit) {
  Parameter row;
  row.name = name;
  row.value = 0;
  row.min = -limit;
  row.max = limit;
  return row;
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
  form.acts = {{"F", pool.channel("F") + pool.parameter("between_samples_lag") * pool.channel("force_rate")}};
  out.variants.push_back(form);
  return out;
}

std::string words_of_reading(const Study& study, const Eigen::Vector2d& parameters) {
  char words[100];
  const double mass = 100 * parameters[0], samples = parameters[1] / study.full.front().dt();
  std::snprintf(words, sizeof words, "%.2g of a sample %s, and a mass that is %.2g %% %s", std::abs(samples),
                samples > 0 ? "earlier" : "later", std::abs(mass), mass < 0 ? "less" : "more");
  return words;
}

}  // namespace lunid
