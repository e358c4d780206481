#include "expr/digits.hpp"

#include <charconv>

namespace lunid {

std::string number(double value, int digits) {
  char text[48];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits).ptr};
}

std::string exact_number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace lunid
