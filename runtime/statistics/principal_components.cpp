#include "statistics/principal_components.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "statistics/checks.hpp"

namespace lunid {

PrincipalComponents principal_components(const Eigen::MatrixXd& columns, bool standardise) {
  const auto least = static_cast<std::size_t>(std::max<Eigen::Index>(columns.cols(), 2));
  check_columns("principal_components", columns_of(columns), {.rows = least, .may_be_constant = !standardise});
  const double freedom = static_cast<double>(columns.rows() - 1);
  PrincipalComponents result;
  result.mean = columns.colwise().mean();
  Eigen::MatrixXd centred = columns.rowwise() - result.mean.transpose();
  result.scale = Eigen::VectorXd::Ones(columns.cols());
  if (standardise) result.scale = (centred.colwise().squaredNorm() / freedom).cwiseSqrt();
  for (Eigen::Index c = 0; c < columns.cols(); ++c) centred.col(c) /= result.scale[c];
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(centred);
  const Eigen::MatrixXd triangle = qr.matrixQR().topRows(columns.cols()).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(triangle, Eigen::ComputeFullV);
  result.variances = svd.singularValues().cwiseAbs2() / freedom;
  const double total = result.variances.sum();
  result.shares = total > 0 ? Eigen::VectorXd(result.variances / total) : result.variances;
  result.directions = svd.matrixV();
  for (Eigen::Index c = 0; c < result.directions.cols(); ++c) {
    Eigen::Index largest = 0;
    result.directions.col(c).cwiseAbs().maxCoeff(&largest);
    if (result.directions(largest, c) < 0) result.directions.col(c) *= -1;
  }
  result.scores = centred * result.directions;
  return result;
}

}  // namespace lunid
