#include "figure/look.hpp"

#include <algorithm>
#include <sstream>

namespace lunid::figure {

std::vector<std::string> wrapped(Canvas& canvas, const std::string& text, double size, bool bold, double width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    if (!lines.empty() && canvas.text_width(longer, size, bold) <= width) lines.back() = longer;
    else lines.push_back(word);
  }
  return lines;
}

std::string shortened(Canvas& canvas, const std::string& text, double size, bool bold, double width) {
  if (canvas.text_width(text, size, bold) <= width) return text;
  std::string cut = text;
  while (!cut.empty()) {
    // Take off one character, with all bytes of its UTF-8 form.
    do cut.pop_back();
    while (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xC0) == 0x80);
    if (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xC0) == 0xC0) cut.pop_back();
    if (canvas.text_width(cut + "…", size, bold) <= width) break;
  }
  return cut + "…";
}

double fitting_size(Canvas& canvas, const std::string& text, double size, double width) {
  const double natural = canvas.text_width(text, size, false);
  return natural <= width ? size : std::max(0.75 * size, size * width / natural);
}

}  // namespace lunid::figure
