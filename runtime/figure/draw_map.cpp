#include <algorithm>
#include <cmath>

#include "figure/draw.hpp"

namespace lunid::figure {
namespace {

/// A row of cells of one colour, from column `begin` to before `end`.
struct Run {
  Eigen::Index begin = 0;
  Eigen::Index end = 0;
};

/// Lines at 45 degrees, the same family all over the plot, within a box.
void hatch(Canvas& canvas, const Look& look, const PanelPlan& plan, const Box& box) {
  constexpr double spacing = 6.0;
  const double origin = plan.plot.bottom - plan.plot.left;
  const double low = box.bottom - box.right - origin, high = box.top - box.left - origin;
  for (double k = std::ceil(low / spacing); k * spacing <= high; k += 1.0) {
    const double offset = k * spacing + origin;  // y = x + offset
    const Stroke line{{box.left, box.left + offset}, {box.right, box.right + offset}};
    for (const Stroke& part : clip(line, box)) canvas.polyline(part, look.palette.hatch, 0.7);
  }
}

bool same(const Colour& a, const Colour& b) { return a.red == b.red && a.green == b.green && a.blue == b.blue; }

/// A map of at most so many cells each way: more are finer than a point of a usual figure.
constexpr std::size_t most_cells = 250;

/// Cells to draw: those of a map, or blocks of them with the value that lies farthest from the middle of the colours.
struct Cells {
  std::vector<double> x, y;  ///< edges
  Eigen::MatrixXd z;

  Cells(const HeatMap& map, const AxisPlan& colour, bool diverging)
      : x(cell_edges(map.x)), y(cell_edges(map.y)), z(map.z) {
    const auto width = static_cast<Eigen::Index>((map.x.size() + most_cells - 1) / most_cells);
    const auto height = static_cast<Eigen::Index>((map.y.size() + most_cells - 1) / most_cells);
    if (width == 1 && height == 1) return;
    const auto extremity = [&](double value) { return std::abs(colour_position(colour, diverging, value) - 0.5); };
    z = Eigen::MatrixXd::Constant((map.z.rows() + height - 1) / height, (map.z.cols() + width - 1) / width,
                                  std::nan(""));
    for (Eigen::Index c = 0; c < map.z.cols(); ++c)
      for (Eigen::Index r = 0; r < map.z.rows(); ++r) {
        double& held = z(r / height, c / width);
        if (std::isnan(held) || extremity(map.z(r, c)) > extremity(held)) held = map.z(r, c);
      }
    thin(x, width);
    thin(y, height);
  }

 private:
  static void thin(std::vector<double>& edges, Eigen::Index step) {
    std::vector<double> kept;
    for (std::size_t i = 0; i + 1 < edges.size(); i += static_cast<std::size_t>(step)) kept.push_back(edges[i]);
    kept.push_back(edges.back());
    edges = std::move(kept);
  }
};

class MapPainter {
 public:
  MapPainter(Canvas& canvas, const Look& look, const PanelPlan& plan)
      : canvas_(canvas), look_(look), plan_(plan), map_(*plan.panel->map), cells_(map_, *plan.colour, map_.diverging) {}

  void paint() {
    for (Eigen::Index row = 0; row < cells_.z.rows(); ++row)
      for (Run run{0, 0}; run.begin < cells_.z.cols(); run.begin = run.end) {
        run.end = run.begin + 1;
        while (run.end < cells_.z.cols() && alike(row, run.begin, run.end)) ++run.end;
        place(row, run);
      }
    canvas_.facets(facets_);
    for (const Box& box : empty_) hatch(canvas_, look_, plan_, box);
  }

 private:
  Colour colour(double value) const {
    return map_colour(colour_position(*plan_.colour, map_.diverging, value), map_.diverging);
  }

  bool alike(Eigen::Index row, Eigen::Index a, Eigen::Index b) const {
    const double u = cells_.z(row, a), v = cells_.z(row, b);
    if (std::isnan(u) || std::isnan(v)) return std::isnan(u) && std::isnan(v);
    return same(colour(u), colour(v));
  }

  void place(Eigen::Index row, Run run) {
    const auto r = static_cast<std::size_t>(row);
    const Point low = plan_.at(cells_.x[static_cast<std::size_t>(run.begin)], cells_.y[r]);
    const Point high = plan_.at(cells_.x[static_cast<std::size_t>(run.end)], cells_.y[r + 1]);
    const Box& plot = plan_.plot;
    Box box{std::max(low.x, plot.left), std::max(low.y, plot.bottom), std::min(high.x, plot.right),
            std::min(high.y, plot.top)};
    if (!(box.width() > 0.0 && box.height() > 0.0)) return;
    // Cells reach a little under the next ones, right and above, so that no viewer shows seams.
    box.right = std::min(box.right + 0.3, plot.right);
    box.top = std::min(box.top + 0.3, plot.top);
    const double value = cells_.z(row, run.begin);
    if (std::isnan(value)) empty_.push_back(box);
    facets_.push_back({{{box.left, box.bottom}, {box.right, box.bottom}, {box.right, box.top}, {box.left, box.top}},
                       std::isnan(value) ? look_.palette.no_data : colour(value)});
  }

