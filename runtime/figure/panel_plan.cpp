#include "figure/panel_plan.hpp"

#include <algorithm>
#include <cmath>

namespace lunid::figure {
namespace {

/// The densest ticks along `length` points whose labels keep apart.
AxisPlan horizontal_axis(Canvas& canvas, const Look& look, const Axis& axis, Range range, double length) {
  for (int wanted = std::max(2, static_cast<int>(length / 45.0)); wanted > 1; --wanted) {
    AxisPlan plan = plan_axis(axis, range, wanted);
    double taken = 0.0;
    for (const Tick& tick : plan.ticks)
      if (!tick.label.empty()) taken += canvas.text_width(tick.label, look.tick_text, false) + 1.2 * look.tick_text;
    if (taken <= length) return plan;
  }
  return plan_axis(axis, range, 1);
}

AxisPlan vertical_axis(const Look& look, const Axis& axis, Range range, double length) {
  return plan_axis(axis, range, std::max(2, static_cast<int>(length / (2.6 * look.tick_text))));
}

double widest_label(Canvas& canvas, const Look& look, const AxisPlan& axis) {
  double width = 0.0;
  for (const Tick& tick : axis.ticks) width = std::max(width, canvas.text_width(tick.label, look.tick_text, false));
  return width;
}

/// How far the last tick's label of a horizontal axis reaches beyond the plot.
double label_overhang(Canvas& canvas, const Look& look, const AxisPlan& axis, double length) {
  double beyond = 0.0;
  for (const Tick& tick : axis.ticks) {
    const double half = 0.5 * canvas.text_width(tick.label, look.tick_text, false);
    beyond = std::max(beyond, half - (1.0 - axis.place(tick.value)) * length);
  }
  return beyond;
}

double left_margin(Canvas& canvas, const Look& look, const PanelPlan& plan) {
  const double title = plan.y.title.empty() ? 0.0 : line_height(look.axis_text);
  if (plan.panel->bars) return title + bar_name_width(canvas, look, plan) + 2.0 * look.gap;
  return title + widest_label(canvas, look, plan.y) + look.tick_length + 1.5 * look.gap;
}

double right_margin(Canvas& canvas, const Look& look, const PanelPlan& plan) {
  const double overhang = label_overhang(canvas, look, plan.x, plan.plot.width()) + 1.0;
  if (!plan.colour) return std::max(2.0, overhang);
  const bool holes = plan.panel->map->z.hasNaN();
  const double labels = std::max(widest_label(canvas, look, *plan.colour),
                                 holes ? canvas.text_width("no data", look.tick_text, false) : 0.0);
  const double title = plan.colour->title.empty() ? 0.0 : line_height(look.axis_text) + look.gap;
  return 10.0 + 11.0 + 2.0 * look.gap + labels + title;
}

/// Whether title and note share a line.
void plan_title(Canvas& canvas, const Look& look, PanelPlan& plan, double width) {
  const double note = canvas.text_width(plan.panel->note, look.legend_text, false);
  const double title = canvas.text_width(plan.panel->title, look.title_text, true);
  const bool both = !plan.panel->note.empty() && !plan.panel->title.empty();
  plan.note_below = both && title + note + 12.0 > width;
  plan.title = wrapped(canvas, plan.panel->title, look.title_text, true, width);
}

}  // namespace

double bar_name_width(Canvas& canvas, const Look& look, const PanelPlan& plan) {
  double width = 0.0;
  for (const std::string& name : plan.panel->bars->name)
    width = std::max(width, canvas.text_width(name, look.tick_text, false));
  return std::min(width, 0.4 * plan.cell.width());
}

void plan_content(Canvas& canvas, const Look& look, PanelPlan& plan, double width, double height) {
  const Panel& panel = *plan.panel;
  const Range x = x_range(panel);
  plan.x = horizontal_axis(canvas, look, panel.x, x, width);
  if (panel.bars) {
    plan.y = {};
    plan.y.range = y_range(panel, x);
    plan.y.title = panel.y.name;
  } else {
    plan.y = vertical_axis(look, panel.y, y_range(panel, x), height);
  }
  if (panel.map) plan.colour = vertical_axis(look, panel.map->colour, colour_range(*panel.map), height);
  plan_title(canvas, look, plan, width);
}

Margins needed_margins(Canvas& canvas, const Look& look, const PanelPlan& plan) {
  Margins margins;
  margins.left = left_margin(canvas, look, plan);
  margins.right = right_margin(canvas, look, plan);
  margins.bottom = look.tick_length + look.gap + line_height(look.tick_text) +
                   (plan.x.title.empty() ? 0.0 : line_height(look.axis_text) + 1.0);
  const bool note_line = plan.note_below || (plan.title.empty() && !plan.panel->note.empty());
  margins.top = static_cast<double>(plan.title.size()) * line_height(look.title_text) +
                (note_line ? line_height(look.legend_text) : 0.0) + look.gap;
  if (plan.legend.place == Legend::above) margins.top += strip_height(look, plan.legend.rows.size());
  return margins;
}

std::vector<Stroke> series_strokes(const PanelPlan& plan, const std::vector<double>& x, const std::vector<double>& y) {
  // A quarter of a point is finer than a pixel of the default figure.
  constexpr double column = 0.25;
  std::vector<Stroke> strokes;
  Stroke run;
  const auto finish = [&] {
    for (Stroke& part : clip(thin(run, column), plan.plot)) strokes.push_back(std::move(part));
    run.clear();
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Point p = plan.at(x[i], y[i]);
    if (std::isfinite(p.x) && std::isfinite(p.y)) run.push_back(p);
    else finish();
  }
  finish();
  return strokes;
}

std::vector<Point> series_points(const PanelPlan& plan, const Series& series, double radius) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const Point p = plan.at(series.x[i], series.y[i]);
    if (std::isfinite(p.x) && std::isfinite(p.y)) points.push_back(p);
  }
  return thin_cloud(points, plan.plot, 0.4 * radius);
}

}  // namespace lunid::figure
