#pragma once
// Nonlinear least squares: the parameters of any formula of a record's channels.
#include <Eigen/Core>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "record/record.hpp"

namespace lunid {

/// A parameter of the formula: first guess and bounds, after the fit its value and what is known of it.
struct CurveParameter {
  std::string name;
  double value = 1;  ///< min <= value <= max
  double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity();
  double std = std::numeric_limits<double>::quiet_NaN();  ///< NaN at a bound, and where the data do not excite it
  bool at_bound = false;                                  ///< held there by the data
  bool unexcited = false;                                 ///< to rounding the data do not depend on it alone
};

struct CurveOptions {
  Expr response;  ///< what was measured, a function of channels
  Expr formula;   ///< what it shall be, a function of channels, t and parameters
  Expr weight;    ///< of a row's squared residual, a function of channels, >= 0; empty: 1
  std::vector<CurveParameter> parameters;
  std::map<std::string, double> values;  ///< of the other parameters
  int max_iterations = 500;              ///< of each search, >= 1
  /// Relative offset at which a search ends (Bates & Watts 1981): what the tangent plane still explains of the residual
  /// over what it cannot, each per degree of freedom; > 0.
  double tolerance = 1e-9;
};
/// Throws InputError: no parameter, bad bounds or guess, a parameter twice or in no place, bad counts.
void validate(const CurveOptions& options);

struct CurveFit {
  std::vector<CurveParameter> parameters;
  Eigen::MatrixXd covariance;  ///< of the parameters; rows and columns of those at bounds or unexcited are NaN
  double rss = 0;              ///< weighted residual sum of squares
  double residual_std = 0;     ///< sqrt(rss / (rows - free parameters))
  double rmse = 0;             ///< sqrt(rss / rows)
  double r2 = 0;               ///< of the weighted response about its mean
  Eigen::Index rows = 0;
  double offset = 0;     ///< relative offset at the solution
  double condition = 1;  ///< of the derivatives, columns scaled to length 1
  bool converged = false;
  std::string stopped;  ///< why
  int iterations = 0, evaluations = 0;
  double seconds = 0;
  Expr formula;  ///< with the values put in
};

/// min over the parameters of sum weight * (response - formula)^2, over all rows of the records. Levenberg-Marquardt in
/// a scaled trust region (More 1978, Lect. Notes Math. 630, 105) with exact derivatives, in one streaming QR pass per
/// evaluation; bounds by projection. A far start may run into a place from which the formula does not depend on its
/// parameters; the search is therefore made from trust regions of several sizes, and the best is the result.
/// Throws InputError: a channel that a record lacks, a parameter without a value, fewer rows than parameters, a row
/// that is not finite at the first guess.
CurveFit fit_curve(std::span<const Record> records, const CurveOptions& options);

}  // namespace lunid
