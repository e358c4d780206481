// The axes of a scene.
#include <algorithm>
#include <cmath>

#include "figure/draw.hpp"
#include "figure/scene_view.hpp"

namespace lunid::figure {
namespace {

/// An edge of the box that carries an axis: along coordinate `along`, the others fixed at `from`.
struct Edge {
  std::size_t along = 0;
  Vector from{};
  Point outward;  ///< unit vector on paper, away from the box
};

class AxesPainter {
 public:
  AxesPainter(Canvas& canvas, TextMeter& meter, const Look& look, const SceneView& view)
      : canvas_(canvas), meter_(meter), look_(look), view_(view) {}

  void paint() {
    walls();
    const double near_x = near(0), near_y = near(1), floor = -0.5 * view_.size[2];
    // Of the two upright edges of the outline, the one on the left.
    const Vector a{near_x, -near_y, 0.0}, b{-near_x, near_y, 0.0};
    axis(view_.z, {2, view_.on_paper(a).x < view_.on_paper(b).x ? a : b, {-1.0, 0.0}});
    axis(view_.x, {0, {0.0, near_y, floor}, outward({0.0, near_y, 0.0})});
    axis(view_.y, {1, {near_x, 0.0, floor}, outward({near_x, 0.0, 0.0})});
  }

 private:
  /// The side of the box, of a horizontal coordinate, on which the viewer stands.
  double near(std::size_t k) const { return (view_.toward[k] >= 0.0 ? 0.5 : -0.5) * view_.size[k]; }

  Point outward(const Vector& direction) const {
    const Point p = view_.on_paper(direction);
    const double x = p.x - view_.centre.x, y = p.y - view_.centre.y, length = std::hypot(x, y);
    return length > 0.0 ? Point{x / length, y / length} : Point{0.0, -1.0};
  }

  void line(const Vector& a, const Vector& b, Colour colour, double width) {
    canvas_.line(view_.on_paper(a), view_.on_paper(b), colour, width);
  }

  double coordinate(const AxisPlan& axis, std::size_t k, double value) const {
    return (axis.place(value) - 0.5) * view_.size[k];
  }

  /// The floor and the two far walls, with the grid of the ticks.
  void walls() {
    const Vector far{-near(0), -near(1), -0.5 * view_.size[2]};
    const AxisPlan* axes[] = {&view_.x, &view_.y, &view_.z};
    for (std::size_t flat = 0; flat < 3; ++flat) {
      const std::size_t u = (flat + 1) % 3, v = (flat + 2) % 3;
      for (const auto& [run, across] : {std::pair{u, v}, {v, u}}) {
        const auto draw = [&, run = run, across = across](double at, Colour colour, double width) {
          Vector a = far, b = far;
          a[across] = b[across] = at;
          a[run] = -0.5 * view_.size[run];
          b[run] = 0.5 * view_.size[run];
          line(a, b, colour, width);
        };
        for (const Tick& tick : axes[across]->ticks)
          draw(coordinate(*axes[across], across, tick.value), look_.palette.faint, 0.6);
        for (const double side : {-0.5, 0.5}) draw(side * view_.size[across], look_.palette.hatch, look_.frame);
      }
    }
  }

  /// The distance at which a text's box clears a point along `outward`.
  double clearance(const std::string& text, double size, Point outward) {
    return 0.5 * (std::abs(outward.x) * meter_.width(text, size, false) + std::abs(outward.y) * 1.1 * size);
  }

  void axis(const AxisPlan& plan, const Edge& edge) {
    Vector a = edge.from, b = edge.from;
    a[edge.along] = -0.5 * view_.size[edge.along];
    b[edge.along] = 0.5 * view_.size[edge.along];
    line(a, b, look_.palette.ink, look_.frame);
    double reach = 0.0;
    for (const Tick& tick : plan.ticks) {
      Vector at = edge.from;
      at[edge.along] = coordinate(plan, edge.along, tick.value);
      const Point p = view_.on_paper(at);
      const Point end{p.x + look_.tick_length * edge.outward.x, p.y + look_.tick_length * edge.outward.y};
      canvas_.line(p, end, look_.palette.ink, look_.frame);
      const double away = 3.0 + clearance(tick.label, look_.tick_text, edge.outward);
      label({end.x + away * edge.outward.x, end.y + away * edge.outward.y}, tick.label);
      reach = std::max(reach, look_.tick_length + 3.0 + 2.0 * clearance(tick.label, look_.tick_text, edge.outward));
    }
    title(plan, edge, reach);
  }

