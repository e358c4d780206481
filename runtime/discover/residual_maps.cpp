#include "discover/residual_maps.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "discover/judge.hpp"
#include "discover/locate.hpp"
#include "discover/residual_power.hpp"
#include "record/random.hpp"
#include "record/spectra.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int cells = 24, plane_cells = 16, orders = 9, parts = 6, flips = 199;
constexpr double most_taken = 0.15;  ///< share of its noise that a bin's mean may take: about seven blocks

/// What each block of rows adds to linear statistics, and the share of each statistic's weight that it holds.
struct BlockSums {
  MatrixXd sums, weights;  ///< statistics x blocks
};

/// Levels that noise stays below in all statistics at once: the noise's blocks with flipped signs, each draw divided by
/// its own standard deviation over blocks, so that a statistic of few blocks has the tails that it should.
VectorXd flipped_level(const BlockSums& noise, std::uint64_t seed) {
  const Index bins = noise.sums.rows(), blocks = noise.sums.cols();
  const VectorXd taken = noise.weights.rowwise().squaredNorm();
  const auto deviations = [&](const MatrixXd& sums, const VectorXd& total) {
    VectorXd out = (sums - total.asDiagonal() * noise.weights).rowwise().norm();
    for (Index b = 0; b < bins; ++b) out[b] /= std::sqrt(std::max(1e-9, 1 - taken[b]));
    return out;
  };
  Philox random(seed, stream_of("residual map"));
  std::vector<double> largest;
  for (int k = 0; k < flips; ++k) {
    VectorXd signs(blocks);
    for (double& sign : signs) sign = random.bits() & 1 ? 1 : -1;
    const VectorXd total = noise.sums * signs;
    const VectorXd deviation = deviations(noise.sums * signs.asDiagonal(), total);
    double most = 0;
    for (Index b = 0; b < bins; ++b)
      if (deviation[b] > 0 && taken[b] <= most_taken) most = std::max(most, std::abs(total[b]) / deviation[b]);
    largest.push_back(most);
  }
  std::sort(largest.begin(), largest.end());
  return largest[static_cast<std::size_t>((1 - false_alarm) * flips)] * deviations(noise.sums, VectorXd::Zero(bins));
}

/// Which bin each row lies in, and which bins say something: those of enough rows, from enough blocks.
struct Bins {
  std::vector<int> of_row;
  VectorXd centres, rows;
  MatrixXd weights;  ///< share of a bin's rows that each block has
  std::vector<bool> speaks;
  int operator[](Index i) const { return of_row[static_cast<std::size_t>(i)]; }
};

Bins bins_of(std::vector<int> of_row, VectorXd centres, Index block) {
  const Index n = static_cast<Index>(of_row.size()), bins = centres.size(), length = std::max<Index>(1, block);
  Bins out{std::move(of_row), std::move(centres), VectorXd::Zero(bins), MatrixXd::Zero(bins, (n + length - 1) / length),
           std::vector<bool>(static_cast<std::size_t>(bins))};
  for (Index i = 0; i < n; ++i) out.rows[out[i]] += 1;
  for (Index i = 0; i < n; ++i) out.weights(out[i], i / length) += 1 / out.rows[out[i]];
  for (Index b = 0; b < bins; ++b)
    out.speaks[static_cast<std::size_t>(b)] = out.rows[b] >= few_rows && out.weights.row(b).squaredNorm() <= most_taken;
  return out;
}

/// Of the rows of each bin; 0 where there are few.
VectorXd means(const VectorXd& force, const Bins& bins) {
  VectorXd out = VectorXd::Zero(bins.rows.size());
  for (Index i = 0; i < force.size(); ++i) out[bins[i]] += force[i];
  for (Index b = 0; b < out.size(); ++b) out[b] = bins.rows[b] >= few_rows ? out[b] / bins.rows[b] : 0;
  return out;
}

