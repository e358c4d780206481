#pragma once
#include <charconv>
#include <string>

namespace lunid::detail {

/// A rounded value, for messages.
inline std::string number(double value, int digits) {
  char text[48];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits);
  return {text, end.ptr};
}

}  // namespace lunid::detail
