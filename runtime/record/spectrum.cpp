#include "record/spectrum.hpp"

#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace lunid {
namespace {

Eigen::VectorXd hann(Eigen::Index length) {
  Eigen::VectorXd w(length);
  for (Eigen::Index i = 0; i < length; ++i) {
    const double s = std::sin(std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(length));
    w[i] = s * s;
  }
  return w;
}

}  // namespace

Eigen::VectorXcd half_spectrum(std::span<const double> x, Eigen::Index length) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<double> padded(x.begin(), x.end());
  padded.resize(static_cast<std::size_t>(length), 0.0);
  Eigen::VectorXcd spectrum(length / 2 + 1);
  fft.fwd(spectrum.data(), padded.data(), length);
  return spectrum;
}

Eigen::VectorXd inverse_half_spectrum(const Eigen::VectorXcd& spectrum, Eigen::Index length) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  Eigen::VectorXd x(length);
  fft.inv(x.data(), spectrum.data(), length);
  return x;
}

Eigen::VectorXd detrend(std::span<const double> x, int degree) {
  const auto n = static_cast<Eigen::Index>(x.size());
  Eigen::VectorXd result = Eigen::Map<const Eigen::VectorXd>(x.data(), n);
  // The discrete orthogonal polynomials of degree 0, 1, 2 on a symmetric grid, one after another.
  const double centre = 0.5 * static_cast<double>(n - 1);
  const double square = (static_cast<double>(n) * static_cast<double>(n) - 1) / 12;
  for (int d = 0; d <= degree && n > d; ++d) {
    Eigen::VectorXd p(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double s = static_cast<double>(i) - centre;
      p[i] = d == 0 ? 1 : d == 1 ? s : s * s - square;
    }
    result -= p * (p.dot(result) / p.squaredNorm());
  }
  return result;
}

Spectrum welch(std::span<const double> x, Eigen::Index length) {
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::Index hop = std::max<Eigen::Index>(length / 2, 1);
  const Eigen::VectorXd window = hann(length);
  Spectrum result{Eigen::VectorXd::Zero(length / 2 + 1), length, 0};
  for (Eigen::Index start = 0; start + length <= n;) {
    const Eigen::VectorXd part =
        detrend(x.subspan(static_cast<std::size_t>(start), static_cast<std::size_t>(length)), 1).cwiseProduct(window);
    result.density += half_spectrum({part.data(), static_cast<std::size_t>(length)}, length).cwiseAbs2();
    ++result.segments;
    // The last segment ends with the record.
    if (start + length < n && start + hop + length > n && n - length > start + hop / 2)
      start = n - length;
    else
      start += hop;
  }
  result.density /= window.squaredNorm() * static_cast<double>(std::max<Eigen::Index>(result.segments, 1));
  return result;
}

Eigen::Index power_of_two_below(Eigen::Index n) {
  Eigen::Index p = 1;
  while (2 * p <= n) p *= 2;
  return p;
}

Eigen::Index power_of_two_above(Eigen::Index n) {
  Eigen::Index p = 1;
  while (p < n) p *= 2;
  return p;
}

}  // namespace lunid
