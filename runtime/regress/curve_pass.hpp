#pragma once
// Inside regress: one pass of a nonlinear regression over its data.
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "expr/tape.hpp"
#include "regress/curve.hpp"
#include "regress/triangle.hpp"

namespace lunid::detail {

/// The triangular factor of [derivatives, residual] at one point: k parameters, (k + 1) x (k + 1).
struct Tangent {
  LongMatrix factor;
  bool finite = true;

  auto r() const { return factor.topLeftCorner(factor.rows() - 1, factor.cols() - 1); }
  auto z() const { return factor.col(factor.cols() - 1).head(factor.rows() - 1); }
  double rss() const { return static_cast<double>(factor.col(factor.cols() - 1).squaredNorm()); }
  /// What no change of the parameters removes, to first order.
  double rest() const {
    const long double last = factor(factor.rows() - 1, factor.cols() - 1);
    return static_cast<double>(last * last);
  }
};

/// Derivatives and residual of a formula, compiled to one tape and run over the records in blocks of rows.
class CurvePass {
 public:
  CurvePass(std::span<const Record> records, const CurveOptions& options);

  Eigen::Index rows() const { return rows_; }
  int evaluations() const { return evaluations_; }
  Tangent at(const Eigen::VectorXd& theta);
  /// The same with residuals computed in extended precision, where they are near the rounding of the response; not
  /// finite where that is of no use.
  Tangent refined(const Eigen::VectorXd& theta);
  /// Weighted sum of squares of the response about its mean.
  double total() const { return total_; }
  /// Throws InputError (Fault::data) for the first row that is not finite at `theta`.
  void refuse(const Eigen::VectorXd& theta);

 private:
  void run(const Record& record, Eigen::Index first, const Eigen::VectorXd& theta, Eigen::MatrixXd& work) const;
  void sum_response(const CurveOptions& options);

  std::span<const Record> records_;
  std::vector<std::string> channels_;
  std::vector<Expr> inputs_;
  Expr residual_;
  std::vector<double> known_;  // values of the other parameters, in the tape's order after those searched for
  Tape tape_;
  Eigen::Index rows_ = 0;
  Eigen::Index parameters_ = 0;
  int evaluations_ = 0;
  double total_ = 0;
};

}  // namespace lunid::detail
