// Derivatives in the frequency domain, of records that need not be periodic.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "record/derivative_error.hpp"
#include "record/method_parts.hpp"
#include "record/shaped_spectrum.hpp"
#include "record/spectrum.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double roll_off = 1.25;  // of the cut-off: there the gain is 0

/// 1 up to the cut-off, a cosine down to 0 beyond it; `at` and `cutoff` in one unit.
double low_pass(double at, double cutoff) {
  const double beyond = (at / cutoff - 1) / (roll_off - 1);
  return beyond <= 0 ? 1 : beyond >= 1 ? 0 : 0.5 + 0.5 * std::cos(std::numbers::pi * beyond);
}

/// Wiener's gain at the bins of the estimated spectrum.
VectorXd wiener(const DerivativeError& error) {
  return error.density().unaryExpr([&](double s) { return s > 0 ? s / (s + error.noise_density()) : 0.0; });
}

/// The gain at the bins 0 .. length/2 of another transform, straight between its own.
VectorXd at_bins(const VectorXd& gain, Index own_length, Index length) {
  VectorXd result(length / 2 + 1);
  for (Index k = 0; k < result.size(); ++k) {
    const double at = static_cast<double>(k) * static_cast<double>(own_length) / static_cast<double>(length);
    const auto below = std::min(static_cast<Index>(at), gain.size() - 2);
    result[k] = gain[below] + (at - static_cast<double>(below)) * (gain[below + 1] - gain[below]);
  }
  return result;
}

}  // namespace

ShapedSpectrum shaped_spectrum(std::span<const double> x, double dt, double noise, double cutoff) {
  ShapedSpectrum shaped;
  shaped.extended = extend(x, std::min<Index>(static_cast<Index>(x.size()), 8192));
  const auto rows = shaped.extended.values.size();
  shaped.length = power_of_two_above(rows);
  if (cutoff > 0) {
    shaped.gain = VectorXd::NullaryExpr(shaped.length / 2 + 1, [&](Index k) {
      return low_pass(static_cast<double>(k) / (static_cast<double>(shaped.length) * dt), cutoff);
    });
  } else {
    const DerivativeError error(x, noise, 0);
    shaped.gain = at_bins(wiener(error), error.length(), shaped.length);
  }
  shaped.spectrum = half_spectrum({shaped.extended.values.data(), static_cast<std::size_t>(rows)}, shaped.length)
                        .cwiseProduct(shaped.gain);
  return shaped;
}

VectorXd ShapedSpectrum::times(const std::function<std::complex<double>(double w)>& factor) const {
  Eigen::VectorXcd product = spectrum;
  for (Index k = 0; k < product.size(); ++k)
    product[k] *= factor(2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(length));
  product[0] = product[0].real();
  product[product.size() - 1] = product[product.size() - 1].real();
  return inverse_half_spectrum(product, length).segment(extended.reach, extended.line.size());
}

Derivative differentiate_by(const FourierFilter& method, std::span<const double> x, double dt, double noise,
                            int derivative) {
  const double nyquist = 0.5 / dt;
  if (method.cutoff < 0 || method.cutoff >= nyquist)
    refuse("fourier", "cutoff: expected < " + short_number(nyquist) + " Hz, the Nyquist frequency, got " +
                          short_number(method.cutoff));
  const ShapedSpectrum shaped = shaped_spectrum(x, dt, noise, method.cutoff);
  const auto factor = [&](double w) { return std::pow(std::complex<double>(0, w), derivative); };
  Derivative result{shaped.times(factor), 0,
                    method.cutoff > 0 ? "Fourier, cut off at " + short_number(method.cutoff) + " Hz"
                                      : "Fourier with Wiener's gain from the noise"};
  if (derivative == 0) result.values += shaped.extended.line;
  if (derivative == 1) result.values.array() += shaped.extended.slope;
  double passed = 0;
  for (Index k = 0; k < shaped.gain.size(); ++k) {
    const double w = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(shaped.length);
    passed += (k > 0 && 2 * k < shaped.length ? 2 : 1) * std::norm(shaped.gain[k] * factor(w));
  }
  const double scale = std::pow(dt, derivative);
  result.values /= scale;
  result.noise = noise * std::sqrt(passed / static_cast<double>(shaped.length)) / scale;
  return result;
}

}  // namespace lunid
