#pragma once
#include <charconv>
#include <string>

namespace lunid::detail {

/// The shortest text that reads back to the same double, for messages.
inline std::string number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  return {text, end.ptr};
}

/// A rounded value, for reading.
inline std::string number(double value, int digits) {
  char text[48];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits);
  return {text, end.ptr};
}

}  // namespace lunid::detail
