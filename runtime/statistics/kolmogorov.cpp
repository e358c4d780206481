#include "statistics/kolmogorov.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "expr/error.hpp"
#include "record/random.hpp"
#include "statistics/bootstrap.hpp"
#include "statistics/checks.hpp"
#include "statistics/distributions.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

/// A matrix times 10^exponent, so that high powers do not overflow.
struct Scaled {
  Eigen::MatrixXd m;
  int exponent = 0;
  void rescale() {
    const double size = m.cwiseAbs().maxCoeff();
    if (size < 1e140) return;
    m *= 1e-140;
    exponent += 140;
  }
};

Scaled power(Scaled base, int n) {
  Scaled result{Eigen::MatrixXd::Identity(base.m.rows(), base.m.cols()), 0};
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) {
      result = {result.m * base.m, result.exponent + base.exponent};
      result.rescale();
    }
    base = {base.m * base.m, 2 * base.exponent};
    base.rescale();
  }
  return result;
}

/// P(D < d) by Durbin's matrix: the central entry of n!/n^n H^n.
double durbin(double d, int n) {
  const int k = static_cast<int>(n * d) + 1, size = 2 * k - 1;
  const double h = k - n * d;
  Eigen::MatrixXd steps(size, size);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) steps(i, j) = i - j + 1 < 0 ? 0 : 1;
  for (int i = 0; i < size; ++i) {
    steps(i, 0) -= std::pow(h, i + 1);
    steps(size - 1, i) -= std::pow(h, size - i);
  }
  if (2 * h - 1 > 0) steps(size - 1, 0) += std::pow(2 * h - 1, size);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j)
      for (int g = 2; g <= i - j + 1; ++g) steps(i, j) /= g;
  Scaled left = power({steps, 0}, n);
  double p = left.m(k - 1, k - 1);
  for (int i = 1; i <= n; ++i) {
    p *= static_cast<double>(i) / n;
    if (p < 1e-140) {
      p *= 1e140;
      left.exponent -= 140;
    }
  }
  return p * std::pow(10.0, left.exponent);
}

/// P(sqrt(n) D > x) for n without bound. (Kolmogorov 1933.)
double limit_tail(double x) {
  if (x < 0.2) return 1;
  if (x < 1) {  // the other form of the theta function converges faster here
    double sum = 0;
    for (int i = 1; i < 40; i += 2) sum += std::exp(-i * i * std::numbers::pi * std::numbers::pi / (8 * x * x));
    return 1 - std::sqrt(2 * std::numbers::pi) / x * sum;
  }
  double sum = 0;
  for (int i = 1; i < 20; ++i) sum += (i % 2 == 1 ? 2 : -2) * std::exp(-2.0 * i * i * x * x);
  return sum;
}

/// P(D+ > d), one-sided. (Smirnov 1944; Birnbaum & Tingey 1951.)
double one_sided_tail(double d, double n) {
  const auto log_gamma = [](double x) {
    int sign = 0;
    return ::lgamma_r(x, &sign);
  };
  double sum = 0;
  for (double j = 0; j <= std::floor(n * (1 - d)); ++j) {
    const double place = d + j / n, rest = 1 - place;
    const double chosen = log_gamma(n + 1) - log_gamma(j + 1) - log_gamma(n - j + 1);
    const double tail = n - j > 0 ? (n - j) * std::log(std::max(rest, 1e-300)) : 0;
    sum += std::exp(chosen + tail + (j - 1) * std::log(place));
  }
  return d * sum;
}

/// Largest distance of the sample's steps from a distribution function that is given at its ordered values.
template <class Function>
double largest_distance(std::span<const double> x, Function cumulative) {
  std::vector<double> ordered(x.begin(), x.end());
  std::sort(ordered.begin(), ordered.end());
  const double n = static_cast<double>(x.size());
  double d = 0;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    const double value = cumulative(ordered[i]), below = static_cast<double>(i) / n;
    d = std::max({d, value - below, below + 1 / n - value});
  }
  return d;
}

/// D from the normal distribution that the rows themselves have.
double own_normal_distance(std::span<const double> x) {
  const double n = static_cast<double>(x.size()), mean = moments::mean(x);
  const double deviation = moments::standard_deviation(x) * std::sqrt(n / (n - 1));
  return largest_distance(x, [&](double value) { return normal_tail((mean - value) / deviation); });
}

