#include "discover/residual_maps.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "discover/judge.hpp"
#include "discover/locate.hpp"
#include "record/random.hpp"
#include "record/spectra.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int cells = 24, plane_cells = 16, amplitude_cells = 12, orders = 9, parts = 6, flips = 199;
constexpr double few = 5;            ///< rows in a bin below which it says nothing
constexpr double most_taken = 0.15;  ///< share of its noise that a bin's mean may take: about seven blocks
constexpr double chance = 0.05;

int bin_of(double x, double low, double high, int count) {
  return std::clamp(static_cast<int>((x - low) / (high - low) * count), 0, count - 1);
}

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
  return largest[static_cast<std::size_t>((1 - chance) * flips)] * deviations(noise.sums, VectorXd::Zero(bins));
}

/// Mean of r over bins; `where` gives each row's bin.
BinnedMap mean_map(const ResidualRows& rows, const std::string& over, const std::vector<int>& where, VectorXd centres) {
  const Index bins = centres.size();
  BinnedMap map;
  map.over = over;
  map.value_is = "mean";
  map.x = std::move(centres);
  map.value.setZero(bins);
  map.rows.setZero(bins);
  for (Index i = 0; i < rows.force.size(); ++i) {
    map.value[where[static_cast<std::size_t>(i)]] += rows.force[i];
    map.rows[where[static_cast<std::size_t>(i)]] += 1;
  }
  VectorXd noise = rows.force;
  for (Index b = 0; b < bins; ++b) map.value[b] = map.rows[b] >= few ? map.value[b] / map.rows[b] : 0;
  for (Index i = 0; i < noise.size(); ++i) noise[i] -= map.value[where[static_cast<std::size_t>(i)]];
  map.share = std::max(0.0, 1 - noise.squaredNorm() / std::max(1e-300, rows.force.squaredNorm()));
  const Index length = std::max<Index>(1, rows.block), blocks = (noise.size() + length - 1) / length;
  BlockSums sums{MatrixXd::Zero(bins, blocks), MatrixXd::Zero(bins, blocks)};
  for (Index i = 0; i < noise.size(); ++i) {
    const int b = where[static_cast<std::size_t>(i)];
    sums.sums(b, i / length) += noise[i] / map.rows[b];
    sums.weights(b, i / length) += 1 / map.rows[b];
  }
  map.level = flipped_level(sums, rows.seed);
  for (Index b = 0; b < bins; ++b)
    if (map.rows[b] < few || sums.weights.row(b).squaredNorm() > most_taken) map.value[b] = map.level[b] = NAN;
  return map;
}

std::vector<int> bins_of(const VectorXd& x, double limit, int count) {
  std::vector<int> where;
  for (const double value : x) where.push_back(bin_of(value, -limit, limit, count));
  return where;
}

VectorXd centres(double low, double high, int count) {
  const double half = 0.5 * (high - low) / count;
  return VectorXd::LinSpaced(count, low + half, high - half);
}

BinnedMap over_channel(const ResidualRows& rows, const std::string& name, const VectorXd& x, const std::string& unit) {
  const double limit = std::max(x.cwiseAbs().maxCoeff(), 1e-300);
  BinnedMap map = mean_map(rows, name, bins_of(x, limit, cells), centres(-limit, limit, cells));
  map.unit = unit;
  return map;
}

VectorXd local_amplitude(const ResidualRows& rows) {
  if (!(rows.omega > 0)) return rows.y.cwiseAbs();
  return (rows.y.array().square() + (rows.v.array() / rows.omega).square()).sqrt();
}

// ---- mean squares: over time and amplitude ----

/// Block means of squares of the noise: their mean, and the deviation of one block's.
struct NoisePower {
  double mean = 0, deviation = 0;
  double level(double rows, double block, Index bins) const {
    const double blocks = std::max(1.0, rows / block);
    return std::sqrt(mean + normal_quantile(1 - chance / static_cast<double>(bins)) * deviation / std::sqrt(blocks));
  }
};

