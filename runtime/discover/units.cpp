#include "discover/units.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

namespace lunid {

namespace {

std::string said(const Record& record, const std::string& channel) {
  return record.has(channel) ? record.channel(channel).unit : "";
}

/// A unit as one of its seconds apart: "rad/s^2" is "rad" and -2.
struct InSeconds {
  std::string rest;
  int power = 0;
};

constexpr std::pair<std::string_view, int> endings[] = {{"/s^2", -2}, {"/s", -1}, {" s", 1}, {" s^2", 2}};

InSeconds apart(const std::string& unit) {
  for (const auto& [ending, power] : endings)
    if (unit.ends_with(ending)) return {unit.substr(0, unit.size() - ending.size()), power};
  return {unit, 0};
}

std::string together(const InSeconds& unit) {
  for (const auto& [ending, power] : endings)
    if (unit.power == power) return unit.rest + std::string(ending);
  return unit.rest;
}

/// Units and their powers, in the order in which they came. A power that is no number is part of the name: "m^n".
class Product {
 public:
  void multiply(const std::string& name, int power) {
    auto at = std::ranges::find(powers_, name, &std::pair<std::string, int>::first);
    if (at == powers_.end()) at = powers_.insert(at, {name, 0});
    at->second += power;
  }
  void multiply(const Product& other, int power) {
    for (const auto& [name, own] : other.powers_) multiply(name, own * power);
  }

  std::string text() const {
    std::string above, below;
    for (const auto& [name, power] : powers_) {
      if (power == 0) continue;
      const int size = std::abs(power);
      const std::string raised = size == 1 ? name : name + "^" + std::to_string(size);
      if (power > 0)
        above += (above.empty() ? "" : " ") + raised;
      else
        below += "/" + raised;
    }
    return (above.empty() && !below.empty() ? "1" : above) + below;
  }
  bool is_one_name() const { return powers_.size() == 1 && powers_.front().second == 1; }

 private:
  std::vector<std::pair<std::string, int>> powers_;
};

/// Takes from the front of a text what stands before any of `ends`, brackets whole.
std::string_view take_until(std::string_view& text, std::string_view ends) {
  std::size_t at = 0;
  for (int open = 0; at < text.size() && (open > 0 || ends.find(text[at]) == ends.npos); ++at)
    open += (text[at] == '(') - (text[at] == ')');
  const std::string_view taken = text.substr(0, at);
  text.remove_prefix(at);
  return taken;
}

/// "N s/m", "N/(m s)", "N (s/m)^p": a stroke divides the next factor. What each name is, `meaning` says.
Product product_of(std::string_view text, const std::function<Product(const std::string&)>& meaning) {
  Product out;
  int side = 1;
  while (!text.empty()) {
    if (std::string_view(" */").find(text.front()) != std::string_view::npos) {
      if (text.front() == '/') side = -1;
      text.remove_prefix(1);
      continue;
    }
    const std::string_view base = take_until(text, " */^");
    const bool bracketed = base.starts_with('(') && base.ends_with(')');
    const Product factor =
        bracketed ? product_of(base.substr(1, base.size() - 2), meaning) : meaning(std::string(base));
    std::string_view exponent = "1";
    if (text.starts_with('^')) {
      text.remove_prefix(1);
      exponent = take_until(text, " */");
    }
    int power = 0;
    const auto [end, error] = std::from_chars(exponent.data(), exponent.data() + exponent.size(), power);
    if (error == std::errc() && end == exponent.data() + exponent.size())
      out.multiply(factor, side * power);
    else
      out.multiply((factor.is_one_name() ? factor.text() : "(" + factor.text() + ")") + "^" + std::string(exponent),
                   side);
    side = 1;
  }
  return out;
}

Product as_written(const std::string& name) {
  Product out;
  if (name != "1") out.multiply(name, 1);
  return out;
}

Product mass_of(const Units& units) {
  if (units.y == "m" && units.force == "N") return as_written("kg");
  if (units.y == "rad" && units.force == "N m") return product_of("kg m^2", as_written);
  Product out = product_of(units.force, as_written);
  out.multiply("s", 2);
  out.multiply(product_of(units.y, as_written), -1);
  return out;
}

}  // namespace

Units units_of(const Record& record, const std::string& displacement, const std::string& force) {
  Units out;
  std::string* const units[] = {&out.y, &out.v, &out.a};
  std::string given[3];
  for (int rank = 0; rank < 3; ++rank) given[rank] = said(record, "yva"[rank] + displacement.substr(1));
  const auto known = std::ranges::find_if_not(given, &std::string::empty) - given;
  if (known < 3) {
    const InSeconds unit = apart(given[known]);
    for (int rank = 0; rank < 3; ++rank)
      *units[rank] =
          given[rank].empty() ? together({unit.rest, unit.power + static_cast<int>(known) - rank}) : given[rank];
  }
  if (const std::string unit = said(record, force); !unit.empty()) out.force = unit;
  return out;
}

std::string in_units(const Units& units, const std::string& unit) {
  if (units.y == "m" && units.force == "N") return unit;
  const auto meaning = [&](const std::string& name) {
    if (name == "N") return product_of(units.force, as_written);
    if (name == "m") return product_of(units.y, as_written);
    return name == "kg" ? mass_of(units) : as_written(name);
  };
  return product_of(unit, meaning).text();
}

}  // namespace lunid
