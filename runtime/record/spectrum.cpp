#include "record/spectrum.hpp"

#include <algorithm>
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

WelchSum::WelchSum(Eigen::Index samples, Eigen::Index length)
    : samples_(samples), window_(hann(length)), sum_{Eigen::VectorXd::Zero(length / 2 + 1), length, 0} {}

void WelchSum::add(std::span<const double> piece) {
  held_.insert(held_.end(), piece.begin(), piece.end());
  const Eigen::Index length = sum_.length, hop = std::max<Eigen::Index>(length / 2, 1);
  const Eigen::Index end = first_ + static_cast<Eigen::Index>(held_.size());
  while (start_ + length <= end) {
    const double* segment = held_.data() + (start_ - first_);
    const Eigen::VectorXd part = detrend({segment, static_cast<std::size_t>(length)}, 1).cwiseProduct(window_);
    sum_.density += half_spectrum({part.data(), static_cast<std::size_t>(length)}, length).cwiseAbs2();
    ++sum_.segments;
    // The last segment ends with the record.
    const bool last = start_ + length < samples_ && start_ + hop + length > samples_;
    start_ = last && samples_ - length > start_ + hop / 2 ? samples_ - length : start_ + hop;
  }
  const Eigen::Index done = std::min(start_, end) - first_;
  held_.erase(held_.begin(), held_.begin() + done);
  first_ += done;
}

Spectrum WelchSum::spectrum() const {
  Spectrum result = sum_;
  result.density /= window_.squaredNorm() * static_cast<double>(std::max<Eigen::Index>(result.segments, 1));
  return result;
}

Spectrum welch(std::span<const double> x, Eigen::Index length) {
  WelchSum sum(static_cast<Eigen::Index>(x.size()), length);
  sum.add(x);
  return sum.spectrum();
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
