#pragma once
// Forces as smooth functions of dimensionless time, evaluated exactly at every stage of the integrator.
#include <cstdint>
#include <functional>

namespace truth {

/// A force over dimensionless time tau (1 = one radian of the linear oscillator).
using Signal = std::function<double(double tau)>;

/// Sum of `lines` cosines of unit amplitude, spread evenly over [from, to] (natural frequency = 1) with
/// random phases, each line off its grid point by a random part of the spacing.
Signal multisine(double from, double to, int lines, std::uint64_t seed);
/// Unit cosine whose frequency rises evenly from `from` to `to` over [0, duration], and falls back beyond it.
Signal chirp(double from, double to, double duration);
/// A step of height one at tau = start, smoothed over one radian.
Signal step(double start);
/// A sum of one cosine: a tone.
Signal tone(double frequency);
/// No force: a free decay.
Signal none();

}  // namespace truth
