// The level of white noise under a signal, and the signal's dominant frequency: both read off the spectrum.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "record/median.hpp"
#include "record/noise_sum.hpp"
#include "record/record.hpp"
#include "record/spectra.hpp"
#include "record/spectrum.hpp"

namespace lunid {
namespace {

constexpr Eigen::Index enough_for_steps = 16384;  // rows

/// Between neighbours among the different values; `sorted`: some of them, in any order.
std::vector<double> distances_of(std::vector<double> sorted) {
  std::sort(sorted.begin(), sorted.end());
  const double same = 1e-9 * (sorted.back() - sorted.front());  // the same value but for rounding
  std::vector<double> distances;
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i] - sorted[i - 1] > same) distances.push_back(sorted[i] - sorted[i - 1]);
  return distances;
}

/// The least distance of two different values, where nearly all distances are multiples of it; else 0. Also 0 where
/// there are few values: a force that is switched on and off is no coarse measurement.
double value_step(const std::vector<double>& distances) {
  constexpr std::size_t few = 16;
  if (distances.size() < few) return 0;
  const double step = *std::min_element(distances.begin(), distances.end());
  std::size_t off = 0;
  for (double d : distances) off += std::abs(d / step - std::round(d / step)) > 0.1;
  return off * 20 < distances.size() ? step : 0;
}

/// For records too short for a spectrum: differences of order m leave of a smooth signal little, of white
/// noise of variance s^2 the variance s^2 binomial(2m, m). The lowest over the orders.
double noise_by_differences(std::span<const double> x) {
  std::vector<double> d(x.begin(), x.end());
  double lowest = std::numeric_limits<double>::infinity(), binomial = 1;
  for (int m = 1; m <= 6 && d.size() > 3; ++m) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < d.size(); ++i) d[i] = d[i + 1] - d[i];
    d.pop_back();
    for (double value : d) sum += value * value;
    binomial *= 2.0 * (2 * m - 1) / m;
    lowest = std::min(lowest, std::sqrt(sum / static_cast<double>(d.size()) / binomial));
  }
  return std::isfinite(lowest) ? lowest : 0;
}

constexpr Eigen::Index least_for_a_spectrum = 64;  // rows

/// Segments of the spectra that noise is read off.
Eigen::Index segment_for(Eigen::Index rows) { return std::clamp<Eigen::Index>(power_of_two_below(rows / 6), 32, 1024); }

/// Degrees of freedom of a bin: 2 for each independent segment (half-overlapping Hann segments: 36/19 of the number of
/// disjoint ones, Welch 1967).
double freedom_of_a_bin(const Spectrum& spectrum, double samples) {
  return std::max(2.0, 2 * 36.0 / 19 * samples / static_cast<double>(spectrum.length) - 1);
}

/// Bands of a spectrum, without its first and last bin: the first bin of each, and the end of the last.
using Bands = std::vector<Eigen::Index>;

Bands even_bands(Eigen::Index bins, Eigen::Index count) {
  Bands out;
  for (Eigen::Index b = 0; b <= count; ++b) out.push_back(1 + b * (bins - 2) / count);
  return out;
}

/// Two to an octave, none wider than a sixteenth of the spectrum.
Bands bands_by_octave(Eigen::Index bins) {
  const Eigen::Index widest = std::max<Eigen::Index>(1, (bins - 2) / 16);
  Bands out{1};
  while (out.back() < bins - 1)
    out.push_back(std::min(bins - 1, out.back() + std::clamp<Eigen::Index>(2 * out.back() / 5, 1, widest)));
  return out;
}

std::span<const double> part_of(const Eigen::VectorXd& density, const Bands& bands, std::size_t b) {
  return {density.data() + bands[b], density.data() + bands[b + 1]};
}

