#include "figure/panel_plan.hpp"

#include <algorithm>
#include <cmath>

#include "figure/draw.hpp"

namespace lunid::figure {
namespace {

constexpr double bar_away = 10.0;  // of the colour bar from the plot
constexpr double bar_width = 11.0;
constexpr double no_data_room = 24.0;  // for the swatch of cells without data, under the bar

/// Whether the labels of a horizontal axis keep apart.
bool apart(TextMeter& meter, const Look& look, const AxisPlan& axis, double length) {
  double end = -1e9;  // of the label before
  for (const Tick& tick : axis.ticks) {
    if (tick.label.empty()) continue;
    const double at = axis.place(tick.value) * length, half = 0.5 * meter.width(tick.label, look.tick_text, false);
    if (at - half < end + 0.6 * look.tick_text) return false;
    end = at + half;
  }
  return true;
}

double hint(const Hints& hints, const Axis& axis) {
  const auto found = hints.find({axis.name, axis.unit});
  return found == hints.end() ? 0.0 : found->second;
}

/// The densest ticks along `length` points whose labels keep apart.
AxisPlan horizontal_axis(TextMeter& meter, const Look& look, const Axis& axis, Range range, double length,
                         const Hints& hints) {
  for (int wanted = std::max(2, static_cast<int>(length / 42.0)); wanted > 1; --wanted) {
    AxisPlan plan = plan_axis(axis, range, wanted, hint(hints, axis));
    if (apart(meter, look, plan, length)) return plan;
  }
  return plan_axis(axis, range, 1, hint(hints, axis));
}

AxisPlan vertical_axis(const Look& look, const Axis& axis, Range range, double length, const Hints& hints) {
  return plan_axis(axis, range, std::max(2, static_cast<int>(length / (2.5 * look.tick_text))), hint(hints, axis));
}

/// How far the labels of a horizontal axis reach beyond the plot's right end.
double label_overhang(TextMeter& meter, const Look& look, const AxisPlan& axis, double length) {
  double beyond = 0.0;
  for (const Tick& tick : axis.ticks) {
    const double half = 0.5 * meter.width(tick.label, look.tick_text, false);
    beyond = std::max(beyond, half - (1.0 - axis.place(tick.value)) * length);
  }
  return beyond;
}

double left_margin(TextMeter& meter, const Look& look, const PanelPlan& plan) {
  const double title = plan.y.title.empty() ? 0.0 : line_height(look.axis_text);
  if (plan.panel->bars) return title + plan.names + 2.0 * look.gap;
  return title + widest_label(meter, look, plan.y) + look.tick_length + 1.5 * look.gap;
}

double right_margin(TextMeter& meter, const Look& look, const PanelPlan& plan) {
  const double overhang = label_overhang(meter, look, plan.x, plan.plot.width()) + 1.0;
  if (!plan.colour_bar) return std::max(2.0, overhang);
  const double lines = static_cast<double>(plan.colour_title.size());
  const double title = lines > 0.0 ? lines * line_height(look.axis_text) + look.gap : 0.0;
  const double labels = widest_label(meter, look, *plan.colour) + title;
  const double no_data = plan.no_data ? meter.width("no data", look.tick_text, false) : 0.0;
  return bar_away + bar_width + look.tick_length + look.gap + std::max(labels, no_data);
}

/// Room for the title: up to the end of the cell.
void plan_title(TextMeter& meter, const Look& look, PanelPlan& plan) {
  const double room = std::max(plan.plot.width(), plan.cell.right - plan.plot.left);
  const double note = meter.width(plan.panel->note, look.legend_text, false);
  const double title = meter.width(plan.panel->title, look.title_text, true);
  const bool both = !plan.panel->note.empty() && !plan.panel->title.empty();
  plan.note_below = both && title + note + 12.0 > plan.plot.width();
  plan.title = wrapped(meter, plan.panel->title, look.title_text, true, room);
}

double bar_name_width(TextMeter& meter, const Look& look, const PanelPlan& plan) {
  double width = 0.0;
  for (const std::string& name : plan.panel->bars->name)
    width = std::max(width, meter.width(name, look.tick_text, false));
  return std::min(width, 180.0);
}

}  // namespace

double widest_label(TextMeter& meter, const Look& look, const AxisPlan& axis) {
  double width = 0.0;
  for (const Tick& tick : axis.ticks) width = std::max(width, meter.width(tick.label, look.tick_text, false));
  return width;
}

Box colour_bar_box(const PanelPlan& plan) {
  const double left = plan.plot.right + bar_away;
  return {left, plan.plot.bottom + (plan.no_data ? no_data_room : 0.0), left + bar_width, plan.plot.top};
}

void plan_content(TextMeter& meter, const Look& look, PanelPlan& plan, const Hints& hints) {
  const Panel& panel = *plan.panel;
  const Range x = x_range(panel);
  const double height = plan.plot.height();
  plan.x = horizontal_axis(meter, look, panel.x, x, plan.plot.width(), hints);
  if (panel.bars) {
    plan.y = {};
    plan.y.range = y_range(panel, x);
    plan.y.title = panel.y.name;
    plan.names = bar_name_width(meter, look, plan);
  } else {
    plan.y = vertical_axis(look, panel.y, y_range(panel, x), height, hints);
  }
  if (panel.map) {
    const double bar = colour_bar_box(plan).height();
    plan.colour = vertical_axis(look, panel.map->colour, colour_range(*panel.map), bar, hints);
    plan.colour_title = wrapped(meter, plan.colour->title, look.axis_text, false, bar);
  }
  plan_title(meter, look, plan);
}

Margins needed_margins(TextMeter& meter, const Look& look, const PanelPlan& plan) {
  Margins margins;
  margins.left = left_margin(meter, look, plan);
  margins.right = right_margin(meter, look, plan);
  margins.bottom =
      look.tick_length + 0.7 * look.gap + 1.15 * look.tick_text + (plan.x.title.empty() ? 0.0 : 1.2 * look.axis_text);
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
    if (std::isfinite(p.x) && std::isfinite(p.y))
      run.push_back(p);
    else
      finish();
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
