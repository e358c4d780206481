#pragma once
// Inside record: the error that a linear filter will make of a derivative, from the spectrum and the noise alone.
#include <Eigen/Core>
#include <span>

#include "record/spectrum.hpp"

namespace lunid {

/// Mean squared error of a filtered derivative (0: of the smoothed signal) in the middle of a record: the noise that it
/// lets through, plus what it does to the part of the signal that stands out of the noise. Samples one apart.
class DerivativeError {
 public:
  /// `noise`: standard deviation of the white noise in x.
  DerivativeError(std::span<const double> x, double noise, int derivative);
  /// From the signal's spectrum over segments of segment_length().
  DerivativeError(const Spectrum& spectrum, double noise, int derivative);
  static Eigen::Index segment_length(Eigen::Index rows);
  /// Of the weights of a symmetric or antisymmetric window, an odd number of them.
  double of(const Eigen::VectorXd& weights) const;
  Eigen::Index length() const { return length_; }  ///< of the transform; bin k is at 2 pi k / length per sample
  const Eigen::VectorXd& density() const { return density_; }  ///< of the signal without the noise; 0 where below it
  double noise_density() const { return noise_density_; }

 private:
  Eigen::VectorXd density_;
  double noise_density_ = 0;
  Eigen::VectorXcd ideal_;  // (i w)^derivative
  Eigen::Index length_ = 0;
};

}  // namespace lunid
