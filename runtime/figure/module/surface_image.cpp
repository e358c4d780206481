// Two layers: paper below, the scene above.
#include <optional>
#include <stdexcept>
#include <vtkContextActor.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include "figure/module/chart.hpp"
#include "figure/module/surface_scene.hpp"

namespace lunid::figure {

std::string draw_surface(Display& display, const SurfaceFigure& figure) {
  const Look look(figure.theme);
  const Point extent = surface_extent(figure);
  const auto window = display.window(pixels(extent.x, figure.size.dpi), pixels(extent.y, figure.size.dpi));
  window->SetNumberOfLayers(2);
  vtkNew<vtkRenderer> paper, scene;
  paper->SetLayer(0);
  scene->SetLayer(1);
  window->AddRenderer(paper);
  window->AddRenderer(scene);
  // Text is measured while the paper is drawn; the scene is made to match and drawn after it.
  std::optional<SurfaceView> view;
  const Drawn drawn = drawn_by(
      [&](Canvas& canvas) {
        view = plan_surface(canvas, look, figure);
        draw_surface_axes(canvas, look, figure, *view);
      },
      figure.size.dpi / 72.0);
  paper->AddActor(drawn.actor);
  window->Render();
  if (const std::string error = drawn.error(); !error.empty()) throw std::runtime_error(error);
  if (!view) throw std::runtime_error("the axes were not drawn");
  add_surface(*scene, figure, *view);
  window->Render();
  return window_as_png(*window);
}

}  // namespace lunid::figure