NoisePower noise_power(const VectorXd& noise, Index block) {
  std::vector<double> means;
  for (Index first = 0; first + block <= noise.size(); first += block)
    means.push_back(noise.segment(first, block).squaredNorm() / static_cast<double>(block));
  NoisePower out;
  out.mean = noise.squaredNorm() / static_cast<double>(noise.size());
  out.deviation = means.size() > 1 ? standard_deviation(means) : out.mean;
  return out;
}

BinnedMap rms_map(const ResidualRows& rows, const std::string& over, const std::string& unit, const VectorXd& x,
                  double low, double high, int count, const NoisePower& noise) {
  BinnedMap map;
  map.over = over;
  map.unit = unit;
  map.value_is = "rms";
  map.x = centres(low, high, count);
  map.value.setZero(count);
  map.rows.setZero(count);
  map.level.resize(count);
  for (Index i = 0; i < x.size(); ++i) {
    const int b = bin_of(x[i], low, high, count);
    map.value[b] += rows.force[i] * rows.force[i];
    map.rows[b] += 1;
  }
  for (Index b = 0; b < count; ++b) {
    const bool seen = map.rows[b] >= few;
    map.value[b] = seen ? std::sqrt(map.value[b] / map.rows[b]) : NAN;
    map.level[b] = seen ? noise.level(map.rows[b], static_cast<double>(rows.block), count) : NAN;
  }
  return map;
}

// ---- harmonics and frequencies ----

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

BinnedMap frequency_map(const ResidualRows& rows, const VectorXd& noise) {
  Index first = 0, longest = 0;
  for (std::size_t r = 0; r + 1 < rows.row_of_record.size(); ++r)
    if (rows.row_of_record[r + 1] - rows.row_of_record[r] > longest) {
      first = rows.row_of_record[r];
      longest = rows.row_of_record[r + 1] - first;
    }
  const auto part = [&](const VectorXd& x) {
    return std::span<const double>(x.data() + first, static_cast<std::size_t>(longest));
  };
  const PowerSpectrum found = power_spectrum(part(rows.force), rows.dt), alone = power_spectrum(part(noise), rows.dt);
  BinnedMap map;
  map.over = "frequency";
  map.unit = "Hz";
  map.value_is = "root density";
  map.x = found.frequency;
  map.value = found.density.cwiseSqrt();
  map.level = alone.high.cwiseSqrt();
  map.rows = VectorXd::Constant(map.x.size(), static_cast<double>(longest));
  return map;
}

// ---- the phase plane ----

/// The means of a map between the centres of its bins, straight.
double between(const BinnedMap& map, double x) {
  const double step = map.x[1] - map.x[0], at = (x - map.x[0]) / step;
  const Index last = map.x.size() - 1, k = std::clamp<Index>(static_cast<Index>(std::floor(at)), 0, last - 1);
  const double a = map.value[k], b = map.value[k + 1];
  if (!std::isfinite(a) || !std::isfinite(b)) return std::isfinite(a) ? a : std::isfinite(b) ? b : 0;
  return a + (b - a) * std::clamp(at - static_cast<double>(k), -0.5, 1.5);
}

/// What is left of the force when means over y and over v are taken away, one after the other, larger share first.
VectorXd without_means(const ResidualRows& rows, const BinnedMap& y, const BinnedMap& v) {
  ResidualRows rest = rows;
  for (const bool by_y : {y.share >= v.share, y.share < v.share}) {
    const VectorXd& x = by_y ? rows.y : rows.v;
    const BinnedMap map = over_channel(rest, by_y ? "y" : "v", x, "");
    for (Index i = 0; i < x.size(); ++i) rest.force[i] -= between(map, x[i]);
  }
  return rest.force;
}

