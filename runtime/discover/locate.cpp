#include "discover/locate.hpp"

#include <algorithm>
#include <cmath>

#include "discover/gap.hpp"
#include "discover/residual_maps.hpp"

namespace lunid {

namespace {

constexpr int cells = 24;

Eigen::Map<const Eigen::VectorXd> column(const Record& record, std::string_view name) {
  const auto x = record[name];
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}

int bin_of(double x, double limit) {
  return std::clamp(static_cast<int>((x + limit) / (2 * limit) * cells), 0, cells - 1);
}

/// What smoothing makes of the reference's own run over a record: a residual force where there is none. `run` is what
/// it shows of the measured channel; where it has no value (lead-in) the measured one stands in.
Eigen::VectorXd smoothing_error(const Study& study, const Candidate& reference, const Record& record,
                                const Eigen::VectorXd& run) {
  if (study.imposed) return Eigen::VectorXd::Zero(record.rows());
  Channel shown = record.channel(study.measured);
  shown.values = column(record, study.measured);
  for (Eigen::Index i = 0; i < shown.values.size(); ++i)
    if (std::isfinite(run[i])) shown.values[i] = run[i];
  const Record moved = with_motion(study, record.with(shown));
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
  return residual -
         smoothing_error(study, reference, record, column(record, study.measured) - reference.fit.residual[index]);
}

std::string describe_residual(const Study& study, const Candidate& candidate, const Candidate& reference) {
  const ResidualRows rows = residual_rows(study, candidate, reference);
  if (!rows.force.allFinite()) return "the model's force is not finite along the measured motion";
  return map_residual(rows).sentence;
}

ResidualMap residual_map(const Study& study, const Candidate& before, const Candidate& after) {
  ResidualMap map;
  double y_limit = 0, v_limit = 0;
  for (const auto& record : study.smooth) {
    y_limit = std::max(y_limit, column(record, "y").cwiseAbs().maxCoeff());
    v_limit = std::max(v_limit, column(record, "v").cwiseAbs().maxCoeff());
  }
  map.y = Eigen::VectorXd::LinSpaced(cells, -1 + 1.0 / cells, 1 - 1.0 / cells) * y_limit;
  map.v = Eigen::VectorXd::LinSpaced(cells, -1 + 1.0 / cells, 1 - 1.0 / cells) * v_limit;
  map.before.setZero(cells, cells);
  map.after.setZero(cells, cells);
  map.count.setZero(cells, cells);
  for (std::size_t k = 0; k < study.smooth.size(); ++k) {
    const Eigen::VectorXd first = residual_force(study, before, after, k);
    const Eigen::VectorXd last = residual_force(study, after, after, k);
    const auto y = column(study.smooth[k], "y"), v = column(study.smooth[k], "v");
    for (Eigen::Index i = 0; i < first.size(); ++i) {
      if (!study.force[k].use[static_cast<std::size_t>(i)]) continue;
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

Comparison compare(const Study& study, const Candidate& before, const Candidate& after, const Record& record,
                   const FreeRun& baseline, const FreeRun& final, const std::string& role) {
  Comparison out;
  out.record = record.name();
  out.role = role;
  out.t.resize(record.rows());
  for (Eigen::Index i = 0; i < record.rows(); ++i) out.t[i] = record.time(i);
  out.measured = column(record, study.output());
  out.baseline = baseline.model;
  out.final = final.model;
  const Record smooth = study.imposed ? record : smooth_motion(study, record, smoothing_kernel(study, record));
  out.y = column(smooth, "y");
  out.v = column(smooth, "v");
  const Eigen::VectorXd error = smoothing_error(study, after, record, out.final);
  out.residual_before = open_force(before, before.fit.theta, smooth) - error;
  out.residual_after = open_force(after, after.fit.theta, smooth) - error;
  Eigen::VectorXd unnamed = after.fit.theta;
  for (Eigen::Index j = before.parameters(); j < unnamed.size(); ++j)
    if (after.linear[static_cast<std::size_t>(j)]) unnamed[j] = 0;
  out.named_force = open_force(after, unnamed, smooth) - open_force(after, after.fit.theta, smooth);
  return out;
}

}  // namespace lunid
