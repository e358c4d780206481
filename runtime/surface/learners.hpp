#pragma once
// Inside surface: the module that holds what other libraries do for surfaces, opened on first use because loading them
// takes longer than most studies.
#include <array>
#include <memory>
#include <vector>

#include "surface/interpolation.hpp"

namespace lunid::detail {

/// A function learnt from points in normalised coordinates. Safe to call from several threads.
class Learner {
 public:
  virtual ~Learner() = default;
  virtual double value(const Eigen::Vector2d& x) const = 0;
};

/// What the module does. What its libraries throw comes out as InputError.
class Learners {
 public:
  virtual ~Learners() = default;
  /// Delaunay triangles of points (a column each), corners by number. (Barber, Dobkin & Huhdanpaa 1996, Qhull.)
  virtual std::vector<std::array<int, 3>> triangulate(const Eigen::Matrix2Xd& points) = 0;
  /// exp(-|a - b|^2/(2 width^2)); targets of unit variance.
  virtual std::unique_ptr<Learner> support_vectors(const Eigen::Matrix2Xd& points, const Eigen::VectorXd& target,
                                                   double cost, double epsilon, double width) = 0;
  virtual std::unique_ptr<Learner> forest(const Eigen::Matrix2Xd& points, const Eigen::VectorXd& target,
                                          const ForestOptions& options) = 0;
};

/// Grows with every change of the classes above, so that a stale module is refused and not run.
inline constexpr int learners_version = 1;
using LearnersFactory = Learners*(int version);
inline constexpr const char* learners_factory = "lunid_learners";

/// Opens liblunid_learners.so (open_module(), with its errors; LUNID_LEARNERS_MODULE may name another place). What it
/// makes may outlive it. Throws InputError when it is of another version.
std::unique_ptr<Learners> open_learners();

}  // namespace lunid::detail
