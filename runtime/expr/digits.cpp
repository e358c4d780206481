#include "expr/digits.hpp"

#include <charconv>

namespace lunid {

std::string number(double value, int digits) {
  char text[48];
  const double unsigned_zero = value + 0.0;  // no "-0"
  return {text, std::to_chars(text, text + sizeof text, unsigned_zero, std::chars_format::general, digits).ptr};
}

std::string exact_number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace lunid
