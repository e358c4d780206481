#pragma once
// Inside the runtime: a unit as powers of others.
#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace lunid {

/// Units and their powers, in the order in which they came.
struct UnitProduct {
  std::vector<std::pair<std::string, int>> powers;

  void multiply(const std::string& name, int power) {
    auto at = std::ranges::find(powers, name, &std::pair<std::string, int>::first);
    if (at == powers.end()) at = powers.insert(at, {name, 0});
    at->second += power;
  }
  void multiply(const UnitProduct& other, int power) {
    for (const auto& [name, own] : other.powers) multiply(name, own * power);
  }

  /// "N s/m", "1/m", "V/A/s^2"; empty where nothing is left.
  std::string text() const {
    std::string above, below;
    for (const auto& [name, power] : powers) {
      const int size = std::abs(power);
      const std::string raised = size == 1 ? name : name + "^" + std::to_string(size);
      if (power > 0) above += (above.empty() ? "" : " ") + raised;
      if (power < 0) below += "/" + raised;
    }
    return below.empty() ? above : (above.empty() ? "1" : above) + below;
  }
};

}  // namespace lunid