double share_of(const VectorXd& force, const Bins& bins, const VectorXd& mean) {
  double left = 0;
  for (Index i = 0; i < force.size(); ++i) left += std::pow(force[i] - mean[bins[i]], 2);
  return std::max(0.0, 1 - left / std::max(1e-300, force.squaredNorm()));
}

void silence(const Bins& bins, VectorXd& values) {
  for (Index b = 0; b < values.size(); ++b)
    if (!bins.speaks[static_cast<std::size_t>(b)]) values[b] = NAN;
}

BinnedMap mean_map(const ResidualRows& rows, const std::string& over, const Bins& bins) {
  BinnedMap map;
  map.over = over;
  map.value_is = "mean";
  map.x = bins.centres;
  map.rows = bins.rows;
  map.value = means(rows.force, bins);
  map.share = share_of(rows.force, bins, map.value);
  const Index length = std::max<Index>(1, rows.block);
  BlockSums sums{MatrixXd::Zero(bins.weights.rows(), bins.weights.cols()), bins.weights};
  for (Index i = 0; i < rows.force.size(); ++i)
    sums.sums(bins[i], i / length) += (rows.force[i] - map.value[bins[i]]) / map.rows[bins[i]];
  map.level = flipped_level(sums, rows.seed);
  silence(bins, map.value);
  silence(bins, map.level);
  return map;
}

double limit_of(const VectorXd& x) { return std::max(x.cwiseAbs().maxCoeff(), 1e-300); }

Bins over_channel(const VectorXd& x, Index block) {
  const double limit = limit_of(x);
  std::vector<int> of_row;
  for (const double value : x) of_row.push_back(bin_of(value, -limit, limit, cells));
  return bins_of(std::move(of_row), centres(-limit, limit, cells), block);
}

Bins over_plane(const ResidualRows& rows) {
  const double y = limit_of(rows.y), v = limit_of(rows.v);
  std::vector<int> of_row;
  for (Index i = 0; i < rows.y.size(); ++i)
    of_row.push_back(bin_of(rows.y[i], -y, y, plane_cells) * plane_cells + bin_of(rows.v[i], -v, v, plane_cells));
  return bins_of(std::move(of_row), VectorXd::Zero(plane_cells * plane_cells), rows.block);
}

// ---- harmonics ----

/// Fourier amplitudes over the phase of the motion, atan2(-v/omega, y).
BinnedMap harmonic_map(const ResidualRows& rows) {
  BinnedMap map;
  map.over = "harmonic";
  map.value_is = "amplitude";
  const Index n = rows.force.size();
  MatrixXd wave(n, 2 * orders);
  const double omega = rows.omega > 0 ? rows.omega : 1;
  for (Index i = 0; i < n; ++i) {
    const double phase = std::atan2(-rows.v[i] / omega, rows.y[i]);
    for (int k = 0; k < orders; ++k) {
      wave(i, 2 * k) = (k ? 2 : 1) * std::cos(k * phase) / static_cast<double>(n);
      wave(i, 2 * k + 1) = (k ? 2 : 1) * std::sin(k * phase) / static_cast<double>(n);
    }
  }
  const VectorXd all = wave.transpose() * rows.force;
  VectorXd noise = rows.force;
  for (int k = 0; k < orders; ++k) {
    const double scale = static_cast<double>(n) / (k ? 2 : 1);
    noise -= scale * (wave.col(2 * k) * all[2 * k] + wave.col(2 * k + 1) * all[2 * k + 1]);
  }
  const Index length = std::max<Index>(1, rows.block), blocks = (n + length - 1) / length;
  BlockSums sums{MatrixXd::Zero(2 * orders, blocks), MatrixXd::Zero(2 * orders, blocks)};
  for (Index k = 0; k < blocks; ++k) {
    const Index first = k * length, count = std::min(length, n - first);
    sums.sums.col(k) = wave.middleRows(first, count).transpose() * noise.segment(first, count);
    sums.weights.col(k).setConstant(static_cast<double>(count) / static_cast<double>(n));
  }
  const VectorXd level = flipped_level(sums, rows.seed);
  map.x = VectorXd::LinSpaced(orders, 0, orders - 1);
  map.value.resize(orders);
  map.level.resize(orders);
  map.rows = VectorXd::Constant(orders, static_cast<double>(n));
  for (int k = 0; k < orders; ++k) {
    map.value[k] = std::hypot(all[2 * k], all[2 * k + 1]);
    map.level[k] = std::hypot(level[2 * k], level[2 * k + 1]);
  }
  return map;
}

