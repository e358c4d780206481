#pragma once
// A surface's numbers as VTK's XML files.
#include <string>

#include "figure/figure.hpp"

namespace lunid::figure {

/// .vts: the grid, with points at (x, y, z) and the arrays "<x>", "<y>", "<z>", each named with its unit. A
/// point without data stands at z = 0, is blanked, and has NaN in its array.
std::string surface_as_vts(const Scene& scene);

/// .vtp: the cells whose four corners have data and, as vertices, the clouds. The same arrays, and for each
/// cell `part`: 0 for the surface, 1 for the first cloud and so on.
std::string surface_as_vtp(const Scene& scene);

/// .vtu: the same cells as an unstructured grid of quadrilaterals and vertices, with `part`.
std::string surface_as_vtu(const Scene& scene);

/// .vtp of the clouds alone, with `part`.
std::string points_as_vtp(const Scene& scene);

}  // namespace lunid::figure
