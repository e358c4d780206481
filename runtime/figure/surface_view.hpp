#pragma once
// How a surface in its box is seen: a parallel projection whose every point is known on paper, so that the
// 3-D scene (by VTK) and the axes (on a Canvas) fall on each other.
#include <array>
#include <vector>

#include "figure/draw.hpp"

namespace lunid::figure {

using Vector = std::array<double, 3>;

struct SurfaceView {
  AxisPlan x, y, z;
  AxisPlan colour;
  Vector size{1.0, 1.0, 0.72};  ///< edges of the box, centred on the origin
  Vector right, up, toward;     ///< of the viewer; `toward` points from the box to the eye
  double scale = 1.0;           ///< points on paper for a unit of the box
  Point centre;                 ///< of the box, on paper
  Point extent;                 ///< of the figure
  std::vector<std::string> heading;
  std::vector<std::vector<LegendEntry>> legend;

  /// From values in units to the box.
  Vector in_box(double x_value, double y_value, double z_value) const;
  bool holds(double x_value, double y_value, double z_value) const;
  /// From the box to paper.
  Point on_paper(const Vector& p) const;
};

/// Plans axes and projection. Throws std::invalid_argument when the size leaves no room.
SurfaceView plan_surface(TextMeter& meter, const Look& look, const SurfaceFigure& figure);

/// Walls, grid, ticks, labels, title, legend and colour bar: all but the surface and the points.
void draw_surface_axes(Canvas& canvas, TextMeter& meter, const Look& look, const SurfaceFigure& figure,
                       const SurfaceView& view);

}  // namespace lunid::figure
