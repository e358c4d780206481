#pragma once
// Figures as PNG, SVG and PDF.
#include <vtkSmartPointer.h>

#include <functional>
#include <string>

#include "figure/look.hpp"
#include "figure/module/display.hpp"
#include "figure/renderer.hpp"

class vtkContextActor;
class vtkRenderer;

namespace lunid::figure {

/// An actor that draws by a function, on a canvas with `scale` device units for each point. What the function
/// throws is kept, since no exception may cross VTK: ask `error` after drawing.
struct Drawn {
  vtkSmartPointer<vtkContextActor> actor;
  std::function<std::string()> error;
};
Drawn drawn_by(std::function<void(Canvas&)> draw, double scale);

/// The bytes of a file. Throws std::runtime_error with the cause when there is nothing to show for it.
std::string draw_chart(Display& display, const Figure& figure, Format format);

/// What a window shows, as PNG. Throws std::runtime_error where all pixels are alike.
std::string window_as_png(vtkRenderWindow& window);

/// Fills what the figure leaves over: the last fraction of a pixel at its edges.
void set_background(vtkRenderer& renderer, const Look& look);

/// Pixels for `points`; throws std::runtime_error when the picture is too large to draw.
int pixels(double points, int dpi);

}  // namespace lunid::figure