  /// Whether nothing is written in a box yet.
  bool is_free(const Box& box) const {
    return std::none_of(written_.begin(), written_.end(), [&](const Box& b) {
      return box.left < b.right && b.left < box.right && box.bottom < b.top && b.bottom < box.top;
    });
  }

  /// The label of a tick; where another stands, such as that of the next axis at their common corner, a little higher
  /// or lower.
  void label(Point at, const std::string& text) {
    const double half = 0.5 * meter_.width(text, look_.tick_text, false), size = look_.tick_text;
    for (const double lift : {0.0, 0.5, -0.5, 1.0, -1.0}) {
      const double y = at.y + lift * size;
      const Box box{at.x - half, y - 0.6 * size, at.x + half, y + 0.6 * size};
      if (!is_free(box)) continue;
      written_.push_back(box);
      return canvas_.text({at.x, y}, text, centred(size));
    }
  }

  void title(const AxisPlan& plan, const Edge& edge, double reach) {
    Vector middle = edge.from;
    middle[edge.along] = 0.0;
    const Point p = view_.on_paper(middle);
    if (edge.along == 2) return upright_title(plan, p, reach);
    const TextStyle style = centred(look_.axis_text);
    const double away = reach + 2.0 + clearance(plan.title, look_.axis_text, edge.outward);
    const double half = 0.5 * meter_.width(plan.title, look_.axis_text, false);
    const double x = std::clamp(p.x + away * edge.outward.x, std::min(view_.room.left + half, view_.room.right - half),
                                std::max(view_.room.left + half, view_.room.right - half));
    // Pushed back from the end of the room it may run into labels, on the far left into the title of z: it goes below.
    const double size = look_.axis_text, lowest = view_.room.bottom + 0.5 * size;
    double y = std::max(p.y + away * edge.outward.y, lowest);
    while (y > lowest && !is_free({x - half, y - 0.6 * size, x + half, y + 0.6 * size}))
      y = std::max(y - 0.5 * size, lowest);
    written_.push_back({x - half, y - 0.6 * size, x + half, y + 0.6 * size});
    canvas_.text({x, y}, plan.title, style);
  }

  /// The title of z: above the lower end of its edge, where labels of the other axes are.
  void upright_title(const AxisPlan& plan, Point middle, double reach) {
    const double half_edge = 0.5 * view_.size[2] * view_.scale * view_.up[2];
    const double floor = view_.room.bottom + 1.2 * look_.axis_text;  // below it are the titles of the other axes
    TextStyle style = centred(fitting_size(meter_, plan.title, look_.axis_text, view_.room.top - floor));
    style.vertical = true;
    const double half = 0.5 * meter_.width(plan.title, style.size, false);
    const double lowest = std::max(middle.y - half_edge + look_.tick_text, floor) + half;
    const double y = std::min(std::max(middle.y, lowest), std::max(view_.room.top - half, floor + half));
    const double x = middle.x - reach - 0.9 * look_.axis_text;
    written_.push_back({x - 0.6 * style.size, y - half, x + 0.6 * style.size, y + half});
    canvas_.text({x, y}, plan.title, style);
  }

  TextStyle centred(double size) const { return {.size = size, .colour = look_.palette.ink, .across = 0, .upward = 0}; }

  Canvas& canvas_;
  TextMeter& meter_;
  Look look_;
  const SceneView& view_;
  std::vector<Box> written_;  ///< room of the texts so far
};

}  // namespace

void draw_scene_axes(Canvas& canvas, TextMeter& meter, const Look& look, const SceneView& view) {
  AxesPainter(canvas, meter, scene_look(look, view.room), view).paint();
}

}  // namespace lunid::figure
