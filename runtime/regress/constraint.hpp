#pragma once
// What is known about the coefficients of a regression, as linear inequalities.
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "expr/error.hpp"

namespace lunid {

/// lower <= sum of weight * coefficient <= upper; an equality when both are equal.
struct Constraint {
  std::vector<std::pair<int, double>> terms;  ///< feature (0-based), weight
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  SourceSpan where;   ///< of the user's line, for messages
  std::string label;  ///< what it says, where the sum itself would say little ("no energy created at ...")

  bool equality() const { return lower == upper; }
};

Constraint at_least(int feature, double bound);
Constraint at_most(int feature, double bound);
Constraint between(int feature, double lower, double upper);
Constraint fixed(int feature, double value);
/// coefficient of `smaller` <= coefficient of `larger`
Constraint ordered(int smaller, int larger);

/// As an engineer writes it, a feature's name standing for its coefficient: "y >= 0", "0 <= y^3 <= 2e6", "y^5 <= y^3".
std::string to_text(const Constraint& constraint, std::span<const std::string> features);

/// "study.lua:7", or "" when unknown.
std::string to_text(const SourceSpan& where);

/// Throws InputError: a feature that does not exist, no term, a weight or bound that is not a number, lower > upper.
void validate(const Constraint& constraint, std::span<const std::string> features);

}  // namespace lunid
