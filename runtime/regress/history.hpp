#pragma once
// History models: the next output from past outputs, inputs and prediction errors (ARX, ARMAX, NARX, NARMAX).
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "record/record.hpp"

namespace lunid {

/// Which lags a model may hold. The sample of output `y` i steps back is written y_i, that of the input F_i, that of
/// the prediction error e_i.
struct HistoryOptions {
  std::string output = "y", input = "F";  ///< channels
  int output_lags = 2;                    ///< y_1 .. y_n, >= 0
  int input_lags = 2;                     ///< so many samples of the input, >= 0, from
  int input_delay = 1;  ///< this one on, >= 0: 1 for a force held between samples, 0 for a straight one
  int noise_lags = 0;   ///< e_1 .. e_n, >= 0: an ARMAX or NARMAX model
  int degree = 1;       ///< of the polynomial in outputs and inputs, 1 to 5; > 1: NARX, NARMAX
  bool constant = false;
  std::vector<Expr> features;  ///< of y_i, F_i, e_i; in place of all monomials up to the degree
  int max_passes = 200;        ///< of extended least squares, >= 1
};
/// Throws InputError on counts out of range and on too many terms (over 400).
void validate(const HistoryOptions& options);

struct HistoryTerm {
  Expr feature;
  double coefficient = 0, std = 0;
};

struct HistoryModel {
  HistoryOptions options;
  std::vector<HistoryTerm> terms;
  Eigen::MatrixXd covariance;                     ///< of the coefficients, from white prediction errors
  double dt = 0;                                  ///< [s]
  Interpolation between = Interpolation::linear;  ///< of the input it was fitted to
  Eigen::Index rows = 0;
  double residual_std = 0;  ///< of the one-step prediction errors, in units of the output
  double aic = 0, bic = 0;  ///< rows*log(residual variance) + 2*terms, or + log(rows)*terms (Akaike 1974; Schwarz 1978)
  bool converged = true;
  std::string stopped;
  int passes = 1;
  std::vector<Eigen::VectorXd> residual;  ///< one for each record, its first rows 0
};

/// Least squares of output = sum of coefficient * feature over the rows of all records. With prediction errors among
/// the features: extended least squares, the errors computed anew from each fit until the coefficients rest (Young
/// 1968; Billings 2013, Nonlinear System Identification, 3.5). Throws InputError: a channel that is absent, records of
/// several sampling times, fewer rows than terms.
HistoryModel fit_history(Pool& pool, std::span<const Record> records, const HistoryOptions& options);

/// One row of a comparison of orders: outputs and inputs with so many lags each.
struct HistoryOrder {
  int output_lags = 0, input_lags = 0;
  double residual_std = 0, aic = 0, bic = 0;
};
/// All orders up to those of `options`, fitted to the same rows; the first of them has the least BIC.
std::vector<HistoryOrder> history_orders(Pool& pool, std::span<const Record> records, const HistoryOptions& options);

/// Prediction of the output from what was measured up to `steps` samples before (1: one-step); 0: a free run, from the
/// first measured rows on. Where it grows beyond 1e6 times the measured output it ends: the rest is NaN.
struct Prediction {
  Eigen::VectorXd values;   ///< one for each row of the record; the first rows are measured ones
  Eigen::Index first = 0;   ///< row of the first prediction
  double rmse = 0;          ///< from there on; infinite where it ended early
  double fit = 0;           ///< 100 (1 - rmse / standard deviation of the measured output) [%], over the same rows
  Eigen::Index ended = -1;  ///< row where it grew without bound, or -1
};
Prediction predict(const HistoryModel& model, const Record& record, int steps);

/// A correlation of the residual with another signal, lag by lag.
struct ResidualTest {
  std::string name;  ///< "residual with itself", "residual with the input", "residual with the squared input"
  int first_lag = 0;
  Eigen::VectorXd correlation;
  double bound = 0;    ///< 1.96 / sqrt(rows): 95 % of a white residual's lie within
  int outside = 0;     ///< lags beyond it
  bool passed = true;  ///< no more lags outside than chance explains (5 % binomial tail at 1 %)
};
/// Whiteness, independence of the input and, for what is not linear, of its square (Billings & Voon 1986, Int. J.
/// Control 44, 235). The residual is the one-step prediction error on `record`.
std::vector<ResidualTest> residual_tests(const HistoryModel& model, const Record& record, int lags = 25);

/// m a + c v + k y = F whose samples the model describes.
struct ContinuousModel {
  double mass = 0, damping = 0, stiffness = 0;
  double mass_std = 0, damping_std = 0, stiffness_std = 0;
  /// Relative difference between the input coefficients of the model and those that this equation has when its force is
  /// held, or straight, between samples: 0 for a model that is exactly of this kind.
  double mismatch = 0;
};
/// Of a linear model with two output lags: poles s = log(z)/dt, the stiffness from the static gain. Throws InputError
/// where no such equation exists: other orders, poles on the negative real axis, an unstable or missing static gain.
ContinuousModel to_continuous(const HistoryModel& model);
/// The poles of a linear model in continuous time [rad/s], pairs of (real, imaginary part).
std::vector<std::pair<double, double>> history_poles(const HistoryModel& model);

}  // namespace lunid
