#include <array>
#include <cmath>
#include <map>

#include "figure/curve.hpp"

namespace lunid::figure {
namespace {

/// An edge of the grid: from a node to the next one along x (0) or y (1).
using Edge = std::array<Eigen::Index, 3>;

class Tracer {
 public:
  Tracer(const HeatMap& map, double level) : map_(map), level_(level) {}

  std::vector<Stroke> trace() {
    for (Eigen::Index row = 0; row + 1 < map_.z.rows(); ++row)
      for (Eigen::Index column = 0; column + 1 < map_.z.cols(); ++column) cross(row, column);
    std::vector<Stroke> lines;
    // Open lines first, from their ends; what is left are rings.
    for (const bool open : {true, false})
      for (auto& [edge, next] : links_)
        if (!next.empty() && (!open || next.size() == 1)) lines.push_back(follow(edge));
    return lines;
  }

 private:
  bool above(Eigen::Index row, Eigen::Index column) const { return map_.z(row, column) >= level_; }

  void cross(Eigen::Index r, Eigen::Index c) {
    const double corners = map_.z(r, c) + map_.z(r, c + 1) + map_.z(r + 1, c) + map_.z(r + 1, c + 1);
    if (!std::isfinite(corners)) return;
    const Edge bottom{r, c, 0}, top{r + 1, c, 0}, left{r, c, 1}, right{r, c + 1, 1};
    std::vector<Edge> cut;
    if (above(r, c) != above(r, c + 1)) cut.push_back(bottom);
    if (above(r, c + 1) != above(r + 1, c + 1)) cut.push_back(right);
    if (above(r + 1, c) != above(r + 1, c + 1)) cut.push_back(top);
    if (above(r, c) != above(r + 1, c)) cut.push_back(left);
    if (cut.size() == 2) return link(cut[0], cut[1]);
    if (cut.size() != 4) return;
    const bool middle = 0.25 * corners >= level_;
    if (middle == above(r, c)) {
      link(bottom, right);
      link(top, left);
    } else {
      link(bottom, left);
      link(top, right);
    }
  }

  void link(const Edge& a, const Edge& b) {
    links_[a].push_back(b);
    links_[b].push_back(a);
  }

  Point place(const Edge& edge) const {
    const auto [r, c, upward] = edge;
    const double low = map_.z(r, c), high = upward ? map_.z(r + 1, c) : map_.z(r, c + 1);
    const double share = (level_ - low) / (high - low);
    const auto x = [&](Eigen::Index i) { return map_.x[static_cast<std::size_t>(i)]; };
    const auto y = [&](Eigen::Index i) { return map_.y[static_cast<std::size_t>(i)]; };
    if (upward) return {x(c), y(r) + share * (y(r + 1) - y(r))};
    return {x(c) + share * (x(c + 1) - x(c)), y(r)};
  }

  /// Walks along the links from an edge and takes them away.
  Stroke follow(Edge edge) {
    Stroke line{place(edge)};
    while (!links_[edge].empty()) {
      const Edge next = links_[edge].back();
      links_[edge].pop_back();
      std::erase(links_[next], edge);
      line.push_back(place(next));
      edge = next;
    }
    return line;
  }

  const HeatMap& map_;
  double level_;
  std::map<Edge, std::vector<Edge>> links_;
};

}  // namespace

std::vector<Stroke> contour(const HeatMap& map, double level) { return Tracer(map, level).trace(); }

}  // namespace lunid::figure
