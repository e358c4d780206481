#include "regress/unit.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include "expr/digits.hpp"

namespace lunid::detail {
namespace {

void add_power(Unit& unit, const std::string& word, double power) {
  const double sum = (unit[word] += power);
  if (sum == 0) unit.erase(word);
}

std::optional<Unit> scaled(std::optional<Unit> unit, double factor) {
  if (unit)
    for (auto& [word, power] : *unit) power *= factor;
  return unit;
}

}  // namespace

std::optional<Unit> read_unit(const std::string& text) {
  Unit unit;
  double sign = 1;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '/') sign = -1;
    if (c == '*' || c == ' ' || c == '/') {
      ++i;
      continue;
    }
    std::string word;
    while (i < text.size() && std::isalpha(static_cast<unsigned char>(text[i]))) word += text[i++];
    if (word.empty()) {
      if (c != '1') return std::nullopt;  // "1/s"
      ++i;
      continue;
    }
    double power = 1;
    if (i < text.size() && (text[i] == '^' || std::isdigit(static_cast<unsigned char>(text[i])))) {
      if (text[i] == '^') ++i;
      char* end = nullptr;
      power = std::strtod(text.c_str() + i, &end);
      if (end == text.c_str() + i) return std::nullopt;
      i = static_cast<std::size_t>(end - text.c_str());
    }
    add_power(unit, word, sign * power);
    sign = 1;
  }
  return unit;
}

std::string to_text(const Unit& unit) {
  const auto word = [](const std::string& name, double power) {
    return power == 1 ? name : name + "^" + number(power);
  };
  std::string above, below;
  // A force comes first, as in N s/m.
  for (const bool force : {true, false})
    for (const auto& [name, power] : unit) {
      if ((name == "N") != force) continue;
      if (power > 0) above += (above.empty() ? "" : " ") + word(name, power);
      if (power < 0) below += "/" + word(name, -power);
    }
  return above.empty() && !below.empty() ? "1" + below : above + below;
}

Unit quotient(const Unit& above, const Unit& below) {
  Unit out = above;
  for (const auto& [word, power] : below) add_power(out, word, -power);
  return out;
}

std::optional<Unit> unit_of(Expr e, const std::function<std::optional<Unit>(Expr symbol)>& of_symbol,
                            std::span<const Expr> numbers) {
  if (std::find(numbers.begin(), numbers.end(), e) != numbers.end()) return Unit{};
  const auto arguments = e.arguments();
  const auto of = [&](std::size_t i) { return unit_of(arguments[i], of_symbol, numbers); };
  const auto alike = [&](std::size_t i, std::size_t k) -> std::optional<Unit> {
    if (arguments[i].is_constant()) return of(k);
    if (arguments[k].is_constant()) return of(i);
    const auto a = of(i), b = of(k);
    return a && b && *a == *b ? a : std::nullopt;
  };
  switch (e.op()) {
    case Op::constant: return Unit{};
    case Op::symbol: return of_symbol(e);
    case Op::add:
    case Op::sub:
    case Op::min:
    case Op::max: return alike(0, 1);
    case Op::where: return alike(1, 2);
    case Op::mul:
    case Op::div: {
      const auto a = of(0), b = of(1);
      if (!a || !b) return std::nullopt;
      return quotient(*a, e.op() == Op::div ? *b : quotient({}, *b));
    }
    case Op::pow:
      if (!arguments[1].is_constant()) return std::nullopt;
      return scaled(of(0), arguments[1].value());
    case Op::sqrt: return scaled(of(0), 0.5);
    case Op::neg:
    case Op::abs: return of(0);
    default: return Unit{};  // of a function: a number, as must be what stands in it
  }
}

}  // namespace lunid::detail
