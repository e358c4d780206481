#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

namespace lunid::detail {

/// Delaunay triangles of points in the plane by Qhull. Throws InputError with Qhull's own words when it fails.
std::vector<std::array<int, 3>> delaunay(const Eigen::Matrix2Xd& points);

}  // namespace lunid::detail
