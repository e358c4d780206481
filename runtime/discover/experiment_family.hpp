#pragma once
// The small family of excitations that an experiment is chosen from. Each is a shape of largest value 1 over its time.
#include <string>
#include <vector>

#include "record/record.hpp"

namespace lunid {

struct ExcitationShape {
  std::string name;   ///< "stepped_amplitude"
  std::string words;  ///< "sine at 12 Hz in five steps of amplitude"
  Eigen::VectorXd values;
  Interpolation between = Interpolation::cubic;  ///< hold where it jumps
};

/// Time base and band of the family.
struct ShapeBase {
  Eigen::Index rows = 0;
  double dt = 0;            ///< [s]
  double from = 0, to = 0;  ///< band [Hz]
  double frequency = 0;     ///< where the structure answers most, within the band [Hz]
  std::uint64_t seed = 1;   ///< of the multisines' phases
};

/// A multisine of the band with a low peak: what the frequency of the largest answer is read off first.
ExcitationShape multisine_shape(const ShapeBase& base);

/// All: multisine, swept sine up and down, stepped amplitude at the frequency of the largest answer and at the lowest,
/// a pair of a low and a high level, multisines about offsets, steps, pull and release. `smooth`: only those without
/// jumps, which a motion can follow.
std::vector<ExcitationShape> excitation_family(const ShapeBase& base, bool smooth);

}  // namespace lunid
