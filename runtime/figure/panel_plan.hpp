#pragma once
// Where everything of a panel goes.
#include <optional>
#include <string>
#include <vector>

#include "figure/curve.hpp"
#include "figure/legend.hpp"
#include "figure/look.hpp"
#include "figure/ticks.hpp"

namespace lunid::figure {

/// Space round the plot for titles, ticks and legends.
struct Margins {
  double left = 0.0;
  double right = 0.0;
  double top = 0.0;
  double bottom = 0.0;
};

struct PanelPlan {
  const Panel* panel = nullptr;
  Box cell;  ///< all that the panel may use
  Box plot;  ///< the frame round the data
  AxisPlan x;
  AxisPlan y;
  std::optional<AxisPlan> colour;
  LegendPlan legend;
  std::vector<std::string> title;  ///< lines
  bool note_below = false;         ///< the note has a line of its own, under the title

  Point at(double x_value, double y_value) const {
    return {plot.left + x.place(x_value) * plot.width(), plot.bottom + y.place(y_value) * plot.height()};
  }
};

/// The ranges of a panel's data within its limits, widened so that no curve lies on the frame.
Range x_range(const Panel& panel);
Range y_range(const Panel& panel, const Range& x);
Range colour_range(const HeatMap& map);

/// Edges of cells from their centres: halfway between neighbours; one more than centres.
std::vector<double> cell_edges(const std::vector<double>& centres);

/// Plans axes, title and legend for a panel whose plot is about `width` by `height`.
void plan_content(Canvas& canvas, const Look& look, PanelPlan& plan, double width, double height);

/// The space that the planned content needs round the plot.
Margins needed_margins(Canvas& canvas, const Look& look, const PanelPlan& plan);

/// Width that the names of bars take, left of the plot.
double bar_name_width(Canvas& canvas, const Look& look, const PanelPlan& plan);

/// The strokes of a series in the plot, thinned and clipped, not dashed.
std::vector<Stroke> series_strokes(const PanelPlan& plan, const std::vector<double>& x, const std::vector<double>& y);

/// The points of a series that can be told apart in the plot.
std::vector<Point> series_points(const PanelPlan& plan, const Series& series, double radius);

bool has_line(Style style);
bool has_points(Style style);

}  // namespace lunid::figure
