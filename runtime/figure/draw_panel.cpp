#include <algorithm>
#include <cmath>

#include "figure/draw.hpp"

namespace lunid::figure {
namespace {

class PanelPainter {
 public:
  PanelPainter(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan)
      : canvas_(canvas), meter_(meter), look_(look), plan_(plan), panel_(*plan.panel) {}

  void paint() {
    if (plan_.view) {
      draw_scene_axes(canvas_, meter_, look_, *plan_.view);
      canvas_.facets(scene_facets(look_, *panel_.scene, *plan_.view));
      return above();
    }
    for (const Band& band : panel_.bands) shade(band);
    if (panel_.map)
      draw_map(canvas_, meter_, look_, plan_);
    else
      grid();
    for (const Series& s : panel_.series) points(s);
    for (const Ribbon& ribbon : panel_.ribbons) fill(ribbon);
    if (plan_.colour_bar && !panel_.map) draw_panel_colour_bar(canvas_, meter_, look_, plan_);
    for (const ReferenceLine& line : panel_.lines) rule(line);
    if (panel_.bars) draw_bars(canvas_, meter_, look_, plan_);
    for (const Series& s : panel_.series) curve(s);
    const Point middle{0.5 * (plan_.plot.left + plan_.plot.right), 0.5 * (plan_.plot.bottom + plan_.plot.top)};
    canvas_.text(middle, nothing_to_show(panel_), text(look_.legend_text, 0, 0));
    frame();
    ticks();
    titles();
    if (plan_.legend.place != Legend::none && plan_.legend.place != Legend::above)
      draw_corner(canvas_, look_, plan_.legend);
  }

 private:
  void shade(const Band& band) {
    const double left = std::max(plan_.at(band.from, 1.0).x, plan_.plot.left);
    const double right = std::min(plan_.at(band.to, 1.0).x, plan_.plot.right);
    if (!(right > left)) return;
    Colour colour = role_colour(band.role, look_.theme);
    colour.alpha = 45;
    canvas_.rectangle({left, plan_.plot.bottom, right, plan_.plot.top}, colour);
  }

  void grid() {
    const Box& plot = plan_.plot;
    for (const Tick& tick : plan_.x.ticks) {
      const double x = plot.left + plan_.x.place(tick.value) * plot.width();
      if (!tick.label.empty()) canvas_.line({x, plot.bottom}, {x, plot.top}, look_.palette.faint, 0.6);
    }
    for (const Tick& tick : plan_.y.ticks) {
      const double y = plot.bottom + plan_.y.place(tick.value) * plot.height();
      if (!tick.label.empty()) canvas_.line({plot.left, y}, {plot.right, y}, look_.palette.faint, 0.6);
    }
  }

  /// Quadrilaterals between the curves, cut at NaN; values beyond the axis end at the frame.
  void fill(const Ribbon& r) {
    Colour colour = role_colour(r.role, look_.theme);
    colour.alpha = 90;
    const Box& plot = plan_.plot;
    // On a log axis an area that reaches zero ends at the frame.
    const auto low = [&](double value) {
      return plan_.y.scale == Scale::log && value <= 0.0 ? plan_.y.range.low : value;
    };
    const auto held = [&](Point p) { return Point{p.x, std::clamp(p.y, plot.bottom, plot.top)}; };
    for (std::size_t i = 1; i < r.x.size(); ++i) {
      const Point corners[] = {held(plan_.at(r.x[i - 1], low(r.low[i - 1]))), held(plan_.at(r.x[i], low(r.low[i]))),
                               held(plan_.at(r.x[i], r.high[i])), held(plan_.at(r.x[i - 1], r.high[i - 1]))};
      const bool drawn = std::all_of(std::begin(corners), std::end(corners), [&](Point p) {
        return std::isfinite(p.x) && std::isfinite(p.y) && p.x >= plot.left - 1e-6 && p.x <= plot.right + 1e-6;
      });
      if (drawn) canvas_.polygon(corners, colour);
    }
  }

