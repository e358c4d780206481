#include "discover/locate.hpp"

#include <algorithm>
#include <cmath>

#include "discover/gap.hpp"
#include "discover/places.hpp"
#include "discover/residual_maps.hpp"

namespace lunid {

namespace {

constexpr int cells = 24;

Eigen::VectorXd times_of(const Record& record) {
  Eigen::VectorXd t(record.rows());
  for (Eigen::Index i = 0; i < t.size(); ++i) t[i] = record.time(i);
  return t;
}

/// What a model's force loses with the parameters of `without`.
Eigen::VectorXd force_beyond(const Candidate& model, const Eigen::VectorXd& without, const Record& record) {
  return open_force(model, without, record) - open_force(model, model.fit.theta, record);
}

int bin_of(double x, double limit) {
  return std::clamp(static_cast<int>((x + limit) / (2 * limit) * cells), 0, cells - 1);
}

/// What smoothing makes of the reference's own run over a record: a residual force where there is none. `runs` is what
/// it shows of each output; where it has no value (lead-in) the measured one stands in.
Eigen::VectorXd smoothing_error(const Study& study, const Candidate& reference, const Record& record,
                                const std::vector<Eigen::VectorXd>& runs) {
  if (study.imposed) return Eigen::VectorXd::Zero(record.rows());
  Record own = record;
  const std::vector<std::string> outputs = study.outputs();
  for (std::size_t c = 0; c < outputs.size(); ++c) {
    Channel shown = of_window(record, outputs[c]);
    for (Eigen::Index i = 0; i < shown.values.size(); ++i)
      if (std::isfinite(runs[c][i])) shown.values[i] = runs[c][i];
    own = own.with(std::move(shown));
  }
  const Record moved = with_motion(study, own);
  const Record smooth = smooth_motion(study, moved, smoothing_kernel(study, record));
  return open_force(reference, reference.fit.theta, smooth);
}

}  // namespace

Eigen::VectorXd residual_force(const Study& study, const Candidate& candidate, const Candidate& reference,
                               std::size_t index) {
  const Record& smooth = study.smooth[index];
  const Eigen::VectorXd residual = open_force(candidate, candidate.fit.theta, smooth);
  if (study.imposed || !reference.ran()) return residual;
  const Record& record = study.train[index].record;
  const std::vector<double> weights = study.weights(record);
  std::vector<Eigen::VectorXd> runs;
  for (const std::string& output : study.outputs()) {
    const std::size_t c = runs.size();
    runs.push_back(as_vector(record[output]) - reference.fit.residual[c * study.train.size() + index] / weights[c]);
  }
  return residual - smoothing_error(study, reference, record, runs);
}

std::optional<ResidualMaps> maps_at(const Study& study, const Candidate& candidate, const Candidate& reference,
                                    const std::optional<Place>& place) {
  const ResidualRows rows = residual_rows(study, candidate, reference, place);
  if (!rows.force.allFinite()) return {};
  ResidualMaps maps = map_residual(rows);
  if (place) speak_of(maps, *place);
  return maps;
}

void speak_of(ResidualMaps& maps, const Place& place) {
  maps.sentence = words_of(place) + ": " + sizes_at(maps.sentence, place);
  maps.no_data = motion_of(place) + sizes_at(maps.no_data, place).substr(1);  // "y below ..."
}

ResidualMap residual_map(const Study& study, const Candidate& before, const Candidate& after,
                         const std::optional<Place>& place) {
  ResidualMap map;
  double y_limit = 0, v_limit = 0;
  for (const auto& record : study.smooth) {
    y_limit = std::max(y_limit, motion_at(record, place, 'y').cwiseAbs().maxCoeff());
    v_limit = std::max(v_limit, motion_at(record, place, 'v').cwiseAbs().maxCoeff());
  }
  map.y = Eigen::VectorXd::LinSpaced(cells, -1 + 1.0 / cells, 1 - 1.0 / cells) * y_limit;
  map.v = Eigen::VectorXd::LinSpaced(cells, -1 + 1.0 / cells, 1 - 1.0 / cells) * v_limit;
  map.before.setZero(cells, cells);
  map.after.setZero(cells, cells);
  map.count.setZero(cells, cells);
  for (std::size_t k = 0; k < study.smooth.size(); ++k) {
    const Eigen::Index rows = study.smooth[k].rows();
    const Eigen::VectorXd first = force_at(residual_force(study, before, after, k), rows, place);
    const Eigen::VectorXd last = force_at(residual_force(study, after, after, k), rows, place);
    const Eigen::VectorXd y = motion_at(study.smooth[k], place, 'y'), v = motion_at(study.smooth[k], place, 'v');
    for (Eigen::Index i = 0; i < first.size(); ++i) {
      if (!is_mapped(study, k, i)) continue;
      const int a = bin_of(y[i], y_limit), b = bin_of(v[i], v_limit);
      map.before(a, b) += first[i];
      map.after(a, b) += last[i];
      map.count(a, b) += 1;
    }
  }
  for (Eigen::Index i = 0; i < map.count.size(); ++i) {
    const double n = map.count.data()[i];
    map.before.data()[i] = n > 0 ? map.before.data()[i] / n : NAN;
    map.after.data()[i] = n > 0 ? map.after.data()[i] / n : NAN;
  }
  return map;
}

std::vector<Comparison> compare(const Study& study, const Candidate& before, const Candidate& after,
                                const Record& record, std::span<const FreeRun> baseline, std::span<const FreeRun> final,
                                const std::string& role) {
  const Record smooth = study.imposed ? record : smooth_motion(study, record, smoothing_kernel(study, record));
  std::vector<Eigen::VectorXd> runs;
  for (const FreeRun& run : final) runs.push_back(run.model);
  const Eigen::VectorXd error = smoothing_error(study, after, record, runs);
  const Eigen::VectorXd left_before = open_force(before, before.fit.theta, smooth) - error;
  const Eigen::VectorXd left_after = open_force(after, after.fit.theta, smooth) - error;
  Eigen::VectorXd unnamed = after.fit.theta;
  for (Eigen::Index j = before.parameters(); j < unnamed.size(); ++j)
    if (after.linear[static_cast<std::size_t>(j)]) unnamed[j] = 0;
  const Eigen::VectorXd named = force_beyond(after, unnamed, smooth);
  std::vector<Comparison> list;
  for (std::size_t c = 0; c < final.size(); ++c) {
    const auto first = static_cast<Eigen::Index>(c) * record.rows();
    Comparison out;
    out.record = record.name();
    out.role = role;
    out.output = final[c].output;
    out.t = times_of(record);
    out.measured = as_vector(record[final[c].output]);
    out.baseline = baseline[c].model;
    out.final = final[c].model;
    out.y = as_vector(smooth[study.channel('y', static_cast<int>(c))]);
    out.v = as_vector(smooth[study.channel('v', static_cast<int>(c))]);
    out.residual_before = left_before.segment(first, record.rows());
    out.residual_after = left_after.segment(first, record.rows());
    out.named_force = named.segment(first, record.rows());
    list.push_back(std::move(out));
  }
  return list;
}

Eigen::VectorXd named_force(const Study& study, const Candidate& final, const Effect& effect, std::size_t index) {
  Eigen::VectorXd unnamed = final.fit.theta;
  const auto& table = final.system->model().parameters;
  for (std::size_t j = 0; j < table.size(); ++j)
    for (const Parameter& own : effect.parameters)
      if (own.name == table[j].name && final.linear[j]) unnamed[static_cast<Eigen::Index>(j)] = 0;
  const Record& smooth = study.smooth[index];
  return force_at(force_beyond(final, unnamed, smooth), smooth.rows(), effect.place);
}

PlacedForce force_of_effect(const Study& study, const Candidate& final, const Effect& effect, std::size_t index) {
  const Record& smooth = study.smooth[index];
  PlacedForce out;
  out.name = effect.label();
  out.t = times_of(smooth);
  out.y = motion_at(smooth, effect.place, 'y');
  out.v = motion_at(smooth, effect.place, 'v');
  out.named = named_force(study, final, effect, index);
  out.left = force_at(residual_force(study, final, final, index), smooth.rows(), effect.place);
  return out;
}

}  // namespace lunid
