#pragma once
// Floquet multipliers: the eigenvalues of the monodromy matrix, which carries a small disturbance over one period.
#include <Eigen/Core>
#include <complex>
#include <map>
#include <vector>

#include "simulate/harmonics.hpp"

namespace lunid {

/// The monodromy matrix along a periodic motion given as a series: a product of exponentials over slices of the period
/// (Magnus expansion of fourth order; Iserles, Munthe-Kaas, Norsett & Zanna 2000, Acta Numerica 9, 215), exact where
/// df/dx is constant. The slices are as short as the fastest rate of the linearised system asks for.
class Monodromy {
 public:
  Monodromy(const Dynamics& dynamics, std::span<const double> theta, std::vector<HarmonicInput> inputs);
  Eigen::MatrixXd along(const Eigen::MatrixXd& series, double omega);

 private:
  const FourierTable& table(int harmonics, Eigen::Index samples);
  DerivativeColumns columns_;
  std::vector<HarmonicInput> inputs_;
  std::map<std::pair<int, Eigen::Index>, FourierTable> tables_;
};

using Multipliers = std::vector<std::complex<double>>;
/// The eigenvalues, the largest first.
Multipliers multipliers_of(const Eigen::MatrixXd& monodromy);

/// How many multipliers lie outside the unit circle, and where they left it: through +1 (fold, branch point), through
/// -1 (period doubling), or as a complex pair (Neimark-Sacker).
struct Outside {
  int plus = 0, minus = 0, complex = 0;
  int total() const { return plus + minus + complex; }
};
Outside outside(const Multipliers& multipliers);

}  // namespace lunid
