#include "discover/residual_power.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "record/median.hpp"
#include "record/spectra.hpp"
#include "statistics/distributions.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int amplitude_cells = 12, fewest_windows = 6, most_windows = 60;
constexpr double median_is_worth = 0.6;  ///< of the degrees of freedom that a mean would have (2/pi)

/// The rows of the longest record.
std::pair<Index, Index> longest_record(const ResidualRows& rows) {
  Index first = 0, count = 0;
  for (std::size_t r = 0; r + 1 < rows.row_of_record.size(); ++r)
    if (const Index own = rows.row_of_record[r + 1] - rows.row_of_record[r]; own > count) {
      first = rows.row_of_record[r];
      count = own;
    }
  return {first, count};
}

/// `fine`: as well resolved as the record allows.
PowerSpectrum spectrum_of(const ResidualRows& rows, const VectorXd& force, bool fine) {
  const auto [first, count] = longest_record(rows);
  const Index whole = static_cast<Index>(std::bit_floor(static_cast<std::size_t>(count)));
  return power_spectrum(std::span<const double>(force.data() + first, static_cast<std::size_t>(count)), rows.dt,
                        fine ? whole : 0);
}

double freedom_of(const PowerSpectrum& s) { return 2 * averages(s.segments); }

/// Neighbours on each side over which the median at bin k is taken: a tone has five bins of a spectrum that is as well
/// resolved as this one, and a resonance of the noise has more. As many on both sides, so that a slope does not matter;
/// two at the ends.
Index reach(Index k, Index bins) {
  constexpr Index widest = 6, least = 2;
  return std::max(least, std::min({widest, k - 1, bins - 1 - k}));
}

/// What a noise whose spectrum has no lines has at each frequency but zero.
VectorXd without_lines(const PowerSpectrum& s) {
  VectorXd out = VectorXd::Zero(s.density.size());
  const Index bins = s.density.size();
  for (Index k = 1; k < bins; ++k) {
    const Index from = std::max<Index>(1, k - reach(k, bins)), to = std::min(bins - 1, k + reach(k, bins));
    out[k] = median(std::vector<double>(s.density.data() + from, s.density.data() + to + 1)) /
             median_over_mean(freedom_of(s));
  }
  return out;
}

/// As segments show it that resolve `ratio` times less: Hann's window, near enough a triangle of one and a half bins.
double seen_coarsely(const VectorXd& fine, Index k, Index ratio) {
  const double width = 1.5 * static_cast<double>(ratio);
  double sum = 0, weights = 0;
  for (Index j = std::max<Index>(1, k * ratio - 3 * ratio / 2);
       j <= std::min(fine.size() - 1, k * ratio + 3 * ratio / 2); ++j) {
    const double weight = 1 - std::abs(static_cast<double>(j - k * ratio)) / (width + 1);
    sum += weight * fine[j];
    weights += weight;
  }
  return sum / weights;
}

/// Mean squares of blocks.
struct BlockPowers {
  Index block;
  std::vector<double> each;
  double middle = 0;

  BlockPowers(const VectorXd& x, Index block_rows) : block(block_rows) {
    for (Index first = 0; first + block <= x.size(); first += block)
      each.push_back(x.segment(first, block).squaredNorm() / static_cast<double>(block));
    middle = median(each);
  }

  /// Blocks of four times what they have in the middle, and more, brought down to it.
  VectorXd without_bursts(VectorXd x) const {
    for (std::size_t b = 0; b < each.size(); ++b)
      if (each[b] > 4 * middle) x.segment(static_cast<Index>(b) * block, block) *= std::sqrt(middle / each[b]);
    return x;
  }
};

BinnedMap rms_map(const ResidualRows& rows, const VectorXd& x, double low, double high, int count,
                  const NoisePower& noise) {
  BinnedMap map;
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
    const bool seen = map.rows[b] >= few_rows;
    map.value[b] = seen ? std::sqrt(map.value[b] / map.rows[b]) : NAN;
    map.level[b] = seen ? noise.level(map.rows[b], count) : NAN;
  }
  return map;
}

/// The upper angular frequency [rad/s] of the motion, std(a) / std(v); 0 of one that rests.
double upper_frequency(const ResidualRows& rows) {
  double a = 0, v = 0;
  for (Index i = 0; i + 1 < rows.v.size(); ++i) {
    if (std::abs(rows.t[i + 1] - rows.t[i]) > 1.5 * rows.dt) continue;  // another record
    a += std::pow((rows.v[i + 1] - rows.v[i]) / rows.dt, 2);
    v += std::pow(0.5 * (rows.v[i + 1] + rows.v[i]), 2);
  }
  return v > 0 ? std::sqrt(a / v) : 0;
}

