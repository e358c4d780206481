#include "figure/module/font.hpp"

#include <unistd.h>

#include <vtkTextProperty.h>

namespace lunid::figure {
namespace {

struct Face {
  const char* plain;
  const char* bold;
};

/// Where Debian's fonts-dejavu-core (which fontconfig requires) and fonts-liberation put their files, and Fedora its own.
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

}  // namespace lunid::figure
