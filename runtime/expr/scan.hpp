#pragma once
// The words of the plain form: numbers, names and signs, each with its place in the text.
#include <string>
#include <string_view>

#include "expr/error.hpp"

namespace lunid {

enum class TokenKind { number, name, sign, end };

struct Token {
  TokenKind kind = TokenKind::end;
  std::string_view text;   ///< as typed; signs are + - * / ^ ( ) , > < >= <=
  double value = 0;        ///< of a number
  std::size_t offset = 0;  ///< of the first byte
};

class Scanner {
 public:
  Scanner(std::string_view text, std::string_view source) : text_(text), source_(source) {}
  /// The next token. Throws InputError for a malformed number or a character that the language does not have.
  Token next();
  /// Throws InputError with line and column of `offset`; columns count characters, not bytes.
  [[noreturn]] void fail(std::size_t offset, const std::string& message) const;
  std::string_view text() const { return text_; }
  /// 1-based column of a byte.
  int column(std::size_t offset) const;

 private:
  Token number();
  Token sign();
  std::string_view text_;
  std::string_view source_;
  std::size_t at_ = 0;
};

}  // namespace lunid
