#pragma once
// The middle of some values in any order, at least one; and how far it lies below the mean for powers of noise.
#include <algorithm>
#include <cmath>
#include <vector>

namespace lunid {

/// One of the values: of an even number the upper of the two in the middle.
inline double middle_value(std::vector<double> x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

/// Of an even number the mean of the two in the middle.
inline double median(std::vector<double> x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return x.size() % 2 == 1 ? *middle : 0.5 * (*middle + *std::max_element(x.begin(), middle));
}

/// Median over mean of a chi-square variable of `dof` degrees of freedom (Wilson & Hilferty 1931, PNAS 17, 684).
inline double median_over_mean(double dof) { return std::pow(1 - 2 / (9 * dof), 3); }

}  // namespace lunid
