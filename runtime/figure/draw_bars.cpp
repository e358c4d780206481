#include <algorithm>
#include <cmath>

#include "figure/draw.hpp"

namespace lunid::figure {
namespace {

/// The part of a name's row that bars fill; the rest keeps rows apart.
constexpr double filled = 0.72;

class BarPainter {
 public:
  BarPainter(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan)
      : canvas_(canvas),
        meter_(meter),
        look_(look),
        plan_(plan),
        bars_(*plan.panel->bars),
        thickness_(filled / static_cast<double>(std::max<std::size_t>(1, bars_.set.size()))) {}

  void paint() {
    for (std::size_t i = 0; i < bars_.name.size(); ++i) {
      const double centre = static_cast<double>(bars_.name.size() - i) - 0.5;
      canvas_.text({plan_.plot.left - 1.5 * look_.gap, plan_.at(0.0, centre).y},
                   shortened(meter_, bars_.name[i], look_.tick_text, false, plan_.names + 1.0),
                   {.size = look_.tick_text, .colour = look_.palette.ink, .across = 1, .upward = 0});
      for (std::size_t j = 0; j < bars_.set.size(); ++j)
        bar(bars_.set[j], i, centre + 0.5 * filled - thickness_ * (static_cast<double>(j) + 0.5));
    }
  }

 private:
  double at(double value) const {
    const bool below = plan_.x.scale == Scale::log && !(value > 0.0);
    return below ? plan_.plot.left : std::clamp(plan_.at(value, 0.0).x, plan_.plot.left, plan_.plot.right);
  }

  void bar(const BarSet& set, std::size_t i, double row) {
    const double value = set.value[i];
    if (std::isnan(value)) return;
    const double from = at(plan_.x.scale == Scale::log ? plan_.x.range.low : 0.0), to = at(value);
    const double half = 0.46 * thickness_;
    const double bottom = plan_.at(0.0, row - half).y, top = plan_.at(0.0, row + half).y;
    canvas_.rectangle({std::min(from, to), bottom, std::max(from, to), top}, role_colour(set.role, look_.theme));
    double beyond = to, short_of = to;
    if (!set.error.empty() && std::isfinite(set.error[i])) {
      const double low = at(value - set.error[i]), high = at(value + set.error[i]), y = 0.5 * (bottom + top);
      canvas_.line({low, y}, {high, y}, look_.palette.ink, look_.frame);
      for (const double x : {low, high}) canvas_.line({x, y - 2.5}, {x, y + 2.5}, look_.palette.ink, look_.frame);
      beyond = value < 0.0 ? low : high;
      short_of = value < 0.0 ? high : low;
    }
    number(value, {from, short_of, beyond}, 0.5 * (bottom + top), std::min(look_.tick_text, 1.1 * (top - bottom)));
  }

  /// Where a bar begins, and where its whisker begins and ends.
  struct Ends {
    double root, short_of, beyond;
  };

  /// Beyond the bar's end, or within the bar where the plot ends first.
  void number(double value, const Ends& bar, double y, double size) {
    const std::string text = few_digits(value / plan_.x.factor, 3);
    const double width = meter_.width(text, size, false) + 2.0 * look_.gap;
    int side = value < 0.0 ? 1 : -1;
    const bool leaves = side > 0 ? bar.beyond - width < plan_.plot.left : bar.beyond + width > plan_.plot.right;
    const bool within = leaves && std::abs(bar.short_of - bar.root) > width;
    if (within) side = -side;
    const double end = within ? bar.short_of : bar.beyond;
    // On paper of its own: a line across the panel would cross it out.
    const double near = end - 0.5 * side * look_.gap, far = end - side * (width - 0.5 * look_.gap);
    if (!within)
      canvas_.rectangle({std::min(near, far), y - 0.5 * size, std::max(near, far), y + 0.5 * size},
                        look_.palette.background);
    canvas_.text(
        {end - side * look_.gap, y}, text,
        {.size = size, .colour = within ? Colour{255, 255, 255} : look_.palette.ink, .across = side, .upward = 0});
  }

  Canvas& canvas_;
  TextMeter& meter_;
  const Look& look_;
  const PanelPlan& plan_;
  const Bars& bars_;
  double thickness_;
};

}  // namespace

void draw_bars(Canvas& canvas, TextMeter& meter, const Look& look, const PanelPlan& plan) {
  BarPainter(canvas, meter, look, plan).paint();
}

}  // namespace lunid::figure
