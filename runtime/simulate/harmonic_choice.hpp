#pragma once
// How many harmonics, and how many samples for them, along a branch of harmonic balance.
#include "simulate/balance.hpp"

namespace lunid {

class HarmonicChoice {
 public:
  /// `fixed` > 0: so many and no others; else up to `most`, so that what is left out is below `accuracy` of the motion.
  HarmonicChoice(const Dynamics& dynamics, int fixed, int most, double accuracy);

  void begin(HarmonicBalance& balance) const;
  /// After a solution q: true when harmonics or samples have changed, so that q has to be resized and corrected.
  bool adapt(HarmonicBalance& balance, const Eigen::VectorXd& q, double omega);
  bool truncated() const { return truncated_; }  ///< of the last solution: more harmonics would be needed

 private:
  Eigen::Index samples_for(int harmonics) const;
  int needed(const HarmonicBalance& balance, const Eigen::VectorXd& q) const;
  bool change(HarmonicBalance& balance, int harmonics);

  bool smooth_;
  int fixed_, most_;
  double accuracy_;
  bool truncated_ = false;
  int calm_ = 0;
};

}  // namespace lunid
