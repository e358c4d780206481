// The noise of a channel in more than one number.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "record/method_parts.hpp"
#include "record/spectra.hpp"
#include "record/spectrum.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

double quantile(std::vector<double> x, double part) {
  const auto at = x.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(x.size() - 1));
  std::nth_element(x.begin(), at, x.end());
  return *at;
}

constexpr int order = 6;
constexpr double gain = 30.3974;  // sqrt(binomial(12, 6)): of the deviation of white noise
constexpr double stands_out = 6;  // deviations

/// They leave next to nothing of a smooth signal.
std::vector<double> sixth_differences(std::span<const double> x) {
  std::vector<double> d(x.begin(), x.end());
  for (int k = 0; k < order; ++k) {
    for (std::size_t i = 0; i + 1 < d.size(); ++i) d[i] = d[i + 1] - d[i];
    d.pop_back();
  }
  return d;
}

double median_size(const std::vector<double>& d) {
  std::vector<double> size(d.size());
  for (std::size_t i = 0; i < d.size(); ++i) size[i] = std::abs(d[i]);
  return quantile(std::move(size), 0.5) / 0.67449;
}

/// Deviation by the median of absolute sixth differences; and the rows at which they stand out. One wild row makes
/// seven of them.
void by_differences(std::span<const double> x, NoiseReport& report) {
  const std::vector<double> d = sixth_differences(x);
  report.robust = median_size(d) / gain;
  const double limit = stands_out * report.robust * gain;
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (std::abs(d[i]) <= limit || limit == 0) continue;
    ++report.outliers;
    i += order;  // the rest of them are of the same row
  }
}

/// The line y = level + slope*x by the median of all slopes (Theil 1950, Sen 1968); the slope's deviation from the
/// quartiles of the residuals.
struct Line {
  double level, slope, slope_std;
};
Line median_line(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> slopes, levels, off;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = i + 1; j < x.size(); ++j) slopes.push_back((y[j] - y[i]) / (x[j] - x[i]));
  Line line{0, quantile(slopes, 0.5), 0};
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    levels.push_back(y[i] - line.slope * x[i]);
    mean += x[i] / static_cast<double>(x.size());
  }
  line.level = quantile(levels, 0.5);
  for (std::size_t i = 0; i < x.size(); ++i) {
    off.push_back(std::abs(levels[i] - line.level));
    square += (x[i] - mean) * (x[i] - mean);
  }
  line.slope_std = 1.4826 * quantile(off, 0.5) / std::sqrt(square);
  return line;
}

}  // namespace

std::vector<WildRow> wild_rows(std::span<const double> x) {
  constexpr std::array<double, order + 1> weights{1, -6, 15, -20, 15, -6, 1};
  constexpr std::size_t middle = order / 2;
  constexpr double alone = 15;  // times what is left where the row is mended: a kink leaves a seventh
  std::vector<WildRow> out;
  if (x.size() < 64) return out;
  std::vector<double> d = sixth_differences(x);
  const double limit = stands_out * median_size(d);
  if (!(limit > 0)) return out;
  for (std::size_t i = order; i + order < x.size(); ++i) {
    const double off =
        -d[i - middle] / weights[middle];  // what the row has beyond its neighbours, with the sign turned
    if (!(std::abs(d[i - middle]) > limit)) continue;
    double left = 0;
    std::array<double, order + 1> mended;
    for (std::size_t j = 0; j <= order; ++j) {
      mended[j] = d[i - j] + weights[j] * off;
      left = std::max(left, std::abs(mended[j]));
    }
    if (left > limit || alone * left > std::abs(d[i - middle])) continue;
    for (std::size_t j = 0; j <= order; ++j) d[i - j] = mended[j];
    out.push_back({static_cast<Index>(i), x[i] + off});
  }
  return out;
}

NoiseReport noise_report(std::span<const double> x, double dt) {
  NoiseReport report;
  const auto n = static_cast<Index>(x.size());
  if (n < 64) refuse("noise", "expected at least 64 rows, got " + std::to_string(n));
  report.white = noise_level(x);
  by_differences(x, report);
  const PowerSpectrum spectrum = power_spectrum(x, dt);
  constexpr double ratio = 1.5;  // of a band's ends
  constexpr Index least = 5;     // bins of a band
  const double dof = 2 * averages(spectrum.segments);
  // Of the lower quartile over the mean (Wilson & Hilferty 1931).
  const double quartile = std::pow(1 - 2 / (9 * dof) - 0.6745 * std::sqrt(2 / (9 * dof)), 3);
  std::vector<double> at, level;
  const Index bins = spectrum.density.size();
  for (Index first = 2; first < bins - 1;) {  // without the bins that the taken-off line reaches
    const Index last =
        std::min(bins - 1, std::max(first + least, static_cast<Index>(ratio * static_cast<double>(first))));
    if (last - first >= least) {
      const double value = quantile({spectrum.density.data() + first, spectrum.density.data() + last}, 0.25) / quartile;
      if (value > 0) {
        at.push_back(0.5 * (std::log(spectrum.frequency[first]) + std::log(spectrum.frequency[last - 1])));
        level.push_back(std::log(value));
      }
    }
    first = last;
  }
  if (at.size() < 3) return report;
  const Line line = median_line(at, level);
  report.exponent = -line.slope;
  report.exponent_std = line.slope_std;
  const double step = spectrum.frequency[1];
  double power = 0;
  for (Index k = 1; k < bins; ++k) power += step * std::exp(line.level + line.slope * std::log(spectrum.frequency[k]));
  report.background = std::sqrt(power);
  report.frequency = Eigen::Map<const VectorXd>(at.data(), static_cast<Index>(at.size())).array().exp();
  report.density = Eigen::Map<const VectorXd>(level.data(), static_cast<Index>(level.size())).array().exp();
  return report;
}

}  // namespace lunid
