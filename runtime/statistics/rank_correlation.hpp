#pragma once
// Association by order alone: the same for any rising function of either column.
#include <Eigen/Core>
#include <span>

#include "statistics/correlation.hpp"

namespace lunid {

/// Ranks 1 .. n; equal values share the mean of theirs.
Eigen::VectorXd ranks(std::span<const double> x);

/// Spearman's rho: the correlation of the ranks, so that ties are right. The probability is that of Student's t with
/// n - 2 degrees of freedom, for independent rows. (Spearman 1904; Kendall 1970, Rank Correlation Methods, 2 and 5.)
/// Throws InputError as check_columns() does; at least 3 rows.
Correlation spearman(std::span<const double> a, std::span<const double> b);

/// Kendall's tau-b in n log n (Knight 1966, J. Am. Stat. Assoc. 61, 436). The probability is the normal limit with the
/// variance that ties call for (Kendall 1970, 4), for independent rows. Throws as spearman().
Correlation kendall(std::span<const double> a, std::span<const double> b);

}  // namespace lunid
