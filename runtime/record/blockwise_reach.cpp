// How far the filters of derive.hpp see: windows end, splines and smoothers die away exponentially.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>

#include "record/blockwise.hpp"
#include "record/method_parts.hpp"

namespace lunid {
namespace {

using Eigen::Index;

constexpr const char* where = "stream";
constexpr double digits = 32;  // exp(-32) = 1e-14

/// Slowest decay per row of the filter 1/(c[0] + c[1] w^2 + ... + w^(2n)), c >= 0 and c[0] > 0: the poles of w lie off
/// the real axis by so much.
double slowest_decay(const Eigen::VectorXd& c) {
  const Index n = c.size();
  const double scale = std::pow(c[0], 1.0 / static_cast<double>(n));  // of w^2, so that the outer coefficients are 1
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.diagonal(-1).setOnes();
  for (Index k = 0; k < n; ++k) companion(k, n - 1) = -c[k] / std::pow(scale, static_cast<double>(n - k));
  double least = HUGE_VAL;
  for (const std::complex<double>& square : companion.eigenvalues())
    least = std::min(least, std::abs(std::sqrt(square * scale).imag()));
  return least;
}

/// Rows after which a filter of this decay has died away; `most`: the decay of the sampled filter where the continuous
/// one is faster than the samples.
Index rows_of_decay(const char* method, double decay, double most) {
  const double rows = std::ceil(1.5 * digits / std::min(decay, most));
  if (!(rows <= static_cast<double>(furthest_reach)))
    refuse(where, std::string("derivative: ") + method + ": smooths over " + short_number(rows) +
                      " rows on either side, expected at most " + std::to_string(furthest_reach) +
                      ": take a smaller weight or a larger density, or the whole record by lunid.read");
  return static_cast<Index>(rows);
}

SettledReach settled(const FiniteDifferences& m, std::span<const int>, std::span<const double>, double,
                     int derivative) {
  // One-sided differences at the ends of the record reach as far as twice the central ones.
  return {m, static_cast<Index>(derivative + m.accuracy) * m.step};
}

SettledReach settled(const PolynomialWindow& m, std::span<const int>, std::span<const double>, double, int) {
  return {m, m.rows / 2};
}

SettledReach settled(const SmoothedDifferences& m, std::span<const int>, std::span<const double>, double,
                     int derivative) {
  return {m, m.rows / 2 + derivative + m.accuracy};
}

SettledReach settled(const SmoothingSpline& m, std::span<const int>, std::span<const double>, double dt, int) {
  const int n = (m.degree + 1) / 2;
  Eigen::VectorXd c = Eigen::VectorXd::Zero(n);
  c[0] = std::pow(dt, m.degree) / m.weight;
  return {m, rows_of_decay("spline", slowest_decay(c), 0.8)};
}

SettledReach settled(const KalmanSmoother& m, std::span<const int> ranks, std::span<const double> noise, double dt,
                     int) {
  Eigen::VectorXd c = Eigen::VectorXd::Zero(m.order - ranks.front());
  const double density = m.density * std::pow(dt, 2 * m.order - 1);  // rows one apart
  for (std::size_t i = 0; i < ranks.size(); ++i)
    c[ranks[i] - ranks.front()] += density / std::pow(noise[i] * std::pow(dt, ranks[i]), 2);
  return {m, rows_of_decay("kalman", slowest_decay(c), 0.4)};
}

template <class Method>
[[noreturn]] SettledReach endless(const Method& m, const std::string& why) {
  refuse(where,
         "derivative: " + name_of(DerivativeMethod(m)) + ": " + why +
             ": take savitzky_golay, spline or kalman, which a stream makes block by block, or the whole record by "
             "lunid.read");
}

SettledReach settled(const FourierFilter& m, std::span<const int>, std::span<const double>, double, int) {
  return endless(m, "its weights have no end");
}

SettledReach settled(const TotalVariation& m, std::span<const int>, std::span<const double>, double, int) {
  return endless(m, "each of its pieces depends on all rows");
}

}  // namespace

SettledReach settled_reach(const DerivativeMethod& method, std::span<const int> ranks, std::span<const double> noise,
                           double dt, int derivative) {
  return std::visit([&](const auto& m) { return settled(m, ranks, noise, dt, derivative); }, method);
}

}  // namespace lunid
