#pragma once
// Figures as PNG, SVG and PDF.
#include <string>

#include "figure/module/display.hpp"
#include "figure/renderer.hpp"

namespace lunid::figure {

/// The bytes of a file. Throws std::runtime_error with the cause when there is nothing to show for it.
std::string draw_chart(Display& display, const Figure& figure, Format format);

}  // namespace lunid::figure
