// Units: names with SI prefixes, and products and quotients of them. A name that is missing here is one row.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "expr/words.hpp"
#include "record/columns.hpp"
#include "record/unit_product.hpp"

namespace lunid {
namespace {

struct Row {
  std::string_view name;
  double factor;
  std::string_view si;
  std::string_view prefixes = "";  ///< those that it takes
};

constexpr double inch = 0.0254, foot = 0.3048, gravity = 9.80665, pound = 0.45359237, ounce = pound / 16,
                 pound_force = 4.4482216152605, turn = 2 * std::numbers::pi;
constexpr double degree = std::numbers::pi / 180;
constexpr std::string_view all = "pnumkMG", of_force = "pnumcdDkMG";

constexpr std::array rows{
    Row{"m", 1, "m", all},
    Row{"cm", 1e-2, "m"},
    Row{"in", inch, "m"},
    Row{"mil", 1e-3 * inch, "m"},
    Row{"ft", foot, "m"},
    Row{"N", 1, "N", of_force},
    Row{"lbf", pound_force, "N"},
    Row{"ozf", pound_force / 16, "N"},
    Row{"kip", 1e3 * pound_force, "N"},
    Row{"kgf", gravity, "N"},
    Row{"tf", 1e3 * gravity, "N"},
    Row{"Nm", 1, "N m", of_force},
    Row{"Ncm", 1e-2, "N m"},
    Row{"Nmm", 1e-3, "N m"},
    Row{"s", 1, "s", all},
    Row{"sec", 1, "s"},
    Row{"min", 60, "s"},
    Row{"h", 3600, "s"},
    Row{"g", gravity, "m/s^2", "num"},
    Row{"Gal", 1e-2, "m/s^2", "um"},
    Row{"ms-1", 1, "m/s"},
    Row{"ms^-1", 1, "m/s"},
    Row{"ms-2", 1, "m/s^2"},
    Row{"ms^-2", 1, "m/s^2"},
    Row{"rad", 1, "rad", "num"},
    Row{"deg", degree, "rad"},
    Row{"\u00b0", degree, "rad"},
    Row{"rev", turn, "rad"},
    Row{"rpm", turn / 60, "rad/s"},
    Row{"V", 1, "V", all},
    Row{"A", 1, "A", all},
    Row{"C", 1, "C", all},
    Row{"Wb", 1, "Wb", all},
    Row{"H", 1, "V s/A", all},
    Row{"Pa", 1, "Pa", all},
    Row{"bar", 1e5, "Pa", "m"},
    Row{"psi", pound_force / (inch * inch), "Pa", "k"},
    Row{"mmHg", 133.322387415, "Pa"},
    Row{"J", 1, "J", all},
    Row{"W", 1, "W", all},
    Row{"K", 1, "K"},
    Row{"kg", 1, "kg"},
    Row{"t", 1e3, "kg"},
    Row{"lb", pound, "kg"},
    Row{"oz", ounce, "kg"},
    Row{"slug", pound_force / foot, "kg"},
    Row{"Hz", 1, "Hz", all},
    Row{"-", 1, ""},
    Row{"1", 1, ""},
    Row{"%", 1e-2, ""},
};

constexpr std::array<std::pair<std::string_view, std::pair<char, double>>, 12> prefixes{{
    {"p", {'p', 1e-12}},
    {"n", {'n', 1e-9}},
    {"u", {'u', 1e-6}},
    {"\u00b5", {'u', 1e-6}},
    {"\u03bc", {'u', 1e-6}},
    {"m", {'m', 1e-3}},
    {"c", {'c', 1e-2}},
    {"d", {'d', 1e-1}},
    {"da", {'D', 10}},
    {"k", {'k', 1e3}},
    {"M", {'M', 1e6}},
    {"G", {'G', 1e9}},
}};

/// Units in full, as they are said.
constexpr std::array<std::pair<std::string_view, std::string_view>, 24> words{{
    {"metre", "m"},  {"meter", "m"},  {"inch", "in"},    {"foot", "ft"}, {"feet", "ft"},      {"micron", "um"},
    {"newton", "N"}, {"second", "s"}, {"minute", "min"}, {"hour", "h"},  {"degree", "deg"},   {"radian", "rad"},
    {"volt", "V"},   {"ampere", "A"}, {"coulomb", "C"},  {"henry", "H"}, {"pascal", "Pa"},    {"hertz", "Hz"},
    {"tonne", "t"},  {"pound", "lb"}, {"ounce", "oz"},   {"kp", "kgf"},  {"kilopond", "kgf"}, {"\"", "in"},
}};

/// A factor and powers of SI units.
struct Product : UnitProduct {
  double factor = 1;