/// That of a tone, whatever its phase; v over the motion's upper frequency keeps it within a motion in a wide band, or
/// with steps.
VectorXd local_amplitude(const ResidualRows& rows) {
  const double upper = upper_frequency(rows);
  if (!(upper > 0)) return rows.y.cwiseAbs();
  return (rows.y.array().square() + (rows.v.array() / upper).square()).sqrt();
}

}  // namespace

int bin_of(double x, double low, double high, int count) {
  return std::clamp(static_cast<int>((x - low) / (high - low) * count), 0, count - 1);
}

VectorXd centres(double low, double high, int count) {
  const double half = 0.5 * (high - low) / count;
  return VectorXd::LinSpaced(count, low + half, high - half);
}

VectorXd running_time(const ResidualRows& rows) {
  VectorXd time = rows.t;
  double end = -INFINITY;
  for (std::size_t r = 0; r + 1 < rows.row_of_record.size(); ++r) {
    const Index first = rows.row_of_record[r], count = rows.row_of_record[r + 1] - first;
    if (count == 0) continue;
    if (time[first] <= end) time.segment(first, count).array() += end + rows.dt - time[first];
    end = time[first + count - 1];
  }
  return time;
}

double NoisePower::level(double rows, double bins) const {
  const double own = std::max(1.0, freedom * rows), all = std::max(1.0, median_is_worth * freedom * all_rows);
  return std::sqrt(mean * f_quantile(false_alarm / bins, own, all));
}

NoisePower noise_power(const ResidualRows& rows, const VectorXd& noise, double left) {
  NoisePower out;
  const Index n = noise.size(), block = std::max<Index>(1, std::min(rows.block, n / 4));
  out.all_rows = static_cast<double>(n);
  const BlockPowers powers(noise, block);
  const PowerSpectrum spectrum = spectrum_of(rows, powers.without_bursts(noise), true);
  out.density = without_lines(spectrum) / left;
  // The mean square over a time T varies by the integral of the squared density over T (Bendat & Piersol 2010, 8.2).
  const double sum = out.density.sum(), squares = std::max(1e-300, out.density.squaredNorm());
  out.freedom = std::min(1.0, 2 * rows.dt * spectrum.frequency[1] * sum * (sum / squares));
  const double of_block = std::max(1.0, out.freedom * static_cast<double>(block));
  out.mean = powers.middle / median_over_mean(of_block) / left;
  return out;
}

BinnedMap time_map(const ResidualRows& rows, const NoisePower& noise) {
  const VectorXd time = running_time(rows);
  const int windows = static_cast<int>(
      std::clamp<Index>(rows.force.size() / std::max<Index>(1, rows.block), fewest_windows, most_windows));
  BinnedMap map = rms_map(rows, time, time.minCoeff(), time.maxCoeff(), windows, noise);
  map.over = "time";
  map.unit = "s";
  return map;
}

BinnedMap amplitude_map(const ResidualRows& rows, const NoisePower& noise) {
  const VectorXd amplitude = local_amplitude(rows);
  BinnedMap map = rms_map(rows, amplitude, 0, std::max(amplitude.maxCoeff(), 1e-300), amplitude_cells, noise);
  map.over = "amplitude";
  map.unit = rows.units.y;
  return map;
}

BinnedMap frequency_map(const ResidualRows& rows, const NoisePower& noise) {
  const PowerSpectrum found = spectrum_of(rows, rows.force, false);
  const double freedom = freedom_of(found);
  const Index bins = found.density.size(), ratio = (noise.density.size() - 1) / (bins - 1);
  BinnedMap map;
  map.over = "frequency";
  map.unit = "Hz";
  map.value_is = "root density";
  map.x = found.frequency.tail(bins - 1);
  map.value = found.density.tail(bins - 1).cwiseSqrt();
  map.rows = VectorXd::Constant(bins - 1, static_cast<double>(longest_record(rows).second));
  map.level.resize(bins - 1);
  for (Index k = 1; k < bins; ++k) {
    const double own = k == bins - 1 ? freedom / 2 : freedom;  // real alone
    map.level[k - 1] =
        std::sqrt(seen_coarsely(noise.density, k, ratio) *
                  f_quantile(false_alarm / static_cast<double>(bins - 1), own, median_is_worth * freedom));
  }
  return map;
}

}  // namespace lunid