/// Also takes the means over the plane off `rest`.
void fill_plane(const ResidualRows& rows, ResidualMaps& out, VectorXd& rest) {
  const double y = std::max(rows.y.cwiseAbs().maxCoeff(), 1e-300), v = std::max(rows.v.cwiseAbs().maxCoeff(), 1e-300);
  std::vector<int> where;
  for (Index i = 0; i < rows.y.size(); ++i)
    where.push_back(bin_of(rows.y[i], -y, y, plane_cells) * plane_cells + bin_of(rows.v[i], -v, v, plane_cells));
  const BinnedMap flat = mean_map(rows, "plane", where, VectorXd::Zero(plane_cells * plane_cells));
  out.plane.y = centres(-y, y, plane_cells);
  out.plane.v = centres(-v, v, plane_cells);
  const auto square = [](const VectorXd& x) {
    MatrixXd m(plane_cells, plane_cells);
    for (int i = 0; i < plane_cells; ++i)
      for (int j = 0; j < plane_cells; ++j) m(i, j) = x[i * plane_cells + j];
    return m;
  };
  out.plane.before = square(flat.value);
  out.plane.count = square(flat.rows);
  out.plane_level = square(flat.level);
  ResidualRows left = rows;
  left.force = rest;
  const VectorXd means = mean_map(left, "plane", where, VectorXd::Zero(plane_cells * plane_cells)).value;
  for (Index i = 0; i < rest.size(); ++i) {
    const double mean = means[where[static_cast<std::size_t>(i)]];
    if (std::isfinite(mean)) rest[i] -= mean;
  }
}

// ---- slow time ----

SlowTime slow_time(const ResidualRows& rows) {
  SlowTime out;
  const Index n = rows.force.size();
  out.time.resize(parts);
  out.value.resize(parts, 3);
  out.std.resize(parts, 3);
  double freedom = 0;
  for (int k = 0; k < parts; ++k) {
    const Index first = n * k / parts, count = n * (k + 1) / parts - first;
    out.time[k] = rows.t.segment(first, count).mean();
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
    out.changes[j] = f_tail(squares / (parts - 1), parts - 1, freedom) < chance / 3;
    effect[j] = size[j] * (out.value.col(j).array() - out.value.col(j).mean()).matrix().norm();
    if (out.changes[j]) largest = std::max(largest, effect[j]);
  }
  for (int j = 0; j < 3; ++j) out.changes[j] = out.changes[j] && effect[j] > 0.2 * largest;
  return out;
}

/// Does the residual at equal y differ between v > 0 and v < 0? Fills loop and loop_share.
void look_for_loop(const ResidualRows& rows, ResidualMaps& out) {
  const double limit = std::max(rows.y.cwiseAbs().maxCoeff(), 1e-300);
  std::vector<int> where;
  for (Index i = 0; i < rows.y.size(); ++i)
    where.push_back(bin_of(rows.y[i], -limit, limit, cells / 2) + (rows.v[i] > 0 ? cells / 2 : 0));
  const BinnedMap map = mean_map(rows, "side", where, VectorXd::Zero(cells));
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
  const BinnedMap y = over_channel(rows, "y", rows.y, rows.units.y), v = over_channel(rows, "v", rows.v, rows.units.v);
  VectorXd noise = without_means(rows, y, v);
  fill_plane(rows, out, noise);
  out.rms = rows.force.norm() / std::sqrt(n);
  out.noise = noise.norm() / std::sqrt(n);
  const NoisePower power = noise_power(noise, std::max<Index>(1, std::min(rows.block, noise.size() / 4)));
  const VectorXd amplitude = local_amplitude(rows);
  const int windows = static_cast<int>(std::clamp<Index>(rows.force.size() / std::max<Index>(1, rows.block), 6, 60));
  out.maps.push_back(rms_map(rows, "time", "s", rows.t, rows.t.minCoeff(), rows.t.maxCoeff(), windows, power));
  out.maps.push_back(y);
  out.maps.push_back(v);
  out.maps.push_back(rms_map(rows, "amplitude", rows.units.y, amplitude, 0, std::max(amplitude.maxCoeff(), 1e-300),
                             amplitude_cells, power));
  out.maps.push_back(harmonic_map(rows));
  out.maps.push_back(frequency_map(rows, noise));
  ResidualRows rest = rows;
  rest.force = noise;
  out.slow = slow_time(rest);
  look_for_loop(rows, out);
  out.above_noise = out.loop || out.slow.changes[0] || out.slow.changes[1] || out.slow.changes[2];
  for (const char* over : {"y", "v", "harmonic"}) out.above_noise = out.above_noise || out.map(over).any_above();
  out.sentence = sentence_of(out, rows);
  out.no_data = unseen(out, rows);
  return out;
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
      const auto row = static_cast<std::size_t>(i);
      if (!study.force[k].use[row]) continue;
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
