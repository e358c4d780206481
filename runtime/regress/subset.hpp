#pragma once
// Inside regress: residual sums of squares of subsets of the features.
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "regress/reduce.hpp"

namespace lunid::detail {

/// Scores subsets of the free features of a regression, each by its least squares under the constraints.
class Subsets {
 public:
  Subsets(const Statistic& data, std::span<const Constraint> constraints);

  /// Candidates: the features that are neither fixed nor unexcited; `columns()[k]` is the k-th one's number.
  int count() const { return static_cast<int>(problem_.columns.size()); }
  const std::vector<int>& columns() const { return problem_.columns; }
  const Problem& problem() const { return problem_; }
  bool constrained() const { return problem_.c.rows() > 0; }
  double rows() const { return rows_; }
  double target() const { return target_; }  ///< sum of squares of the target less the fixed part
  double rest() const { return rest_; }      ///< residual sum of squares that no subset removes

  /// Least sum of squares with the candidates `in` (any order); infinite when the constraints cannot be met by them.
  double rss(const std::vector<int>& in) const;
  /// The same without the constraints: never more.
  double unconstrained(const std::vector<int>& in) const;
  /// Candidates without which the constraints cannot be met.
  const std::vector<int>& needed() const { return needed_; }
  /// The fit on the features of a subset.
  Fit fit(const std::vector<int>& in) const;
  /// Candidates as numbers of features.
  std::vector<int> features(const std::vector<int>& in) const;

 private:
  Eigen::MatrixXd factor(const std::vector<int>& in) const;

  const Statistic& data_;
  std::span<const Constraint> constraints_;
  Problem problem_;
  double rows_, target_, rest_;
  std::vector<int> needed_;
};

/// AICc (Hurvich & Tsai 1989, Biometrika 76, 297) or BIC (Schwarz 1978, Ann. Stat. 6, 461) of a model with `terms`
/// coefficients; rss is taken for at least what rounding leaves of `target`.
double information(bool bic, double rows, double rss, double target, int terms);

}  // namespace lunid::detail
