#include "expr/number.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "expr/op.hpp"

namespace lunid {
namespace {

/// Shortest digits, with the exponent as people write it: 1e-5, not 1e-05.
std::string digits(double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  std::string text(buffer.data(), end);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  std::size_t first = e + 1;
  const bool negative = text[first] == '-';
  while (first + 1 < text.size() && (text[first] == '+' || text[first] == '-' || text[first] == '0')) ++first;
  return text.substr(0, e + 1) + (negative ? "-" : "") + text.substr(first);
}

Written write_non_finite(double value, Format format) {
  const bool nan = std::isnan(value);
  const std::string sign = value < 0 ? "-" : "";
  switch (format) {
    case Format::latex: return {nan ? "\\mathrm{NaN}" : sign + "\\infty", nan || value > 0 ? bind::atom : bind::unary};
    case Format::c: return {nan ? "NAN" : sign + "INFINITY", nan || value > 0 ? bind::atom : bind::unary};
    default: return {nan ? "0/0" : sign + "1/0", bind::product};
  }
}

Written write_latex_number(const std::string& text, int level) {
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return {text, level};
  const std::string mantissa = text.substr(0, e), power = "10^{" + text.substr(e + 1) + "}";
  if (mantissa == "1") return {power, bind::power};
  return {mantissa + " \\times " + power, bind::product};
}

constexpr std::array greek = {"alpha", "beta",  "gamma",  "delta", "epsilon", "zeta",  "eta",
                              "theta", "kappa", "lambda", "mu",    "nu",      "xi",    "rho",
                              "sigma", "tau",   "phi",    "chi",   "psi",     "omega", "pi"};

std::string latex_word(const std::string& word) {
  if (std::find(greek.begin(), greek.end(), word) != greek.end()) return "\\" + word;
  return word.size() == 1 ? word : "\\mathrm{" + word + "}";
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '_' ? std::string("\\_") : std::string(1, c);
  return result;
}

}  // namespace

Written write_number(double value, Format format) {
  if (!std::isfinite(value)) return write_non_finite(value, format);
  const int level = std::signbit(value) ? bind::unary : bind::atom;
  std::string text = digits(value);
  if (format == Format::latex) return write_latex_number(text, level);
  if (format == Format::c && text.find_first_of(".e") == std::string::npos) text += ".0";  // no integer division
  return {text, level};
}

Written write_name(const std::string& name, Format format) {
  if (format != Format::latex) return {name, bind::atom};
  std::size_t split = name.find('_');
  if (split == 0) return {"\\mathrm{" + escaped(name) + "}", bind::atom};
  std::string subscript;
  if (split != std::string::npos) {
    subscript = name.substr(split + 1);
  } else {
    split = name.find_last_not_of("0123456789") + 1;
    subscript = name.substr(split);
  }
  const std::string word = latex_word(name.substr(0, split));
  if (subscript.empty()) return {word, bind::atom};
  const bool plain_subscript = subscript.size() == 1 || std::isdigit(static_cast<unsigned char>(subscript[0]));
  return {word + "_{" + (plain_subscript ? escaped(subscript) : "\\mathrm{" + escaped(subscript) + "}") + "}",
          bind::atom};
}

}  // namespace lunid
