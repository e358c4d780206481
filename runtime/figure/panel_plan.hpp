#pragma once
// Where everything of a panel goes.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "figure/curve.hpp"
#include "figure/legend.hpp"
#include "figure/look.hpp"
#include "figure/scene_view.hpp"
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
  Box cell;       ///< all that the panel may use
  Box plot;       ///< the frame round the data
  Range x_reach;  ///< what the axes cover
  Range y_reach;
  AxisPlan x;
  AxisPlan y;
  std::optional<AxisPlan> colour;
  std::vector<std::string> colour_title;  ///< lines, turned, beside the colour bar
  std::optional<SceneView> view;          ///< of a panel with a scene
  LegendPlan legend;
  std::vector<std::string> title;  ///< lines
  bool note_below = false;         ///< the note has a line of its own, under the title
  double names = 0.0;              ///< width of the names of bars
  bool colour_bar = false;         ///< beside the plot; a neighbour with the same colours may have it instead
  bool bare_x = false;             ///< a panel below has the labels and the title of x
  bool bare_y = false;             ///< a panel on the left has those of y
  bool no_data = false;            ///< the colour bar explains cells without data

  Point at(double x_value, double y_value) const {
    return {plot.left + x.place(x_value) * plot.width(), plot.bottom + y.place(y_value) * plot.height()};
  }
};

/// The largest value on each axis of a name and unit in all of a figure, so that panels share their SI
/// prefix.
using Hints = std::map<std::pair<std::string, std::string>, double>;

/// The ranges of a panel's data within its limits, widened so that no curve lies on the frame.
Range x_range(const Panel& panel);
Range y_range(const Panel& panel, const Range& x);
/// Of the panel's colour axis, which there must be.
Range colour_range(const Panel& panel);

/// What stands in a panel whose curves have no point that its axes can show; "" where there is one.
std::string nothing_to_show(const Panel& panel);

/// What the colours of a panel stand for: its map's values, or those of its curves; null where it has no colours.
const Axis* colour_axis(const Panel& panel);
bool diverging_colours(const Panel& panel);

/// The least distance between neighbours of a series of columns.
double column_width(const Series& series);

/// Edges of cells from their centres: halfway between neighbours; one more than centres.
std::vector<double> cell_edges(const std::vector<double>& centres);

/// The colour bar: beside the plot, above the swatch of cells without data where there is one.
Box colour_bar_box(const PanelPlan& plan);

/// Plans the axes and the title of a panel for the plot that it has now.
void plan_content(TextMeter& meter, const Look& look, PanelPlan& plan, const Hints& hints);

/// The space that the planned content needs round the plot.
Margins needed_margins(TextMeter& meter, const Look& look, const PanelPlan& plan);

/// The strokes of a series in the plot, thinned and clipped, not dashed.
std::vector<Stroke> series_strokes(const PanelPlan& plan, const std::vector<double>& x, const std::vector<double>& y);

/// A stroke, or points, of one colour.
struct ColouredStroke {
  Stroke stroke;
  Colour colour;
};

/// The same of a series with colours of its own, cut where the colour changes by more than the eye sees.
std::vector<ColouredStroke> coloured_strokes(const PanelPlan& plan, const Series& series);

/// The points of a series with colours of its own, by colour.
std::vector<ColouredStroke> coloured_points(const PanelPlan& plan, const Series& series, double radius);

/// The points of a series that can be told apart in the plot.
std::vector<Point> series_points(const PanelPlan& plan, const Series& series, double radius);

bool has_line(Style style);
bool has_points(Style style);
bool stands_on_zero(Style style);

}  // namespace lunid::figure
