// The ranges that axes cover.
#include <algorithm>
#include <cmath>

#include "figure/panel_plan.hpp"

namespace lunid::figure {
namespace {

bool shows(const Axis& axis, double value) {
  return std::isfinite(value) && (axis.scale == Scale::linear || value > 0.0);
}

/// Smallest range over finite values that the axis can show.
class Span {
 public:
  explicit Span(const Axis& axis) : axis_(axis) {}

  void take(double value) {
    if (!shows(axis_, value)) return;
    low_ = empty_ ? value : std::min(low_, value);
    high_ = empty_ ? value : std::max(high_, value);
    empty_ = false;
  }

  /// With the axis's own limits, else widened by `share` of its length at each end.
  Range range(double share) const {
    if (!axis_.names.empty()) return {0.5, static_cast<double>(axis_.names.size()) + 0.5};
    Range r = empty_ ? Range{axis_.scale == Scale::log ? 1.0 : 0.0, axis_.scale == Scale::log ? 10.0 : 1.0}
                     : Range{low_, high_};
    if (axis_.scale == Scale::log) {
      const double factor = r.high > r.low ? std::pow(r.high / r.low, share) : 3.0;
      r = {r.low / factor, r.high * factor};
    } else {
      const bool flat = !(r.high - r.low > 1e-12 * std::max(std::abs(r.low), std::abs(r.high)));
      const double flat_room = r.low == 0.0 ? 1.0 : 0.1 * std::abs(r.low);
      const double room = flat ? flat_room : share * (r.high - r.low);
      r = {r.low - room, r.high + room};
    }
    return limited(r);
  }

 private:
  Range limited(Range r) const {
    const bool log = axis_.scale == Scale::log;
    if (std::isfinite(axis_.min)) r.low = axis_.min;
    if (std::isfinite(axis_.max)) r.high = axis_.max;
    // One limit given, and all data beyond it.
    if (!(r.high > r.low)) {
      const double length = log ? 1.0 : std::max(1.0, std::abs(r.low));
      if (std::isfinite(axis_.min))
        r.high = log ? 10.0 * r.low : r.low + length;
      else
        r.low = log ? r.high / 10.0 : r.high - length;
    }
    return r;
  }

  const Axis& axis_;
  double low_ = 0.0;
  double high_ = 0.0;
  bool empty_ = true;
};

/// Curves that run from left to right may touch the frame; clouds and loops may not.
bool needs_room(const Series& s) {
  return has_points(s.style) || (s.style != Style::columns && !std::is_sorted(s.x.begin(), s.x.end()));
}

void take_bars(const Bars& bars, Span& span) {
  span.take(0.0);
  for (const BarSet& set : bars.set) {
    for (std::size_t i = 0; i < set.value.size(); ++i) {
      const double error = set.error.empty() || !std::isfinite(set.error[i]) ? 0.0 : set.error[i];
      span.take(set.value[i] - error);
      span.take(set.value[i] + error);
    }
  }
}

/// Bars start at zero: no room beyond it where no bar goes there.
Range from_zero(const Panel& panel, Range range) {
  if (panel.x.scale == Scale::log) return range;
  double low = 0.0;
  for (const BarSet& set : panel.bars->set)
    for (std::size_t i = 0; i < set.value.size(); ++i)
      if (std::isfinite(set.value[i])) low = std::min(low, set.value[i] - (set.error.empty() ? 0.0 : set.error[i]));
  if (low >= 0.0 && !std::isfinite(panel.x.min)) range.low = 0.0;
  return range;
}

}  // namespace

bool has_line(Style style) { return style <= Style::dash_dot || style == Style::line_points; }
bool has_points(Style style) { return style == Style::points || style == Style::line_points || style == Style::stems; }
bool stands_on_zero(Style style) { return style == Style::stems || style == Style::columns; }

double column_width(const Series& series) {
  double width = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < series.x.size(); ++i)
    if (const double apart = std::abs(series.x[i] - series.x[i - 1]); apart > 0.0) width = std::min(width, apart);
  return std::isfinite(width) ? width : 1.0;
}