  void rule(const ReferenceLine& line) {
    const Box& plot = plan_.plot;
    const double share = line.vertical ? plan_.x.place(line.value) : plan_.y.place(line.value);
    if (!(share >= 0.0 && share <= 1.0)) return;
    const double x = plot.left + share * plot.width(), y = plot.bottom + share * plot.height();
    const Stroke stroke =
        line.vertical ? Stroke{{x, plot.bottom}, {x, plot.top}} : Stroke{{plot.left, y}, {plot.right, y}};
    ink({stroke}, line.style, role_colour(line.role, look_.theme), look_.line);
  }

  void curve(const Series& s) {
    const Colour colour = role_colour(s.role, look_.theme);
    if (s.style == Style::stems) return stems(s, colour);
    if (!has_line(s.style)) return;
    if (s.colour.empty()) return ink(series_strokes(plan_, s.x, s.y), s.style, colour, look_.line * s.width);
    for (const ColouredStroke& part : coloured_strokes(plan_, s))
      ink({part.stroke}, s.style, part.colour, look_.line * s.width);
  }

  /// Where zero is, or the end of the plot next to it.
  double ground() const {
    const double at = plan_.y.scale == Scale::log ? 0.0 : plan_.y.place(0.0);
    return plan_.plot.bottom + std::clamp(at, 0.0, 1.0) * plan_.plot.height();
  }

  void stems(const Series& s, Colour colour) {
    const double zero = ground();
    Stroke tops;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const Point top = plan_.at(s.x[i], s.y[i]);
      if (std::isfinite(top.x) && std::isfinite(top.y)) tops.push_back(top);
    }
    std::vector<Stroke> strokes;
    for (const Point& top : thin(tops, 0.25)) {
      for (Stroke& part : clip({{top.x, zero}, top}, plan_.plot)) strokes.push_back(std::move(part));
    }
    ink(strokes, Style::line, colour, look_.line * s.width);
  }

  void columns(const Series& s) {
    const double zero = ground(), half = 0.5 * column_width(s);
    Colour colour = role_colour(s.role, look_.theme);
    colour.alpha = 170;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const Point left = plan_.at(s.x[i] - half, s.y[i]), right = plan_.at(s.x[i] + half, s.y[i]);
      if (!std::isfinite(left.x + right.x + left.y)) continue;
      const double gap = std::min(0.5, 0.1 * (right.x - left.x));  // a hair of paper between neighbours
      const Box bar{
          std::max(left.x + gap, plan_.plot.left), std::clamp(std::min(left.y, zero), plan_.plot.bottom, zero),
          std::min(right.x - gap, plan_.plot.right), std::clamp(std::max(left.y, zero), zero, plan_.plot.top)};
      if (bar.width() > 0.0 && bar.height() > 0.0) canvas_.rectangle(bar, colour);
    }
  }

  /// Points lie under everything else: a cloud would hide it. Many points are smaller.
  void points(const Series& s) {
    if (s.style == Style::columns) columns(s);
    if (!has_points(s.style)) return;
    const double radius = look_.point_radius * s.width * (s.x.size() > 1000 ? 0.67 : 1.0);
    if (!s.colour.empty()) {
      for (const ColouredStroke& group : coloured_points(plan_, s, radius))
        canvas_.discs(group.stroke, radius, group.colour);
      return;
    }
    canvas_.discs(series_points(plan_, s, radius), radius, role_colour(s.role, look_.theme));
  }

  void ink(const std::vector<Stroke>& strokes, Style style, Colour colour, double width) {
    for (const Stroke& part : dash(strokes, style, width)) canvas_.polyline(part, colour, width);
  }

  void frame() {
    const Box& p = plan_.plot;
    const Point corners[] = {
        {p.left, p.bottom}, {p.right, p.bottom}, {p.right, p.top}, {p.left, p.top}, {p.left, p.bottom}};
    canvas_.polyline(corners, look_.palette.ink, look_.frame);
  }

