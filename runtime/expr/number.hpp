#pragma once
// Text of numbers and names in each format.
#include <string>

#include "expr/expr.hpp"

namespace lunid {

/// A text and how strongly it binds (bind::Level).
struct Written {
  std::string text;
  int level;
};

/// The fewest digits that read back to the same double; non-finite values as what gives them (1/0, 0/0).
Written write_number(double value, Format format);
/// A symbol's name; LaTeX gets subscripts and Greek letters (k3 -> k_{3}, alpha_s -> \alpha_{s}).
Written write_name(const std::string& name, Format format);

}  // namespace lunid
