#pragma once
// A fitted model to first order: what its whitened residual would be with other parameters and first states.
#include "discover/candidate.hpp"

namespace lunid {

struct Linearised {
  Eigen::VectorXd residual;  ///< whitened, all records
  Eigen::MatrixXd columns;   ///< d model / d (theta, then the first state of each record), whitened
  /// First row of each record, of each record's second output and so on, as residuals of a fit have them; behind them
  /// the number of rows
  std::vector<Eigen::Index> row_of_record;
};

/// Of `system` at theta, with the first states and the residual of `at`; states and parameters that `at` lacks are
/// zero. False where it cannot be run.
bool linearise(const Study& study, const System& system, const Eigen::VectorXd& theta, const FitResult& at,
               const Whitening& whitening, Linearised& out);

/// Sets the columns of parameters that are fixed, or held by a bound in `fit`, to zero, and the rest to length one.
void hold_and_scale(const Model& model, const FitResult& fit, Eigen::MatrixXd& columns);

}  // namespace lunid
