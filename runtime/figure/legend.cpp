#include "figure/legend.hpp"

#include <algorithm>

#include "figure/panel_plan.hpp"

namespace lunid::figure {
namespace {

constexpr double swatch_width = 24.0;
constexpr double between_entries = 16.0;
constexpr double padding = 5.0;

double entry_width(TextMeter& meter, const Look& look, const LegendEntry& entry) {
  return swatch_width + look.gap + meter.width(entry.label, look.legend_text, false);
}

void draw_swatch(Canvas& canvas, const Look& look, const LegendEntry& entry, double left, double middle) {
  Colour colour = role_colour(entry.role, look.theme);
  if (entry.swatch != Swatch::curve) {
    if (entry.swatch == Swatch::area) colour.alpha = 90;
    canvas.rectangle({left, middle - 4.0, left + swatch_width, middle + 4.0}, colour);
    return;
  }
  const double width = look.line * entry.width;
  if (has_line(entry.style)) {
    const Stroke whole{{left, middle}, {left + swatch_width, middle}};
    for (const Stroke& part : dash({whole}, entry.style, width)) canvas.polyline(part, colour, width);
  }
  if (has_points(entry.style)) {
    const double r = look.point_radius * entry.width;
    const Point centre{left + 0.5 * swatch_width, middle};
    const double apart = std::min(4.0 * r, 0.5 * swatch_width - r);
    const Point three[] = {{centre.x - apart, middle}, centre, {centre.x + apart, middle}};
    if (entry.style == Style::points)
      canvas.discs(three, r, colour);
    else
      canvas.discs({&centre, 1}, r, colour);
  }
}

void draw_entry(Canvas& canvas, const Look& look, const LegendEntry& entry, double left, double middle) {
  draw_swatch(canvas, look, entry, left, middle);
  canvas.text({left + swatch_width + look.gap, middle}, entry.label,
              {.size = look.legend_text, .colour = look.palette.ink, .across = -1, .upward = 0});
}

Box corner_box(TextMeter& meter, const Look& look, const PanelPlan& plan, Legend corner) {
  double width = 0.0;
  for (const LegendEntry& entry : plan.legend.entries) width = std::max(width, entry_width(meter, look, entry));
  width += 2.0 * padding;
  const double height = static_cast<double>(plan.legend.entries.size()) * line_height(look.legend_text) + padding;
  const double inset = 5.0;
  const bool left = corner == Legend::top_left || corner == Legend::bottom_left;
  const bool top = corner == Legend::top_left || corner == Legend::top_right;
  const double x = left ? plan.plot.left + inset : plan.plot.right - inset - width;
  const double y = top ? plan.plot.top - inset - height : plan.plot.bottom + inset;
  return {x, y, x + width, y + height};
}

bool crosses(const std::vector<Stroke>& strokes, const Box& box) {
  return std::any_of(strokes.begin(), strokes.end(), [&](const Stroke& s) { return !clip(s, box).empty(); });
}

/// Everything that a legend must not cover, as strokes and points.
struct Obstacles {
  std::vector<Stroke> strokes;
  std::vector<Point> points;

  explicit Obstacles(const PanelPlan& plan) {
    for (const Series& s : plan.panel->series) {
      if (has_line(s.style)) add(series_strokes(plan, s.x, s.y));
      if (stands_on_zero(s.style)) add_standing(plan, s);
      if (!has_points(s.style)) continue;
      const std::vector<Point> more = series_points(plan, s, 4.0);
      points.insert(points.end(), more.begin(), more.end());
    }
    for (const Ribbon& r : plan.panel->ribbons) {
      add(series_strokes(plan, r.x, r.low));
      add(series_strokes(plan, r.x, r.high));
    }
    for (const ReferenceLine& line : plan.panel->lines) {
      const Point p = plan.at(line.value, line.value);
      if (line.vertical)
        strokes.push_back({{p.x, plan.plot.bottom}, {p.x, plan.plot.top}});
      else
        strokes.push_back({{plan.plot.left, p.y}, {plan.plot.right, p.y}});
    }
    if (plan.panel->bars) add_bars(plan);
  }

  bool free(const Box& box) const {
    const Box wide{box.left - 3, box.bottom - 3, box.right + 3, box.top + 3};
    return !crosses(strokes, wide) &&
           std::none_of(points.begin(), points.end(), [&](Point p) { return wide.holds(p); });
  }

 private:
  void add(std::vector<Stroke> more) {
    for (Stroke& s : more) strokes.push_back(std::move(s));
  }

  void add_standing(const PanelPlan& plan, const Series& s) {
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const Point top = plan.at(s.x[i], s.y[i]), foot = plan.at(s.x[i], 0.0);
      if (std::isfinite(top.x + top.y))
        strokes.push_back({{top.x, std::isfinite(foot.y) ? foot.y : plan.plot.bottom}, top});
    }
  }

