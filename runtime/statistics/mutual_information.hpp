#pragma once
// Mutual information [nat] by distances to nearest neighbours: dependence of any form, linear or not.
#include <Eigen/Core>
#include <span>

namespace lunid {

struct NeighbourOptions {
  int neighbours = 3;  ///< k: fewer for less bias, more for less scatter; 1 to rows - 1
  int threads = 0;     ///< over the columns; 0: all cores. The same bits for any number
};

/// I(x; target) for each column x: the first estimator of Kraskov, Stoegbauer & Grassberger (2004, Phys. Rev. E 69,
/// 066138, eq. 8) in the maximum norm, columns scaled to deviation 1. It may fall below 0 by its scatter, about 1 /
/// sqrt(rows). Rows that repeat one another are told apart by 1e-10 of a deviation, the same for every call. Throws
/// InputError as check_columns() does, and for neighbours out of range; at least 5 rows.
Eigen::VectorXd mutual_information(const Eigen::MatrixXd& columns, std::span<const double> target,
                                   const NeighbourOptions& options = {});
double mutual_information(std::span<const double> x, std::span<const double> target,
                          const NeighbourOptions& options = {});

/// I(x; target | given) for each column x: what x tells about the target beyond what the columns `given` tell. (Frenzel
/// & Pompe 2007, Phys. Rev. Lett. 99, 204101, eq. 10.) Throws as above.
Eigen::VectorXd conditional_mutual_information(const Eigen::MatrixXd& columns, std::span<const double> target,
                                               const Eigen::MatrixXd& given, const NeighbourOptions& options = {});

/// The thesis' significance index of a term (figure 2.12): its mutual information times its largest force |c f|.
double significance_index(double information, double coefficient, std::span<const double> feature);

}  // namespace lunid
