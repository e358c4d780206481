#pragma once
#include <algorithm>
#include <vector>

namespace lunid {

/// The middle of values in any order, of an even number the upper of the two. At least one value.
inline double middle_value(std::vector<double> x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

}  // namespace lunid
