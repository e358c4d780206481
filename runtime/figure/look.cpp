#include "figure/look.hpp"

#include <algorithm>
#include <sstream>

namespace lunid::figure {

std::vector<std::string> wrapped(TextMeter& meter, const std::string& text, double size, bool bold, double width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    if (!lines.empty() && meter.width(longer, size, bold) <= width)
      lines.back() = longer;
    else
      lines.push_back(word);
  }
  return lines;
}

namespace {

/// The first `length` bytes, less what would be half a character.
std::string beginning(const std::string& text, std::size_t length) {
  while (length > 0 && length < text.size() && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) --length;
  return text.substr(0, length);
}

}  // namespace

std::string shortened(TextMeter& meter, const std::string& text, double size, bool bold, double width) {
  if (meter.width(text, size, bold) <= width) return text;
  std::size_t fits = 0, over = text.size();
  while (over - fits > 1) {  // halves: a formula of thousands of characters is measured a dozen times
    const std::size_t middle = (fits + over) / 2;
    (meter.width(beginning(text, middle) + "…", size, bold) <= width ? fits : over) = middle;
  }
  return beginning(text, fits) + "…";
}

std::string printable(const std::string& text) {
  std::string clean;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
    const unsigned lead = byte(i);
    const std::size_t length = lead < 0x80                   ? 1
                               : lead >= 0xC2 && lead < 0xE0 ? 2
                               : lead >= 0xE0 && lead < 0xF0 ? 3
                               : lead >= 0xF0 && lead < 0xF5 ? 4
                                                             : 0;
    bool valid = length > 0;
    unsigned code = length == 1 ? lead : lead & (0x7Fu >> length);
    for (std::size_t k = 1; k < length; ++k) {
      valid = valid && (byte(i + k) & 0xC0u) == 0x80u;
      code = code << 6 | (byte(i + k) & 0x3Fu);
    }
    constexpr unsigned least[] = {0, 0, 0x80, 0x800, 0x10000};
    valid = valid && code >= least[length] && code <= 0x10FFFF && !(code >= 0xD800 && code <= 0xDFFF);
    if (!valid)
      clean += '?';
    else if (code < 0x20 || code == 0x7F)
      clean += ' ';
    else
      clean.append(text, i, length);
    i += valid ? length : 1;
  }
  return clean;
}

double fitting_size(TextMeter& meter, const std::string& text, double size, double width) {
  const double natural = meter.width(text, size, false);
  return natural <= width ? size : std::max(0.75 * size, size * width / natural);
}

}  // namespace lunid::figure