double median_of(std::span<const double> x) { return median({x.begin(), x.end()}); }
double mean_of(std::span<const double> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

/// The lowest level over broad bands of the spectrum; bands that differ from the lowest by no more than
/// chance are pooled with it, because the lowest of several equals would be too low.
double floor_of(const Spectrum& spectrum, double samples) {
  const Eigen::Index bins = spectrum.density.size(), count = std::clamp<Eigen::Index>(bins / 8, 2, 8);
  const Bands bands = even_bands(bins, count);
  const double lower = median_over_mean(freedom_of_a_bin(spectrum, samples));
  std::vector<double> levels;
  for (std::size_t b = 0; b + 1 < bands.size(); ++b)
    levels.push_back(median_of(part_of(spectrum.density, bands, b)) / lower);
  const double lowest = *std::min_element(levels.begin(), levels.end());
  // Relative scatter of a band's level: chi-square with the band's degrees of freedom, the median's
  // efficiency 2/pi.
  const double scatter = std::sqrt(std::numbers::pi / 2 * 2 * static_cast<double>(count) / samples);
  double sum = 0, pooled = 0;
  for (double level : levels) {
    if (level > lowest * (1 + 4 * scatter)) continue;
    sum += level;
    ++pooled;
  }
  return sum / pooled;
}

/// Of each bin of a signal's spectrum the part that follows no drive, without bias: (1 - g^2) n/(n - 1) of n averages.
Eigen::VectorXd undriven_part(std::span<const double> left, const Drives& drives) {
  const Eigen::Index length = segment_for(static_cast<Eigen::Index>(left.size()));
  Eigen::VectorXd out = Eigen::VectorXd::Ones(length / 2 + 1);
  for (const std::span<const double> drive : drives) {
    const TransferFunction response = transfer_function(drive, left, 1, length);
    const double unbiased = response.averages / (response.averages - 1);
    for (Eigen::Index i = 0; i < out.size(); ++i)
      if (const double g = response.coherence[i]; std::isfinite(g)) out[i] *= (1 - g) * unbiased;
  }
  return out;
}

}  // namespace

NoiseSum::NoiseSum(Eigen::Index rows) : rows_(rows) {
  if (rows >= least_for_a_spectrum) spectrum_.emplace(rows, segment_for(rows));
}

void NoiseSum::add(std::span<const double> piece) {
  const Eigen::Index every = 1 + rows_ / enough_for_steps;
  for (const double value : piece) {
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
    if (seen_++ % every == 0) some_.push_back(value);
  }
  if (spectrum_) spectrum_->add(piece);
}

double NoiseSum::level() const {
  if (rows_ < 2 || !(high_ > low_)) return 0;
  constexpr std::size_t switched = 4;  // between so few values: noise would show as more of them
  const std::vector<double> distances = distances_of(some_);
  if (spectrum_ && distances.size() < switched) return 0;
  const double least = 0.5 * value_step(distances) / std::sqrt(12.0);
  if (!spectrum_) return std::max(least, noise_by_differences(some_));
  return std::max(least, std::sqrt(floor_of(spectrum_->spectrum(), static_cast<double>(rows_))));
}

double quantisation_step(std::span<const double> x) {
  const std::size_t every = 1 + x.size() / static_cast<std::size_t>(enough_for_steps);
  std::vector<double> some;
  for (std::size_t i = 0; i < x.size(); i += every)
    if (std::isfinite(x[i])) some.push_back(x[i]);
  return some.empty() ? 0 : value_step(distances_of(std::move(some)));
}

double noise_level(std::span<const double> x) {
  NoiseSum sum(static_cast<Eigen::Index>(x.size()));
  sum.add(x);
  return sum.level();
}

