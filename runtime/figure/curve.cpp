#include "figure/curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace lunid::figure {
namespace {

/// Appends the places of the points of stroke[begin, end) that must stay.
void keep_extremes(const Stroke& stroke, std::size_t begin, std::size_t end, std::vector<std::size_t>& kept) {
  std::size_t low = begin, high = begin;
  for (std::size_t i = begin; i < end; ++i) {
    if (stroke[i].y < stroke[low].y) low = i;
    if (stroke[i].y > stroke[high].y) high = i;
  }
  std::array<std::size_t, 4> order{begin, low, high, end - 1};
  std::sort(order.begin(), order.end());
  kept.insert(kept.end(), order.begin(), std::unique(order.begin(), order.end()));
}

/// The part [from, to] of the segment a-b (parameters 0 to 1) within the box; false when there is none.
bool clip_segment(Point a, Point b, const Box& box, double& from, double& to) {
  from = 0.0;
  to = 1.0;
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double p[] = {-dx, dx, -dy, dy};
  const double q[] = {a.x - box.left, box.right - a.x, a.y - box.bottom, box.top - a.y};
  for (int i = 0; i < 4; ++i) {
    if (p[i] == 0.0) {
      if (q[i] < 0.0) return false;
      continue;
    }
    const double t = q[i] / p[i];
    if (p[i] < 0.0)
      from = std::max(from, t);
    else
      to = std::min(to, t);
  }
  return from <= to;
}

Point along(Point a, Point b, double t) { return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; }

/// Lengths of ink and gap in turn, in line widths.
std::vector<double> pattern(Style style) {
  switch (style) {
    case Style::dashed: return {4.5, 2.4};
    case Style::dotted: return {1.0, 1.7};
    case Style::dash_dot: return {5.0, 1.8, 1.0, 1.8};
    default: return {};
  }
}

/// Walks along strokes and puts the pen down and up.
class Dasher {
 public:
  Dasher(std::vector<double> lengths, double width) : lengths_(std::move(lengths)) {
    for (double& length : lengths_) length *= width;
  }

  void walk(const Stroke& stroke) {
    index_ = 0;
    left_ = lengths_[0];
    if (!stroke.empty()) current_ = {stroke[0]};
    for (std::size_t i = 1; i < stroke.size(); ++i) segment(stroke[i - 1], stroke[i]);
    lift();
  }

  std::vector<Stroke> take() { return std::move(dashes_); }

 private:
  void segment(Point a, Point b) {
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    double done = 0.0;
    while (length - done > left_) {
      done += left_;
      const Point p = along(a, b, done / length);
      if (inked()) {
        current_.push_back(p);
        lift();
      }
      index_ = (index_ + 1) % lengths_.size();
      left_ = lengths_[index_];
      if (inked()) current_ = {p};
    }
    left_ -= length - done;
    if (inked()) current_.push_back(b);
  }

  bool inked() const { return index_ % 2 == 0; }

  void lift() {
    if (current_.size() > 1) dashes_.push_back(current_);
    current_.clear();
  }

  std::vector<double> lengths_;
  std::size_t index_ = 0;
  double left_ = 0.0;
  Stroke current_;
  std::vector<Stroke> dashes_;
};

}  // namespace

std::vector<std::size_t> thin_places(const Stroke& stroke, double column) {
  std::vector<std::size_t> kept;
  std::size_t begin = 0;
  while (begin < stroke.size()) {
    const double place = std::floor(stroke[begin].x / column);
    std::size_t end = begin + 1;
    while (end < stroke.size() && std::floor(stroke[end].x / column) == place) ++end;
    keep_extremes(stroke, begin, end, kept);
    begin = end;
  }
  return kept;
}

Stroke thin(const Stroke& stroke, double column) {
  Stroke kept;
  for (const std::size_t i : thin_places(stroke, column)) kept.push_back(stroke[i]);
  return kept;
}

namespace {

constexpr std::size_t block = 32;  // cells each way

}  // namespace

SeenSegments::SeenSegments(const Box& box, double cell)
    : box_(box),
      cell_(cell),
      columns_(static_cast<std::size_t>(box.width() / cell) + 3),
      rows_(static_cast<std::size_t>(box.height() / cell) + 4),
      block_columns_(columns_ / block + 1) {}

/// A segment in cells: whole steps of at most one cell along it. From 1, so that each cell has neighbours.
struct SeenSegments::Walk {
  double x, y, along_x, along_y, inverse_x, inverse_y;
  int steps;
  std::size_t column(int k) const { return static_cast<std::size_t>(std::max(1.0, x + k * along_x)); }
  std::size_t row(int k) const { return static_cast<std::size_t>(std::max(1.0, y + k * along_y)); }

  /// Steps from the k-th until one of the two coordinates leaves its block.
  int leap(int k) const {
    const auto out = [](double at, double along, double inverse) {
      const double low = static_cast<double>(static_cast<std::size_t>(std::max(0.0, at)) / block * block);
      return along > 0.0 ? (low + block - at) * inverse : along < 0.0 ? (low - at) * inverse : 1e9;
    };
    const double least = std::min(out(x + k * along_x, along_x, inverse_x), out(y + k * along_y, along_y, inverse_y));
    return std::max(1, static_cast<int>(std::min(least, 1e9)));
  }
};

SeenSegments::Walk SeenSegments::walk(Point a, Point b) const {
  const int steps = static_cast<int>(std::max(std::abs(b.x - a.x), std::abs(b.y - a.y)) / cell_) + 1;
  const double along_x = (b.x - a.x) / cell_ / steps, along_y = (b.y - a.y) / cell_ / steps;
  return {1.0 + (a.x - box_.left) / cell_,
          1.0 + (a.y - box_.bottom) / cell_,
          along_x,
          along_y,
          1.0 / along_x,
          1.0 / along_y,
          steps};
}