// ---- the phase plane ----

/// The means over y, v and the phase plane that a force has along a motion.
struct MotionBins {
  Bins y, v, plane;
};

/// Means between the centres of their bins, straight.
double between(const Bins& bins, const VectorXd& mean, double x) {
  const double step = bins.centres[1] - bins.centres[0], at = (x - bins.centres[0]) / step;
  const Index last = mean.size() - 1, k = std::clamp<Index>(static_cast<Index>(std::floor(at)), 0, last - 1);
  const double a = mean[k], b = mean[k + 1];
  if (!std::isfinite(a) || !std::isfinite(b)) return std::isfinite(a) ? a : std::isfinite(b) ? b : 0;
  return a + (b - a) * std::clamp(at - static_cast<double>(k), -0.5, 1.5);
}

/// What is left of a force when its means over y and over v, the larger share first, and over the plane are taken away,
/// one after the other.
VectorXd without_motion(const ResidualRows& rows, const MotionBins& bins, VectorXd force) {
  const bool y_first = share_of(force, bins.y, means(force, bins.y)) >= share_of(force, bins.v, means(force, bins.v));
  for (const bool by_y : {y_first, !y_first}) {
    const Bins& over = by_y ? bins.y : bins.v;
    const VectorXd& x = by_y ? rows.y : rows.v;
    VectorXd mean = means(force, over);
    silence(over, mean);
    for (Index i = 0; i < x.size(); ++i) force[i] -= between(over, mean, x[i]);
  }
  const VectorXd mean = means(force, bins.plane);
  for (Index i = 0; i < force.size(); ++i)
    if (bins.plane.speaks[static_cast<std::size_t>(bins.plane[i])]) force[i] -= mean[bins.plane[i]];
  return force;
}

/// Share of the noise's power that is left where these means are taken away, which are of noise too: asked of the noise
/// itself, with the signs of whole blocks flipped.
double power_left(const ResidualRows& rows, const MotionBins& bins, const VectorXd& noise) {
  constexpr int draws = 9;
  constexpr double least = 0.1;
  Philox random(rows.seed, stream_of("residual power"));
  const Index length = std::max<Index>(1, rows.block);
  double left = 0;
  for (int k = 0; k < draws; ++k) {
    VectorXd flipped = noise;
    for (Index first = 0; first < noise.size(); first += length)
      if (random.bits() & 1) flipped.segment(first, std::min(length, noise.size() - first)) *= -1;
    left += without_motion(rows, bins, std::move(flipped)).squaredNorm() / draws;
  }
  return std::clamp(left / std::max(1e-300, noise.squaredNorm()), least, 1.0);
}

void fill_plane(const ResidualRows& rows, const Bins& bins, ResidualMaps& out) {
  const BinnedMap flat = mean_map(rows, "plane", bins);
  out.plane.y = centres(-limit_of(rows.y), limit_of(rows.y), plane_cells);
  out.plane.v = centres(-limit_of(rows.v), limit_of(rows.v), plane_cells);
  const auto square = [](const VectorXd& x) {
    MatrixXd m(plane_cells, plane_cells);
    for (int i = 0; i < plane_cells; ++i)
      for (int j = 0; j < plane_cells; ++j) m(i, j) = x[i * plane_cells + j];
    return m;
  };
  out.plane.before = square(flat.value);
  out.plane.count = square(flat.rows);
  out.plane_level = square(flat.level);
}

