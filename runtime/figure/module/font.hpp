#pragma once
// The typeface of figures.
class vtkTextProperty;

namespace lunid::figure {

/// Sets DejaVu Sans or Liberation Sans where the machine has one of them: both have Greek letters, superscripts and a
/// true minus sign, which VTK's built-in face lacks.
void set_font(vtkTextProperty& text, bool bold);

}  // namespace lunid::figure
