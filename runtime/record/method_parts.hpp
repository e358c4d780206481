#pragma once
// Inside record: the methods of derive.hpp, and what they share.
#include <functional>
#include <string>
#include <vector>

#include "expr/digits.hpp"
#include "record/derivative_error.hpp"
#include "record/derive.hpp"

namespace lunid {

Derivative differentiate_by(const FiniteDifferences& method, std::span<const double> x, double dt, double noise,
                            int derivative);
Derivative differentiate_by(const PolynomialWindow& method, std::span<const double> x, double dt, double noise,
                            int derivative);
Derivative differentiate_by(const FourierFilter& method, std::span<const double> x, double dt, double noise,
                            int derivative);
Derivative differentiate_by(const SmoothingSpline& method, std::span<const double> x, double dt, double noise,
                            int derivative);
Derivative differentiate_by(const TotalVariation& method, std::span<const double> x, double dt, double noise,
                            int derivative);
Derivative differentiate_by(const SmoothedDifferences& method, std::span<const double> x, double dt, double noise,
                            int derivative);
Derivative differentiate_by(const KalmanSmoother& method, std::span<const double> x, double dt, double noise,
                            int derivative);

// What a method leaves open, chosen from the estimated error of a signal of so many rows.
FiniteDifferences chosen(const FiniteDifferences& given, const DerivativeError& error, double noise, Eigen::Index rows,
                         int derivative);
PolynomialWindow chosen(const PolynomialWindow& given, const DerivativeError& error, Eigen::Index rows, int derivative);
SmoothedDifferences chosen(const SmoothedDifferences& given, const DerivativeError& error, Eigen::Index rows,
                           int derivative);
// The same from parts of a signal, each with ends of its own: one part where it is whole.
double chosen_weight(const SmoothingSpline& given, std::span<const std::span<const double>> parts, double dt,
                     double noise);  ///< [s^degree]
double chosen_density(const KalmanSmoother& given, std::span<const std::vector<Measurement>> parts, double dt);

/// " by the noise", of a weight that was chosen.
std::string choice_words(const SmoothingSpline& given);
/// "Kalman smoother, white jerk of density 3e+05"
std::string kalman_words(const KalmanSmoother& method, const SmoothedMotion& motion);

/// Weights of finite differences on the positions `at`, for the derivative at 0. (Fornberg 1988.)
Eigen::VectorXd difference_weights(const Eigen::VectorXd& at, int derivative);
/// Differences of this accuracy over rows `step` apart, one-sided at the ends; rows one apart.
Eigen::VectorXd differences(std::span<const double> x, int derivative, int accuracy, int step);

/// The smoothing spline itself, rows one apart: derivative 0, 1 or 2 at the rows, and the trace of its hat matrix.
struct Spline {
  Eigen::MatrixXd values;  ///< rows x 3
  double squares = 0;      ///< sum of (x - f)^2
  double trace = 0;
};
Spline fit_spline(std::span<const double> x, int degree, double weight);

/// Total-variation smoothing, rows one apart: least |x - f|^2/2 + weight*|D f|_1, D the differences of order + 1.
struct Variation {
  Eigen::VectorXd values;  ///< f
  Eigen::VectorXd dual;    ///< z with f = x - D^T z, |z| <= weight
  int pieces = 0;          ///< entries of D f that are not zero
  int steps = 0;           ///< of the interior point method
};
Variation fit_variation(std::span<const double> x, int order, double weight);

/// Minimum of f over log h between `low` and `high`: the best of a geometric grid, then golden sections beside it.
double minimise_over_scale(double low, double high, double ratio, const std::function<double(double)>& f);

/// A number for texts, in four digits.
inline std::string short_number(double value) { return number(value, 4); }
/// Throws InputError `where: message`.
[[noreturn]] inline void refuse(const std::string& where, const std::string& message) {
  throw InputError(where + ": " + message, {}, Fault::study);
}

}  // namespace lunid
