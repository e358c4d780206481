#pragma once
// The few strokes that every figure is made of. Lengths are points (1/72 inch) with the origin at the bottom
// left; a device scales them.
#include <span>
#include <string>
#include <vector>

namespace lunid::figure {

struct Colour {
  unsigned char red = 0;
  unsigned char green = 0;
  unsigned char blue = 0;
  unsigned char alpha = 255;
};

struct Point {
  double x = 0.0;
  double y = 0.0;
};

struct Box {
  double left = 0.0;
  double bottom = 0.0;
  double right = 0.0;
  double top = 0.0;
  double width() const { return right - left; }
  double height() const { return top - bottom; }
  bool holds(Point p) const { return p.x >= left && p.x <= right && p.y >= bottom && p.y <= top; }
};

/// A filled convex polygon among many.
struct Facet {
  std::vector<Point> corners;
  Colour colour;
};

/// Where a text's anchor lies in it: -1 left or bottom, 0 centre, 1 right or top.
struct TextStyle {
  double size = 11.0;
  bool bold = false;
  Colour colour;
  int across = -1;
  int upward = -1;
  bool vertical = false;  ///< turned by 90 degrees, read from below; the anchor is that of the turned text
};

/// How wide text is, in points; asked before there is anything to draw on.
class TextMeter {
 public:
  virtual ~TextMeter() = default;
  virtual double width(const std::string& text, double size, bool bold) = 0;
};

/// What a device must be able to do.
class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void polyline(std::span<const Point> points, Colour colour, double width) = 0;
  /// A convex polygon.
  virtual void polygon(std::span<const Point> corners, Colour colour) = 0;
  /// Many polygons in their order, later ones over earlier ones.
  virtual void facets(std::span<const Facet> facets) {
    for (const Facet& facet : facets) polygon(facet.corners, facet.colour);
  }
  virtual void discs(std::span<const Point> centres, double radius, Colour colour) = 0;
  virtual void text(Point anchor, const std::string& text, const TextStyle& style) = 0;

  void rectangle(const Box& box, Colour colour) {
    const Point corners[] = {
        {box.left, box.bottom}, {box.right, box.bottom}, {box.right, box.top}, {box.left, box.top}};
    polygon(corners, colour);
  }
  void line(Point from, Point to, Colour colour, double width) {
    const Point ends[] = {from, to};
    polyline(ends, colour, width);
  }
};

}  // namespace lunid::figure
