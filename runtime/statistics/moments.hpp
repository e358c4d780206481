#pragma once
// Inside statistics: mean and standard deviation of a span.
#include <cmath>
#include <span>

namespace lunid::moments {

inline double mean(std::span<const double> x) {
  double sum = 0;
  for (double value : x) sum += value;
  return x.empty() ? 0 : sum / static_cast<double>(x.size());
}

/// About the mean, divided by the number of rows.
inline double standard_deviation(std::span<const double> x) {
  const double centre = mean(x);
  double sum = 0;
  for (double value : x) sum += (value - centre) * (value - centre);
  return x.empty() ? 0 : std::sqrt(sum / static_cast<double>(x.size()));
}

}  // namespace lunid::moments
