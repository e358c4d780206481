#include "figure/surface_view.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lunid::figure {
namespace {

constexpr double pi = 3.14159265358979323846;

void widen(Range& range, const std::vector<double>& values) {
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    range.low = std::min(range.low, v);
    range.high = std::max(range.high, v);
  }
}

/// The axis's limits where it has them, else the data's range, widened by `share`.
Range finish(Range range, const Axis& axis, double share) {
  if (!(range.low <= range.high)) range = {0.0, 1.0};
  const double room =
      range.high > range.low ? share * (range.high - range.low) : std::max(1e-12, 0.1 * std::abs(range.low));
  range = {range.low - room, range.high + room};
  if (std::isfinite(axis.min)) range.low = axis.min;
  if (std::isfinite(axis.max)) range.high = axis.max;
  if (!(range.high > range.low)) range.high = range.low + 1.0;
  return range;
}

constexpr Range nothing{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

Range surface_range(const SurfaceFigure& figure) {
  Range range = nothing;
  widen(range, {figure.surface.data(), figure.surface.data() + figure.surface.size()});
  return range;
}

void plan_axes(SurfaceView& view, const SurfaceFigure& figure) {
  Range x = nothing, y = nothing, z = surface_range(figure);
  widen(x, figure.grid_x);
  widen(y, figure.grid_y);
  for (const Cloud& cloud : figure.clouds) {
    widen(x, cloud.x);
    widen(y, cloud.y);
    widen(z, cloud.z);
  }
  view.x = plan_axis(figure.x, finish(x, figure.x, 0.0), 5);
  view.y = plan_axis(figure.y, finish(y, figure.y, 0.0), 5);
  view.z = plan_axis(figure.z, finish(z, figure.z, 0.03), 5);
  Range colours = finish(surface_range(figure), Axis{}, 0.0);
  if (figure.diverging) {
    const double reach = std::max(std::abs(colours.low), std::abs(colours.high));
    colours = {-reach, reach};
  }
  view.colour = plan_axis(figure.z, colours, 5);
}

void set_directions(SurfaceView& view, const SurfaceFigure& figure) {
  const double a = figure.azimuth * pi / 180.0, e = std::clamp(figure.elevation, 5.0, 85.0) * pi / 180.0;
  view.toward = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  view.right = {-std::sin(a), std::cos(a), 0.0};
  view.up = {-std::sin(e) * std::cos(a), -std::sin(e) * std::sin(a), std::cos(e)};
}

/// The largest box whose outline fits `room`.
void fit(SurfaceView& view, const Box& room) {
  view.scale = 1.0;
  view.centre = {0.0, 0.0};
  double half_width = 0.0, half_height = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    Vector p = view.size;
    for (int k = 0; k < 3; ++k) p[static_cast<std::size_t>(k)] *= corner >> k & 1 ? 0.5 : -0.5;
    const Point q = view.on_paper(p);
    half_width = std::max(half_width, std::abs(q.x));
    half_height = std::max(half_height, std::abs(q.y));
  }
  if (room.width() < 40.0 || room.height() < 40.0)
    throw std::invalid_argument("the figure is too small for its surface: raise size.width_cm or size.height_cm");
  view.scale = std::min(room.width() / (2.0 * half_width), room.height() / (2.0 * half_height));
  view.centre = {0.5 * (room.left + room.right), 0.5 * (room.bottom + room.top)};
}

}  // namespace

Vector SurfaceView::in_box(double x_value, double y_value, double z_value) const {
  return {(x.place(x_value) - 0.5) * size[0], (y.place(y_value) - 0.5) * size[1], (z.place(z_value) - 0.5) * size[2]};
}

bool SurfaceView::holds(double x_value, double y_value, double z_value) const {
  const auto inside = [](double share) { return share >= -1e-9 && share <= 1.0 + 1e-9; };
  return inside(x.place(x_value)) && inside(y.place(y_value)) && inside(z.place(z_value));
}

Point SurfaceView::on_paper(const Vector& p) const {
  const auto dot = [&](const Vector& d) { return p[0] * d[0] + p[1] * d[1] + p[2] * d[2]; };
  return {centre.x + scale * dot(right), centre.y + scale * dot(up)};
}

namespace {

Point surface_extent(const SurfaceFigure& figure) {
  const double per_cm = 72.0 / 2.54;
  const double height = figure.size.height_cm > 0.0 ? figure.size.height_cm : 0.75 * figure.size.width_cm;
  return {figure.size.width_cm * per_cm, height * per_cm};
}

}  // namespace

SurfaceView plan_surface(TextMeter& meter, const Look& look, const SurfaceFigure& figure) {
  SurfaceView view;
  view.extent = surface_extent(figure);
  plan_axes(view, figure);
  set_directions(view, figure);
  const double width = view.extent.x - 2.0 * look.margin;
  view.heading = wrapped(meter, figure.title, look.heading_text, true, width);
  std::vector<LegendEntry> entries;
  for (const Cloud& cloud : figure.clouds)
    if (!cloud.label.empty()) entries.push_back({cloud.label, Swatch::curve, Style::points, cloud.role, 1.0});
  view.legend = legend_rows(meter, look, entries, width);
  const double header = static_cast<double>(view.heading.size()) * line_height(look.heading_text) +
                        strip_height(look, view.legend.size()) + look.gap;
  // Left: labels of z; right: the colour bar; below: labels of x and y.
  fit(view, {62.0, 52.0, view.extent.x - 84.0, view.extent.y - look.margin - header - 6.0});
  return view;
}

}  // namespace lunid::figure
