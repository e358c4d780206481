#pragma once
// Periodic motions as Fourier series over the phase tau = omega*t, and the inputs that drive them.
// A series of n states with H harmonics is a (2H + 1) x n matrix: rows a0, a1, b1, ... aH, bH of
// x(tau) = a0 + sum of ak cos(k tau) + bk sin(k tau).
#include <Eigen/Core>
#include <complex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "simulate/dynamics.hpp"

namespace lunid {

/// One harmonic of an exogenous input: u[input] gains Re(coefficient * (i*k*omega)^derivative * exp(i*k*omega*t)), k
/// being `harmonic`. A cosine force of amplitude A is {0, 1, A, 0}; a base that moves as Y cos(omega t) is yb: {i, 1,
/// Y, 0}, vb: {j, 1, Y, 1}, ab: {k, 1, Y, 2}.
struct HarmonicInput {
  int input = 0;
  int harmonic = 1;  ///< >= 0; 0: a constant
  std::complex<double> coefficient;
  int derivative = 0;
};

/// The inputs at `phase` (samples x exogenous), the angular frequency being omega [rad/s].
Eigen::MatrixXd input_values(std::span<const HarmonicInput> inputs, int exogenous, double omega,
                             const Eigen::VectorXd& phase);

/// cos(k tau) and sin(k tau) at `samples` even phases, as columns in the order of a series.
class FourierTable {
 public:
  FourierTable() = default;
  FourierTable(int harmonics, Eigen::Index samples);
  int harmonics() const { return static_cast<int>(values_.cols() / 2); }
  Eigen::Index samples() const { return values_.rows(); }
  const Eigen::VectorXd& phase() const { return phase_; }
  const Eigen::MatrixXd& values() const { return values_; }
  /// Samples of series, one column each.
  Eigen::MatrixXd sample(const Eigen::MatrixXd& series) const { return values_ * series; }
  /// Series of samples, one column each.
  Eigen::MatrixXd series(const Eigen::MatrixXd& samples) const;

 private:
  Eigen::VectorXd phase_;
  Eigen::MatrixXd values_;
};

/// The series of dx/dtau.
Eigen::MatrixXd phase_derivative(const Eigen::MatrixXd& series);

/// f, df/dx along samples of a motion, by one column run of the derivative tape.
class DerivativeColumns {
 public:
  DerivativeColumns(const Dynamics& dynamics, std::span<const double> theta);
  /// u: samples x exogenous, x: samples x n. False where a value is not finite.
  bool run(const Eigen::MatrixXd& u, const Eigen::MatrixXd& x);
  auto rate() const { return out_.leftCols(n_); }
  auto slope(int row, int column) const { return out_.col(n_ + row * n_ + column); }
  const Dynamics& dynamics() const { return d_; }

 private:
  const Dynamics& d_;
  std::vector<double> theta_;
  int n_;
  double zero_ = 0;
  Eigen::MatrixXd out_;
};

/// The states (y, v) of each degree of freedom.
std::vector<std::pair<int, int>> displacement_pairs(const Dynamics& dynamics);

/// True when the right-hand side holds the time itself.
bool depends_on_time(const Dynamics& dynamics, std::span<const double> theta);

/// What a state does over a period.
struct Motion {
  double min = 0, max = 0;
  /// Mean, then for k = 1, 2, ... the complex amplitude: x has |c| cos(k omega t + arg c).
  std::vector<std::complex<double>> harmonics;
  double amplitude() const { return 0.5 * (max - min); }  ///< half of the range
};
/// Extremes to rounding. `series`: one column of a series.
Motion motion_of_series(const Eigen::VectorXd& series);
/// Widens [low, high] by the extremes of the cubic through two samples with their slopes (per interval).
void widen_by_cubic(double x0, double x1, double d0, double d1, double& low, double& high);
/// From rows + 1 even samples of one period (the last is the first again): extremes on the cubic that the time
/// derivatives make between samples (of the samples themselves where `rate` is empty), the first `harmonics` harmonics.
/// `periods`: periods of the excitation in it.
Motion motion_of_samples(const Eigen::VectorXd& x, const Eigen::VectorXd& rate, double dt, int harmonics,
                         int periods = 1);

}  // namespace lunid
