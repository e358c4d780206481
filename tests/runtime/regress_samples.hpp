#pragma once
// Random regression problems for the tests of solvers.
#include <Eigen/Core>
#include <random>
#include <string>
#include <vector>

#include "regress/statistic.hpp"

namespace lunid {

inline Eigen::MatrixXd random_matrix(std::mt19937& random, Eigen::Index rows, Eigen::Index columns) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

/// Columns that lean on one another: each is the one before and something new.
inline Eigen::MatrixXd leaning_matrix(std::mt19937& random, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd x = random_matrix(random, rows, columns);
  for (Eigen::Index j = 1; j < columns; ++j) x.col(j) += 0.8 * x.col(j - 1);
  return x;
}

inline Statistic data_of(const Eigen::MatrixXd& x, const Eigen::VectorXd& z) {
  std::vector<std::string> names;
  for (Eigen::Index j = 0; j < x.cols(); ++j) names.push_back("x" + std::to_string(j));
  Statistic data(names);
  data.add(x, z);
  return data;
}

inline std::vector<Statistic> blocks_of(const Eigen::MatrixXd& x, const Eigen::VectorXd& z, Eigen::Index count) {
  std::vector<Statistic> out;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index from = x.rows() * k / count, to = x.rows() * (k + 1) / count;
    out.push_back(data_of(x.middleRows(from, to - from), z.segment(from, to - from)));
  }
  return out;
}

}  // namespace lunid
