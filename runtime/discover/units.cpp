#include "discover/units.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

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

std::string mass_unit(const Units& units) {
  if (units.y == "m" && units.force == "N") return "kg";
  if (units.y == "rad" && units.force == "N m") return "kg m^2";
  return units.force + " s^2/" + units.y;
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
  std::string out, word;
  for (const char c : unit + " ") {
    if (std::isalpha(static_cast<unsigned char>(c))) {
      word += c;
      continue;
    }
    out += (word == "N" ? units.force : word == "m" ? units.y : word == "kg" ? mass_unit(units) : word) + c;
    word.clear();
  }
  out.pop_back();
  return out;
}

}  // namespace lunid
