#pragma once
// Whether the records show more than one motion.
#include <span>
#include <vector>

#include "discover/study.hpp"

namespace lunid {

struct Tone {
  double omega = 0;      ///< [rad/s]
  double amplitude = 0;  ///< of the signal
  double share = 0;      ///< of its variance
};

/// The strongest tone of a signal of even steps `dt` [s], by least squares about its dominant frequency.
Tone strongest_tone(std::span<const double> x, double dt);

/// These records of a study hold one tone at one level: what is named by them follows one loop, and laws that part at
/// other levels or frequencies cannot be told. Its angular frequency [rad/s]; 0 where they hold more.
double one_motion(const Study& study, const std::vector<Record>& records);

}  // namespace lunid
