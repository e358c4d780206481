#include "discover/units.hpp"

#include <algorithm>
#include <charconv>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "record/unit_product.hpp"

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

bool is_one_name(const UnitProduct& unit) { return unit.powers.size() == 1 && unit.powers.front().second == 1; }

/// Takes from the front of a text what stands before any of `ends`, brackets whole.
std::string_view take_until(std::string_view& text, std::string_view ends) {
  std::size_t at = 0;
  for (int open = 0; at < text.size() && (open > 0 || ends.find(text[at]) == ends.npos); ++at)
    open += (text[at] == '(') - (text[at] == ')');
  const std::string_view taken = text.substr(0, at);
  text.remove_prefix(at);
  return taken;
}

/// "N s/m", "N/(m s)", "N (s/m)^p": a stroke divides the next factor. A power that is no number is part of the name.
/// What each name is, `meaning` says.
UnitProduct product_of(std::string_view text, const std::function<UnitProduct(const std::string&)>& meaning) {
  UnitProduct out;
  int side = 1;
  while (!text.empty()) {
    if (std::string_view(" */").find(text.front()) != std::string_view::npos) {
      if (text.front() == '/') side = -1;
      text.remove_prefix(1);
      continue;
    }
    const std::string_view base = take_until(text, " */^");
    const bool bracketed = base.starts_with('(') && base.ends_with(')');
    const UnitProduct factor =
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
      out.multiply((is_one_name(factor) ? factor.text() : "(" + factor.text() + ")") + "^" + std::string(exponent),
                   side);
    side = 1;
  }
  return out;
}

UnitProduct as_written(const std::string& name) {
  UnitProduct out;
  if (name != "1") out.multiply(name, 1);
  return out;
}

UnitProduct mass_of(const Units& units) {
  if (units.y == "m" && units.force == "N") return as_written("kg");
  if (units.y == "rad" && units.force == "N m") return product_of("kg m^2", as_written);
  UnitProduct out = product_of(units.force, as_written);
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
