#include "statistics/correlation.hpp"

#include <cmath>
#include <vector>

#include "expr/error.hpp"
#include "record/autoregression.hpp"
#include "record/median.hpp"
#include "statistics/distributions.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

/// Autocovariance at a lag of a series of mean 0.
double autocovariance(const Eigen::VectorXd& x, Eigen::Index lag) {
  const Eigen::Index n = x.size();
  return lag < n ? x.head(n - lag).dot(x.tail(n - lag)) / static_cast<double>(n) : 0;
}

Eigen::VectorXd centred(std::span<const double> x) {
  const Eigen::Map<const Eigen::VectorXd> values(x.data(), static_cast<Eigen::Index>(x.size()));
  return values.array() - moments::mean(x);
}

}  // namespace

Eigen::VectorXd autocorrelation(std::span<const double> x, int lags) {
  const Eigen::VectorXd c = centred(x);
  Eigen::VectorXd r = Eigen::VectorXd::Zero(lags + 1);
  r[0] = 1;
  const double variance = autocovariance(c, 0);
  if (!(variance > 0)) return r;
  for (int k = 1; k <= lags; ++k) r[k] = autocovariance(c, k) / variance;
  return r;
}

TestResult ljung_box(std::span<const double> x, int lags, int fitted) {
  const auto n = static_cast<double>(x.size());
  if (lags <= fitted || lags >= static_cast<int>(x.size()))
    throw InputError("ljung_box: lags: expected more than " + std::to_string(fitted) + " and fewer than " +
                     std::to_string(x.size()) + ", got " + std::to_string(lags));
  const Eigen::VectorXd r = autocorrelation(x, lags);
  double sum = 0;
  for (int k = 1; k <= lags; ++k) sum += r[k] * r[k] / (n - k);
  sum *= n * (n + 2);
  return {sum, chi_square_tail(sum, lags - fitted)};
}

TestResult runs_test(std::span<const double> x) {
  if (x.empty()) return {};
  const double middle = median({x.begin(), x.end()});
  double above = 0, below = 0, runs = 0;
  int last = 0;
  for (double value : x) {
    const int side = value > middle ? 1 : value < middle ? -1 : 0;
    if (side == 0) continue;
    (side > 0 ? above : below) += 1;
    runs += side != last;
    last = side;
  }
  const double n = above + below;
  if (above == 0 || below == 0 || n < 3) return {};
  const double expected = 1 + 2 * above * below / n;
  const double variance = (expected - 1) * (expected - 2) / (n - 1);
  const double z = (runs - expected) / std::sqrt(variance);
  return {z, 2 * normal_tail(std::abs(z))};
}

TestResult f_test(double squares_smaller, double squares_larger, double added, double freedom) {
  if (added <= 0 || freedom <= 0 || !(squares_smaller > squares_larger)) return {};
  const double f = (squares_smaller - squares_larger) / added / (squares_larger / freedom);
  return {f, f_tail(f, added, freedom)};
}

double long_run_variance(std::span<const double> x) {
  const auto n = static_cast<Eigen::Index>(x.size());
  if (n < 4) return 0;
  const AutoregressiveFit fit = fit_autoregression(x, static_cast<int>(std::clamp<Eigen::Index>(n / 20, 0, 20)));
  Eigen::VectorXd e = innovations(centred(x), fit);
  e.array() -= e.mean();
  const double variance = autocovariance(e, 0);
  if (!(variance > 0)) return 0;
  const double rho = std::clamp(autocovariance(e, 1) / variance, -0.97, 0.97);
  const double m = static_cast<double>(e.size());
  const auto lags = static_cast<Eigen::Index>(1.1447 * std::cbrt(4 * rho * rho / std::pow(1 - rho * rho, 2) * m));
  double sum = variance;
  for (Eigen::Index k = 1; k <= std::min(lags, e.size() - 1); ++k)
    sum += 2 * (1 - static_cast<double>(k) / static_cast<double>(lags + 1)) * autocovariance(e, k);
  double gain = 1;
  for (double coefficient : fit.coefficients) gain -= coefficient;
  gain = std::max(gain, 0.03);  // Andrews & Monahan: no unit root
  return sum / (gain * gain);
}

}  // namespace lunid
