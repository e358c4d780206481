#include "statistics/rank_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "statistics/checks.hpp"
#include "statistics/distributions.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

std::vector<std::size_t> order_of(std::span<const double> x) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return x[i] < x[j]; });
  return order;
}

/// Sums over groups of t equal values: of t (t - 1) / 2, and what the variance of tau needs.
struct Ties {
  double pairs = 0, triples = 0, weighted = 0;
  void add(double t) {
    pairs += t * (t - 1) / 2;
    triples += t * (t - 1) * (t - 2);
    weighted += t * (t - 1) * (2 * t + 5);
  }
};

/// Groups of neighbours in a sorted list that `equal(i, j)`.
template <class Equal>
Ties count_ties(std::size_t n, Equal equal) {
  Ties ties;
  for (std::size_t first = 0; first < n;) {
    std::size_t last = first + 1;
    while (last < n && equal(first, last)) ++last;
    ties.add(static_cast<double>(last - first));
    first = last;
  }
  return ties;
}

/// Sorts values[first, last) by merging; the number of exchanges of neighbours that this stands for.
std::int64_t sort_counting(std::vector<double>& values, std::vector<double>& work, std::size_t first,
                           std::size_t last) {
  if (last - first < 2) return 0;
  const std::size_t middle = first + (last - first) / 2;
  std::int64_t swaps = sort_counting(values, work, first, middle) + sort_counting(values, work, middle, last);
  std::size_t left = first, right = middle, to = first;
  while (left < middle && right < last) {
    if (values[right] < values[left]) {
      swaps += static_cast<std::int64_t>(middle - left);
      work[to++] = values[right++];
    } else {
      work[to++] = values[left++];
    }
  }
  while (left < middle) work[to++] = values[left++];
  while (right < last) work[to++] = values[right++];
  std::copy(work.begin() + static_cast<std::ptrdiff_t>(first), work.begin() + static_cast<std::ptrdiff_t>(last),
            values.begin() + static_cast<std::ptrdiff_t>(first));
  return swaps;
}

/// Variance of concordant less discordant pairs where there is no association.
double variance_of_score(double n, const Ties& a, const Ties& b) {
  double variance = (n * (n - 1) * (2 * n + 5) - a.weighted - b.weighted) / 18;
  variance += a.triples * b.triples / (9 * n * (n - 1) * (n - 2));
  return variance + 2 * a.pairs * b.pairs / (n * (n - 1));
}

}  // namespace

Eigen::VectorXd ranks(std::span<const double> x) {
  const std::vector<std::size_t> order = order_of(x);
  Eigen::VectorXd result(static_cast<Eigen::Index>(x.size()));
  for (std::size_t first = 0; first < x.size();) {
    std::size_t last = first + 1;
    while (last < x.size() && x[order[last]] == x[order[first]]) ++last;
    const double mean = 0.5 * static_cast<double>(first + last + 1);
    for (std::size_t i = first; i < last; ++i) result[static_cast<Eigen::Index>(order[i])] = mean;
    first = last;
  }
  return result;
}

Correlation spearman(std::span<const double> a, std::span<const double> b) {
  check_columns("spearman", {a, b}, {.rows = 3});
  const double n = static_cast<double>(a.size());
  const Eigen::VectorXd first = ranks(a).array() - (n + 1) / 2, second = ranks(b).array() - (n + 1) / 2;
  const double rho = std::clamp(first.dot(second) / std::sqrt(first.squaredNorm() * second.squaredNorm()), -1.0, 1.0);
  if (std::abs(rho) == 1) return {rho, 0};
  return {rho, 2 * t_tail(std::abs(rho) * std::sqrt((n - 2) / (1 - rho * rho)), n - 2)};
}

Correlation kendall(std::span<const double> a, std::span<const double> b) {
  check_columns("kendall", {a, b}, {.rows = 3});
  std::vector<std::size_t> order(a.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return a[i] < a[j] || (a[i] == a[j] && (b[i] < b[j] || (b[i] == b[j] && i < j)));
  });
  const auto same_a = [&](std::size_t i, std::size_t j) { return a[order[i]] == a[order[j]]; };
  const auto same_b = [&](std::size_t i, std::size_t j) { return b[order[i]] == b[order[j]]; };
  const Ties in_a = count_ties(a.size(), same_a);
  const Ties in_both = count_ties(a.size(), [&](std::size_t i, std::size_t j) { return same_a(i, j) && same_b(i, j); });
  std::vector<double> sorted(b.size()), work(b.size());
  for (std::size_t i = 0; i < b.size(); ++i) sorted[i] = b[order[i]];
  const auto discordant = static_cast<double>(sort_counting(sorted, work, 0, sorted.size()));
  const Ties in_b = count_ties(b.size(), [&](std::size_t i, std::size_t j) { return sorted[i] == sorted[j]; });

  const double n = static_cast<double>(a.size()), pairs = n * (n - 1) / 2;
  const double score = pairs - in_a.pairs - in_b.pairs + in_both.pairs - 2 * discordant;
  const double tau = score / std::sqrt((pairs - in_a.pairs) * (pairs - in_b.pairs));
  return {tau, 2 * normal_tail(std::abs(score) / std::sqrt(variance_of_score(n, in_a, in_b)))};
}

}  // namespace lunid
