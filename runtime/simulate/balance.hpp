#pragma once
// Harmonic balance (Krack & Gross 2019, Harmonic balance for nonlinear vibration problems): the Fourier coefficients of
// a periodic motion, the right-hand side being sampled over a period and transformed back (alternating frequency/time;
// Cameron & Griffin 1989). The unknowns are the series of every state but those velocities that are v = y' (they follow
// exactly), so that one harmonic of an oscillator is three numbers.
#include "simulate/harmonics.hpp"

namespace lunid {

class HarmonicBalance {
 public:
  HarmonicBalance(const Dynamics& dynamics, std::span<const double> theta, std::vector<HarmonicInput> inputs);

  void set_harmonics(int harmonics, Eigen::Index samples);
  int harmonics() const { return harmonics_; }
  Eigen::Index samples() const { return table_.samples(); }
  int rows() const { return 2 * harmonics_ + 1; }  ///< of a series
  Eigen::Index size() const { return static_cast<Eigen::Index>(unknown_.size()) * rows(); }
  /// The states whose series are unknowns, in their order in q; (y, v) pairs.
  const std::vector<int>& unknowns() const { return unknown_; }
  const std::vector<std::pair<int, int>>& pairs() const { return pairs_; }

  /// Series of all states.
  Eigen::MatrixXd series(const Eigen::VectorXd& q, double omega) const;
  /// The same q with other harmonics: cut, or filled up with zeros.
  Eigen::VectorXd resized(const Eigen::VectorXd& q, int harmonics) const;

  struct Slopes {
    Eigen::MatrixXd q;
    Eigen::VectorXd omega;    ///< by the angular frequency
    Eigen::VectorXd driving;  ///< by `driving`
  };
  /// What the coefficients lack to balance omega*dx/dtau = f(x, u); `driving` [1/s] is added as driving * v to every
  /// v' (a negative damping in proportion to the mass). False where f is not finite.
  bool residual(const Eigen::VectorXd& q, double omega, double driving, Eigen::VectorXd& r, Slopes* slopes);

  /// Estimated size of the harmonics left out, over that of the series: those of the residual force through the mean
  /// linear system; their sum up to half of the sampled band, and the largest above it.
  struct Tail {
    double left_out = 0, aliased = 0;
  };
  Tail tail(const Eigen::VectorXd& q, double omega);

 private:
  bool sample(const Eigen::MatrixXd& series, double omega);
  void add_block(int row, int state, double omega, double driving, Slopes& slopes, const Eigen::MatrixXd& turned) const;
  Eigen::MatrixXd block(int row, int state, double omega, double driving) const;

  const Dynamics& d_;
  std::vector<HarmonicInput> inputs_;
  DerivativeColumns columns_;
  std::vector<std::pair<int, int>> pairs_;
  std::vector<int> unknown_, equation_;  ///< states; rates that are balanced
  std::vector<int> place_, speed_of_;    ///< per state: its place among the unknowns or -1; the y whose v it is or -1
  int harmonics_ = 0;
  FourierTable table_, fine_;  ///< of the series, and of twice its harmonics for df/dx
};

/// Weights of q by the size of each state's series (displacements share theirs); `largest`: what was met so far.
Eigen::VectorXd series_weights(const HarmonicBalance& balance, const Eigen::VectorXd& q, Eigen::VectorXd& largest);

}  // namespace lunid
