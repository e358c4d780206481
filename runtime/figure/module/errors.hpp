#pragma once
// VTK reports by printing; we collect what it would print.
#include <string>

namespace lunid::figure {

/// From construction to destruction, VTK's errors and warnings go here and not to the terminal.
class CapturedErrors {
 public:
  CapturedErrors();
  ~CapturedErrors();
  CapturedErrors(const CapturedErrors&) = delete;
  CapturedErrors& operator=(const CapturedErrors&) = delete;

  /// The first error since construction in one line; "" when there was none. Warnings do not count.
  std::string first() const;
};

}  // namespace lunid::figure
