// Two layers: paper below, the scene above.
#include <vtkContextActor.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <stdexcept>

#include "figure/module/chart.hpp"
#include "figure/module/font.hpp"
#include "figure/module/surface_scene.hpp"

namespace lunid::figure {

std::string draw_surface(Display& display, const SurfaceFigure& figure) {
  const Look look(figure.theme);
  FontMeter meter;
  const SurfaceView view = plan_surface(meter, look, figure);
  const auto window = display.window(pixels(view.extent.x, figure.size.dpi), pixels(view.extent.y, figure.size.dpi));
  window->SetNumberOfLayers(2);
  vtkNew<vtkRenderer> paper, scene;
  paper->SetLayer(0);
  scene->SetLayer(1);
  set_background(*paper, look);
  window->AddRenderer(paper);
  window->AddRenderer(scene);
  const Drawn drawn =
      drawn_by([&](Canvas& canvas) { draw_surface_axes(canvas, meter, look, figure, view); }, figure.size.dpi / 72.0);
  paper->AddActor(drawn.actor);
  add_surface(*scene, figure, view);
  window->Render();
  if (const std::string error = drawn.error(); !error.empty()) throw std::runtime_error(error);
  return window_as_png(*window);
}

}  // namespace lunid::figure
