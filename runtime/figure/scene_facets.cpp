// The surface itself, from the back to the front.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "figure/colours.hpp"
#include "figure/scene_view.hpp"

namespace lunid::figure {
namespace {

constexpr std::size_t most_lines = 140;  // each way: finer is not seen in print
constexpr double pi = 3.14159265358979323846;

/// Indices from 0 to n - 1, evenly thinned to `most`, both ends kept.
std::vector<Eigen::Index> thinned(std::size_t n) {
  const std::size_t count = std::min(n, most_lines);
  std::vector<Eigen::Index> kept(count);
  for (std::size_t i = 0; i < count; ++i)
    kept[i] = static_cast<Eigen::Index>(i * (n - 1) / std::max<std::size_t>(1, count - 1));
  return kept;
}

/// A grid that can be drawn: the one given, or a thinned one that has its lowest and highest value.
struct Grid {
  std::vector<double> x, y;
  Eigen::MatrixXd z;

  explicit Grid(const Scene& scene) {
    const std::vector<Eigen::Index> rows = thinned(scene.grid_y.size()), columns = thinned(scene.grid_x.size());
    for (const Eigen::Index c : columns) x.push_back(scene.grid_x[static_cast<std::size_t>(c)]);
    for (const Eigen::Index r : rows) y.push_back(scene.grid_y[static_cast<std::size_t>(r)]);
    z = scene.surface(rows, columns);
    keep_extremes(scene, rows, columns);
  }

 private:
  void keep_extremes(const Scene& scene, const std::vector<Eigen::Index>& rows,
                     const std::vector<Eigen::Index>& columns) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    Eigen::Index at[4] = {0, 0, 0, 0};
    for (Eigen::Index r = 0; r < scene.surface.rows(); ++r)
      for (Eigen::Index c = 0; c < scene.surface.cols(); ++c) {
        const double value = scene.surface(r, c);
        if (value < low) low = value, at[0] = r, at[1] = c;
        if (value > high) high = value, at[2] = r, at[3] = c;
      }
    if (!(low <= high)) return;
    const auto nearest = [](const std::vector<Eigen::Index>& kept, Eigen::Index i) {
      return static_cast<Eigen::Index>(std::lower_bound(kept.begin(), kept.end(), i) - kept.begin());
    };
    z(nearest(rows, at[0]), nearest(columns, at[1])) = low;
    z(nearest(rows, at[2]), nearest(columns, at[3])) = high;
  }
};

class FacetBuilder {
 public:
  FacetBuilder(const Look& look, const Scene& scene, const SceneView& view)
      : look_(look), scene_(scene), view_(view), grid_(scene) {}

  std::vector<Facet> build() {
    sort_points();
    const Eigen::Index rows = grid_.z.rows() - 1, columns = grid_.z.cols() - 1;
    // The eye is on the side of large values where `toward` is positive: small ones lie behind.
    for (Eigen::Index i = 0; i < rows; ++i)
      for (Eigen::Index j = 0; j < columns; ++j)
        cell(view_.toward[1] >= 0.0 ? i : rows - 1 - i, view_.toward[0] >= 0.0 ? j : columns - 1 - j);
    return std::move(facets_);
  }

 private:
  struct Dot {
    Point at;
    double height = 0.0;  ///< above the surface; without a surface, above the ground
    Colour colour;
  };

  Vector node(Eigen::Index r, Eigen::Index c) const {
    return view_.in_box(grid_.x[static_cast<std::size_t>(c)], grid_.y[static_cast<std::size_t>(r)], grid_.z(r, c));
  }

  bool shown(Eigen::Index r, Eigen::Index c) const {
    return view_.holds(grid_.x[static_cast<std::size_t>(c)], grid_.y[static_cast<std::size_t>(r)], grid_.z(r, c));
  }

  bool filled(Eigen::Index r, Eigen::Index c) const {
    return r >= 0 && c >= 0 && r + 1 < grid_.z.rows() && c + 1 < grid_.z.cols() && shown(r, c) && shown(r, c + 1) &&
           shown(r + 1, c + 1) && shown(r + 1, c);
  }

  void cell(Eigen::Index r, Eigen::Index c) {
    const std::vector<Dot>& dots = dots_[static_cast<std::size_t>(r * (grid_.z.cols() - 1) + c)];
    for (const Dot& dot : dots)
      if (dot.height < 0.0) add_dot(dot);
    if (filled(r, c)) {
      add_quad(r, c);
      add_mesh(r, c);
    }
    for (const Dot& dot : dots)
      if (dot.height >= 0.0) add_dot(dot);
  }

  void add_quad(Eigen::Index r, Eigen::Index c) {
    const Vector a = node(r, c), b = node(r, c + 1), d = node(r + 1, c + 1), e = node(r + 1, c);
    std::vector<Point> corners;
    Point middle;
    for (const Vector* p : {&a, &b, &d, &e}) {
      corners.push_back(view_.on_paper(*p));
      middle.x += 0.25 * corners.back().x;
      middle.y += 0.25 * corners.back().y;
    }
    // A little larger, so that no viewer shows seams between neighbours.
    for (Point& p : corners) {
      const double dx = p.x - middle.x, dy = p.y - middle.y, length = std::hypot(dx, dy);
      if (length > 0.0) p = {p.x + 0.2 * dx / length, p.y + 0.2 * dy / length};
    }
    const double value = 0.25 * (grid_.z(r, c) + grid_.z(r, c + 1) + grid_.z(r + 1, c + 1) + grid_.z(r + 1, c));
    facets_.push_back({std::move(corners), lit(colour(value), normal(a, b, d, e))});
  }

