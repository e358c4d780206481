#include <cmath>

#include "expr/digits.hpp"
#include "expr/error.hpp"
#include "figure/figure.hpp"

namespace lunid::figure {
namespace {

[[noreturn]] void fail(const std::string& place, const std::string& text) { throw InputError(place + ": " + text); }

std::string quoted(const std::string& label) { return label.empty() ? "without label" : "'" + label + "'"; }

void same_length(const std::string& place, const char* names, std::size_t a, std::size_t b) {
  if (a == b) return;
  fail(place,
       std::string(names) + ": expected the same length, got " + std::to_string(a) + " and " + std::to_string(b));
}

void increasing(const std::string& place, const char* name, const std::vector<double>& values) {
  if (values.empty()) fail(place, std::string(name) + ": expected at least one value, got none");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || (i > 0 && !(values[i] > values[i - 1])))
      fail(place, std::string(name) + ": expected finite values that increase, got something else at position " +
                      std::to_string(i + 1));
  }
}

void check_axis(const std::string& place, const char* name, const Axis& axis) {
  const std::string where = place + ": axis " + name;
  if (std::isinf(axis.min) || std::isinf(axis.max)) fail(where, "expected finite limits, got infinity");
  if (axis.min >= axis.max) fail(where, "expected min < max");
  if (!axis.names.empty() && axis.scale == Scale::log) fail(where, "expected a linear scale with names");
  if (axis.scale == Scale::log && (axis.min <= 0.0 || axis.max <= 0.0))
    fail(where, "expected limits > 0 on a logarithmic axis");
}

void check_size(const Size& size) {
  const auto inside = [](double value, double low, double high) { return value >= low && value <= high; };
  if (!inside(size.width_cm, 3.0, 100.0)) fail("figure", "size.width_cm: expected 3 to 100");
  if (size.height_cm != 0.0 && !inside(size.height_cm, 3.0, 100.0)) fail("figure", "size.height_cm: expected 3 to 100");
  if (!inside(size.dpi, 50.0, 600.0)) fail("figure", "size.dpi: expected 50 to 600, got " + number(size.dpi));
}

void check_map(const std::string& place, const HeatMap& map) {
  increasing(place + ": map", "x", map.x);
  increasing(place + ": map", "y", map.y);
  same_length(place + ": map", "columns of z and x", static_cast<std::size_t>(map.z.cols()), map.x.size());
  same_length(place + ": map", "rows of z and y", static_cast<std::size_t>(map.z.rows()), map.y.size());
  check_axis(place, "colour", map.colour);
}

void check_bars(const std::string& place, const Bars& bars) {
  if (bars.name.empty() || bars.set.empty()) fail(place + ": bars", "expected at least one name and one set, got none");
  for (const BarSet& set : bars.set) {
    const std::string where = place + ": bars " + quoted(set.label);
    same_length(where, "value and name", set.value.size(), bars.name.size());
    if (!set.error.empty()) same_length(where, "error and name", set.error.size(), bars.name.size());
  }
}

void check_scene(const std::string& place, const Panel& panel) {
  const Scene& scene = *panel.scene;
  const std::string where = place + ": surface";
  if (!panel.series.empty() || panel.map || panel.bars) fail(where, "expected nothing else in its panel");
  increasing(where, "grid_x", scene.grid_x);
  increasing(where, "grid_y", scene.grid_y);
  if (scene.grid_x.size() < 2 || scene.grid_y.size() < 2) fail(where, "expected at least 2 by 2 grid points");
  same_length(where, "columns and grid_x", static_cast<std::size_t>(scene.surface.cols()), scene.grid_x.size());
  same_length(where, "rows and grid_y", static_cast<std::size_t>(scene.surface.rows()), scene.grid_y.size());
  for (const auto& [name, axis] : {std::pair{"x", &scene.x}, {"y", &scene.y}, {"z", &scene.z}}) {
    check_axis(where, name, *axis);
    if (axis->scale == Scale::log) fail(where, std::string("axis ") + name + ": expected a linear scale");
  }
  for (const Cloud& cloud : scene.clouds) {
    same_length(where + ": points " + quoted(cloud.label), "x and y", cloud.x.size(), cloud.y.size());
    same_length(where + ": points " + quoted(cloud.label), "x and z", cloud.x.size(), cloud.z.size());
  }
}

void check_panel(const std::string& place, const Panel& panel) {
  if (panel.scene) return check_scene(place, panel);
  if (panel.series.empty() && panel.ribbons.empty() && !panel.map && !panel.bars)
    fail(place, "expected a curve, a map or bars, got nothing to draw");
  if (panel.map && panel.bars) fail(place, "expected a map or bars, got both");
  check_axis(place, "x", panel.x);
  check_axis(place, "y", panel.y);
  for (const Series& s : panel.series) {
    same_length(place + ": curve " + quoted(s.label), "x and y", s.x.size(), s.y.size());
    if (!s.colour.empty())
      same_length(place + ": curve " + quoted(s.label), "x and colour", s.x.size(), s.colour.size());
  }
  for (const Ribbon& r : panel.ribbons) {
    same_length(place + ": ribbon " + quoted(r.label), "x and low", r.x.size(), r.low.size());
    same_length(place + ": ribbon " + quoted(r.label), "x and high", r.x.size(), r.high.size());
  }
  if (panel.map) check_map(place, *panel.map);
  if (panel.bars) check_bars(place, *panel.bars);
}

}  // namespace

void validate(const Figure& figure) {
  check_size(figure.size);
  if (figure.columns < 1 || figure.columns > 12)
    fail("figure", "columns: expected 1 to 12, got " + std::to_string(figure.columns));
  if (figure.panels.empty()) fail("figure", "panels: expected at least one, got none");
  for (std::size_t i = 0; i < figure.panels.size(); ++i)
    check_panel("figure: panel " + std::to_string(i + 1), figure.panels[i]);
}

const Scene& scene_of(const Figure& figure) {
  for (const Panel& panel : figure.panels)
    if (panel.scene) return *panel.scene;
  throw InputError("the figure has no surface: only its numbers can be written, as .csv");
}

}  // namespace lunid::figure
