// Slow time: envelopes by the analytic signal, cycles by crossings.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "record/shaped_spectrum.hpp"
#include "record/spectra.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

Envelope envelope(std::span<const double> x, double dt, double noise) {
  using Complex = std::complex<double>;
  const ShapedSpectrum shaped = shaped_spectrum(x, dt, noise);
  const VectorXd re = shaped.times([](double) { return Complex(1, 0); }),
                 im = shaped.times([](double w) { return w > 0 ? Complex(0, -1) : Complex(0, 0); }),
                 re_rate = shaped.times([](double w) { return Complex(0, w); }),
                 im_rate = shaped.times([](double w) { return Complex(w, 0); });
  Envelope result;
  result.amplitude = (re.array().square() + im.array().square()).sqrt();
  const VectorXd square = result.amplitude.cwiseAbs2();
  result.frequency =
      (re.cwiseProduct(im_rate) - im.cwiseProduct(re_rate)).cwiseQuotient(square) / (2 * std::numbers::pi * dt);
  result.phase.resize(re.size());
  for (Index i = 0; i < re.size(); ++i) result.phase[i] = std::atan2(im[i], re[i]);
  unwrap(result.phase);
  return result;
}

void unwrap(VectorXd& angle) {
  constexpr double turn = 2 * std::numbers::pi;
  for (Index i = 1; i < angle.size(); ++i) angle[i] -= turn * std::round((angle[i] - angle[i - 1]) / turn);
}

namespace {

/// The largest of sign*x over the rows first .. last, by a parabola through it and its neighbours.
double extreme(const VectorXd& x, Index first, Index last, double sign) {
  Index at = first;
  for (Index i = first; i <= last; ++i)
    if (sign * x[i] > sign * x[at]) at = i;
  if (at == 0 || at + 1 == x.size()) return x[at];
  const double a = x[at - 1], b = x[at], c = x[at + 1], bend = a - 2 * b + c;
  return sign * bend < 0 ? b - (a - c) * (a - c) / (8 * bend) : b;
}

}  // namespace

std::vector<Cycle> cycles(std::span<const double> x, double dt, double noise) {
  const ShapedSpectrum shaped = shaped_spectrum(x, dt, noise);
  const VectorXd s = shaped.times([](double) { return std::complex<double>(1, 0); });
  const VectorXd& line = shaped.extended.line;
  const double beyond = std::max(2 * noise, 0.02 * std::sqrt(s.squaredNorm() / static_cast<double>(s.size())));
  std::vector<double> crossings;  // upwards, in rows
  double candidate = -1;
  bool was_low = false;
  for (Index i = 0; i < s.size(); ++i) {
    if (i > 0 && s[i - 1] < 0 && s[i] >= 0) candidate = static_cast<double>(i - 1) + s[i - 1] / (s[i - 1] - s[i]);
    if (s[i] < -beyond) was_low = true;
    if (s[i] > beyond && was_low) {
      crossings.push_back(candidate);
      was_low = false;
    }
  }
  std::vector<Cycle> result;
  for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
    const auto first = static_cast<Index>(std::ceil(crossings[k])), last = static_cast<Index>(crossings[k + 1]);
    const double high = extreme(s, first, last, 1), low = extreme(s, first, last, -1);
    const double centre = line[(first + last) / 2];
    result.push_back(
        {crossings[k] * dt, (crossings[k + 1] - crossings[k]) * dt, 0.5 * (high - low), 0.5 * (high + low) + centre});
  }
  return result;
}

}  // namespace lunid