  Canvas& canvas_;
  const Look& look_;
  const PanelPlan& plan_;
  const HeatMap& map_;
  Cells cells_;
  std::vector<Facet> facets_;
  std::vector<Box> empty_;
};

void outline(Canvas& canvas, const Look& look, const Box& box) {
  const Point corners[] = {{box.left, box.bottom},
                           {box.right, box.bottom},
                           {box.right, box.top},
                           {box.left, box.top},
                           {box.left, box.bottom}};
  canvas.polyline(corners, look.palette.ink, look.frame);
}

/// The lines of the colour bar's title, side by side. A word that is longer than the bar is written smaller.
void draw_colour_title(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan, const Box& bar) {
  double x = bar.right + look.tick_length + 1.7 * look.gap + widest_label(meter, look, *plan.colour);
  for (const std::string& line : plan.colour_title) {
    const double size = fitting_size(meter, line, look.axis_text, bar.height());
    canvas.text({x, 0.5 * (bar.bottom + bar.top)}, line,
                {.size = size, .colour = look.palette.ink, .across = -1, .upward = 0, .vertical = true});
    x += line_height(look.axis_text);
  }
}

}  // namespace

double colour_position(const AxisPlan& axis, bool diverging, double value) {
  if (!diverging || axis.scale == Scale::log) return axis.place(value);
  const double reach = std::max(std::abs(axis.range.low), std::abs(axis.range.high));
  return 0.5 + 0.5 * value / reach;
}

void draw_colour_bar(Canvas& canvas, const Look& look, const AxisPlan& axis, bool diverging, const Box& bar) {
  constexpr int steps = 128;
  for (int i = 0; i < steps; ++i) {
    const double share = (i + 0.5) / steps;
    const double value = axis.scale == Scale::log ? axis.range.low * std::pow(axis.range.high / axis.range.low, share)
                                                  : axis.range.low + share * (axis.range.high - axis.range.low);
    const double bottom = bar.bottom + bar.height() * i / steps;
    const double top = std::min(bar.top, bar.bottom + bar.height() * (i + 1) / steps + (i + 1 < steps ? 0.3 : 0.0));
    canvas.rectangle({bar.left, bottom, bar.right, top},
                     map_colour(colour_position(axis, diverging, value), diverging));
  }
  outline(canvas, look, bar);
  for (const Tick& tick : axis.ticks) {
    const double y = bar.bottom + axis.place(tick.value) * bar.height();
    canvas.line({bar.right, y}, {bar.right + look.tick_length, y}, look.palette.ink, look.frame);
    canvas.text({bar.right + look.tick_length + 0.7 * look.gap, y}, tick.label,
                {.size = look.tick_text, .colour = look.palette.ink, .across = -1, .upward = 0});
  }
}

namespace {

/// Dark ink on light cells, light on dark ones (the weights of sRGB luminance).
Colour legible_on(const Colour& cell) {
  const double luminance = 0.2126 * cell.red + 0.7152 * cell.green + 0.0722 * cell.blue;
  return luminance > 140.0 ? Colour{20, 20, 20} : Colour{250, 250, 250};
}

/// The value of each cell, where it is large enough to hold one.
void draw_numbers(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan) {
  const HeatMap& map = *plan.panel->map;
  constexpr double least = 5.0;  // points: smaller is not read
  const std::vector<double> x = cell_edges(map.x), y = cell_edges(map.y);
  for (std::size_t row = 0; row < map.y.size(); ++row)
    for (std::size_t column = 0; column < map.x.size(); ++column) {
      const double value = map.z(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
      if (!std::isfinite(value)) continue;
      const std::string text = few_digits(value / plan.colour->factor, 2);
      const Point low = plan.at(x[column], y[row]), high = plan.at(x[column + 1], y[row + 1]);
      const double natural = meter.width(text, look.tick_text, false);
      const double size =
          std::min({look.tick_text, look.tick_text * 0.9 * (high.x - low.x) / natural, 0.7 * (high.y - low.y)});
      const Colour cell = map_colour(colour_position(*plan.colour, map.diverging, value), map.diverging);
      if (size >= least && plan.plot.holds({0.5 * (low.x + high.x), 0.5 * (low.y + high.y)}))
        canvas.text({0.5 * (low.x + high.x), 0.5 * (low.y + high.y)}, text,
                    {.size = size, .colour = legible_on(cell), .across = 0, .upward = 0});
    }
}

void draw_contours(Canvas& canvas, const Look& look, const PanelPlan& plan) {
  for (const Tick& tick : plan.colour->ticks)
    for (const Stroke& line : contour(*plan.panel->map, tick.value)) {
      Stroke on_paper;
      for (const Point& p : line) on_paper.push_back(plan.at(p.x, p.y));
      for (const Stroke& part : clip(on_paper, plan.plot)) canvas.polyline(part, {20, 20, 20, 200}, 0.8 * look.frame);
    }
}

}  // namespace

void draw_map(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan) {
  MapPainter(canvas, look, plan).paint();
  if (plan.panel->map->contours) draw_contours(canvas, look, plan);
  if (plan.panel->map->numbers) draw_numbers(canvas, meter, look, plan);
  if (plan.colour_bar) draw_panel_colour_bar(canvas, meter, look, plan);
}

void draw_panel_colour_bar(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan) {
  const Box bar = colour_bar_box(plan);
  if (plan.no_data) {
    const Box swatch{bar.left, plan.plot.bottom, bar.right, plan.plot.bottom + bar.width()};
    canvas.rectangle(swatch, look.palette.no_data);
    hatch(canvas, look, plan, swatch);
    outline(canvas, look, swatch);
    canvas.text({swatch.right + look.tick_length + 0.7 * look.gap, 0.5 * (swatch.bottom + swatch.top)},
                plan.panel->map->missing,
                {.size = look.tick_text, .colour = look.palette.ink, .across = -1, .upward = 0});
  }
  draw_colour_bar(canvas, look, *plan.colour, diverging_colours(*plan.panel), bar);
  draw_colour_title(canvas, meter, look, plan, bar);
}

}  // namespace lunid::figure
