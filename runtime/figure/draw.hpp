#pragma once
// Draws figures on any canvas.
#include "figure/panel_plan.hpp"

namespace lunid::figure {

/// Width and height of a figure in points.
Point figure_extent(const Figure& figure);

/// The plan of every panel of a figure: what draw_figure draws.
struct FigurePlan {
  std::vector<std::string> heading;                 ///< lines of the title
  std::vector<std::vector<LegendEntry>> legend;     ///< rows of the shared legend
  std::vector<PanelPlan> panels;
};
FigurePlan plan_figure(Canvas& canvas, const Look& look, const Figure& figure);

/// Draws a valid figure. Throws std::invalid_argument when its size leaves no room for the data.
void draw_figure(Canvas& canvas, const Figure& figure);

/// One planned panel: data, frame, ticks, titles, legend.
void draw_panel(Canvas& canvas, const Look& look, const PanelPlan& plan);

/// The cells of a map within the plot, and the colour bar beside it.
void draw_map(Canvas& canvas, const Look& look, const PanelPlan& plan);

/// Horizontal bars with their names, whiskers and numbers.
void draw_bars(Canvas& canvas, const Look& look, const PanelPlan& plan);

/// A colour bar from bottom to top with ticks on its right; `axis` runs over the colours, `title` is turned and stands
/// `title_offset` right of the bar.
void draw_colour_bar(Canvas& canvas, const Look& look, const AxisPlan& axis, bool diverging, const Box& bar,
                     double title_offset);

/// The position in the colour map of a value.
double colour_position(const AxisPlan& axis, bool diverging, double value);

}  // namespace lunid::figure
