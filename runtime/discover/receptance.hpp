#pragma once
// What a force that is missing makes of the motion, without a free run.
#include <vector>

#include "discover/candidate.hpp"

namespace lunid {

/// A force that is missing moves the mass through the receptance of the linear system; noise of the sensor, of which
/// the inertia is a second derivative, becomes white again behind it. Hence forces are compared behind
/// 1/(m s^2 + c s + k), with m, c, k the regression of the measured force on a, v, y (Steiglitz and McBride 1965, IEEE
/// Trans. Autom. Control 10, 461); of a velocity that was measured behind s times that, of an acceleration s^2: what is
/// integrated from these is no more than drift at low frequencies, to which a displacement would give all weight. With
/// several coordinates a force on one of them moves all, through the modes of the linear system nearest to the
/// baseline.
class Receptance {
 public:
  Receptance() = default;  ///< forces stay as they are
  /// `data`: the smoothed records.
  Receptance(const Study& study, const Candidate& baseline, const std::vector<FitData>& data);

  /// Of the forces on all coordinates, one after another, of all records in a row what they make of the quantity that
  /// was measured, weighted (Study::weights) and in the same order. Rows out of use have no force.
  Eigen::VectorXd motion_of(const Eigen::VectorXd& force, const std::vector<FitData>& data, Eigen::Index degrees) const;

 private:
  /// A mode as a filter, b0 + b1/z over 1 + a0/z + a1/z^2.
  struct Mode {
    double b[2] = {1, 0}, a[2] = {0, 0};
    Eigen::VectorXd shape;  ///< its displacement on each coordinate; empty with one
    Eigen::VectorXd filtered(const FitData& data, const Eigen::VectorXd& force) const;
  };
  static Mode mode(double mass, double frequency, double damping, double dt);
  void find_modes(const Study& study, const Candidate& baseline, const std::vector<FitData>& data_of);

  std::vector<Mode> modes_;               ///< none: forces stay as they are
  int order_ = 0;                         ///< of the derivative of the displacement that was measured
  std::vector<Eigen::VectorXd> weights_;  ///< of the outputs of each record
};

}  // namespace lunid
