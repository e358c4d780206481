#include "record/spectra.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "record/method_parts.hpp"
#include "record/spectrum.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;

VectorXd hann(Index length) {
  return VectorXd::NullaryExpr(length, [&](Index i) {
    const double s = std::sin(std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(length));
    return s * s;
  });
}

/// First rows of half-overlapping segments; the last one ends with the record.
std::vector<Index> starts(Index rows, Index length) {
  std::vector<Index> list;
  for (Index start = 0; start + length <= rows; start += std::max<Index>(length / 2, 1)) list.push_back(start);
  if (rows - length > list.back() + length / 4) list.push_back(rows - length);
  return list;
}

VectorXcd segment_spectrum(std::span<const double> x, Index start, const VectorXd& window) {
  const auto length = static_cast<std::size_t>(window.size());
  const VectorXd part = detrend(x.subspan(static_cast<std::size_t>(start), length), 1).cwiseProduct(window);
  return half_spectrum({part.data(), length}, window.size());
}

VectorXd frequencies(Index length, double dt) {
  return VectorXd::NullaryExpr(length / 2 + 1,
                               [&](Index k) { return static_cast<double>(k) / (static_cast<double>(length) * dt); });
}

/// Factor of |X|^2 to a one-sided density.
VectorXd one_sided(const VectorXd& window, double dt) {
  VectorXd factor = VectorXd::Constant(window.size() / 2 + 1, 2 * dt / window.squaredNorm());
  factor[0] /= 2;
  factor[factor.size() - 1] /= 2;
  return factor;
}

/// Quantile of chi-square over its degrees of freedom. (Wilson & Hilferty 1931.)
double chi_square(double dof, double normal) {
  return std::pow(std::max(0.0, 1 - 2 / (9 * dof) + normal * std::sqrt(2 / (9 * dof))), 3);
}

}  // namespace

Index segment_length(Index rows, Index asked, const char* where) {
  if (asked == 0) return std::max<Index>(16, power_of_two_below(std::max<Index>(rows / 8, 1)));
  if (asked < 16 || asked > rows || power_of_two_below(asked) != asked)
    refuse(where, "length: expected a power of two from 16 to the record's " + std::to_string(rows) + " rows, got " +
                      std::to_string(asked));
  return asked;
}

double averages(Index segments) {
  const double k = static_cast<double>(segments);
  return k <= 1 ? k : k / (1 + (k - 1) / k / 18);
}

PowerSpectrum power_spectrum(std::span<const double> x, double dt, Index length) {
  length = segment_length(static_cast<Index>(x.size()), length, "spectrum");
  const VectorXd window = hann(length);
  PowerSpectrum result;
  result.length = length;
  result.frequency = frequencies(length, dt);
  result.density = VectorXd::Zero(length / 2 + 1);
  for (const Index start : starts(static_cast<Index>(x.size()), length)) {
    result.density += segment_spectrum(x, start, window).cwiseAbs2();
    ++result.segments;
  }
  result.density = result.density.cwiseProduct(one_sided(window, dt)) / static_cast<double>(result.segments);
  const double dof = 2 * averages(result.segments);
  result.low = result.density / chi_square(dof, 1.96);
  result.high = result.density / std::max(1e-12, chi_square(dof, -1.96));
  return result;
}

TransferFunction transfer_function(std::span<const double> x, std::span<const double> y, double dt, Index length) {
  const auto n = static_cast<Index>(x.size());
  length = segment_length(n, length, "transfer");
  const VectorXd window = hann(length);
  const VectorXd zero = VectorXd::Zero(length / 2 + 1);
  VectorXd xx = zero, yy = zero;
  VectorXcd xy = zero;
  TransferFunction result;
  for (const Index start : starts(n, length)) {
    const VectorXcd a = segment_spectrum(x, start, window), b = segment_spectrum(y, start, window);
    xx += a.cwiseAbs2();
    yy += b.cwiseAbs2();
    xy += a.conjugate().cwiseProduct(b);
    ++result.segments;
  }
  if (result.segments < 2)
    refuse("transfer", "length: expected segments of at most " + std::to_string(power_of_two_below(n / 2)) +
                           " rows, so that there are two or more to average, got " + std::to_string(length));
  result.length = length;
  result.frequency = frequencies(length, dt);
  result.averages = averages(result.segments);
  result.chance = 1 - std::pow(0.05, 1 / std::max(result.averages - 1, 0.1));
  result.h1 = xy.cwiseQuotient(xx.cast<std::complex<double>>());
  result.h2 = yy.cast<std::complex<double>>().cwiseQuotient(xy.conjugate());
  result.coherence = xy.cwiseAbs2().cwiseQuotient(xx.cwiseProduct(yy)).cwiseMin(1.0);
  result.error = ((1 - result.coherence.array()) / (2 * result.averages * result.coherence.array())).sqrt();
  return result;
}

Spectrogram spectrogram(std::span<const double> x, double dt, Index length, Index hop) {
  const auto n = static_cast<Index>(x.size());
  length = segment_length(n, length, "spectrogram");
  if (hop == 0) hop = length / 4;
  if (hop < 1 || hop > length)
    refuse("spectrogram",
           "hop: expected 1 to the segment's " + std::to_string(length) + " rows, got " + std::to_string(hop));
  const VectorXd window = hann(length), factor = one_sided(window, dt);
  const Index segments = (n - length) / hop + 1;
  Spectrogram result{VectorXd(segments), frequencies(length, dt), Eigen::MatrixXd(length / 2 + 1, segments),
                     VectorXd(segments)};
  for (Index s = 0; s < segments; ++s) {
    result.time[s] = dt * (static_cast<double>(s * hop) + 0.5 * static_cast<double>(length - 1));
    result.density.col(s) = segment_spectrum(x, s * hop, window).cwiseAbs2().cwiseProduct(factor);
    const VectorXd d = result.density.col(s);
    Index peak = 1;
    d.segment(1, d.size() - 2).maxCoeff(&peak);
    ++peak;
    double shift = 0;
    if (d[peak] > 0 && d[peak - 1] > 0 && d[peak + 1] > 0) {
      const double a = std::log(d[peak - 1]), b = std::log(d[peak]), c = std::log(d[peak + 1]);
      if (a - 2 * b + c < 0) shift = std::clamp(0.5 * (a - c) / (a - 2 * b + c), -0.5, 0.5);
    }
    result.ridge[s] = (static_cast<double>(peak) + shift) / (static_cast<double>(length) * dt);
  }
  return result;
}

}  // namespace lunid
