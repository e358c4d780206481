#include "simulate/harmonic_choice.hpp"

#include <algorithm>

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int first_harmonics = 5, least_harmonics = 3;
/// A kink between two samples costs the square of their distance.
constexpr Index least_samples = 128, least_samples_of_kinks = 1024, most_samples = 4096;
/// Harmonics are given up where the highest kept are below this part of the accuracy, for so many points in a row.
constexpr double spare = 1e-4;
constexpr int patience = 6;
/// What lies above half of the sampled band comes back as aliases and is kept to this part of the accuracy.
constexpr double alias_part = 0.1;

}  // namespace

HarmonicChoice::HarmonicChoice(const Dynamics& dynamics, int fixed, int most, double accuracy)
    : smooth_(dynamics.smooth()), fixed_(fixed), most_(most), accuracy_(accuracy) {}

Index HarmonicChoice::samples_for(int harmonics) const {
  Index samples = smooth_ ? least_samples : least_samples_of_kinks;
  while (samples < 8 * (harmonics + 1)) samples *= 2;
  return samples;
}

void HarmonicChoice::begin(HarmonicBalance& balance) const {
  const int harmonics = fixed_ > 0 ? fixed_ : std::min(first_harmonics, most_);
  balance.set_harmonics(harmonics, samples_for(harmonics));
}

bool HarmonicChoice::adapt(HarmonicBalance& balance, const VectorXd& q, double omega) {
  const HarmonicBalance::Tail tail = balance.tail(q, omega);
  const int now = balance.harmonics();
  if (tail.aliased > alias_part * accuracy_ && 2 * balance.samples() <= most_samples) {
    balance.set_harmonics(now, 2 * balance.samples());
    return true;
  }
  truncated_ = tail.left_out > accuracy_;
  if (fixed_ > 0) return false;
  if (truncated_) {
    calm_ = 0;
    return now < most_ && change(balance, std::min(most_, now + std::max(2, now / 2)));
  }
  const int enough = std::max(least_harmonics, needed(balance, q) + 2);
  calm_ = enough < now ? calm_ + 1 : 0;
  if (calm_ < patience) return false;
  calm_ = 0;
  return change(balance, enough);
}

/// The highest harmonic that is not negligible.
int HarmonicChoice::needed(const HarmonicBalance& balance, const VectorXd& q) const {
  const Index rows = balance.rows();
  int needed = 1;
  for (std::size_t i = 0; i < balance.unknowns().size(); ++i) {
    const auto part = q.segment(static_cast<Index>(i) * rows, rows);
    const double scale = part.tail(rows - 1).norm();
    for (int k = balance.harmonics(); k > needed; --k)
      if (part.segment(2 * k - 1, 2).norm() > spare * accuracy_ * scale) needed = k;
  }
  return needed;
}

bool HarmonicChoice::change(HarmonicBalance& balance, int harmonics) {
  const bool more = harmonics > balance.harmonics();
  balance.set_harmonics(harmonics, std::max(samples_for(harmonics), more ? balance.samples() : 0));
  return true;
}

}  // namespace lunid