  void multiply(const Product& other, int power) {
    factor *= std::pow(other.factor, power);
    UnitProduct::multiply(other, power);
  }
};

/// Removes `end` from the end of a text; false where it does not end so.
bool take_end(std::string_view& text, std::string_view end) {
  if (!text.ends_with(end) || text.size() == end.size()) return false;
  text.remove_suffix(end.size());
  return true;
}

/// The exponent at the end of a factor ("s^2", "s2", "s\u00b2", "s^-1"), which is removed; 1 where there is none.
int take_exponent(std::string_view& factor) {
  int sign = 1, power = 1;
  if (take_end(factor, "\u00b2")) return 2;
  if (take_end(factor, "\u00b3")) return 3;
  if (factor.size() > 1 && factor.back() >= '1' && factor.back() <= '9') {
    power = factor.back() - '0';
    factor.remove_suffix(1);
    if (take_end(factor, "-")) sign = -1;
    take_end(factor, "^");
  }
  return sign * power;
}

std::optional<Product> product_of(std::string_view unit);

/// The powers of a table's row; its SI unit is written in names of the table whose factor is 1.
Product of_row(const Row& row, double prefix) {
  Product out;
  if (row.si == row.name)
    out.powers.emplace_back(row.name, 1);
  else if (!row.si.empty())
    out = *product_of(row.si);
  out.factor = prefix * row.factor;
  return out;
}

std::optional<Product> named(std::string_view name) {
  for (const Row& row : rows)
    if (row.name == name) return of_row(row, 1);
  for (const auto& [text, prefix] : prefixes) {
    if (!name.starts_with(text)) continue;
    for (const Row& row : rows)
      if (row.name == name.substr(text.size()) && row.prefixes.find(prefix.first) != std::string_view::npos)
        return of_row(row, prefix.second);
  }
  return std::nullopt;
}

/// Where the next factor ends, and how many bytes its separator has; '/' divides what follows.
std::pair<std::size_t, std::size_t> next_separator(std::string_view unit) {
  std::pair<std::size_t, std::size_t> first{unit.size(), 0};
  for (const std::string_view separator : {"/", "*", " ", ".", "\u00b7", "\u22c5"})
    if (const std::size_t at = unit.find(separator); at < first.first) first = {at, separator.size()};
  return first;
}

std::optional<Product> product_of(std::string_view unit) {
  Product out;
  int side = 1;
  while (true) {
    const auto [end, length] = next_separator(unit);
    std::string_view factor = unit.substr(0, end);
    std::optional<Product> one = named(factor);
    int power = 1;
    if (!one) {
      power = take_exponent(factor);
      one = named(factor);
    }
    if (!one) return std::nullopt;
    out.multiply(*one, side * power);
    if (end == unit.size()) return out;
    side = unit[end] == '/' ? -1 : 1;
    unit.remove_prefix(end + length);
  }
}

}  // namespace

std::optional<SiUnit> si_unit(std::string_view unit) {
  std::optional<Product> product = product_of(unit);
  if (!product) return std::nullopt;
  std::ranges::stable_partition(product->powers,
                                [](const auto& power) { return power.first != "m"; });  // "N m" of "ft lbf"
  return SiUnit{product->factor, product->text()};
}

std::string known_units() {
  std::string text;
  for (const Row& row : rows) text += (text.empty() ? "" : " ") + std::string(row.name);
  return text + ", many of them with p n u (or \u00b5) m k M G before, and products such as mm/s^2 or kN*m";
}

std::string unit_alike(std::string_view name) {
  const std::string said = lower_case(name);
  for (const auto& [word, unit] : words)
    for (const char* plural : {"", "s", "es"})
      if (said == std::string(word) + plural) return std::string(unit);
  for (const Row& row : rows)
    if (said == lower_case(row.name)) return std::string(row.name);
  for (const auto& [text, prefix] : prefixes)
    for (const Row& row : rows)
      if (row.prefixes.find(prefix.first) != std::string_view::npos && said == lower_case(text) + lower_case(row.name))
        return std::string(text) + std::string(row.name);
  for (const Row& row : rows)
    if (row.name.size() > 1 && said == lower_case(row.name) + "s") return std::string(row.name);
  return "";
}

std::string unit_meant(std::string_view word) {
  std::string meant;
  while (true) {
    const auto [end, length] = next_separator(word);
    std::string_view name = word.substr(0, end);
    std::string power;
    if (!named(name)) {
      const std::string_view whole = name;
      take_exponent(name);
      power = whole.substr(name.size());
    }
    const std::string one = named(name) ? std::string(name) : unit_alike(name);
    if (one.empty()) return "";
    meant += one + power + std::string(word.substr(end, length));
    if (end == word.size()) return meant;
    word.remove_prefix(end + length);
  }
}

}  // namespace lunid
