#include "expr/scan.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace lunid {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)); }
bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

/// The whole UTF-8 character that starts at `offset`.
std::string_view character(std::string_view text, std::size_t offset) {
  std::size_t length = 1;
  while (offset + length < text.size() && is_continuation(text[offset + length])) ++length;
  return text.substr(offset, length);
}

}  // namespace

int Scanner::column(std::size_t offset) const {
  const std::string_view before = text_.substr(0, offset);
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  return 1 + static_cast<int>(std::count_if(before.begin() + static_cast<std::ptrdiff_t>(line_start), before.end(),
                                            [](char c) { return !is_continuation(c); }));
}

void Scanner::fail(std::size_t offset, const std::string& message) const {
  const std::string_view before = text_.substr(0, offset);
  const int line = 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n'));
  throw InputError(message, {std::string(source_), line, column(offset)});
}

Token Scanner::next() {
  while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  if (at_ == text_.size()) return {TokenKind::end, {}, 0, at_};
  const char c = text_[at_];
  if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) return number();
  if (!is_word(c)) return sign();
  const std::size_t first = at_;
  while (at_ < text_.size() && is_word(text_[at_])) ++at_;
  return {TokenKind::name, text_.substr(first, at_ - first), 0, first};
}

Token Scanner::number() {
  const std::size_t first = at_;
  double value = 0;
  const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
  at_ = static_cast<std::size_t>(end - text_.data());
  // 2e5 is one number; 2y, 1e, 1.2.3 and 0x10 are none.
  std::size_t last = at_;
  while (last < text_.size() && (is_word(text_[last]) || text_[last] == '.')) ++last;
  const std::string typed(text_.substr(first, last - first));
  const std::string rest(text_.substr(at_, last - at_));
  if (!rest.empty()) {
    const bool product = (std::isalpha(static_cast<unsigned char>(rest[0])) || rest[0] == '_') && rest != "e" &&
                         rest != "E" && typed[0] + std::string(1, rest[0]) != "0x" &&
                         rest.find('.') == std::string::npos;
    fail(first,
         "malformed number '" + typed + "'" +
             (product ? ", write '" + typed.substr(0, typed.size() - rest.size()) + "*" + rest + "' for a product"
                      : ""));
  }
  if (error == std::errc::result_out_of_range) fail(first, "number '" + typed + "' is beyond the range of a double");
  return {TokenKind::number, text_.substr(first, at_ - first), value, first};
}

Token Scanner::sign() {
  const std::size_t first = at_;
  const std::string_view two = text_.substr(at_, 2);
  if (two == "**") fail(first, "unexpected '**', write '^' for a power");
  if (two == "==" || two == "~=" || two == "!=")
    fail(first, "unexpected '" + std::string(two) + "', comparisons are > < >= <=");
  if (two[0] == '=') fail(first, "unexpected '=': give one side of an equation alone; comparisons are > < >= <=");
  if (two[0] == '|') fail(first, "unexpected '|', write abs(v) for the size of v");
  if (two[0] == '\'') fail(first, "unexpected \"'\": the derivative of y is v, that of v is a");
  if (two == ">=" || two == "<=") return at_ += 2, Token{TokenKind::sign, two, 0, first};
  if (std::string_view("+-*/^(),><").find(text_[at_]) != std::string_view::npos)
    return ++at_, Token{TokenKind::sign, text_.substr(first, 1), 0, first};
  fail(first, "unexpected character '" + std::string(character(text_, first)) + "'");
}

}  // namespace lunid
