#include "figure/scene_view.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

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

Range surface_range(const Scene& scene) {
  Range range = nothing;
  widen(range, {scene.surface.data(), scene.surface.data() + scene.surface.size()});
  return range;
}

void plan_axes(SceneView& view, const Scene& scene) {
  Range x = nothing, y = nothing, z = surface_range(scene);
  widen(x, scene.grid_x);
  widen(y, scene.grid_y);
  for (const Cloud& cloud : scene.clouds) {
    widen(x, cloud.x);
    widen(y, cloud.y);
    widen(z, cloud.z);
  }
  view.x = plan_axis(scene.x, finish(x, scene.x, 0.0), 5);
  view.y = plan_axis(scene.y, finish(y, scene.y, 0.0), 5);
  view.z = plan_axis(scene.z, finish(z, scene.z, 0.03), 5);
  view.colour = finish(surface_range(scene), Axis{}, 0.0);
  if (scene.diverging) {
    const double reach = std::max(std::abs(view.colour.low), std::abs(view.colour.high));
    view.colour = {-reach, reach};
  }
}

void set_directions(SceneView& view, const Scene& scene) {
  const double a = scene.azimuth * pi / 180.0, e = std::clamp(scene.elevation, 5.0, 85.0) * pi / 180.0;
  view.toward = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  view.right = {-std::sin(a), std::cos(a), 0.0};
  view.up = {-std::sin(e) * std::cos(a), -std::sin(e) * std::sin(a), std::cos(e)};
}

/// The largest box whose outline fits `room`.
void fit(SceneView& view, const Box& room) {
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

Vector SceneView::in_box(double x_value, double y_value, double z_value) const {
  return {(x.place(x_value) - 0.5) * size[0], (y.place(y_value) - 0.5) * size[1], (z.place(z_value) - 0.5) * size[2]};
}

bool SceneView::holds(double x_value, double y_value, double z_value) const {
  const auto inside = [](double share) { return share >= -1e-9 && share <= 1.0 + 1e-9; };
  return inside(x.place(x_value)) && inside(y.place(y_value)) && inside(z.place(z_value));
}

Point SceneView::on_paper(const Vector& p) const {
  const auto dot = [&](const Vector& d) { return p[0] * d[0] + p[1] * d[1] + p[2] * d[2]; };
  return {centre.x + scale * dot(right), centre.y + scale * dot(up)};
}

namespace {

/// Room for the labels of a horizontal axis whose edge is seen from the side, on the right. Its title goes below.
double right_side(TextMeter& meter, const Look& look, const SceneView& view) {
  double room = 0.0;
  for (const auto& [axis, across] : {std::pair{&view.x, 1u}, {&view.y, 0u}}) {
    const double sign = view.toward[across] >= 0.0 ? 1.0 : -1.0;  // the edge is on the viewer's side
    const double x = sign * view.right[across], y = sign * view.up[across];
    if (x < 0.8 * std::hypot(x, y)) continue;
    double widest = 0.0;
    for (const Tick& tick : axis->ticks) widest = std::max(widest, meter.width(tick.label, look.tick_text, false));
    room = std::max(room, look.tick_length + 8.0 + widest);
  }
  return room;
}

}  // namespace

Look scene_look(const Look& look, const Box& room) {
  Look small = look;
  const double scale = std::clamp(room.width() / 320.0, 0.68, 1.0);
  for (double* size : {&small.tick_text, &small.axis_text}) *size *= scale;
  return small;
}

SceneView scene_axes(const Scene& scene) {
  SceneView view;
  plan_axes(view, scene);
  return view;
}

SceneView plan_scene(TextMeter& meter, const Look& page, const Scene& scene, const Box& room) {
  const Look look = scene_look(page, room);
  SceneView view = scene_axes(scene);
  view.room = room;
  set_directions(view, scene);
  const auto fit_labels = [&] {
    double widest = 0.0;
    for (const Tick& tick : view.z.ticks) widest = std::max(widest, meter.width(tick.label, look.tick_text, false));
    // Left: labels and title of z; below: labels and titles of x and y; right: the same where they stick out.
    const double left = widest + line_height(look.axis_text) + look.tick_length + 4.0,
                 below = 3.4 * look.axis_text + 7.0;
    fit(view, {room.left + left, room.bottom + below,
               room.right - std::max(right_side(meter, look, view), 2.2 * look.tick_text), room.top - look.gap});
  };
  fit_labels();
  // As many ticks as the edges have room for, now that their lengths are known.
  for (const auto& [axis, plan, k] :
       {std::tuple{&scene.x, &view.x, 0u}, {&scene.y, &view.y, 1u}, {&scene.z, &view.z, 2u}}) {
    const double length = view.scale * view.size[k] * std::hypot(view.right[k], view.up[k]);
    *plan = plan_axis(*axis, plan->range, std::clamp(static_cast<int>(length / (3.5 * look.tick_text)), 1, 5));
  }
  fit_labels();
  return view;
}

}  // namespace lunid::figure
