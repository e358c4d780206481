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

/// The parts of a stroke that lie within a box (Liang and Barsky 1984, for each segment).
std::vector<Stroke> clip(const Stroke& stroke, const Box& box);

/// Cuts strokes into the dashes of a style; `width` is the line's width, dashes scale with it. Solid styles
/// pass through.
std::vector<Stroke> dash(const std::vector<Stroke>& strokes, Style style, double width);

/// One point for each cell of `cell` points' width that holds any: what the eye cannot tell apart. Drops what
/// is outside the box.
std::vector<Point> thin_cloud(const std::vector<Point>& points, const Box& box, double cell);

}  // namespace lunid::figure
