#pragma once
// Numbers in messages and reports.
#include <string>

namespace lunid {

/// Rounded to so many significant digits, whatever the scale: 1.2e-07.
std::string number(double value, int digits = 6);
/// The shortest text that reads back to the same double.
std::string exact_number(double value);

}  // namespace lunid
