#pragma once
// Inside record: the spectrum of a record without its noise.
#include <Eigen/Core>
#include <complex>
#include <functional>
#include <span>

#include "record/extension.hpp"

namespace lunid {

struct ShapedSpectrum {
  Extended extended;
  Eigen::Index length = 0;  ///< of the transform
  Eigen::VectorXd gain;     ///< at its bins
  Eigen::VectorXcd spectrum;
  /// The signal (without its line) times a factor in the frequency domain; w in radians a row.
  Eigen::VectorXd times(const std::function<std::complex<double>(double w)>& factor) const;
};
/// The spectrum of x without its line, continued beyond its ends, times Wiener's gain for white noise of this standard
/// deviation; or, with a cut-off > 0 [Hz], times a low pass.
ShapedSpectrum shaped_spectrum(std::span<const double> x, double dt, double noise, double cutoff = 0);

}  // namespace lunid
