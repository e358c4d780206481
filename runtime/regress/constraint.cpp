#include "regress/constraint.hpp"

#include <cmath>

#include "expr/digits.hpp"

namespace lunid {

namespace {

std::string left_side(const Constraint& constraint, std::span<const std::string> features) {
  std::string text;
  for (const auto& [feature, weight] : constraint.terms) {
    if (!text.empty())
      text += weight < 0 ? " - " : " + ";
    else if (weight < 0)
      text += "-";
    if (std::abs(weight) != 1) text += exact_number(std::abs(weight)) + "*";
    text += features[static_cast<std::size_t>(feature)];
  }
  return text;
}

}  // namespace

Constraint at_least(int feature, double bound) {
  Constraint c;
  c.terms = {{feature, 1.0}};
  c.lower = bound;
  return c;
}

Constraint at_most(int feature, double bound) {
  Constraint c;
  c.terms = {{feature, 1.0}};
  c.upper = bound;
  return c;
}

Constraint between(int feature, double lower, double upper) { return {{{feature, 1.0}}, lower, upper, {}, {}}; }

Constraint fixed(int feature, double value) { return {{{feature, 1.0}}, value, value, {}, {}}; }

Constraint ordered(int smaller, int larger) {
  Constraint c;
  c.terms = {{larger, 1.0}, {smaller, -1.0}};
  c.lower = 0;
  return c;
}

std::string to_text(const Constraint& c, std::span<const std::string> features) {
  if (!c.label.empty()) return c.label;
  const auto& t = c.terms;
  if (t.size() == 2 && t[0].second == 1 && t[1].second == -1 && c.lower == 0 && std::isinf(c.upper))
    return features[static_cast<std::size_t>(t[1].first)] + " <= " + features[static_cast<std::size_t>(t[0].first)];
  const std::string left = left_side(c, features);
  if (c.equality()) return left + " = " + exact_number(c.lower);
  if (std::isinf(c.upper)) return left + " >= " + exact_number(c.lower);
  if (std::isinf(c.lower)) return left + " <= " + exact_number(c.upper);
  return exact_number(c.lower) + " <= " + left + " <= " + exact_number(c.upper);
}

std::string to_text(const SourceSpan& where) {
  if (where.file.empty()) return "";
  return where.line > 0 ? where.file + ":" + std::to_string(where.line) : where.file;
}

void validate(const Constraint& c, std::span<const std::string> features) {
  if (c.terms.empty()) throw InputError("constraint: expected at least one feature", c.where);
  for (const auto& [feature, weight] : c.terms) {
    if (feature < 0 || feature >= static_cast<int>(features.size()))
      throw InputError("constraint: feature " + std::to_string(feature + 1) + " of " + std::to_string(features.size()),
                       c.where);
    if (!std::isfinite(weight) || weight == 0)
      throw InputError("constraint: weight: expected a number other than 0, got " + exact_number(weight), c.where);
  }
  if (std::isnan(c.lower) || std::isnan(c.upper) || c.lower == std::numeric_limits<double>::infinity() ||
      c.upper == -std::numeric_limits<double>::infinity())
    throw InputError("constraint '" + to_text(c, features) + "': expected finite bounds", c.where);
  if (c.lower > c.upper)
    throw InputError("constraint on '" + left_side(c, features) + "': the lower bound " + exact_number(c.lower) +
                         " is above the upper bound " + exact_number(c.upper),
                     c.where);
}

}  // namespace lunid
