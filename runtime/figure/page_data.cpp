// A figure as JSON for a browser: plain data, with the axes, prefixes and colours of the drawn one. Long curves are
// thinned as on paper, but for a page that can be enlarged.
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "figure/colours.hpp"
#include "figure/figure.hpp"
#include "figure/panel_plan.hpp"

namespace lunid::figure {
namespace {

using nlohmann::json;

constexpr std::size_t long_series = 20000;  // points: a browser draws as many without delay
constexpr double page = 1000.0;             // points on which long series are thinned
constexpr std::size_t scene_lines = 120;

/// Six digits are more than a screen shows; what is not finite is null, a break.
json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 6).ptr;
  double rounded = 0.0;
  std::from_chars(buffer, end, rounded);
  return rounded;
}

template <class List>
json numbers(const List& values) {
  json list = json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

std::string hex(Colour c) {
  constexpr const char* digits = "0123456789abcdef";
  std::string text = "#";
  for (const unsigned char part : {c.red, c.green, c.blue}) {
    text += digits[part >> 4];
    text += digits[part & 15];
  }
  return text;
}

const char* style_name(Style style) {
  switch (style) {
    case Style::line: return "line";
    case Style::dashed: return "dashed";
    case Style::dotted: return "dotted";
    case Style::dash_dot: return "dash_dot";
    case Style::points: return "points";
    case Style::line_points: return "line_points";
    case Style::stems: return "stems";
    case Style::columns: return "columns";
  }
  return "line";
}

json axis_of(const Axis& axis, const Range& range) {
  const AxisPlan plan = plan_axis(axis, range, 5);
  json out{{"title", typeset(plan.title)}, {"factor", plan.factor}, {"min", range.low}, {"max", range.high}};
  if (axis.scale == Scale::log) out["log"] = true;
  for (const std::string& name : axis.names) out["names"].push_back(typeset(name));
  return out;
}

json palette_of(bool diverging) {
  json list = json::array();
  for (int i = 0; i <= 32; ++i) list.push_back(hex(map_colour(i / 32.0, diverging)));
  return list;
}

json colours_of(const Axis& axis, const Range& range, bool diverging) {
  json out = axis_of(axis, range);
  out["palette"] = palette_of(diverging);
  return out;
}

class PanelPage {
 public:
  PanelPage(const Panel& panel, Theme theme) : panel_(panel), theme_(theme) {}

  json make() {
    const std::string note = panel_.note.empty() ? nothing_to_show(panel_) : panel_.note;
    out_ = {{"title", typeset(panel_.title)}, {"note", typeset(note)}, {"span", panel_.column_span}};
    if (panel_.scene) {
      add_scene(*panel_.scene);
      return out_;
    }
    plan_.panel = &panel_;
    plan_.plot = {0.0, 0.0, page, page};
    plan_.x_reach = x_range(panel_);
    plan_.y_reach = y_range(panel_, plan_.x_reach);
    plan_.x = plan_axis(panel_.x, plan_.x_reach, 5);
    plan_.y = plan_axis(panel_.y, plan_.y_reach, 5);
    out_["x"] = axis_of(panel_.x, plan_.x_reach);
    out_["y"] = panel_.bars
                    ? json{{"title", panel_.y.name}, {"factor", 1}, {"min", 0}, {"max", panel_.bars->name.size()}}
                    : axis_of(panel_.y, plan_.y_reach);
    if (const Axis* colour = colour_axis(panel_))
      out_["colour"] = colours_of(*colour, colour_range(panel_), diverging_colours(panel_));
    for (const Series& s : panel_.series) add(s);
    add_areas();
    if (panel_.map) add_map(*panel_.map);
    if (panel_.bars) add_bars(*panel_.bars);
    return out_;
  }

 private:
  std::string colour(Role role) const { return hex(role_colour(role, theme_)); }

  double value(const AxisPlan& axis, double share) const {
    if (axis.scale == Scale::log) return axis.range.low * std::pow(axis.range.high / axis.range.low, share);
    return axis.range.low + share * (axis.range.high - axis.range.low);
  }

  void add(const Series& s) {
    json out{
        {"label", typeset(s.label)}, {"style", style_name(s.style)}, {"colour", colour(s.role)}, {"width", s.width}};
    if (s.x.size() <= long_series || !s.colour.empty()) {
      out["x"] = numbers(s.x);
      out["y"] = numbers(s.y);
      if (!s.colour.empty()) out["c"] = numbers(s.colour);
    } else {
      thin_out(s, out);
    }
    out_["series"].push_back(std::move(out));
  }

  void thin_out(const Series& s, json& out) const {
    std::vector<Stroke> strokes;
    if (s.style == Style::points)
      strokes.push_back(series_points(plan_, s, 1.0));
    else
      strokes = series_strokes(plan_, s.x, s.y);
    for (const Stroke& stroke : strokes) {
      for (const Point& p : stroke) {
        out["x"].push_back(number(value(plan_.x, p.x / page)));
        out["y"].push_back(number(value(plan_.y, p.y / page)));
      }
      out["x"].push_back(nullptr);
      out["y"].push_back(nullptr);
    }
    out["thinned"] = s.x.size();
  }

  void add_areas() {
    for (const Ribbon& r : panel_.ribbons)
      out_["ribbons"].push_back({{"label", typeset(r.label)},
                                 {"colour", colour(r.role)},
                                 {"x", numbers(r.x)},
                                 {"low", numbers(r.low)},
                                 {"high", numbers(r.high)}});
    for (const Band& b : panel_.bands)
      out_["bands"].push_back(
          {{"label", typeset(b.label)}, {"colour", colour(b.role)}, {"from", number(b.from)}, {"to", number(b.to)}});
    for (const ReferenceLine& l : panel_.lines)
      out_["lines"].push_back({{"label", typeset(l.label)},
                               {"colour", colour(l.role)},
                               {"style", style_name(l.style)},
                               {"value", number(l.value)},
                               {"vertical", l.vertical}});
  }

  void add_map(const HeatMap& map) {
    json rows = json::array();
    for (Eigen::Index r = 0; r < map.z.rows(); ++r) rows.push_back(numbers(Eigen::VectorXd(map.z.row(r))));
    out_["map"] = {{"x", numbers(cell_edges(map.x))}, {"y", numbers(cell_edges(map.y))}, {"z", rows}};
    out_["map"]["missing"] = typeset(map.missing);
    if (map.numbers) out_["map"]["numbers"] = true;
    if (!map.contours) return;
    for (const Tick& tick : plan_axis(map.colour, colour_range(panel_), 6).ticks)
      for (const Stroke& line : contour(map, tick.value)) {
        json out{{"label", ""}, {"style", "line"}, {"colour", "#141414"}, {"width", 0.5}};
        for (const Point& p : line) {
          out["x"].push_back(number(p.x));
          out["y"].push_back(number(p.y));
        }
        out_["series"].push_back(std::move(out));
      }
  }

  void add_bars(const Bars& bars) {
    json out{{"names", json::array()}, {"sets", json::array()}};
    for (const std::string& name : bars.name) out["names"].push_back(typeset(name));
    for (const BarSet& set : bars.set)
      out["sets"].push_back({{"label", typeset(set.label)},
                             {"colour", colour(set.role)},
                             {"value", numbers(set.value)},
                             {"error", numbers(set.error)}});
    out_["bars"] = std::move(out);
  }

  void add_scene(const Scene& scene) {
    std::vector<Eigen::Index> rows = thinned(scene.grid_y.size()), columns = thinned(scene.grid_x.size());
    const Eigen::MatrixXd grid = scene.surface(rows, columns);
    json z = json::array(), x = json::array(), y = json::array(), clouds = json::array();
    for (Eigen::Index r = 0; r < grid.rows(); ++r) z.push_back(numbers(Eigen::VectorXd(grid.row(r))));
    for (const Eigen::Index c : columns) x.push_back(number(scene.grid_x[static_cast<std::size_t>(c)]));
    for (const Eigen::Index r : rows) y.push_back(number(scene.grid_y[static_cast<std::size_t>(r)]));
    const SceneView view = scene_axes(scene);
    for (const Cloud& cloud : scene.clouds)
      clouds.push_back({{"label", typeset(cloud.label)},
                        {"colour", colour(cloud.role)},
                        {"x", numbers(cloud.x)},
                        {"y", numbers(cloud.y)},
                        {"z", numbers(cloud.z)}});
    out_["scene"] = {
        {"axes", {axis_of(scene.x, view.x.range), axis_of(scene.y, view.y.range), axis_of(scene.z, view.z.range)}},
        {"x", x},
        {"y", y},
        {"z", z},
        {"clouds", clouds},
        {"low", view.colour.low},
        {"high", view.colour.high},
        {"palette", palette_of(scene.diverging)},
        {"azimuth", scene.azimuth},
        {"elevation", scene.elevation}};
  }

  static std::vector<Eigen::Index> thinned(std::size_t n) {
    std::vector<Eigen::Index> kept;
    const std::size_t step = std::max<std::size_t>(1, (n + scene_lines - 1) / scene_lines);
    for (std::size_t i = 0; i + 1 < n; i += step) kept.push_back(static_cast<Eigen::Index>(i));
    kept.push_back(static_cast<Eigen::Index>(n) - 1);
    return kept;
  }

  const Panel& panel_;
  Theme theme_;
  PanelPlan plan_;
  json out_;
};

}  // namespace

std::string page_data(const Figure& figure) {
  validate(figure);
  const Palette paper = palette(figure.theme);
  json out{{"title", typeset(figure.title)}, {"columns", figure.columns}, {"paper", hex(paper.background)},
           {"ink", hex(paper.ink)},          {"faint", hex(paper.faint)}, {"no_data", hex(paper.no_data)},
           {"hatch", hex(paper.hatch)}};
  for (const Panel& panel : figure.panels) out["panels"].push_back(PanelPage(panel, figure.theme).make());
  return out.dump();
}

}  // namespace lunid::figure
