#pragma once
// Derivatives of noisy signals: seven methods with one face. What is left at its default is chosen from the noise.
#include <Eigen/Core>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "record/record.hpp"

namespace lunid {

// ---- methods ----

/// Central differences over rows `step` apart, exact for polynomials up to degree derivative + accuracy - 1; one-sided
/// ones of the same accuracy at the ends. (Weights: Fornberg 1988, Math. Comp. 51, 699.)
struct FiniteDifferences {
  int accuracy = 0;  ///< even, 2 to 12; 0: from the noise
  int step = 0;      ///< rows, >= 1; 0: from the noise
};
/// A polynomial through a window of rows. (Savitzky & Golay 1964.)
struct PolynomialWindow {
  int rows = 0;   ///< odd; 0: from the noise
  int order = 0;  ///< 1 to 12, at least the derivative; 0: from the noise
};
/// (i w)^derivative times a gain, over the record without its line, continued beyond its ends by linear prediction and
/// let down to zero, so that it need not be periodic. Without a cut-off the gain is Wiener's, S/(S + N) by the record's
/// own spectrum and noise (Wiener 1949). With one: 1 below it, falling to 0 at 1.25 of it.
struct FourierFilter {
  double cutoff = 0;  ///< [Hz], below the Nyquist frequency; 0: Wiener's gain
};
/// Least sum of (x - f)^2 + weight * integral of (f'' or f''')^2 dt over all functions f: a natural cubic or quintic
/// spline with a knot at each row. (Reinsch 1967; Wahba 1990.)
struct SmoothingSpline {
  int degree = 5;  ///< 3 or 5
  /// How the weight is chosen: by least unbiased risk with the known noise (Mallows 1973), or without it by generalised
  /// cross-validation (Craven & Wahba 1979).
  enum class Choice { noise, cross_validation } by = Choice::noise;
  double weight = 0;  ///< [s^(degree)]; 0: chosen
};
/// Least sum of (x - f)^2/2 + weight * sum of |differences of f|: penalises the total variation of the derivative of
/// `order`, which comes out piecewise constant. The dual problem is a box-constrained quadratic one, solved by a
/// primal-dual interior point method with banded steps. (Chartrand 2011; Kim, Koh, Boyd & Gorinevsky 2009.)
struct TotalVariation {
  int order = 3;      ///< whose variation: 1 velocity, 2 acceleration, 3 jerk
  double weight = 0;  ///< of differences of order + 1, in the signal's unit; 0: by Stein's unbiased risk
};
/// A polynomial window that smooths, then central differences. (As in PySINDy.)
struct SmoothedDifferences {
  int rows = 0, order = 0;  ///< of the window, as PolynomialWindow
  int accuracy = 2;         ///< of the differences
};
/// Displacement, velocity and acceleration jointly, from all that was measured of them: a higher derivative is white
/// noise, and each channel has its own. Rauch, Tung & Striebel's smoother (1965) in its square-root form without a
/// prior on the first state (Bierman 1977); the density by maximum likelihood.
struct KalmanSmoother {
  double density = 0;  ///< two-sided, of the white derivative [(m/s^order)^2/Hz]; 0: by maximum likelihood
  int order = 4;       ///< which derivative is white: 3 the jerk, to 6
};
using DerivativeMethod = std::variant<FiniteDifferences, PolynomialWindow, FourierFilter, SmoothingSpline,
                                      TotalVariation, SmoothedDifferences, KalmanSmoother>;

// ---- of a signal ----

struct Derivative {
  Eigen::VectorXd values;
  double noise = 0;  ///< standard deviation of what the noise of the signal leaves in it, away from the ends
  std::string how;   ///< method and chosen parameters, for people
};
/// Derivative 0 (the smoothed signal), 1 or 2 of an even signal with white noise of this standard deviation. Throws
/// InputError for options out of range and for too few rows.
Derivative differentiate(std::span<const double> x, double dt, double noise, int derivative,
                         const DerivativeMethod& method);

/// "finite_differences", "savitzky_golay" ...: the language's name.
std::string name_of(const DerivativeMethod& method);

// ---- jointly ----

/// A measured channel of one coordinate.
struct Measurement {
  int rank = 0;  ///< 0 displacement, 1 velocity, 2 acceleration
  std::span<const double> values;
  double noise = 0;  ///< standard deviation
};
struct SmoothedMotion {
  int lowest = 0;          ///< rank of the first column: that of the lowest measurement
  Eigen::MatrixXd values;  ///< rows x (3 - lowest)
  Eigen::MatrixXd std;     ///< standard deviations of the same, under the model
  double density = 0;      ///< used [(m/s^order)^2/Hz]
  double log_likelihood = 0;
};
/// The motion that explains all measurements. Throws InputError for none, for unequal lengths and for fewer than 6
/// rows.
SmoothedMotion kalman_smoother(const std::vector<Measurement>& measurements, double dt,
                               const KalmanSmoother& options = {});

// ---- of a record ----

struct DeriveOptions {
  DerivativeMethod method = FourierFilter{};
  std::vector<std::string> channels;  ///< to make, of y v a y1 v1 ...; empty: what of v and a was not measured
  std::string from;                   ///< channel to differentiate; "": the nearest measured one below each
  bool smooth = false;                ///< measured channels as well are replaced by what the method makes of them
};
/// This record with derived channels that remember how. A Kalman smoother takes all measured channels of a coordinate.
/// Throws InputError: no such channel, nothing to derive from, values that are no numbers, a constant channel.
Record derive(const Record& record, const DeriveOptions& options);

}  // namespace lunid