/// Nearly the same distribution for every n. (Stephens 1974, J. Am. Stat. Assoc. 69, 730.)
double stephens(double d, double n) { return d * (std::sqrt(n) - 0.01 + 0.85 / std::sqrt(n)); }

/// Share of the orders of n and m values whose steps stay closer than d: paths on a grid, each step of equal right.
double share_of_paths_below(double d, int n, int m) {
  const double width = d * n * m * (1 - 1e-12);  // |i m - j n| in whole numbers, so that D itself counts as reached
  std::vector<double> share(static_cast<std::size_t>(m) + 1);
  const auto inside = [&](int i, int j) {
    return std::abs(static_cast<double>(i) * m - static_cast<double>(j) * n) < width;
  };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= m; ++j) {
      double& here = share[static_cast<std::size_t>(j)];
      if (i == 0 && j == 0)
        here = 1;
      else if (!inside(i, j))
        here = 0;
      else  // of the paths to (i, j), i of i + j come from the left by symmetry
        here = (i > 0 ? here * i / (i + j) : 0) + (j > 0 ? share[static_cast<std::size_t>(j) - 1] * j / (i + j) : 0);
    }
  return share[static_cast<std::size_t>(m)];
}

}  // namespace

double kolmogorov_tail(double d, double n) {
  if (d <= 0.5 / n) return 1;
  if (d >= 1) return 0;
  const double square = n * d * d;
  if (square > 4) return std::min(2 * one_sided_tail(d, n), 1.0);
  if (n <= 1000) return std::clamp(1 - durbin(d, static_cast<int>(n)), 0.0, 1.0);
  const double x = std::sqrt(square);
  return limit_tail(x + 1 / (6 * std::sqrt(n)) + (x - 1) / (4 * n));
}

double smirnov_tail(double d, double n, double m) {
  if (d <= 0) return 1;
  if (n * m <= 1e6) return std::clamp(1 - share_of_paths_below(d, static_cast<int>(n), static_cast<int>(m)), 0.0, 1.0);
  const double effective = std::sqrt(n * m / (n + m));
  return limit_tail(d * (effective + 0.12 + 0.11 / effective));
}

TestResult kolmogorov_normal(std::span<const double> x, double mean, double deviation) {
  check_columns("kolmogorov_smirnov", {x}, {.rows = 1, .may_be_constant = true});
  if (!(deviation > 0)) throw InputError("kolmogorov_smirnov: std: expected > 0");
  const double d = largest_distance(x, [&](double value) { return normal_tail((mean - value) / deviation); });
  return {d, kolmogorov_tail(d, static_cast<double>(x.size()))};
}

TestResult lilliefors(std::span<const double> x, std::uint64_t seed) {
  check_columns("kolmogorov_smirnov", {x}, {.rows = 5});
  const double d = own_normal_distance(x), found = stephens(d, static_cast<double>(x.size()));
  std::vector<double> draw(std::min<std::size_t>(x.size(), 500));
  MonteCarlo chance(1999);
  while (chance.more()) {
    Philox random(seed, chance.draws());
    for (double& value : draw) value = random.normal();
    chance.add(stephens(own_normal_distance(draw), static_cast<double>(draw.size())) >= found);
  }
  return {d, chance.p_value()};
}

TestResult kolmogorov_two(std::span<const double> a, std::span<const double> b) {
  check_columns("kolmogorov_smirnov", {a, b}, {.rows = 1, .may_be_constant = true, .may_differ = true});
  std::vector<double> first(a.begin(), a.end()), second(b.begin(), b.end());
  std::sort(first.begin(), first.end());
  std::sort(second.begin(), second.end());
  const double n = static_cast<double>(a.size()), m = static_cast<double>(b.size());
  double d = 0;
  for (std::size_t i = 0, j = 0; i < first.size() && j < second.size();) {
    const double value = std::min(first[i], second[j]);
    while (i < first.size() && first[i] == value) ++i;
    while (j < second.size() && second[j] == value) ++j;
    d = std::max(d, std::abs(static_cast<double>(i) / n - static_cast<double>(j) / m));
  }
  return {d, smirnov_tail(d, n, m)};
}

}  // namespace lunid