  void ticks() {
    const Box& plot = plan_.plot;
    const double full = look_.tick_length, gap = 0.7 * look_.gap;
    for (const Tick& tick : plan_.x.ticks) {
      const double x = plot.left + plan_.x.place(tick.value) * plot.width();
      const double length = tick.label.empty() ? 0.6 * full : full;
      canvas_.line({x, plot.bottom}, {x, plot.bottom - length}, look_.palette.ink, look_.frame);
      if (plan_.x.bare) continue;
      TextStyle style = text(look_.tick_text, 0, 1);
      style.vertical = plan_.x.turned;
      canvas_.text({x, plot.bottom - full - gap}, tick.label, style);
    }
    for (const Tick& tick : plan_.y.ticks) {
      const double y = plot.bottom + plan_.y.place(tick.value) * plot.height();
      const double length = tick.label.empty() ? 0.6 * full : full;
      canvas_.line({plot.left, y}, {plot.left - length, y}, look_.palette.ink, look_.frame);
      if (!plan_.y.bare) canvas_.text({plot.left - full - gap, y}, tick.label, text(look_.tick_text, 1, 0));
    }
  }

  TextStyle text(double size, int across, int upward) const {
    return {.size = size, .colour = look_.palette.ink, .across = across, .upward = upward};
  }

  /// The middle of a plot's side, moved so that a text of this half length stays within the cell.
  static double centred(double from, double to, double half, double low, double high) {
    const double middle = 0.5 * (from + to);
    return 2.0 * half > high - low ? 0.5 * (low + high) : std::clamp(middle, low + half, high - half);
  }

  void titles() {
    const Box& plot = plan_.plot;
    const double x_size = fitting_size(meter_, plan_.x.title, look_.axis_text, plan_.cell.width());
    const double x_half = 0.5 * meter_.width(plan_.x.title, x_size, false);
    const double x_middle = centred(plot.left, plot.right, x_half, plan_.cell.left, plan_.cell.right);
    if (!plan_.x.bare) canvas_.text({x_middle, plan_.cell.bottom}, plan_.x.title, text(x_size, 0, -1));
    const double room = plan_.cell.height();
    const double y_size = fitting_size(meter_, plan_.y.title, look_.axis_text, room);
    const double half = 0.5 * meter_.width(plan_.y.title, y_size, false);
    const double middle = centred(plot.bottom, plot.top, half, plan_.cell.bottom, plan_.cell.top);
    TextStyle style = text(y_size, -1, 0);
    style.vertical = true;
    if (!plan_.y.bare) canvas_.text({y_title_left(), middle}, plan_.y.title, style);
    above();
  }

  /// In line with the titles of the column, but not far from its own labels where another panel's are long.
  double y_title_left() const {
    const double beside = plan_.plot.left - needed_margins(meter_, look_, plan_).left;
    return beside - plan_.cell.left < 2.0 * line_height(look_.axis_text) ? plan_.cell.left : beside;
  }

  /// Title, note and legend strip, from the plot's top upwards.
  void above() {
    double y = plan_.plot.top + look_.gap;
    if (plan_.legend.place == Legend::above) {
      y += strip_height(look_, plan_.legend.rows.size());
      draw_strip(canvas_, meter_, look_, plan_.legend.rows, plan_.plot.left, y - look_.gap);
    }
    canvas_.text({plan_.plot.right, y}, panel_.note, text(look_.legend_text, 1, -1));
    if (plan_.note_below) y += line_height(look_.legend_text);
    for (auto line = plan_.title.rbegin(); line != plan_.title.rend(); ++line) {
      TextStyle style = text(look_.title_text, -1, -1);
      style.bold = true;
      canvas_.text({plan_.plot.left, y}, *line, style);
      y += line_height(look_.title_text);
    }
  }

  Canvas& canvas_;
  TextMeter& meter_;
  const Look& look_;
  const PanelPlan& plan_;
  const Panel& panel_;
};

}  // namespace

void draw_panel(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan) {
  PanelPainter(canvas, meter, look, plan).paint();
}

}  // namespace lunid::figure
