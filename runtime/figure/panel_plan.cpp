#include "figure/panel_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "figure/draw.hpp"

namespace lunid::figure {
namespace {

constexpr double bar_away = 10.0;  // of the colour bar from the plot
constexpr double bar_width = 11.0;
constexpr double no_data_room = 24.0;   // for the swatch of cells without data, under the bar
constexpr double longest_name = 130.0;  // along an axis

/// Whether the labels of a horizontal axis keep apart.
bool apart(TextMeter& meter, const Look& look, const AxisPlan& axis, double length) {
  double end = -1e9;  // of the label before
  if (axis.turned) return true;
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
  if (!axis.names.empty()) {
    AxisPlan plan = plan_axis(axis, range, 1);
    plan.turned = !apart(meter, look, plan, length);
    if (plan.turned)
      for (Tick& tick : plan.ticks) tick.label = shortened(meter, tick.label, look.tick_text, false, longest_name);
    return plan;
  }
  for (int wanted = std::max(2, static_cast<int>(length / 42.0)); wanted > 1; --wanted) {
    AxisPlan plan = plan_axis(axis, range, wanted, hint(hints, axis));
    if (apart(meter, look, plan, length)) return plan;
  }
  return plan_axis(axis, range, 1, hint(hints, axis));
}

AxisPlan vertical_axis(TextMeter& meter, const Look& look, const Axis& axis, Range range, double length,
                       const Hints& hints) {
  if (!axis.names.empty()) {
    AxisPlan plan = plan_axis(axis, range, 1);
    for (Tick& tick : plan.ticks) tick.label = shortened(meter, tick.label, look.tick_text, false, longest_name);
    return plan;
  }
  return plan_axis(axis, range, std::max(2, static_cast<int>(length / (2.5 * look.tick_text))), hint(hints, axis));
}

/// How far the labels of a horizontal axis reach beyond the plot's right end.
double label_overhang(TextMeter& meter, const Look& look, const AxisPlan& axis, double length) {
  double beyond = 0.0;
  if (axis.turned || axis.bare) return beyond;
  for (const Tick& tick : axis.ticks) {
    const double half = 0.5 * meter.width(tick.label, look.tick_text, false);
    beyond = std::max(beyond, half - (1.0 - axis.place(tick.value)) * length);
  }
  return beyond;
}

double left_margin(TextMeter& meter, const Look& look, const PanelPlan& plan) {
  const double title = plan.y.title.empty() ? 0.0 : line_height(look.axis_text);
  if (plan.panel->bars) return title + plan.names + 2.0 * look.gap;
  if (plan.y.bare) return look.tick_length;
  return title + widest_label(meter, look, plan.y) + look.tick_length + 1.5 * look.gap;
}

double right_margin(TextMeter& meter, const Look& look, const PanelPlan& plan) {
  const double overhang = label_overhang(meter, look, plan.x, plan.plot.width()) + 1.0;
  if (!plan.colour_bar) return std::max(2.0, overhang);
  const double lines = static_cast<double>(plan.colour_title.size());
  const double title = lines > 0.0 ? lines * line_height(look.axis_text) + look.gap : 0.0;
  const double labels = widest_label(meter, look, *plan.colour) + title;
  const double no_data = plan.no_data ? meter.width(plan.panel->map->missing, look.tick_text, false) : 0.0;
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
  if (panel.scene) return plan_title(meter, look, plan);
  const double height = plan.plot.height();
  plan.x = horizontal_axis(meter, look, panel.x, plan.x_reach, plan.plot.width(), hints);
  if (panel.bars) {
    plan.y = {};
    plan.y.range = plan.y_reach;
    plan.y.title = panel.y.name;
    plan.names = bar_name_width(meter, look, plan);
  } else {
    plan.y = vertical_axis(meter, look, panel.y, plan.y_reach, height, hints);
  }
  plan.x.bare = plan.bare_x;
  plan.y.bare = plan.bare_y;
  if (const Axis* colour = colour_axis(panel)) {
    const double bar = colour_bar_box(plan).height();
    plan.colour = vertical_axis(meter, look, *colour, colour_range(panel), bar, hints);
    plan.colour_title = wrapped(meter, plan.colour->title, look.axis_text, false, bar);
  }
  plan_title(meter, look, plan);
}

Margins needed_margins(TextMeter& meter, const Look& look, const PanelPlan& plan) {
  Margins margins;
  if (!plan.panel->scene) {
    margins.left = left_margin(meter, look, plan);
    margins.right = right_margin(meter, look, plan);
  }
  const double labels = plan.x.turned ? widest_label(meter, look, plan.x) : 1.15 * look.tick_text;
  margins.bottom = plan.panel->scene ? 0.0 : look.tick_length;
  if (!plan.x.bare && !plan.panel->scene)
    margins.bottom += 0.7 * look.gap + labels + (plan.x.title.empty() ? 0.0 : 1.2 * look.axis_text);
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
  SeenSegments seen(plan.plot, 2.0 * column);  // less than half the width of a line
  const auto finish = [&] {
    for (const Stroke& part : clip(thin(run, column), plan.plot))
      for (Stroke& fresh : seen.fresh(part)) strokes.push_back(std::move(fresh));
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

namespace {

/// Colours in steps that the eye cannot tell apart.
constexpr int colour_steps = 64;

int colour_step(const PanelPlan& plan, double value) {
  const double place = plan.colour->place(value);
  return std::isfinite(place) ? std::clamp(static_cast<int>(place * colour_steps), 0, colour_steps - 1) : -1;
}

Colour step_colour(int step) { return map_colour((step + 0.5) / colour_steps, false); }

}  // namespace

namespace {

/// A long coloured curve with what thin() keeps of it; breaks stay.
Series thinned(const PanelPlan& plan, const Series& s, double column) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  Series kept;
  Stroke run;
  std::size_t first = 0;
  const auto finish = [&](std::size_t end) {
    for (const std::size_t i : thin_places(run, column)) {
      kept.x.push_back(s.x[first + i]);
      kept.y.push_back(s.y[first + i]);
      kept.colour.push_back(s.colour[first + i]);
    }
    for (std::vector<double>* values : {&kept.x, &kept.y, &kept.colour}) values->push_back(nothing);
    run.clear();
    first = end + 1;
  };
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const Point p = plan.at(s.x[i], s.y[i]);
    if (std::isfinite(p.x) && std::isfinite(p.y))
      run.push_back(p);
    else
      finish(i);
  }
  finish(s.x.size());
  return kept;
}

}  // namespace

std::vector<ColouredStroke> coloured_strokes(const PanelPlan& plan, const Series& given) {
  constexpr std::size_t few = 20000;
  const Series s = given.x.size() > few ? thinned(plan, given, 0.25) : given;
  std::vector<ColouredStroke> strokes;
  for (std::size_t begin = 0; begin + 1 < s.x.size();) {
    const int step = colour_step(plan, s.colour[begin]);
    std::size_t end = begin + 1;
    while (end < s.x.size() && colour_step(plan, s.colour[end]) == step) ++end;
    // Up to the first point of the next colour, so that there is no gap.
    const auto last = static_cast<std::ptrdiff_t>(std::min(end + 1, s.x.size()));
    const auto first = static_cast<std::ptrdiff_t>(begin);
    if (step >= 0)
      for (Stroke& stroke :
           series_strokes(plan, {s.x.begin() + first, s.x.begin() + last}, {s.y.begin() + first, s.y.begin() + last}))
        strokes.push_back({std::move(stroke), step_colour(step)});
    begin = end;
  }
  return strokes;
}

std::vector<ColouredStroke> coloured_points(const PanelPlan& plan, const Series& s, double radius) {
  std::vector<Series> groups(colour_steps);
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const int step = colour_step(plan, s.colour[i]);
    if (step < 0) continue;
    groups[static_cast<std::size_t>(step)].x.push_back(s.x[i]);
    groups[static_cast<std::size_t>(step)].y.push_back(s.y[i]);
  }
  std::vector<ColouredStroke> result;
  for (int step = 0; step < colour_steps; ++step)
    result.push_back({series_points(plan, groups[static_cast<std::size_t>(step)], radius), step_colour(step)});
  return result;
}

std::vector<Point> series_points(const PanelPlan& plan, const Series& series, double radius) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const Point p = plan.at(series.x[i], series.y[i]);
    if (std::isfinite(p.x) && std::isfinite(p.y)) points.push_back(p);
  }
  std::vector<Point> kept = thin_cloud(points, plan.plot, 0.4 * radius);
  constexpr std::size_t many = 20000;
  // So many cover each other: neighbours that touch show the same.
  return kept.size() > many ? thin_cloud(kept, plan.plot, 1.4 * radius) : kept;
}

}  // namespace lunid::figure
