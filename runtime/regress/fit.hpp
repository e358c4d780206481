#pragma once
// What every solver returns, and the first solvers: least squares, ridge, sequentially thresholded least squares, lasso
// and elastic net. All work on a Statistic; all honour linear constraints. Bad options throw InputError from
// validate(). The others are in solvers.hpp.
#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "regress/constraint.hpp"
#include "regress/statistic.hpp"

namespace lunid {

/// A constraint that holds with equality at the solution. `multiplier` >= 0 is the rise of half the residual sum of
/// squares per unit by which the bound is tightened; any sign for equalities.
struct ActiveBound {
  int constraint = 0;  ///< index in the list given
  bool upper = false;
  double multiplier = 0;
  std::string text;  ///< "y^5 <= y^3"
};

/// A feature that the data do not excite on its own: to rounding it is a combination of features before it. Its
/// coefficient is left at 0.
struct Unexcited {
  int feature = 0;
  std::string text;     ///< "on these data a = -4.3e4*y"
  std::vector<int> of;  ///< the features that it is a combination of
};

/// One model that a search over subsets passed through.
struct SelectionStep {
  std::vector<int> features;   ///< of the model, in the order in which they came in
  int feature = -1;            ///< what the step added or dropped; -1: the best model of its size
  bool added = true;           ///< false: dropped
  double error_reduction = 0;  ///< of this step: fall of the residual sum of squares over that of the target
  double rmse = 0;
  double criterion = 0;  ///< AICc or BIC
};

struct SolverSummary {
  std::string solver;   ///< "least squares", "lasso, lambda = 0.012 (cross-validation, one standard error)", ...
  std::string stopped;  ///< why it stopped
  bool converged = true;
  int iterations = 0;
  double kkt = 0;  ///< optimality: largest violation of a first-order condition, relative to |target|
  double seconds = 0;
};

/// A solved regression. Sizes: n features.
struct Fit {
  std::vector<std::string> features;
  Eigen::VectorXd coefficients;
  /// Covariance of the coefficients, given which of them are free and which bounds are active; rows and columns of
  /// held coefficients are 0. NaN where rows do not exceed free coefficients, and for unexcited features.
  Eigen::MatrixXd covariance;
  Eigen::VectorXd std;           ///< square root of its diagonal
  Eigen::VectorXd contribution;  ///< rms of coefficient * feature over the rms of the target
  Eigen::Index rows = 0;
  int free = 0;             ///< coefficients that were estimated, less the active bounds
  double residual_std = 0;  ///< sqrt(RSS / (rows - free)), in units of the target
  double rmse = 0;          ///< sqrt(RSS / rows)
  double r2 = 0;            ///< about the mean when a constant is among the features, else about zero (as NIST)
  double condition = 0;     ///< of the free columns, each scaled to length 1
  /// Variance inflation: how much larger the variance of a coefficient is than if its feature were orthogonal to the
  /// others (about the mean when a constant is among them). NaN for held coefficients and the constant.
  Eigen::VectorXd vif;
  Eigen::VectorXd inclusion;         ///< probability that the feature belongs to the model; empty where none is known
  std::vector<SelectionStep> steps;  ///< of a search over subsets
  std::vector<Unexcited> unexcited;
  std::vector<ActiveBound> active;
  SolverSummary summary;
};

/// min |X b - z|^2 under the constraints. Rows fewer than features throw InputError, as do a feature that is zero on
/// all rows and constraints that cannot all be met.
Fit least_squares(const Statistic& data, std::span<const Constraint> constraints = {});

struct RidgeOptions {
  double lambda = 1e-3;  ///< > 0, dimensionless: penalty on the squares of coefficient * size(feature) / size(target)
};
void validate(const RidgeOptions& options);
/// min |X b - z|^2 / rows + lambda * sum (size_j b_j)^2. The size of a feature is its standard deviation when a
/// constant is among the features (which is then not penalised), else its rms. (Hoerl & Kennard 1970, Technometrics
/// 12, 55.)
Fit ridge(const Statistic& data, const RidgeOptions& options = {}, std::span<const Constraint> constraints = {});

struct StlsqOptions {
  double threshold = 0.02;  ///< 0 < threshold < 1: least contribution (rms of coefficient * feature over rms of target)
  double ridge = 0;         ///< >= 0: lambda of the ridge regression in each pass
  int max_passes = 50;      ///< >= 1
};
void validate(const StlsqOptions& options);
/// Sequentially thresholded least squares (Brunton, Proctor & Kutz 2016, PNAS 113, 3932), thresholded on the
/// dimensionless contribution, so that units do not matter. Constraints hold in every pass; a coefficient that they
/// keep from 0 is never dropped.
Fit stlsq(const Statistic& data, const StlsqOptions& options = {}, std::span<const Constraint> constraints = {});

struct LassoOptions {
  /// Share of the penalty that is on absolute values, 0 < mixture <= 1; the rest is on half the squares (elastic net:
  /// Zou & Hastie 2005, J. R. Stat. Soc. B 67, 301).
  double mixture = 1;
  /// Dimensionless, > 0; empty: by cross-validation over the blocks given. At the first entry of a path all are zero.
  std::optional<double> lambda = std::nullopt;
  int path = 100;                  ///< values of lambda on the path, >= 2
  double path_ratio = 1e-3;        ///< last over first value, 0 < ratio < 1
  bool one_standard_error = true;  ///< cross-validation: the largest lambda within one standard error of the least
  /// Refit the selected features by least squares, which takes away the lasso's shrinkage.
  bool refit = false;
};
void validate(const LassoOptions& options);

/// One lambda of a path.
struct PathPoint {
  double lambda = 0;
  Eigen::VectorXd coefficients;
  double rmse = 0;     ///< on the data of the fit
  double cv_rmse = 0;  ///< over the left-out blocks; NaN without cross-validation
  double cv_std = 0;   ///< standard error of the left-out mean square, carried over to the rmse
};

/// min |X b - z|^2 / (2 rows size(z)^2) + lambda * sum (mixture |s_j| + (1 - mixture) s_j^2 / 2) with s_j = size_j b_j
/// / size(z) and the sizes of ridge(). Exact at each lambda: a quadratic programme in the orthant of the signs, which
/// moves to a neighbouring orthant while that lowers the objective; works with any constraints. (Tibshirani 1996, J. R.
/// Stat. Soc. B 58, 267.) `blocks`: statistics of blocks of time; cross-validation leaves out each in turn and needs at
/// least 3. `path` receives the whole path when given.
Fit lasso(std::span<const Statistic> blocks, const LassoOptions& options = {},
          std::span<const Constraint> constraints = {}, std::vector<PathPoint>* path = nullptr);

}  // namespace lunid
