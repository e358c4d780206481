#pragma once
// The legend: what it says and where it fits.
#include <string>
#include <vector>

#include "figure/canvas.hpp"
#include "figure/figure.hpp"
#include "figure/look.hpp"

namespace lunid::figure {

struct PanelPlan;

enum class Swatch { curve, area, bar };

struct LegendEntry {
  std::string label;
  Swatch swatch = Swatch::curve;
  Style style = Style::line;
  Role role = Role::first;
  double width = 1.0;
  bool operator==(const LegendEntry&) const = default;
};

/// Entries in rows; a corner's legend has one entry in each row.
struct LegendPlan {
  std::vector<LegendEntry> entries;
  std::vector<std::vector<LegendEntry>> rows;
  Legend place = Legend::none;  ///< a corner, above or none
  Box box;                      ///< of a corner's legend
};

/// What a panel's legend would say, in drawing order.
std::vector<LegendEntry> legend_entries(const Panel& panel);

/// Breaks entries into rows not wider than `width`.
std::vector<std::vector<LegendEntry>> legend_rows(TextMeter& meter, const Look& look,
                                                  const std::vector<LegendEntry>& entries, double width);

/// The height of a strip with these rows.
double strip_height(const Look& look, std::size_t rows);

/// Decides where a planned panel's legend goes: the wanted place, or for `automatic` the first corner that no
/// curve enters, or else above.
void place_legend(TextMeter& meter, const Look& look, PanelPlan& plan, Legend wanted);

/// Puts a corner's legend into its corner of the plot as it is now.
void settle_legend(TextMeter& meter, const Look& look, PanelPlan& plan);

/// Draws rows from the top left corner of a strip, or a corner's box with its background.
void draw_strip(Canvas& canvas, TextMeter& meter, const Look& look, const std::vector<std::vector<LegendEntry>>& rows,
                double left, double top);
void draw_corner(Canvas& canvas, const Look& look, const LegendPlan& legend);

}  // namespace lunid::figure
