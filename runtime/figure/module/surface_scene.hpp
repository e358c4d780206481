#pragma once
// A surface and its points as a picture.
#include <string>

#include "figure/module/display.hpp"
#include "figure/surface_view.hpp"

class vtkRenderer;

namespace lunid::figure {

/// Adds the surface, its mesh lines and the points to a renderer and sets its camera, all in the box of the
/// view.
void add_surface(vtkRenderer& renderer, const SurfaceFigure& figure, const SurfaceView& view);

/// PNG bytes. Throws std::runtime_error with the cause.
std::string draw_surface(Display& display, const SurfaceFigure& figure);

}  // namespace lunid::figure
