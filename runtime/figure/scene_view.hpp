#pragma once
// How a surface in its box is seen: a parallel projection, drawn from the back to the front on any canvas.
#include <array>
#include <vector>

#include "figure/canvas.hpp"
#include "figure/figure.hpp"
#include "figure/look.hpp"
#include "figure/ticks.hpp"

namespace lunid::figure {

using Vector = std::array<double, 3>;

struct SceneView {
  AxisPlan x, y, z;
  Range colour;                 ///< values at the ends of the colour map
  Vector size{1.0, 1.0, 0.72};  ///< edges of the box, centred on the origin
  Vector right, up, toward;     ///< of the viewer; `toward` points from the box to the eye
  double scale = 1.0;           ///< points on paper for a unit of the box
  Point centre;                 ///< of the box, on paper
  Box room;                     ///< of the scene with its labels

  /// From values in units to the box.
  Vector in_box(double x_value, double y_value, double z_value) const;
  bool holds(double x_value, double y_value, double z_value) const;
  /// From the box to paper.
  Point on_paper(const Vector& p) const;
};

/// The look of a scene in this room: three axes crowd a narrow one, so that its text is smaller there.
Look scene_look(const Look& look, const Box& room);

/// The axes and colours alone, before there is any room.
SceneView scene_axes(const Scene& scene);

/// Plans axes and projection within `room`. Throws std::invalid_argument when there is too little.
SceneView plan_scene(TextMeter& meter, const Look& look, const Scene& scene, const Box& room);

/// Walls, grid, ticks and labels: all but the surface and the points.
void draw_scene_axes(Canvas& canvas, TextMeter& meter, const Look& look, const SceneView& view);

/// The facets of the surface, its mesh lines and the points, those behind first: what is nearer covers them. Exact,
/// since a surface over a grid, seen from above, hides only what lies behind it along the grid's rows and columns.
/// Grids of more than 140 lines are thinned, the extremes kept.
std::vector<Facet> scene_facets(const Look& look, const Scene& scene, const SceneView& view);

}  // namespace lunid::figure
