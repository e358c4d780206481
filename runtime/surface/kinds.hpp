#pragma once
// Inside surface: how each kind of interpolation.hpp is made. Options are valid.
#include "surface/interpolation.hpp"

namespace lunid::detail {

/// Cells along each axis by which these kinds mark where there is no data.
inline constexpr int kCells = 25;

struct Learnt {
  std::shared_ptr<const ForceSurface> surface;
  std::string stopped = {};  ///< why an iteration stopped
  bool converged = true;
};

Learnt nearest(const SurfacePoints& points, const NearestOptions& options);
Learnt triangulation(const SurfacePoints& points, const TriangulationOptions& options);
Learnt mlp(const SurfacePoints& points, const MlpOptions& options);
Learnt gaussian_process(const SurfacePoints& points, const GaussianProcessOptions& options);
Learnt support_vectors(const SurfacePoints& points, const SupportVectorOptions& options);
Learnt forest(const SurfacePoints& points, const ForestOptions& options);

}  // namespace lunid::detail
