#include "record/derivative_error.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "record/spectrum.hpp"

namespace lunid {
namespace {

/// Frequency response of a filter at the bins of a transform of `length`, about its middle.
Eigen::VectorXcd response(const Eigen::VectorXd& w, Eigen::Index length) {
  const Eigen::Index h = w.size() / 2;
  Eigen::VectorXd turned = Eigen::VectorXd::Zero(length);
  for (Eigen::Index k = -h; k <= h; ++k) turned[(length + k) % length] = w[h + k];
  return half_spectrum({turned.data(), static_cast<std::size_t>(length)}, length).conjugate();
}

/// The spectrum less the noise where it stands out of it by more than chance; elsewhere 0. (Where the signal
/// is below the noise no filter gains by letting it pass, and the scatter of the difference would drown the
/// sum.)
Eigen::VectorXd signal_density(const Spectrum& spectrum, double noise_density) {
  const Eigen::Index bins = spectrum.density.size();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(bins + 1), density = Eigen::VectorXd::Zero(bins);
  for (Eigen::Index k = 0; k < bins; ++k) sum[k + 1] = sum[k] + spectrum.density[k];
  const double independent = std::max(1.0, 0.5 * static_cast<double>(spectrum.segments));
  for (Eigen::Index k = 0; k < bins; ++k) {
    const Eigen::Index reach = std::min<Eigen::Index>(4, bins / 8) + k / 8;  // broader where chance weighs more
    const Eigen::Index first = std::max<Eigen::Index>(k - reach, 0), last = std::min(k + reach + 1, bins);
    // Quantile 1 - 1e-4 of chi-square over its degrees of freedom (Wilson & Hilferty 1931); neighbouring bins
    // of a Hann window share half of theirs.
    const double dof = independent * static_cast<double>(last - first);
    const double threshold = std::pow(1 - 2 / (9 * dof) + 3.72 * std::sqrt(2 / (9 * dof)), 3);
    const double mean = (sum[last] - sum[first]) / static_cast<double>(last - first);
    if (mean > threshold * noise_density) density[k] = spectrum.density[k] - noise_density;
  }
  return density;
}

/// How often the bin k stands for a frequency: its negative one counts too, but for the last bin.
double both(Eigen::Index k, Eigen::Index bins) { return k + 1 < bins ? 2 : 1; }

}  // namespace

Eigen::Index DerivativeError::segment_length(Eigen::Index rows) {
  constexpr Eigen::Index longest = 16384;  // bounds the work and the window
  return std::min(power_of_two_below(std::max<Eigen::Index>(rows, 2)), longest);
}

DerivativeError::DerivativeError(std::span<const double> x, double noise, int derivative)
    : DerivativeError(welch(x, segment_length(static_cast<Eigen::Index>(x.size()))), noise, derivative) {}

DerivativeError::DerivativeError(const Spectrum& spectrum, double noise, int derivative) {
  density_ = signal_density(spectrum, noise * noise);
  noise_density_ = noise * noise;
  length_ = spectrum.length;
  ideal_.resize(density_.size());
  for (Eigen::Index k = 0; k < ideal_.size(); ++k) {
    const std::complex<double> iw(0, 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(length_));
    ideal_[k] = std::pow(iw, derivative);
  }
}

double DerivativeError::of(const Eigen::VectorXd& weights) const {
  const Eigen::VectorXcd h = response(weights, length_);
  double bias = 0;
  for (Eigen::Index k = 1; k < h.size(); ++k) bias += both(k, h.size()) * std::norm(h[k] - ideal_[k]) * density_[k];
  return weights.squaredNorm() * noise_density_ + bias / static_cast<double>(length_);
}

}  // namespace lunid
