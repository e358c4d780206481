#include "record/random_signal.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "expr/error.hpp"
#include "record/spectrum.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// To rms 1; a signal of zeros stays one.
VectorXd of_unit_rms(VectorXd x) {
  const double rms = std::sqrt(x.squaredNorm() / static_cast<double>(std::max<Index>(x.size(), 1)));
  if (rms > 0) x /= rms;
  return x;
}

/// White noise with bin k of `length` / 2 + 1 bins multiplied by gain(k); its first `rows` rows, rms 1.
template <class Gain>
VectorXd shaped(Index rows, Index length, Philox& random, Gain gain) {
  const VectorXd white = white_noise(length, random);
  Eigen::VectorXcd spectrum = half_spectrum({white.data(), static_cast<std::size_t>(length)}, length);
  for (Index k = 0; k < spectrum.size(); ++k) spectrum[k] *= gain(k);
  return inverse_half_spectrum(spectrum, length).head(rows);
}

Index padded(Index rows) { return power_of_two_above(2 * std::max<Index>(rows, 2)); }

/// The largest magnitude of the roots of z^p - ar[0] z^(p-1) - ...: 1 and more is a series that grows.
double spectral_radius(std::span<const double> ar) {
  const auto order = static_cast<Index>(ar.size());
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(order, order);
  for (Index i = 0; i < order; ++i) companion(0, i) = ar[static_cast<std::size_t>(i)];
  for (Index i = 1; i < order; ++i) companion(i, i - 1) = 1;
  return companion.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace

VectorXd white_noise(Index rows, Philox& random) {
  return VectorXd::NullaryExpr(rows, [&](Index) { return random.normal(); });
}

VectorXd uniform_noise(Index rows, Philox& random) {
  return VectorXd::NullaryExpr(rows, [&](Index) { return 2 * random.uniform() - 1; });
}

VectorXd coloured_noise(Index rows, double exponent, Philox& random) {
  if (!(std::abs(exponent) <= 4))
    throw InputError("coloured_noise: exponent: expected -4 to 4, got " + number(exponent));
  const VectorXd x = shaped(rows, padded(rows), random, [exponent](Index k) {
    return k == 0 ? 0.0 : std::pow(static_cast<double>(k), -exponent / 2);
  });
  return of_unit_rms(x.array() - x.mean());
}

VectorXd band_limited_noise(Index rows, double dt, double from, double to, Philox& random) {
  const double nyquist = 0.5 / dt;
  if (!(from >= 0 && from < to && to <= nyquist))
    throw InputError("band_limited_noise: expected 0 <= from < to <= " + number(nyquist) +
                     " Hz (the Nyquist frequency), got " + number(from) + " to " + number(to));
  const Index length = padded(rows);
  const double spacing = 1 / (static_cast<double>(length) * dt);
  bool empty = true;
  const VectorXd x = shaped(rows, length, random, [&](Index k) {
    const double frequency = static_cast<double>(k) * spacing;
    const bool inside = k > 0 && frequency >= from && frequency <= to;
    empty = empty && !inside;
    return inside ? 1.0 : 0.0;
  });
  if (empty)
    throw InputError("band_limited_noise: " + number(from) + " to " + number(to) + " Hz is too narrow for " +
                     number(static_cast<double>(rows) * dt) + " s: expected a band of at least " +
                     number(1 / (static_cast<double>(rows) * dt)) + " Hz");
  return of_unit_rms(x);
}

VectorXd autoregressive_noise(Index rows, std::span<const double> ar, Philox& random) {
  if (ar.empty()) return white_noise(rows, random);
  const double radius = spectral_radius(ar);
  if (!(radius < 1))
    throw InputError("autoregressive_noise: the series grows by a factor of " + number(radius) +
                     " per row; expected less than 1");
  // Started at zero, it is stationary to 1e-9 once its slowest root has died away.
  const auto lead = static_cast<Index>(std::min(1e6, std::ceil(std::log(1e-9) / std::log(std::max(radius, 1e-3)))));
  VectorXd x = VectorXd::Zero(lead + rows);
  for (Index i = 0; i < x.size(); ++i) {
    x[i] = random.normal();
    for (std::size_t j = 0; j < ar.size() && static_cast<Index>(j) < i; ++j)
      x[i] += ar[j] * x[i - 1 - static_cast<Index>(j)];
  }
  return of_unit_rms(x.tail(rows));
}

}  // namespace lunid
