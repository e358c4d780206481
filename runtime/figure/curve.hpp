#pragma once
// From a series of any length to strokes that fit a panel: cut at NaN, thin, clip, dash.
#include <vector>

#include "figure/canvas.hpp"
#include "figure/figure.hpp"

namespace lunid::figure {

using Stroke = std::vector<Point>;

/// Thins a stroke: of each run of consecutive points within one column of `column` points' width, the first,
/// the lowest, the highest and the last stay, in their order. Extremes are thus kept exactly.
Stroke thin(const Stroke& stroke, double column);

/// The indices of what thin() keeps.
std::vector<std::size_t> thin_places(const Stroke& stroke, double column);

/// What of a long curve that runs over itself is new to the eye, to within `cell` points, which is less than half the
/// width of a line: a segment stays where it goes through a cell that none before has inked, or run beside. Strokes of
/// fewer points pass through, such as any that runs from left to right, which thin() has thinned.
class SeenSegments {
 public:
  SeenSegments(const Box& box, double cell);
  std::vector<Stroke> fresh(const Stroke& stroke);

 private:
  struct Walk;
  Walk walk(Point a, Point b) const;
  bool is_clear(const Walk& w, int k) const;
  int first_clear(const Walk& w) const;
  bool draw_part(Point a, Point b, const Walk& w, int first, std::vector<Stroke>& parts);
  void ink(Point a, Point b);
  void ink(std::size_t column, std::size_t row);

  Box box_;
  double cell_;
  std::size_t columns_, rows_, block_columns_;
  std::vector<char> inked_;  ///< cells, row by row; empty while no long stroke came
  std::vector<int> clear_;   ///< cells without ink in each block: a walk leaps over the full ones
};

/// The parts of a stroke that lie within a box (Liang and Barsky 1984, for each segment).
std::vector<Stroke> clip(const Stroke& stroke, const Box& box);

/// The lines on which a map's values, linear between the centres of its cells, are `level`: in the map's own
/// coordinates, broken where there is no data (marching squares; an ambiguous cell is cut by the mean of its corners).
std::vector<Stroke> contour(const HeatMap& map, double level);

/// Cuts strokes into the dashes of a style; `width` is the line's width, dashes scale with it. Solid styles
/// pass through.
std::vector<Stroke> dash(const std::vector<Stroke>& strokes, Style style, double width);

/// One point for each cell of `cell` points' width that holds any: what the eye cannot tell apart. Drops what
/// is outside the box.
std::vector<Point> thin_cloud(const std::vector<Point>& points, const Box& box, double cell);

}  // namespace lunid::figure
