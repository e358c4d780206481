#include "discover/unknown_force.hpp"

#include <cmath>

#include "discover/baseline.hpp"
#include "discover/between_samples.hpp"
#include "discover/gap.hpp"
#include "discover/locate.hpp"

namespace lunid {

namespace {

Candidate with_forces(const Study& study, const Closure& closure) {
  Candidate out = compile(study, closure.system->model(), {});
  out.fit = fit_trajectory(*out.system, closure.fit.theta, study.train, full_fit(study, 40));
  return out;
}

/// The generic forces beside the model: as they were asked for at once, or one by one, by the left-out gap. The study
/// is left with the force read as they tell: what was chosen beside a poor model says little.
std::optional<Candidate> fitted_forces(Study& study, const Round& round) {
  const Closure& at_once = round.left.closure;
  if (!round.left.seen || !at_once.system || !std::isfinite(at_once.fit.cost)) return {};
  read_force(study, {study.guesses.front()});
  Candidate baseline = round.found.chosen;
  fit(study, baseline, full_fit(study, 40));
  const Closure grown = grow_closure(study, baseline, round.found.whitening, at_once.place);
  Candidate out = with_forces(study, at_once);
  if (grown.system != baseline.system) {
    Candidate one_by_one = with_forces(study, grown);
    run_left_out(study, out);
    run_left_out(study, one_by_one);
    if (one_by_one.left_out_gap < out.left_out_gap) out = std::move(one_by_one);
  }
  rechoose_interpolation(study, out, [&](BetweenSamples between) -> const Study& {
    read_force(study, between);
    return study;
  });
  out.fit = fit_trajectory(*out.system, out.fit.theta, study.train, full_fit(study, 40));
  return out;
}

}  // namespace

std::vector<UnknownForce::Harmonic> harmonics_of(const ResidualMaps& maps) {
  std::vector<UnknownForce::Harmonic> out;
  const BinnedMap& map = maps.map("harmonic");
  for (Eigen::Index k = 0; k < map.value.size(); ++k) out.push_back({map.value[k], map.level[k]});
  return out;
}

UnknownForce unknown_force(const Study& study, const Round& round, const std::optional<Place>& place,
                           const ResidualMap& left, const Gap& test) {
  const Candidate& baseline = round.found.chosen;
  UnknownForce out;
  ResidualMap map = left;
  Study own = study;
  if (const std::optional<Candidate> forces = fitted_forces(own, round); forces && forces->ran()) {
    const Gap with = pool_gap(runs(own, *forces, own.test), 0);
    if (with.value < test.value) {
      out.closure = {fitted(own, *forces), pool_gap(runs(own, *forces, own.full), 0), with,
                     words_of_interpolation(own)};
      map = residual_map(own, baseline, *forces, place);
      map.before -= map.after;
    }
  }
  out.y = std::move(map.y);
  out.v = std::move(map.v);
  out.force = std::move(map.before);
  return out;
}

}  // namespace lunid