const Axis* colour_axis(const Panel& panel) {
  if (panel.map) return &panel.map->colour;
  const bool any =
      std::any_of(panel.series.begin(), panel.series.end(), [](const Series& s) { return !s.colour.empty(); });
  return any ? &panel.colour : nullptr;
}

bool diverging_colours(const Panel& panel) { return panel.map && panel.map->diverging; }

std::vector<double> cell_edges(const std::vector<double>& centres) {
  const std::size_t n = centres.size();
  if (n == 1) return {centres[0] - 0.5, centres[0] + 0.5};
  std::vector<double> edges(n + 1);
  for (std::size_t i = 1; i < n; ++i) edges[i] = 0.5 * (centres[i - 1] + centres[i]);
  edges[0] = centres[0] - (edges[1] - centres[0]);
  edges[n] = centres[n - 1] + (centres[n - 1] - edges[n - 1]);
  return edges;
}

Range x_range(const Panel& panel) {
  Span span(panel.x);
  for (const Series& s : panel.series) {
    const double half = s.style == Style::columns ? 0.5 * column_width(s) : 0.0;
    for (const double value : s.x) {
      span.take(value - half);
      span.take(value + half);
    }
  }
  for (const Ribbon& r : panel.ribbons)
    for (const double value : r.x) span.take(value);
  for (const ReferenceLine& line : panel.lines)
    if (line.vertical) span.take(line.value);
  if (panel.map)
    for (const double edge : cell_edges(panel.map->x)) span.take(edge);
  const bool loose = std::any_of(panel.series.begin(), panel.series.end(), needs_room);
  const double room = loose ? 0.04 : 0.0;
  if (!panel.bars) return span.range(panel.map ? 0.0 : room);
  take_bars(*panel.bars, span);
  return from_zero(panel, span.range(0.14));  // room for the numbers at the bars' ends
}

Range y_range(const Panel& panel, const Range& x) {
  if (panel.bars) return {0.0, static_cast<double>(panel.bars->name.size())};
  Span span(panel.y);
  const auto seen = [&](double value) { return value >= x.low && value <= x.high; };
  for (const Series& s : panel.series) {
    if (stands_on_zero(s.style)) span.take(0.0);
    for (std::size_t i = 0; i < s.x.size(); ++i)
      if (seen(s.x[i])) span.take(s.y[i]);
  }
  for (const Ribbon& r : panel.ribbons)
    for (std::size_t i = 0; i < r.x.size(); ++i)
      if (seen(r.x[i])) {
        span.take(r.low[i]);
        span.take(r.high[i]);
      }
  for (const ReferenceLine& line : panel.lines)
    if (!line.vertical) span.take(line.value);
  if (panel.map)
    for (const double edge : cell_edges(panel.map->y)) span.take(edge);
  return span.range(panel.map ? 0.0 : 0.06);
}

Range colour_range(const Panel& panel) {
  const Axis& axis = *colour_axis(panel);
  Span span(axis);
  if (panel.map) {
    for (Eigen::Index i = 0; i < panel.map->z.size(); ++i) span.take(panel.map->z.data()[i]);
  } else {
    for (const Series& s : panel.series)
      for (const double value : s.colour) span.take(value);
  }
  Range r = span.range(0.0);
  if (!diverging_colours(panel)) return r;
  const double reach = std::max(std::abs(r.low), std::abs(r.high));
  if (!std::isfinite(axis.min)) r.low = -reach;
  if (!std::isfinite(axis.max)) r.high = reach;
  return r;
}

std::string nothing_to_show(const Panel& panel) {
  if (panel.series.empty() || panel.map || panel.bars || !panel.ribbons.empty()) return "";
  bool finite = false;
  for (const Series& s : panel.series)
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (shows(panel.x, s.x[i]) && shows(panel.y, s.y[i])) return "";
      finite = finite || (std::isfinite(s.x[i]) && std::isfinite(s.y[i]));
    }
  return finite ? "no values above 0" : "no data";
}

}  // namespace lunid::figure
