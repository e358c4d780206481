#pragma once
// What a figure shows, in plain values: no VTK here. All numbers are in SI units or in the unit that the axis
// names; the renderer picks SI prefixes for the ticks (an axis `y`, unit `m`, with values of 1e-3 is drawn as
// `y [mm]`). A NaN breaks a line and is "no data" in a map or a surface; the written data (export_data) are
// never decimated.
#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace lunid::figure {

inline constexpr double no_limit = std::numeric_limits<double>::quiet_NaN();

/// What a curve means; decides its colour (Okabe-Ito palette), the same in every figure. `first` to `sixth`
/// are for curves that have no such meaning.
enum class Role { measured, baseline, final, residual, effect, noise, first, second, third, fourth, fifth, sixth };

/// How a curve is drawn. Curves that share a panel should differ in style as well as in colour. `stems` stand on zero,
/// one for each point; `columns` too, and are as wide as the points are apart: a histogram.
enum class Style { line, dashed, dotted, dash_dot, points, line_points, stems, columns };

enum class Scale { linear, log };

/// Where the legend goes. `automatic`: an empty corner of the panel, else a strip above it; what an earlier
/// panel's legend says is not said again, and where all say the same one legend stands at the top of the
/// figure.
enum class Legend { automatic, top_left, top_right, bottom_left, bottom_right, above, none };

enum class Theme { light, dark };

/// A quantity along an axis: `name` in words or as a symbol, `unit` bare ("m", "N s/m", "" for none). `min`
/// and `max` are in the unit; NaN takes them from the data. A log axis shows only values > 0. `names`: of the places
/// 1, 2, ..., in place of numbers.
struct Axis {
  std::string name;
  std::string unit;
  double min = no_limit;
  double max = no_limit;
  Scale scale = Scale::linear;
  std::vector<std::string> names = {};
};

/// A curve or a cloud of points: `x` and `y` of one length. An empty label stays out of the legend.
struct Series {
  std::string label;
  std::vector<double> x;
  std::vector<double> y;
  Style style = Style::line;
  Role role = Role::first;
  double width = 1.0;               ///< factor on the usual line width or point size
  std::vector<double> colour = {};  ///< empty, or for each point a value on the panel's colour axis
};

/// A filled area between two curves, such as mean +- one standard deviation of the noise.
struct Ribbon {
  std::string label;
  std::vector<double> x;
  std::vector<double> low;
  std::vector<double> high;
  Role role = Role::noise;
};

/// A shaded window of x over the whole height, such as the training window.
struct Band {
  std::string label;
  double from = 0.0;
  double to = 0.0;
  Role role = Role::noise;
};

/// A straight line across the panel: x = value (vertical) or y = value.
struct ReferenceLine {
  std::string label;
  double value = 0.0;
  bool vertical = false;
  Style style = Style::dashed;
  Role role = Role::noise;
};

/// A matrix of cells: `z(row, column)` at (y[row], x[column]); `x` and `y` are cell centres, strictly
/// increasing. NaN cells are drawn hatched and named as `missing` says.
struct HeatMap {
  std::vector<double> x;
  std::vector<double> y;
  Eigen::MatrixXd z;
  Axis colour;                      ///< name and unit of z; min and max fix the colour range (to compare two maps)
  bool diverging = true;            ///< colours symmetric about zero (residuals); false: from low to high (counts)
  bool numbers = false;             ///< written into the cells
  bool contours = false;            ///< lines of equal z, at the ticks of the colour bar
  std::string missing = "no data";  ///< what a cell without a number stands for
};

/// One set of bars: a value for each name of the Bars; `error` is empty or a standard deviation for each.
struct BarSet {
  std::string label;
  std::vector<double> value;
  std::vector<double> error;
  Role role = Role::first;
};

/// Horizontal bars, the first name on top; their values run along the panel's x axis. NaN draws no bar.
struct Bars {
  std::vector<std::string> name;
  std::vector<BarSet> set;
};

/// Measured points near a surface; `x`, `y`, `z` of one length.
struct Cloud {
  std::string label;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> z;
  Role role = Role::measured;
};

/// A surface `z(row, column)` over (grid_y[row], grid_x[column]), both strictly increasing, and points near it. NaN
/// leaves a hole. Drawn in a box of its own proportions; the exported numbers are the ones given.
struct Scene {
  Axis x;
  Axis y;
  Axis z;
  std::vector<double> grid_x;
  std::vector<double> grid_y;
  Eigen::MatrixXd surface;
  std::vector<Cloud> clouds;
  bool diverging = true;    ///< colours symmetric about zero
  double azimuth = -130.0;  ///< degrees about the z axis, from the x axis; here a spring's surface rises to the back
  double elevation = 28.0;  ///< degrees above the xy plane, 5 to 85
};

/// One pair of axes and what stands on it, or a scene with three axes of its own. With `bars`, the y axis holds the
/// names and its limits are not used.
struct Panel {
  std::string title;
  std::string note;  ///< one short line above the panel, on the right: a number to remember, such as "gap 0.05"
  Axis x;
  Axis y;
  Legend legend = Legend::automatic;
  std::vector<Series> series;
  std::vector<Ribbon> ribbons;
  std::vector<Band> bands;
  std::vector<ReferenceLine> lines;
  std::optional<HeatMap> map;
  std::optional<Bars> bars;
  std::optional<Scene> scene;
  Axis colour;          ///< of the curves that have colours
  int column_span = 1;  ///< columns of the figure's grid that the panel takes
};

/// Printed size. Text keeps its size in points: with the default width it is still legible when the figure is
/// printed 8 cm wide. `height_cm` 0 lets the rows decide.
struct Size {
  double width_cm = 16.0;
  double height_cm = 0.0;
  int dpi = 250;  ///< of PNG files
};

/// Panels in a grid of `columns`, filled row by row in order; `rows` 0 means as many as needed.
struct Figure {
  std::string title;
  int columns = 1;
  int rows = 0;
  Size size;
  Theme theme = Theme::light;
  bool share_x =
      false;  ///< panels of one column that show the same quantity have one range; only the lowest has labels
  bool share_y = false;  ///< the same of panels side by side
  std::vector<Panel> panels;
};

/// Throws InputError that names the panel and the curve when lengths differ, centres do not increase, a limit
/// is not finite, nothing is to be drawn.
void validate(const Figure& figure);

/// The first surface of a figure, which export as a grid is about; throws InputError where there is none.
const Scene& scene_of(const Figure& figure);

/// Writes what the figure draws as CSV, without VTK: comment lines (`#`) with the axes and units, then
/// `panel,kind,label,name,x,y,z`, one row per point, whose doubles read back bit for bit. Kinds: curve (x,
/// y, colour), ribbon (x, y low, z high), map (x, y, z), bar (name, x value, y error), band (x from, y to), vertical
/// and horizontal (x or y); surface and cloud (x, y, z). Written whole or not at all; throws InputError with
/// the path.
void export_data(const Figure& figure, const std::string& path);

/// The figure as JSON for stdlib/web/figure.js, which draws it in a browser: no VTK, no display.
std::string page_data(const Figure& figure);

}  // namespace lunid::figure
