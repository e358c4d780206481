#pragma once
// Ways to draw a surface through scattered points beside the grid and the polynomial: nearest neighbours, a
// triangulation, a neural network, a Gaussian process, support vectors, a random forest; and all side by side.
#include <cstdint>
#include <optional>
#include <variant>

#include "surface/surface.hpp"

namespace lunid {

/// Mean of the nearest points, weighted by one over their distance, in coordinates normalised to -1..1.
struct NearestOptions {
  int neighbours = 12;  ///< 1..1000
};

/// Planes over the triangles of Delaunay between cell means; no value outside their hull.
struct TriangulationOptions {
  int cells = 40;  ///< along each axis, 2..300: the points of a cell are one corner, their mean
};

/// Layers of tanh units and a linear output, fitted to cell means by L-BFGS. (Rumelhart, Hinton & Williams 1986,
/// Nature 323, 533; Liu & Nocedal 1989.)
struct MlpOptions {
  std::vector<int> hidden = {20, 20};  ///< units in each hidden layer, 1 to 4 layers of 1..500
  double penalty = 1e-6;               ///< >= 0: weight of the mean square of the weights, target of unit variance
  int evaluations = 1000;              ///< >= 1: at most so many of the loss
  std::uint64_t seed = 1;              ///< of the first weights
};

/// A Gaussian process about a plane, squared exponential with a length for each axis, on cell means; lengths and noise
/// by maximum likelihood. Its mean is the kernel ridge regression. (Rasmussen & Williams 2006, chapters 2 and 5.)
struct GaussianProcessOptions {
  int centres = 600;  ///< 20..3000: at most so many cell means; time grows with their cube
};

/// Epsilon-insensitive regression with a Gaussian kernel on cell means. (Drucker et al. 1997; Smola & Schoelkopf 2004.)
struct SupportVectorOptions {
  double cost = 10;                            ///< > 0, for a target of unit variance
  double epsilon = 0.05;                       ///< >= 0: half width of the tube, the same
  std::optional<double> width = std::nullopt;  ///< of the kernel, normalised, > 0; empty: by cross-validation
  int centres = 600;                           ///< 20..3000: at most so many cell means
};

/// The mean of regression trees on resampled points. (Breiman 2001, Mach. Learn. 45, 5.)
struct ForestOptions {
  int trees = 200;     ///< 1..5000
  int least_leaf = 5;  ///< >= 1: points in a leaf
  std::uint64_t seed = 1;
};

using Interpolator = std::variant<PolynomialOptions, GridOptions, NearestOptions, TriangulationOptions, MlpOptions,
                                  GaussianProcessOptions, SupportVectorOptions, ForestOptions>;
/// Throws InputError: an option outside the range that it states.
void validate(const Interpolator& how);
/// "polynomial", "bilinear grid" or "bicubic grid", "nearest neighbours", "triangulation", "neural network", "Gaussian
/// process", "support vectors", "random forest": what the surface's name() says.
std::string name_of(const Interpolator& how);
/// Whether its derivatives have no jumps.
bool is_smooth(const Interpolator& how);

/// A surface that was fitted to points, and how well.
struct FittedSurface {
  std::shared_ptr<const ForceSurface> surface;
  double rmse = 0, r2 = 0;  ///< on the points of the fit where it has data [N]
  std::string stopped;      ///< why an iteration stopped; empty where there is none
  bool converged = true;    ///< a network that is not yet at rest is a result, not an error
  double seconds = 0;
};
/// Throws InputError as the kinds do: too few points, points on a line, a missing module of learners.
FittedSurface fit_surface(const SurfacePoints& points, const Interpolator& how);

/// One of several surfaces of the same points.
struct SurfaceRival {
  Interpolator how;
  FittedSurface fit;
  SurfaceScore left_out;  ///< on the points that all rivals predict
  Eigen::MatrixXd std;    ///< of the surface at the cell centres, by leaving out blocks of time in turn [N]
  std::string fault;      ///< why it could not be fitted; the rest is then empty
};
/// Fits each to all points and to all but each of `blocks` (>= 2) blocks of time; the one with the least left-out rmse
/// comes first, those that failed come last. Throws InputError: no kind, blocks, or the fault when all fail.
std::vector<SurfaceRival> compare_surfaces(const SurfacePoints& points, std::span<const Interpolator> kinds,
                                           int blocks);

}  // namespace lunid
