#include "figure/look.hpp"

#include <algorithm>
#include <sstream>

namespace lunid::figure {

std::vector<std::string> wrapped(TextMeter& meter, const std::string& text, double size, bool bold, double width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    if (!lines.empty() && meter.width(longer, size, bold) <= width) lines.back() = longer;
    else lines.push_back(word);
  }
  return lines;
}

std::string shortened(TextMeter& meter, const std::string& text, double size, bool bold, double width) {
  if (meter.width(text, size, bold) <= width) return text;
  std::string cut = text;
  while (!cut.empty()) {
    // Take off one character, with all bytes of its UTF-8 form.
    do cut.pop_back();
    while (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xC0) == 0x80);
    if (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xC0) == 0xC0) cut.pop_back();
    if (meter.width(cut + "…", size, bold) <= width) break;
  }
  return cut + "…";
}

double fitting_size(TextMeter& meter, const std::string& text, double size, double width) {
  const double natural = meter.width(text, size, false);
  return natural <= width ? size : std::max(0.75 * size, size * width / natural);
}

}  // namespace lunid::figure
