#include "discover/locate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "discover/gap.hpp"

namespace lunid {

namespace {

constexpr int cells = 24;

Eigen::VectorXd force_of(const Candidate& c, const Eigen::VectorXd& theta, const Record& record) {
  return imposed_force(*c.force_system, {theta.data(), static_cast<std::size_t>(theta.size())}, record);
}

Eigen::Map<const Eigen::VectorXd> column(const Record& record, const char* name) {
  const auto x = record[name];
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}

/// Mean of r over equal bins of x in [-limit, limit], and the share of r's variance that these means explain.
struct Binned {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(cells), count = Eigen::VectorXd::Zero(cells);
  double limit = 0, share = 0, odd = 0, even = 0;
};

int bin_of(double x, double limit) {
  return std::clamp(static_cast<int>((x + limit) / (2 * limit) * cells), 0, cells - 1);
}

Binned bin(const std::vector<double>& x, const std::vector<double>& r) {
  Binned out;
  for (const double v : x) out.limit = std::max(out.limit, std::abs(v));
  if (!(out.limit > 0)) return out;
  double total = 0, explained = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const int k = bin_of(x[i], out.limit);
    out.mean[k] += r[i];
    out.count[k] += 1;
    total += r[i] * r[i];
  }
  for (int k = 0; k < cells; ++k)
    if (out.count[k] > 0) {
      out.mean[k] /= out.count[k];
      explained += out.mean[k] * out.mean[k] * out.count[k];
    }
  out.share = total > 0 ? explained / total : 0;
  for (int k = 0; k < cells / 2; ++k) {
    const int m = cells - 1 - k;
    const double weight = std::min(out.count[k], out.count[m]);
    out.odd += weight * std::pow((out.mean[m] - out.mean[k]) / 2, 2);
    out.even += weight * std::pow((out.mean[m] + out.mean[k]) / 2, 2);
  }
  return out;
}

std::string parity(const Binned& b, const char* name) {
  const double sum = b.odd + b.even;
  if (!(sum > 0)) return {};
  if (b.odd > 0.85 * sum) return std::string(", odd in ") + name;
  if (b.even > 0.85 * sum) return std::string(", even in ") + name;
  return std::string(", neither odd nor even in ") + name;
}

std::string quantity(double value, const char* unit) {
  static constexpr struct {
    double factor;
    const char* prefix;
  } prefixes[] = {{1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "\u00b5"}, {1e-9, "n"}};
  const auto* chosen = &prefixes[5];
  for (const auto& p : prefixes)
    if (std::abs(value) >= p.factor) {
      chosen = &p;
      break;
    }
  if (value == 0) chosen = &prefixes[2];
  char text[64];
  std::snprintf(text, sizeof text, "%.3g %s%s", value / chosen->factor, chosen->prefix, unit);
  return text;
}

/// Least |x| beyond which the mean residual is above half of its largest value: where it starts to matter.
double onset(const Binned& b) {
  double largest = 0;
  for (int k = 0; k < cells; ++k)
    if (b.count[k] >= 5) largest = std::max(largest, std::abs(b.mean[k]));
  double from = b.limit;
  for (int k = 0; k < cells; ++k)
    if (b.count[k] >= 5 && std::abs(b.mean[k]) > 0.5 * largest)
      from = std::min(from, std::abs(-b.limit + (k + 0.5) * 2 * b.limit / cells));
  return from;
}

/// What smoothing makes of the reference's own run over a record: a residual force where there is none. `run` is its
/// displacement; where it has no value (lead-in) the measured one stands in.
Eigen::VectorXd smoothing_error(const Study& study, const Candidate& reference, const Record& record,
                                const Eigen::VectorXd& run) {
  if (study.imposed) return Eigen::VectorXd::Zero(record.rows());
  Channel y = record.channel("y");
  y.values = column(record, "y");
  for (Eigen::Index i = 0; i < y.values.size(); ++i)
    if (std::isfinite(run[i])) y.values[i] = run[i];
  const Record smooth = smooth_motion(record.with(y), smoothing_kernel(record));
  return column(smooth, "F") - force_of(reference, reference.fit.theta, smooth);
}

}  // namespace

Eigen::VectorXd residual_force(const Study& study, const Candidate& candidate, const Candidate& reference,
                               std::size_t index) {
  const Record& smooth = study.smooth[index];
  const Eigen::VectorXd residual = column(smooth, "F") - force_of(candidate, candidate.fit.theta, smooth);
  if (study.imposed || !reference.ran()) return residual;
  const Record& record = study.train[index].record;
  return residual - smoothing_error(study, reference, record, column(record, "y") - reference.fit.residual[index]);
}

std::string describe_residual(const Study& study, const Candidate& candidate, const Candidate& reference) {
  std::vector<double> y, v, r;
  for (std::size_t k = 0; k < study.smooth.size(); ++k) {
    const Eigen::VectorXd residual = residual_force(study, candidate, reference, k);
    if (!residual.allFinite()) return "the model's force is not finite along the measured motion";
    for (Eigen::Index i = 0; i < residual.size(); ++i) {
      if (!study.force[k].use[static_cast<std::size_t>(i)]) continue;
      y.push_back(study.smooth[k]["y"][static_cast<std::size_t>(i)]);
      v.push_back(study.smooth[k]["v"][static_cast<std::size_t>(i)]);
      r.push_back(residual[i]);
    }
  }
  const double rms = standard_deviation(r);
  const Binned in_y = bin(y, r), in_v = bin(v, r);
  const std::string size = "rms " + quantity(rms, "N");
  if (std::max(in_y.share, in_v.share) < 0.05) return size + ", no dependence on displacement or velocity alone";
  char percent[80];
  const bool by_y = in_y.share >= in_v.share;
  const Binned& b = by_y ? in_y : in_v;
  std::snprintf(percent, sizeof percent, " (%.0f %% of its variance)", 100 * b.share);
  const char* name = by_y ? "y" : "v";
  const double from = onset(b);
  std::string text = size + ", follows " + (by_y ? "the displacement" : "the velocity") + percent;
  if (from > 2.0 * b.limit / cells)
    text += ", largest at |" + std::string(name) + "| > " + quantity(from, by_y ? "m" : "m/s");
  return text + parity(b, name);
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
                   const std::string& role) {
  Comparison out;
  out.record = record.name();
  out.role = role;
  out.t.resize(record.rows());
  for (Eigen::Index i = 0; i < record.rows(); ++i) out.t[i] = record.time(i);
  out.measured = column(record, study.imposed ? "F" : "y");
  out.baseline = free_run(study, *before.system, before.fit.theta, record, before.fit.substeps).model;
  out.final = free_run(study, *after.system, after.fit.theta, record, after.fit.substeps).model;
  const Record smooth = study.imposed ? record : smooth_motion(record, smoothing_kernel(record));
  out.y = column(smooth, "y");
  out.v = column(smooth, "v");
  const Eigen::VectorXd error = smoothing_error(study, after, record, out.final);
  out.residual_before = column(smooth, "F") - force_of(before, before.fit.theta, smooth) - error;
  out.residual_after = column(smooth, "F") - force_of(after, after.fit.theta, smooth) - error;
  Eigen::VectorXd unnamed = after.fit.theta;
  for (Eigen::Index j = before.parameters(); j < unnamed.size(); ++j)
    if (after.linear[static_cast<std::size_t>(j)]) unnamed[j] = 0;
  out.named_force = force_of(after, after.fit.theta, smooth) - force_of(after, unnamed, smooth);
  return out;
}

}  // namespace lunid
