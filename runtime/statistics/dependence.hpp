#pragma once
// Inside statistics: does a residual follow given functions, or does it only look so?
#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace lunid {

/// Orthonormal functions on some of the rows.
struct Projection {
  std::vector<Eigen::Index> rows;
  Eigen::MatrixXd basis;  ///< a row for each of them
};

/// An orthonormal basis of the columns, less directions that the `nuisance` columns hold already.
Eigen::MatrixXd orthonormal_beside(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& nuisance);

/// Legendre polynomials 0 .. degree (>= 1) of s in [-1, 1], one in each column.
Eigen::MatrixXd legendre(const Eigen::ArrayXd& s, int degree);

struct Dependence {
  double explained = 0;  ///< sum of squares of the residual along the projections
  double by_chance = 0;  ///< its mean for the residual's own blocks in random order
  double p_value = 1;
};
/// Compares the residual with blocks of `noise` (what of it cannot be a function of interest: of mean 0) in
/// random order, which keep its colour and lose their place. The rows of the projections do not overlap.
/// `block_length` is a least length; longer blocks are taken where the noise is correlated for longer, up to
/// a twentieth of the rows.
Dependence dependence(const Eigen::VectorXd& residual, const Eigen::VectorXd& noise,
                      const std::vector<Projection>& projections, Eigen::Index block_length, std::uint64_t seed);

}  // namespace lunid
