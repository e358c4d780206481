// The part of LaTeX's notation that single characters can show.
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include "figure/look.hpp"

namespace lunid::figure {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 32> commands{{
    {"alpha", "α"}, {"beta", "β"},  {"gamma", "γ"},  {"delta", "δ"},  {"epsilon", "ε"}, {"zeta", "ζ"}, {"eta", "η"},
    {"theta", "θ"}, {"kappa", "κ"}, {"lambda", "λ"}, {"mu", "μ"},     {"nu", "ν"},      {"xi", "ξ"},   {"pi", "π"},
    {"rho", "ρ"},   {"sigma", "σ"}, {"tau", "τ"},    {"phi", "φ"},    {"chi", "χ"},     {"psi", "ψ"},  {"omega", "ω"},
    {"Gamma", "Γ"}, {"Delta", "Δ"}, {"Theta", "Θ"},  {"Lambda", "Λ"}, {"Sigma", "Σ"},   {"Phi", "Φ"},  {"Psi", "Ψ"},
    {"Omega", "Ω"}, {"times", "×"}, {"cdot", "·"},   {"pm", "±"},
}};

constexpr std::string_view raised = "0123456789+-=()n", lowered = "0123456789+-=()aeoxijkmnt";
constexpr std::array<const char*, 16> above{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷",
                                            "⁸", "⁹", "⁺", "⁻", "⁼", "⁽", "⁾", "ⁿ"};
constexpr std::array<const char*, 25> below{"₀", "₁", "₂", "₃", "₄", "₅", "₆", "₇", "₈", "₉", "₊", "₋", "₌",
                                            "₍", "₎", "ₐ", "ₑ", "ₒ", "ₓ", "ᵢ", "ⱼ", "ₖ", "ₘ", "ₙ", "ₜ"};

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

class Typesetter {
 public:
  explicit Typesetter(std::string_view text) : text_(text) {}

  std::string run() {
    while (at_ < text_.size())
      if (!command() && !script()) out_ += text_[at_++];
    return out_;
  }

 private:
  /// "\omega", "\dot y", "\ddot{y}".
  bool command() {
    if (text_[at_] != '\\') return false;
    std::size_t end = at_ + 1;
    while (end < text_.size() && is_letter(text_[end])) ++end;
    const std::string_view name = text_.substr(at_ + 1, end - at_ - 1);
    if (name == "dot" || name == "ddot") return dotted(end, name == "dot" ? "\u0307" : "\u0308");
    for (const auto& [word, symbol] : commands)
      if (word == name) {
        out_ += symbol;
        at_ = end;
        return true;
      }
    return false;
  }

  bool dotted(std::size_t from, const char* mark) {
    while (from < text_.size() && (text_[from] == ' ' || text_[from] == '{')) ++from;
    if (from >= text_.size() || !is_letter(text_[from])) return false;
    const char letter = text_[from];
    const bool one = std::string_view(mark) == "\u0307";
    // Letters that have a character of their own look better than a mark that is laid over them.
    if (letter == 'y')
      out_ += one ? "ẏ" : "ÿ";
    else if (letter == 'x')
      out_ += one ? "ẋ" : "ẍ";
    else
      (out_ += letter) += mark;
    at_ = from + 1;
    if (at_ < text_.size() && text_[at_] == '}') ++at_;
    return true;
  }

  /// "^3", "^{-2}" after anything; "_1", "_{max}" after a single letter, so that file names stay what they are.
  bool script() {
    const char sign = text_[at_];
    if (sign != '^' && sign != '_') return false;
    if (sign == '_' && !after_symbol()) return false;
    std::size_t from = at_ + 1, end = from;
    const bool braced = from < text_.size() && text_[from] == '{';
    if (braced) {
      end = text_.find('}', ++from);
      if (end == std::string_view::npos) return false;
    } else {
      if (end < text_.size() && text_[end] == '-' && sign == '^') ++end;
      while (end < text_.size() && is_digit(text_[end])) ++end;
      if (end < text_.size() && (is_letter(text_[end]) || text_[end] == '_' || text_[end] == '.')) return false;
    }
    return write(sign, text_.substr(from, end - from), end + (braced ? 1 : 0));
  }

  bool write(char sign, std::string_view body, std::size_t next) {
    if (body.empty() || body == "-") return false;
    std::string written;
    for (const char c : body) {
      const std::size_t place = (sign == '^' ? raised : lowered).find(c);
      if (place == std::string_view::npos) return false;
      written += sign == '^' ? above[place] : below[place];
    }
    out_ += written;
    at_ = next;
    return true;
  }

  /// Whether a lone letter, or a symbol that was a command, stands before.
  bool after_symbol() const {
    if (out_.empty()) return false;
    if (static_cast<unsigned char>(out_.back()) >= 0x80) return true;
    return is_letter(out_.back()) &&
           (out_.size() == 1 ||
            (!is_letter(out_[out_.size() - 2]) && !is_digit(out_[out_.size() - 2]) && out_[out_.size() - 2] != '_'));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string out_;
};

}  // namespace

std::string typeset(const std::string& text) {
  const std::string clean = printable(text);
  return Typesetter(clean).run();
}

}  // namespace lunid::figure
