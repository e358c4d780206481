#include "figure/module/font.hpp"

#include <unistd.h>
#include <vtkStdString.h>
#include <vtkTextRenderer.h>

#include "figure/look.hpp"

namespace lunid::figure {
namespace {

struct Face {
  const char* plain;
  const char* bold;
};

/// Where Debian's fonts-dejavu-core (which fontconfig requires) and fonts-liberation put their files, and
/// Fedora its own.
constexpr Face faces[] = {
    {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"},
    {"/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans-Bold.ttf"},
    {"/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
     "/usr/share/fonts/truetype/liberation/LiberationSans-Bold.ttf"}};

}  // namespace

void set_font(vtkTextProperty& text, bool bold) {
  for (const Face& face : faces) {
    const char* file = bold ? face.bold : face.plain;
    if (::access(file, R_OK) != 0) continue;
    text.SetFontFamily(VTK_FONT_FILE);
    text.SetFontFile(file);
    return;
  }
  text.SetFontFamilyToArial();
  text.SetBold(bold);
}

double FontMeter::width(const std::string& text, double size, bool bold) {
  if (text.empty()) return 0.0;
  // Measured at a size of its own, so that every device and scale plans the same figure.
  constexpr int measured_size = 64;
  set_font(*property_, bold);
  property_->SetFontSize(measured_size);
  int box[4];
  if (!vtkTextRenderer::GetInstance()->GetBoundingBox(property_, vtkStdString(typeset(text)), box, 72)) return 0.0;
  return static_cast<double>(box[1] - box[0]) * size / measured_size;
}

}  // namespace lunid::figure
