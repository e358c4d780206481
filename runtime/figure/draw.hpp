#pragma once
// Draws figures on any canvas.
#include "figure/panel_plan.hpp"

namespace lunid::figure {

/// Where everything of a figure goes: what draw_figure draws.
struct FigurePlan {
  Point extent;                                  ///< width and height in points
  std::vector<std::string> heading;              ///< lines of the title
  std::vector<std::vector<LegendEntry>> legend;  ///< rows of the shared legend
  std::vector<PanelPlan> panels;
};

/// The look of a figure: its theme, and smaller text where its columns are narrow.
Look look_for(const Figure& figure);

/// Plans a valid figure. Throws std::invalid_argument when its size leaves no room for the data.
FigurePlan plan_figure(TextMeter& meter, const Look& look, const Figure& figure);

/// Draws a planned figure, on paper that has the look's background already.
void draw_figure(Canvas& canvas, TextMeter& meter, const Look& look, const FigurePlan& plan);

/// One planned panel: data, frame, ticks, titles, legend.
void draw_panel(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan);

/// The colour bar beside a panel's plot, with its title.
void draw_panel_colour_bar(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan);

/// The cells of a map within the plot, and the colour bar beside it.
void draw_map(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan);

/// Horizontal bars with their names, whiskers and numbers.
void draw_bars(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan);

/// A colour bar from bottom to top, with the ticks of `axis` on its right.
void draw_colour_bar(Canvas& canvas, const Look& look, const AxisPlan& axis, bool diverging, const Box& bar);

/// The position in the colour map of a value.
double colour_position(const AxisPlan& axis, bool diverging, double value);

/// The width of an axis's widest label.
double widest_label(TextMeter& meter, const Look& look, const AxisPlan& axis);

}  // namespace lunid::figure