// ---- slow time ----

SlowTime slow_time(const ResidualRows& rows) {
  SlowTime out;
  const Index n = rows.force.size();
  out.time.resize(parts);
  out.value.resize(parts, 3);
  out.std.resize(parts, 3);
  const VectorXd time = running_time(rows);
  double freedom = 0;
  for (int k = 0; k < parts; ++k) {
    const Index first = n * k / parts, count = n * (k + 1) / parts - first;
    out.time[k] = time.segment(first, count).mean();
    MatrixXd x(count, 3);
    x << VectorXd::Ones(count), rows.y.segment(first, count), rows.v.segment(first, count);
    const VectorXd scale = x.colwise().norm().cwiseMax(1e-300).cwiseInverse().transpose();
    x = x * scale.asDiagonal();
    MatrixXd gram = x.transpose() * x;
    gram.diagonal().array() += 1e-9;
    const MatrixXd inverse = gram.ldlt().solve(MatrixXd::Identity(3, 3));
    const VectorXd beta = inverse * (x.transpose() * rows.force.segment(first, count));
    const VectorXd left = rows.force.segment(first, count) - x * beta;
    MatrixXd scores = MatrixXd::Zero(3, 3);  // of blocks: holds for coloured noise
    double blocks = 0;
    for (Index at = 0; at < count; at += rows.block) {
      const Index length = std::min(rows.block, count - at);
      const VectorXd sum = x.middleRows(at, length).transpose() * left.segment(at, length);
      scores += sum * sum.transpose();
      ++blocks;
    }
    const MatrixXd covariance = inverse * scores * inverse * (blocks / std::max(1.0, blocks - 3));
    freedom += std::max(1.0, blocks - 3);
    out.value.row(k) = (scale.asDiagonal() * beta).transpose();
    out.std.row(k) = (covariance.diagonal().cwiseMax(0).cwiseSqrt().array() * scale.array()).transpose();
  }
  const double size[3] = {1, rows.y.norm() / std::sqrt(static_cast<double>(n)),
                          rows.v.norm() / std::sqrt(static_cast<double>(n))};
  double effect[3], largest = 0;
  for (int j = 0; j < 3; ++j) {
    const VectorXd weight = out.std.col(j).array().square().max(1e-300).inverse();
    const double mean = weight.dot(out.value.col(j)) / weight.sum();
    double squares = 0;
    for (int k = 0; k < parts; ++k) squares += weight[k] * std::pow(out.value(k, j) - mean, 2);
    out.changes[j] = f_tail(squares / (parts - 1), parts - 1, freedom) < false_alarm / 3;
    effect[j] = size[j] * (out.value.col(j).array() - out.value.col(j).mean()).matrix().norm();
    if (out.changes[j]) largest = std::max(largest, effect[j]);
  }
  for (int j = 0; j < 3; ++j) out.changes[j] = out.changes[j] && effect[j] > 0.2 * largest;
  return out;
}

/// Does the residual at equal y differ between v > 0 and v < 0? Fills loop and loop_share.
void look_for_loop(const ResidualRows& rows, ResidualMaps& out) {
  const double limit = limit_of(rows.y);
  std::vector<int> where;
  for (Index i = 0; i < rows.y.size(); ++i)
    where.push_back(bin_of(rows.y[i], -limit, limit, cells / 2) + (rows.v[i] > 0 ? cells / 2 : 0));
  const BinnedMap map = mean_map(rows, "side", bins_of(std::move(where), VectorXd::Zero(cells), rows.block));
  double squares = 0;
  for (int k = 0; k < cells / 2; ++k) {
    const double apart = map.value[k + cells / 2] - map.value[k];
    out.loop = out.loop || std::abs(apart) > std::hypot(map.level[k], map.level[k + cells / 2]);
    if (std::isfinite(apart)) squares += (map.rows[k] + map.rows[k + cells / 2]) * std::pow(apart / 2, 2);
  }
  out.loop_share = squares / std::max(rows.force.squaredNorm(), 1e-300);
}

}  // namespace

