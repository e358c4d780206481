#pragma once
// The Householder kernel under every regression: R <- triangular factor of [R; block].
#include <Eigen/Core>

namespace lunid {

/// Replaces the upper triangular `r` (k x k) by the triangular factor of [r; block]. `block` (any rows x k, each column
/// contiguous) is work space and is overwritten. Signs of the rows of R are arbitrary. The lower part of `r` is not
/// touched. Backward stable column by column (Higham 2002, Accuracy and Stability, theorem 19.4).
/// Reflectors are applied four at a time (compact WY: Schreiber & Van Loan 1989, SIAM J. Sci. Stat. Comput. 10, 53);
/// sums run over 8 logical lanes in a fixed order, so that the bits do not depend on the width of the machine's SIMD.
void triangularise(Eigen::Ref<Eigen::MatrixXd> r, Eigen::Ref<Eigen::MatrixXd> block);

/// Extended precision (80 bits on x86), for the small matrices in which a whole record ends: merges and solutions then
/// add nothing to the error of the data's own blocks.
using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// The same in extended precision, one reflector at a time; zeros below the last entry of a column cost nothing, so
/// that folding in a triangle is cheap.
void triangularise(LongMatrix& r, LongMatrix block);

}  // namespace lunid
