#pragma once
// A Canvas on VTK's 2-D context: the screen's, SVG's or PDF's.
#include <vector>

#include "figure/canvas.hpp"

class vtkContext2D;

namespace lunid::figure {

class ContextCanvas : public Canvas {
 public:
  /// `scale`: device units for each point. `batch`: the device draws many polygons faster as one object.
  ContextCanvas(vtkContext2D& context, double scale, bool batch) : context_(context), scale_(scale), batch_(batch) {}

  void polyline(std::span<const Point> points, Colour colour, double width) override;
  void polygon(std::span<const Point> corners, Colour colour) override;
  void facets(std::span<const Facet> facets) override;
  void discs(std::span<const Point> centres, double radius, Colour colour) override;
  void text(Point anchor, const std::string& text, const TextStyle& style) override;

 private:
  std::vector<float> scaled(std::span<const Point> points) const;
  vtkContext2D& context_;
  double scale_;
  bool batch_;
};

}  // namespace lunid::figure