double noise_between_jumps(std::span<const double> x) {
  constexpr double normal = 1.4826;            // standard deviation over the middle size of normal values
  constexpr double as_large = 0.8, few = 0.2;  // of the level: nothing jumps; of the rows: a value that is held
  const double level = noise_level(x);
  std::vector<double> d(x.begin(), x.end()), sizes;
  double lowest = level, binomial = 1;
  for (int m = 1; m <= 5 && d.size() > 16; ++m) {
    for (std::size_t i = 0; i + 1 < d.size(); ++i) d[i] = d[i + 1] - d[i];
    d.pop_back();
    if (m == 1 && static_cast<double>(std::ranges::count(d, 0.0)) > few * static_cast<double>(d.size())) return level;
    binomial *= 2.0 * (2 * m - 1) / m;
    sizes.assign(d.begin(), d.end());
    for (double& size : sizes) size = std::abs(size);
    lowest = std::min(lowest, normal * median(sizes) / std::sqrt(binomial));
  }
  return lowest < as_large * level ? lowest : level;
}

double noise_beside(std::span<const double> left, std::span<const double> model, const Drives& drives) {
  constexpr double next_to_none = 0.3;  // of the power that is left
  const auto rows = static_cast<Eigen::Index>(left.size());
  if (rows < least_for_a_spectrum) return 0;
  const Spectrum of_left = welch(left, segment_for(rows)), of_model = welch(model, segment_for(rows));
  const Eigen::VectorXd undriven = of_left.density.cwiseProduct(undriven_part(left, drives));
  const Bands bands = bands_by_octave(of_left.density.size());
  const double lower = median_over_mean(freedom_of_a_bin(of_left, static_cast<double>(rows)));
  std::vector<double> powers;
  double highest = 0;
  for (std::size_t b = 0; b + 1 < bands.size(); ++b) {
    const std::span<const double> here = part_of(undriven, bands, b);
    powers.push_back(std::max(0.0, mean_of(here)));
    const double whole = mean_of(part_of(of_left.density, bands, b));
    if (mean_of(part_of(of_model.density, bands, b)) < next_to_none * whole)
      highest = std::max(highest, median_of(here) / lower);
  }
  double sum = 0;
  for (std::size_t b = 0; b < powers.size(); ++b)
    sum += std::min(powers[b], highest) * static_cast<double>(bands[b + 1] - bands[b]);
  return std::sqrt(sum / static_cast<double>(bands.back() - bands.front()));
}

double driven_part(std::span<const double> left, const Drives& drives) {
  const auto rows = static_cast<Eigen::Index>(left.size());
  if (rows < least_for_a_spectrum || drives.empty()) return 0;
  const Eigen::VectorXd density = welch(left, segment_for(rows)).density;
  return 1 - density.dot(undriven_part(left, drives)) / density.sum();
}

double dominant_frequency(std::span<const double> x, double dt) {
  const auto n = static_cast<Eigen::Index>(x.size());
  if (n < 4) return 0;
  const Eigen::VectorXd part = detrend(x, 1);  // and no window: it would hide the start of a decay
  const Eigen::Index length = 2 * power_of_two_above(n);
  const Eigen::VectorXd power = half_spectrum({part.data(), x.size()}, length).cwiseAbs2();
  // Less than three quarters of a cycle in the whole record is drift.
  const auto lowest = static_cast<Eigen::Index>(std::ceil(0.75 * static_cast<double>(length) / static_cast<double>(n)));
  Eigen::Index peak = lowest;
  power.segment(lowest, power.size() - lowest).maxCoeff(&peak);
  peak += lowest;
  if (!(power[peak] > 0)) return 0;
  double weight = 0, moment = 0;
  const auto add = [&](Eigen::Index k) {
    weight += power[k];
    moment += power[k] * static_cast<double>(k);
  };
  add(peak);
  for (Eigen::Index k = peak + 1; k < power.size() && power[k] > 0.1 * power[peak]; ++k) add(k);
  for (Eigen::Index k = peak - 1; k >= lowest && power[k] > 0.1 * power[peak]; --k) add(k);
  return 2 * std::numbers::pi * moment / weight / (static_cast<double>(length) * dt);
}

}  // namespace lunid