bool BinnedMap::any_above() const {
  for (Index i = 0; i < value.size(); ++i)
    if (above(i)) return true;
  return false;
}

const BinnedMap& ResidualMaps::map(std::string_view over) const {
  for (const BinnedMap& m : maps)
    if (m.over == over) return m;
  throw InputError("locate: no map over '" + std::string(over) + "'");
}

ResidualMaps map_residual(const ResidualRows& rows) {
  ResidualMaps out;
  const double n = static_cast<double>(rows.force.size());
  const MotionBins bins{over_channel(rows.y, rows.block), over_channel(rows.v, rows.block), over_plane(rows)};
  const VectorXd noise = without_motion(rows, bins, rows.force);
  fill_plane(rows, bins.plane, out);
  out.rms = rows.force.norm() / std::sqrt(n);
  out.noise = noise.norm() / std::sqrt(n);
  const NoisePower power = noise_power(rows, noise, power_left(rows, bins, noise));
  out.maps.push_back(time_map(rows, power));
  for (const bool of_y : {true, false}) {
    out.maps.push_back(mean_map(rows, of_y ? "y" : "v", of_y ? bins.y : bins.v));
    out.maps.back().unit = of_y ? rows.units.y : rows.units.v;
  }
  out.maps.push_back(amplitude_map(rows, power));
  out.maps.push_back(harmonic_map(rows));
  out.maps.push_back(frequency_map(rows, power));
  ResidualRows rest = rows;
  rest.force = noise;
  out.slow = slow_time(rest);
  look_for_loop(rows, out);
  out.above_noise = out.loop || out.slow.changes[0] || out.slow.changes[1] || out.slow.changes[2];
  for (const BinnedMap& map : out.maps) out.above_noise = out.above_noise || map.any_above();
  out.sentence = sentence_of(out, rows);
  say_each(out, rows.units);
  out.no_data = unseen(out, rows);
  return out;
}

bool is_mapped(const Study& study, std::size_t record, Index row) {
  constexpr double cycles = 0.5;  // of the limit of the high pass
  if (!study.force[record].use[static_cast<std::size_t>(row)]) return false;
  if (study.slow == 0) return true;
  const Record& smooth = study.smooth[record];
  const auto longest = static_cast<double>(smooth.rows()) / 10;
  const auto end = static_cast<Index>(std::min(longest, cycles / study.slow / smooth.dt()));
  return row >= end && row < smooth.rows() - end;
}

ResidualRows residual_rows(const Study& study, const Candidate& candidate, const Candidate& reference,
                           const std::optional<Place>& place) {
  ResidualRows out;
  std::vector<double> t, y, v, force;
  for (std::size_t k = 0; k < study.smooth.size(); ++k) {
    const Record& record = study.smooth[k];
    const VectorXd residual = force_at(residual_force(study, candidate, reference, k), record.rows(), place);
    const VectorXd motion = motion_at(record, place, 'y'), rate = motion_at(record, place, 'v');
    out.row_of_record.push_back(static_cast<Index>(force.size()));
    for (Index i = 0; i < residual.size(); ++i) {
      if (!is_mapped(study, k, i)) continue;
      t.push_back(record.time(i));
      y.push_back(motion[i]);
      v.push_back(rate[i]);
      force.push_back(residual[i]);
    }
  }
  out.row_of_record.push_back(static_cast<Index>(force.size()));
  const auto column = [](const std::vector<double>& x) {
    return VectorXd(Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size())));
  };
  out.t = column(t);
  out.y = column(y);
  out.v = column(v);
  out.force = column(force);
  out.dt = study.smooth.front().dt();
  out.omega = study.omega;
  out.block = bootstrap_block(study);
  out.seed = study.options->seed;
  out.units = study.units();
  return out;
}

}  // namespace lunid
