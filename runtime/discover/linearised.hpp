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
  std::vector<Eigen::Index> state_of_record;  ///< first column of each record's first state; behind them the number
};

/// Of `system` at theta, with the first states and the residual of `at`; states and parameters that `at` lacks are
/// zero. False where it cannot be run.
bool linearise(const Study& study, const System& system, const Eigen::VectorXd& theta, const FitResult& at,
               const Whitening& whitening, Linearised& out);

/// Takes what the first states can do out of the residual and of the parameters' columns, record by record, and drops
/// their columns: of hundreds of short runs these are far more than the parameters.
void project_first_states(Linearised& linear);

/// Sets the columns of parameters that are fixed, or held by a bound in `fit`, to zero, and the rest to length one.
void hold_and_scale(const Model& model, const FitResult& fit, Eigen::MatrixXd& columns);

/// What the columns that a candidate has beyond those of a model take off that model's whitened residual.
struct MotionGain {
  double gain = 0;     ///< relative drop of the residual's norm
  double p_value = 1;  ///< of as large a drop by chance, F test
  std::string remark;  ///< why there is none
};

/// To first order, at theta with the candidate's linear coefficients at zero: there its free run is that of `before`,
/// whose parameters are the first of the candidate's.
MotionGain gain_on_motion(const Study& study, const Whitening& whitening, const Candidate& before,
                          const Candidate& candidate, Eigen::VectorXd theta);

}  // namespace lunid