  Colour colour(double value) const {
    return map_colour((value - view_.colour.low) / (view_.colour.high - view_.colour.low), scene_.diverging);
  }

  static Vector normal(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
    Vector u, v;
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = c[k] - a[k];
      v[k] = d[k] - b[k];
    }
    const Vector n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return length > 0.0 ? Vector{n[0] / length, n[1] / length, n[2] / length} : Vector{0.0, 0.0, 1.0};
  }

  /// Light from behind the viewer's left shoulder.
  Colour lit(Colour c, const Vector& n) const {
    double cosine = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      cosine += n[k] * (0.85 * view_.toward[k] - 0.35 * view_.right[k] + 0.39 * view_.up[k]);
    const double strength = 0.62 + 0.42 * std::abs(cosine);
    const auto shaded = [&](unsigned char part) {
      return static_cast<unsigned char>(std::clamp(std::lround(strength * part), 0L, 255L));
    };
    return {shaded(c.red), shaded(c.green), shaded(c.blue)};
  }

  /// Grid lines on the surface, about twenty each way, that show its shape; each by the cells on its far side.
  void add_mesh(Eigen::Index r, Eigen::Index c) {
    const Eigen::Index row_step = std::max<Eigen::Index>(1, grid_.z.rows() / 20),
                       column_step = std::max<Eigen::Index>(1, grid_.z.cols() / 20);
    for (const Eigen::Index row : {r, r + 1})
      if (row % row_step == 0) add_line(node(row, c), node(row, c + 1));
    for (const Eigen::Index column : {c, c + 1})
      if (column % column_step == 0) add_line(node(r, column), node(r + 1, column));
  }

  /// A line as a thin facet, since facets are drawn in one order.
  void add_line(const Vector& from, const Vector& to) {
    const Point a = view_.on_paper(from), b = view_.on_paper(to);
    const double dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
    if (!(length > 0.0)) return;
    const double half = 0.2, u = half * dy / length, v = -half * dx / length;
    facets_.push_back(
        {{{a.x + u, a.y + v}, {b.x + u, b.y + v}, {b.x - u, b.y - v}, {a.x - u, a.y - v}}, {25, 25, 25, 110}});
  }

  void add_dot(const Dot& dot) {
    constexpr int corners = 10;
    const double radius = 0.85 * look_.point_radius;
    std::vector<Point> ring;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2.0 * pi * k / corners;
      ring.push_back({dot.at.x + radius * std::cos(angle), dot.at.y + radius * std::sin(angle)});
    }
    facets_.push_back({std::move(ring), dot.colour});
  }

  static std::size_t cell_of(const std::vector<double>& nodes, double value) {
    const auto place = static_cast<std::size_t>(std::upper_bound(nodes.begin(), nodes.end(), value) - nodes.begin());
    return std::clamp<std::size_t>(place, 1, nodes.size() - 1) - 1;
  }

  /// Each point into the cell that it stands on; of points so close that they look like one, only the first.
  void sort_points() {
    const std::size_t columns = grid_.x.size() - 1;
    dots_.resize((grid_.y.size() - 1) * columns);
    for (const Cloud& cloud : scene_.clouds)
      for (std::size_t i = 0; i < cloud.x.size(); ++i) {
        if (!view_.holds(cloud.x[i], cloud.y[i], cloud.z[i])) continue;
        const Point at = view_.on_paper(view_.in_box(cloud.x[i], cloud.y[i], cloud.z[i]));
        const std::size_t r = cell_of(grid_.y, cloud.y[i]), c = cell_of(grid_.x, cloud.x[i]);
        std::vector<Dot>& dots = dots_[r * columns + c];
        const bool taken = std::any_of(dots.begin(), dots.end(), [&](const Dot& d) {
          return std::hypot(d.at.x - at.x, d.at.y - at.y) < 0.4 * look_.point_radius;
        });
        if (!taken)
          dots.push_back({at, above(cloud.x[i], cloud.y[i], cloud.z[i], r, c), role_colour(cloud.role, look_.theme)});
      }
  }

  double above(double x, double y, double z, std::size_t r, std::size_t c) const {
    const double u = (x - grid_.x[c]) / (grid_.x[c + 1] - grid_.x[c]),
                 v = (y - grid_.y[r]) / (grid_.y[r + 1] - grid_.y[r]);
    const auto i = static_cast<Eigen::Index>(r), j = static_cast<Eigen::Index>(c);
    const double surface = (1 - v) * ((1 - u) * grid_.z(i, j) + u * grid_.z(i, j + 1)) +
                           v * ((1 - u) * grid_.z(i + 1, j) + u * grid_.z(i + 1, j + 1));
    return std::isfinite(surface) ? z - surface : 0.0;
  }

  const Look& look_;
  const Scene& scene_;
  const SceneView& view_;
  Grid grid_;
  std::vector<std::vector<Dot>> dots_;
  std::vector<Facet> facets_;
};

}  // namespace

std::vector<Facet> scene_facets(const Look& look, const Scene& scene, const SceneView& view) {
  return FacetBuilder(look, scene, view).build();
}

}  // namespace lunid::figure
