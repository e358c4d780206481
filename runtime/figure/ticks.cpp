#include "figure/ticks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

namespace lunid::figure {
namespace {

constexpr const char* superscripts[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};

std::string superscript(int number) {
  std::string text;
  for (const char c : std::to_string(number)) text += c == '-' ? "⁻" : superscripts[c - '0'];
  return text;
}

/// The first symbol of a unit, when an SI prefix may stand before it: "m" of "m/s", "N" of "N s/m".
std::string_view prefixable(std::string_view unit) {
  static constexpr std::array<std::string_view, 11> bases{"m", "N", "V", "A", "Pa", "J", "W", "g", "Hz", "s", "K"};
  const std::size_t end = unit.find_first_of(" /*^");
  const std::string_view symbol = unit.substr(0, end);
  const bool power = end != std::string_view::npos && unit[end] == '^';
  if (power || std::find(bases.begin(), bases.end(), symbol) == bases.end()) return {};
  return symbol;
}

/// The power of ten, a multiple of three, that brings `largest` to [1, 1000); 0 where it reads well as it is.
int engineering_exponent(double largest) {
  if (!(largest > 0.0) || !std::isfinite(largest)) return 0;
  if (largest >= 0.1 && largest < 1e4) return 0;
  return 3 * static_cast<int>(std::floor(std::log10(largest) / 3.0 + 1e-9));
}

const char* prefix(int exponent) {
  static constexpr std::pair<int, const char*> prefixes[] = {{-12, "p"}, {-9, "n"}, {-6, "µ"}, {-3, "m"},
                                                             {3, "k"},   {6, "M"},  {9, "G"},  {12, "T"}};
  for (const auto& [power, name] : prefixes)
    if (power == exponent) return name;
  return nullptr;
}

double nice_step(double span, int wanted) {
  const double raw = span / std::max(1, wanted);
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * decade >= raw * (1.0 - 1e-9)) return factor * decade;
  return 10.0 * decade;
}

void linear_ticks(AxisPlan& plan, int wanted) {
  plan.ticks.clear();
  const double low = plan.range.low / plan.factor, high = plan.range.high / plan.factor;
  const double step = nice_step(high - low, wanted);
  const int decimals = std::clamp(-static_cast<int>(std::floor(std::log10(step) + 1e-9)), 0, 15);
  const double slack = 1e-9 * (high - low) / step;
  const double first = std::ceil(low / step - slack), last = std::floor(high / step + slack);
  for (double i = first; i <= last; i += 1.0) {
    const double value = i * step;
    plan.ticks.push_back({value * plan.factor, fixed(value, decimals)});
  }
}

void log_ticks(AxisPlan& plan, int wanted) {
  const int first = static_cast<int>(std::floor(std::log10(plan.range.low))),
            last = static_cast<int>(std::ceil(std::log10(plan.range.high)));
  const int stride = std::max(1, (last - first) / std::max(1, wanted));
  // Fewer than two decades have too few powers of ten to read: 2 and 5 get labels as well.
  const bool dense = std::log10(plan.range.high / plan.range.low) < 2.0;
  for (int decade = first; decade <= last; ++decade) {
    for (int digit = 1; digit <= 9; ++digit) {
      const double value = digit * std::pow(10.0, decade);
      if (value < plan.range.low * (1 - 1e-9) || value > plan.range.high * (1 + 1e-9)) continue;
      std::string label;
      if (dense && (digit == 1 || digit == 2 || digit == 5))
        label = fixed(value, std::max(0, -decade));
      else if (digit == 1 && (decade - first) % stride == 0)
        label = "10" + superscript(decade);
      plan.ticks.push_back({value, std::move(label)});
    }
  }
}

}  // namespace

double AxisPlan::place(double value) const {
  if (scale == Scale::linear) return (value - range.low) / (range.high - range.low);
  if (!(value > 0.0)) return std::nan("");
  return std::log(value / range.low) / std::log(range.high / range.low);
}

std::string with_superscripts(const std::string& unit) {
  std::string text;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    if (unit[i] != '^') {
      text += unit[i];
      continue;
    }
    std::size_t end = i + 1;
    if (end < unit.size() && unit[end] == '-') ++end;
    while (end < unit.size() && unit[end] >= '0' && unit[end] <= '9') ++end;
    int power = 0;
    const auto read = std::from_chars(unit.data() + i + 1, unit.data() + end, power);
    const bool whole =
        read.ec == std::errc{} && read.ptr == unit.data() + end && (end == unit.size() || unit[end] != '.');
    text += whole ? superscript(power) : "^";
    if (whole) i = end - 1;
  }
  return text;
}

ScaledUnit scaled_unit(const std::string& unit, double largest) {
  const int exponent = engineering_exponent(largest);
  const std::string shown = with_superscripts(unit);
  if (exponent == 0) return {1.0, shown};
  const std::string_view symbol = prefixable(unit);
  const bool up = exponent > 0;
  // A kilosecond and a megagram are read by nobody.
  const bool usual = !(up && (symbol == "s" || symbol == "K" || symbol == "g"));
  if (!symbol.empty() && usual && prefix(exponent)) return {std::pow(10.0, exponent), prefix(exponent) + shown};
  if (largest >= 1e-3 && largest < 1e5) return {1.0, shown};
  return {std::pow(10.0, exponent), "10" + superscript(exponent) + (shown.empty() ? "" : " " + shown)};
}

std::string fixed(double value, int decimals) {
  char buffer[400];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, decimals).ptr;
  std::string text(buffer, end);
  if (text.starts_with('-')) {
    const bool zero = text.find_first_of("123456789") == std::string::npos;
    text.replace(0, 1, zero ? "" : "−");
  }
  return text;
}

std::string few_digits(double value, int digits) {
  if (value == 0.0) return "0";
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, digits).ptr;
  std::string text(buffer, end);
  if (text.starts_with('-')) text.replace(0, 1, "−");
  return text;
}

AxisPlan plan_axis(const Axis& axis, Range range, int wanted, double largest) {
  AxisPlan plan;
  plan.range = range;
  plan.scale = axis.scale;
  if (!axis.names.empty()) {
    plan.title = axis.name;
    for (std::size_t i = 0; i < axis.names.size(); ++i)
      plan.ticks.push_back({static_cast<double>(i + 1), axis.names[i]});
    return plan;
  }
  ScaledUnit unit{1.0, with_superscripts(axis.unit)};
  const double own = std::max(std::abs(range.low), std::abs(range.high));
  if (axis.scale == Scale::linear) unit = scaled_unit(axis.unit, largest > own && largest < 1e3 * own ? largest : own);
  plan.factor = unit.factor;
  plan.title = axis.name;
  if (!unit.unit.empty()) plan.title += (plan.title.empty() ? "[" : " [") + unit.unit + "]";
  if (axis.scale == Scale::log) log_ticks(plan, wanted);
  // Round steps can jump past both ends of a short axis: then finer ones.
  else
    for (int finer = wanted; plan.ticks.size() < 2; finer *= 2) linear_ticks(plan, finer);
  return plan;
}

}  // namespace lunid::figure