bool SeenSegments::is_clear(const Walk& w, int k) const {
  const std::size_t column = w.column(k), row = w.row(k);
  return row + 1 < rows_ && column + 1 < columns_ && !inked_[row * columns_ + column];
}

/// The first step of a walk at a cell without ink; -1 where there is none.
int SeenSegments::first_clear(const Walk& w) const {
  for (int k = 0; k <= w.steps;) {
    const std::size_t column = w.column(k), row = w.row(k);
    const bool inside = row + 1 < rows_ && column + 1 < columns_;
    if (inside && clear_[row / block * block_columns_ + column / block] == 0) {
      k += w.leap(k);
      continue;
    }
    if (is_clear(w, k)) return k;
    ++k;
  }
  return -1;
}

/// Of a long segment that is new in a small part of it, draws that part alone: the rest has ink.
bool SeenSegments::draw_part(Point a, Point b, const Walk& w, int first, std::vector<Stroke>& parts) {
  constexpr int is_long = 60, margin = 3;  // cells
  if (w.steps < is_long) return false;
  int last = w.steps;
  while (last > first && !is_clear(w, last)) --last;
  if (2 * (last - first) > w.steps) return false;
  const Point from = along(a, b, std::max(0.0, double(first - margin) / w.steps));
  const Point to = along(a, b, std::min(1.0, double(last + margin) / w.steps));
  ink(from, to);
  parts.push_back({from, to});
  return true;
}

void SeenSegments::ink(std::size_t column, std::size_t row) {
  if (inked_[row * columns_ + column]) return;
  inked_[row * columns_ + column] = true;
  --clear_[row / block * block_columns_ + column / block];
}

/// What is drawn covers its cells and those beside them. Only what is drawn: a spiral whose every turn is hidden by the
/// one before must not creep away unseen.
void SeenSegments::ink(Point a, Point b) {
  const Walk w = walk(a, b);
  for (int k = 0; k <= w.steps; ++k) {
    const std::size_t column = w.column(k), row = w.row(k);
    if (row + 1 >= rows_ || column + 1 >= columns_) continue;
    ink(column, row);
    ink(column - 1, row);
    ink(column + 1, row);
    ink(column, row - 1);
    ink(column, row + 1);
  }
}

std::vector<Stroke> SeenSegments::fresh(const Stroke& stroke) {
  constexpr std::size_t few = 10000;
  if (stroke.empty() || (stroke.size() < few && inked_.empty())) return {stroke};
  if (inked_.empty()) {
    inked_.resize(columns_ * rows_);
    clear_.assign(block_columns_ * (rows_ / block + 1), static_cast<int>(block * block));
  }
  std::vector<Stroke> parts;
  Stroke current;
  // What the segment before has inked beside itself does not end a line.
  constexpr int patience = 2;
  int stale = 0;
  Point last = stroke.front();
  for (std::size_t i = 1; i < stroke.size(); ++i) {
    if (std::hypot(stroke[i].x - last.x, stroke[i].y - last.y) < cell_ && i + 1 < stroke.size()) continue;
    const Walk w = walk(last, stroke[i]);
    const int first = first_clear(w);
    const bool in_part = first >= 0 && draw_part(last, stroke[i], w, first, parts);
    stale = in_part ? patience + 1 : first >= 0 ? 0 : stale + 1;
    if (stale == 0 && current.empty()) current.push_back(last);
    if (stale <= patience && !current.empty()) {
      current.push_back(stroke[i]);
      ink(last, stroke[i]);
    } else if (!current.empty()) {
      parts.push_back(std::move(current));
      current.clear();
    }
    last = stroke[i];
  }
  if (!current.empty()) parts.push_back(std::move(current));
  return parts;
}

std::vector<Stroke> clip(const Stroke& stroke, const Box& box) {
  std::vector<Stroke> parts;
  Stroke current;
  const auto finish = [&] {
    if (current.size() > 1) parts.push_back(current);
    current.clear();
  };
  for (std::size_t i = 1; i < stroke.size(); ++i) {
    double from, to;
    if (!clip_segment(stroke[i - 1], stroke[i], box, from, to)) {
      finish();
      continue;
    }
    if (from > 0.0) finish();
    if (current.empty()) current.push_back(along(stroke[i - 1], stroke[i], from));
    current.push_back(to < 1.0 ? along(stroke[i - 1], stroke[i], to) : stroke[i]);
    if (to < 1.0) finish();
  }
  finish();
  return parts;
}

std::vector<Stroke> dash(const std::vector<Stroke>& strokes, Style style, double width) {
  std::vector<double> lengths = pattern(style);
  if (lengths.empty()) return strokes;
  Dasher dasher(std::move(lengths), width);
  for (const Stroke& stroke : strokes) dasher.walk(stroke);
  return dasher.take();
}

std::vector<Point> thin_cloud(const std::vector<Point>& points, const Box& box, double cell) {
  std::vector<Point> kept;
  std::unordered_set<std::uint64_t> taken;
  for (const Point& p : points) {
    if (!box.holds(p)) continue;
    const auto column = static_cast<std::uint64_t>((p.x - box.left) / cell);
    const auto row = static_cast<std::uint64_t>((p.y - box.bottom) / cell);
    if (taken.insert(column << 32 | row).second) kept.push_back(p);
  }
  return kept;
}

}  // namespace lunid::figure
