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

class MapPainter {
 public:
  MapPainter(Canvas& canvas, const Look& look, const PanelPlan& plan)
      : canvas_(canvas),
        look_(look),
        plan_(plan),
        map_(*plan.panel->map),
        x_(cell_edges(map_.x)),
        y_(cell_edges(map_.y)) {}

  void paint() {
    for (Eigen::Index row = 0; row < map_.z.rows(); ++row)
      for (Run run{0, 0}; run.begin < map_.z.cols(); run.begin = run.end) {
        run.end = run.begin + 1;
        while (run.end < map_.z.cols() && alike(row, run.begin, run.end)) ++run.end;
        paint(row, run);
      }
  }

 private:
  Colour colour(double value) const {
    return map_colour(colour_position(*plan_.colour, map_.diverging, value), map_.diverging);
  }

  bool alike(Eigen::Index row, Eigen::Index a, Eigen::Index b) const {
    const double u = map_.z(row, a), v = map_.z(row, b);
    if (std::isnan(u) || std::isnan(v)) return std::isnan(u) && std::isnan(v);
    return same(colour(u), colour(v));
  }

  void paint(Eigen::Index row, Run run) {
    const auto r = static_cast<std::size_t>(row);
    const Point low = plan_.at(x_[static_cast<std::size_t>(run.begin)], y_[r]);
    const Point high = plan_.at(x_[static_cast<std::size_t>(run.end)], y_[r + 1]);
    const Box& plot = plan_.plot;
    Box box{std::max(low.x, plot.left), std::max(low.y, plot.bottom), std::min(high.x, plot.right),
            std::min(high.y, plot.top)};
    if (!(box.width() > 0.0 && box.height() > 0.0)) return;
    // Cells reach a little under the next ones, right and above, so that no viewer shows seams.
    box.right = std::min(box.right + 0.3, plot.right);
    box.top = std::min(box.top + 0.3, plot.top);
    const double value = map_.z(row, run.begin);
    if (std::isnan(value)) {
      canvas_.rectangle(box, look_.palette.no_data);
      hatch(canvas_, look_, plan_, box);
      return;
    }
    canvas_.rectangle(box, colour(value));
  }

  Canvas& canvas_;
  const Look& look_;
  const PanelPlan& plan_;
  const HeatMap& map_;
  std::vector<double> x_;
  std::vector<double> y_;
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

void draw_map(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan) {
  MapPainter(canvas, look, plan).paint();
  if (!plan.colour_bar) return;
  const Box bar = colour_bar_box(plan);
  if (plan.no_data) {
    const Box swatch{bar.left, plan.plot.bottom, bar.right, plan.plot.bottom + bar.width()};
    canvas.rectangle(swatch, look.palette.no_data);
    hatch(canvas, look, plan, swatch);
    outline(canvas, look, swatch);
    canvas.text({swatch.right + look.tick_length + 0.7 * look.gap, 0.5 * (swatch.bottom + swatch.top)}, "no data",
                {.size = look.tick_text, .colour = look.palette.ink, .across = -1, .upward = 0});
  }
  draw_colour_bar(canvas, look, *plan.colour, plan.panel->map->diverging, bar);
  draw_colour_title(canvas, meter, look, plan, bar);
}

}  // namespace lunid::figure
