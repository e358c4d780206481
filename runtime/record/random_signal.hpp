#pragma once
// Random signals of a given spectrum: excitations, and the noise of sensors.
#include <Eigen/Core>
#include <span>

#include "record/random.hpp"

namespace lunid {

/// `rows` independent numbers, Gaussian of standard deviation 1, or uniform within -1 to 1.
Eigen::VectorXd white_noise(Eigen::Index rows, Philox& random);
Eigen::VectorXd uniform_noise(Eigen::Index rows, Philox& random);

/// Gaussian noise whose power density goes as 1/f^exponent up to the Nyquist frequency (0 white, 1 pink, 2 brown, -1
/// blue): white noise through its Fourier transform (Timmer & Koenig 1995, Astron. Astrophys. 300, 707), twice as long
/// as needed and cut, so that its end does not know its beginning. Mean 0 and rms 1 over its rows.
Eigen::VectorXd coloured_noise(Eigen::Index rows, double exponent, Philox& random);

/// Gaussian noise of even density between two frequencies and none outside, made and scaled in the same way. [Hz]
/// Throws InputError unless 0 <= from < to <= 1/(2 dt), or when the band is narrower than the rows can tell.
Eigen::VectorXd band_limited_noise(Eigen::Index rows, double dt, double from, double to, Philox& random);

/// x[i] = ar[0] x[i-1] + ar[1] x[i-2] + ... + Gaussian noise, in its stationary state; rms 1 over its rows.
/// Throws InputError when the series would grow (a root of its polynomial within the unit circle).
Eigen::VectorXd autoregressive_noise(Eigen::Index rows, std::span<const double> ar, Philox& random);

}  // namespace lunid
