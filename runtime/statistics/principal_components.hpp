#pragma once
#include <Eigen/Core>

namespace lunid {

/// The directions along which the rows of several columns vary most, one after the other.
struct PrincipalComponents {
  Eigen::VectorXd mean, scale;  ///< of the columns: scores = (columns - mean) / scale * directions
  Eigen::VectorXd variances;    ///< of the scores (divided by rows - 1), falling
  Eigen::VectorXd shares;       ///< of the total variance
  Eigen::MatrixXd directions;   ///< one in each column, of length 1; its largest entry is positive
  Eigen::MatrixXd scores;       ///< rows x components
};

/// By the singular values of the triangle of a QR factorisation, so that the condition is not squared. (Pearson 1901;
/// Hotelling 1933.) `standardise`: columns of different units are brought to deviation 1 first. Throws InputError as
/// check_columns() does; at least 2 rows, and as many rows as columns.
PrincipalComponents principal_components(const Eigen::MatrixXd& columns, bool standardise = true);

}  // namespace lunid