  /// A bar, its whisker and its number as three strokes that a legend box cannot slip between.
  void add_bars(const PanelPlan& plan) {
    const Bars& bars = *plan.panel->bars;
    for (const BarSet& set : bars.set) {
      for (std::size_t i = 0; i < set.value.size(); ++i) {
        const double error = set.error.empty() ? 0.0 : set.error[i];
        const double row = static_cast<double>(bars.name.size() - i);
        for (const double part : {0.1, 0.5, 0.9}) {
          const Point end = plan.at(set.value[i] + error, row - part);
          if (end.x == end.x) strokes.push_back({{plan.plot.left, end.y}, {end.x + 50.0, end.y}});
        }
      }
    }
  }
};

}  // namespace

std::vector<LegendEntry> legend_entries(const Panel& panel) {
  std::vector<LegendEntry> entries;
  const auto add = [&](LegendEntry entry) {
    if (entry.label.empty() || std::find(entries.begin(), entries.end(), entry) != entries.end()) return;
    entries.push_back(std::move(entry));
  };
  if (panel.scene)
    for (const Cloud& cloud : panel.scene->clouds) add({cloud.label, Swatch::curve, Style::points, cloud.role, 1.0});
  for (const Series& s : panel.series)
    add({s.label, s.style == Style::columns ? Swatch::area : Swatch::curve, s.style, s.role, s.width});
  if (panel.bars)
    for (const BarSet& set : panel.bars->set) add({set.label, Swatch::bar, Style::line, set.role, 1.0});
  for (const Ribbon& r : panel.ribbons) add({r.label, Swatch::area, Style::line, r.role, 1.0});
  for (const Band& band : panel.bands) add({band.label, Swatch::area, Style::line, band.role, 1.0});
  for (const ReferenceLine& line : panel.lines) add({line.label, Swatch::curve, line.style, line.role, 1.0});
  return entries;
}

std::vector<std::vector<LegendEntry>> legend_rows(TextMeter& meter, const Look& look,
                                                  const std::vector<LegendEntry>& entries, double width) {
  std::vector<std::vector<LegendEntry>> rows;
  double used = 0.0;
  for (LegendEntry entry : entries) {
    entry.label = shortened(meter, entry.label, look.legend_text, false, width - swatch_width - look.gap);
    const double wide = entry_width(meter, look, entry);
    if (rows.empty() || used + between_entries + wide > width) {
      rows.emplace_back();
      used = -between_entries;
    }
    used += between_entries + wide;
    rows.back().push_back(std::move(entry));
  }
  return rows;
}

double strip_height(const Look& look, std::size_t rows) {
  return rows == 0 ? 0.0 : static_cast<double>(rows) * line_height(look.legend_text) + look.gap;
}

void place_legend(TextMeter& meter, const Look& look, PanelPlan& plan, Legend wanted) {
  LegendPlan& legend = plan.legend;
  legend.place = Legend::none;
  if (legend.entries.empty() || wanted == Legend::none) return;
  const auto above = [&] {
    legend.place = Legend::above;
    legend.rows = legend_rows(meter, look, legend.entries, plan.cell.right - plan.plot.left);
  };
  if (wanted == Legend::above || (wanted == Legend::automatic && (plan.panel->map || plan.panel->scene)))
    return above();
  if (wanted != Legend::automatic) {
    legend.place = wanted;
    return settle_legend(meter, look, plan);
  }
  const Obstacles obstacles(plan);
  for (const Legend corner : {Legend::top_right, Legend::top_left, Legend::bottom_right, Legend::bottom_left}) {
    const Box box = corner_box(meter, look, plan, corner);
    const bool fits = box.width() < 0.6 * plan.plot.width() && box.height() < 0.6 * plan.plot.height();
    if (!fits || !obstacles.free(box)) continue;
    legend.place = corner;
    legend.box = box;
    return;
  }
  above();
}

void settle_legend(TextMeter& meter, const Look& look, PanelPlan& plan) {
  LegendPlan& legend = plan.legend;
  if (legend.place != Legend::none && legend.place != Legend::above)
    legend.box = corner_box(meter, look, plan, legend.place);
}

void draw_strip(Canvas& canvas, TextMeter& meter, const Look& look, const std::vector<std::vector<LegendEntry>>& rows,
                double left, double top) {
  double middle = top - 0.5 * line_height(look.legend_text);
  for (const std::vector<LegendEntry>& row : rows) {
    double x = left;
    for (const LegendEntry& entry : row) {
      draw_entry(canvas, look, entry, x, middle);
      x += entry_width(meter, look, entry) + between_entries;
    }
    middle -= line_height(look.legend_text);
  }
}

void draw_corner(Canvas& canvas, const Look& look, const LegendPlan& legend) {
  const Box& box = legend.box;
  Colour paper = look.palette.background;
  paper.alpha = 225;
  canvas.rectangle(box, paper);
  double middle = box.top - 0.5 * padding - 0.5 * line_height(look.legend_text);
  for (const LegendEntry& entry : legend.entries) {
    draw_entry(canvas, look, entry, box.left + padding, middle);
    middle -= line_height(look.legend_text);
  }
}

}  // namespace lunid::figure
