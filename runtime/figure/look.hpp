#pragma once
// Sizes of everything that is not data, in points, and text that fits its place.
#include <string>
#include <vector>

#include "figure/canvas.hpp"
#include "figure/colours.hpp"

namespace lunid::figure {

/// Text of 11 points on a figure 16 cm wide is 5.5 points when it is printed 8 cm wide: the least that reads
/// well.
struct Look {
  Theme theme = Theme::light;
  Palette palette;
  double tick_text = 11.0;
  double axis_text = 12.0;
  double legend_text = 11.0;
  double title_text = 12.0;
  double heading_text = 14.0;
  double line = 1.25;
  double point_radius = 1.5;
  double frame = 0.8;
  double tick_length = 3.5;
  double gap = 4.0;     ///< between a tick and its label, a swatch and its name
  double margin = 7.0;  ///< round the figure and between panels

  /// `text_scale`: for many columns, smaller text.
  explicit Look(Theme chosen, double text_scale = 1.0) : theme(chosen), palette(figure::palette(chosen)) {
    for (double* size : {&tick_text, &axis_text, &legend_text, &title_text}) *size *= text_scale;
  }
};

/// The height of a line of text of this size.
inline double line_height(double size) { return 1.28 * size; }

/// `text` broken at spaces into lines not wider than `width` (a longer word stays whole).
std::vector<std::string> wrapped(TextMeter& meter, const std::string& text, double size, bool bold, double width);

/// `text`, cut with an ellipsis where it is wider than `width`.
std::string shortened(TextMeter& meter, const std::string& text, double size, bool bold, double width);

/// `text` as one line of valid UTF-8: other bytes become "?", control characters spaces. Column names of a
/// measured record come in any encoding, and text libraries crash on bad bytes.
std::string printable(const std::string& text);

/// The same with what single characters can show of LaTeX: Greek letters "\omega", "\dot y", powers "y^3" and "s^{-2}",
/// indices "k_3" after a lone letter. What they cannot show stays as it is written.
std::string typeset(const std::string& text);

/// The size, not under 0.75 of `size`, at which `text` fits `width`.
double fitting_size(TextMeter& meter, const std::string& text, double size, double width);

}  // namespace lunid::figure
