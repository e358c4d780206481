#pragma once
// The typeface of figures.
#include <vtkNew.h>
#include <vtkTextProperty.h>

#include "figure/canvas.hpp"

namespace lunid::figure {

/// Sets DejaVu Sans or Liberation Sans where the machine has one of them: both have Greek letters,
/// superscripts and a true minus sign, which VTK's built-in face lacks.
void set_font(vtkTextProperty& text, bool bold);

/// Measures text in that typeface; needs no display.
class FontMeter : public TextMeter {
 public:
  double width(const std::string& text, double size, bool bold) override;

 private:
  vtkNew<vtkTextProperty> property_;
};

}  // namespace lunid::figure
