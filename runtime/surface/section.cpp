// Cuts through a surface.
#include <cmath>
#include <vector>

#include "expr/digits.hpp"
#include "surface/surface.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

SurfaceSection section(const ForceSurface& surface, const SurfacePoints& points, bool along_y, double at, int count,
                       double half_width) {
  const Cells& cells = surface.cells();
  const double across_min = along_y ? cells.v_min() : cells.y_min(),
               across_max = along_y ? cells.v_max() : cells.y_max();
  const double least = along_y ? cells.y_min() : cells.v_min(), most = along_y ? cells.y_max() : cells.v_max();
  const std::string axis = along_y ? "v" : "y";
  if (!(at >= across_min && at <= across_max))
    throw InputError("surface: section: " + axis + ": expected within the data, " + number(across_min, 4) + " to " +
                     number(across_max, 4) + ", got " + number(at));
  if (count < 2) throw InputError("surface: section: count: expected >= 2, got " + std::to_string(count));
  SurfaceSection out{along_y,
                     at,
                     half_width > 0 ? half_width : (across_max - across_min) / 20,
                     VectorXd(count),
                     VectorXd(count),
                     VectorXd(count),
                     {},
                     {}};
  for (int k = 0; k < count; ++k) {
    out.place[k] = least + (most - least) * k / (count - 1);
    const double y = along_y ? out.place[k] : at, v = along_y ? at : out.place[k];
    const bool known = surface.has_data(y, v);
    out.f[k] = known ? surface.value(y, v) : std::nan("");
    out.std[k] = known ? surface.std(y, v) : std::nan("");
  }
  std::vector<Index> near;
  const VectorXd &across = along_y ? points.v : points.y, &along = along_y ? points.y : points.v;
  for (Index k = 0; k < points.size(); ++k)
    if (std::abs(across[k] - at) <= out.half_width) near.push_back(k);
  out.points_place = along(near);
  out.points_f = points.f(near);
  return out;
}

}  // namespace lunid
