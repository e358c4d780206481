#pragma once
// What a record looks like over frequency and over slow time: densities, transfer functions, envelopes, cycles, noise.
#include <Eigen/Core>
#include <array>
#include <complex>
#include <span>
#include <vector>

#include "record/record.hpp"

namespace lunid {

/// Rows of a segment: a power of two from 16 to the rows; 0: about 15 half-overlapping segments. Throws InputError.
Eigen::Index segment_length(Eigen::Index rows, Eigen::Index asked, const char* where);
/// Independent averages that half-overlapping Hann segments are worth. (Welch 1967: 18/19 of their number.)
double averages(Eigen::Index segments);

/// One-sided power spectral density [unit^2/Hz] by Welch's method, with 95 % limits by chi-square.
struct PowerSpectrum {
  Eigen::VectorXd frequency, density, low, high;
  Eigen::Index length = 0, segments = 0;
};
PowerSpectrum power_spectrum(std::span<const double> x, double dt, Eigen::Index length = 0);

/// From an input x to an output y, both with Hann windows and half-overlapping segments. H1 = Sxy/Sxx holds for noise
/// in the output, H2 = Syy/Syx for noise in the input; the truth lies between them. (Bendat & Piersol 2010, 6.1, 9.2.)
struct TransferFunction {
  Eigen::VectorXd frequency;
  Eigen::VectorXcd h1, h2;
  Eigen::VectorXd coherence;  ///< 0 to 1
  /// Standard deviation of the magnitude over the magnitude, and of the phase [rad]: sqrt((1 - g^2)/(2 g^2 averages)).
  Eigen::VectorXd error;
  double averages = 0;
  double chance = 0;  ///< coherence that unrelated noise stays under at 95 %: 1 - 0.05^(1/(averages - 1))
  Eigen::Index length = 0, segments = 0;
};
/// Throws InputError for fewer than two segments, of which the coherence would be 1 whatever the data.
TransferFunction transfer_function(std::span<const double> x, std::span<const double> y, double dt,
                                   Eigen::Index length = 0);

/// Densities of Hann segments `hop` rows apart: columns are segments.
struct Spectrogram {
  Eigen::VectorXd time;  ///< middles of the segments [s] after the first row
  Eigen::VectorXd frequency;
  Eigen::MatrixXd density;  ///< frequency x time [unit^2/Hz]
  Eigen::VectorXd ridge;  ///< frequency of the largest density of each segment, between bins by a parabola of the logs
};
Spectrogram spectrogram(std::span<const double> x, double dt, Eigen::Index length, Eigen::Index hop);

/// Of the analytic signal x + i Hilbert(x) about the record's line, without the noise (Wiener's gain). (Gabor 1946.)
struct Envelope {
  Eigen::VectorXd amplitude;
  Eigen::VectorXd frequency;  ///< instantaneous [Hz]
  Eigen::VectorXd phase;      ///< unwrapped [rad]
};
Envelope envelope(std::span<const double> x, double dt, double noise);

/// Takes the jumps of whole turns out of an angle [rad]: each row is the one that is nearest to the row before it.
void unwrap(Eigen::VectorXd& angle);
/// Channels that discovery takes for the angle of a shaft, which may wrap.
inline constexpr std::array shaft_angles{"phase", "shaft_angle"};

/// From one upward crossing of the record's line to the next, where between the two the signal went beyond the noise on
/// both sides.
struct Cycle {
  double time;       ///< of its first crossing [s] after the first row
  double period;     ///< [s]
  double amplitude;  ///< half of highest less lowest
  double mean;       ///< half of highest plus lowest
};
std::vector<Cycle> cycles(std::span<const double> x, double dt, double noise);

/// The noise under a signal in more than one number.
struct NoiseReport {
  double white = 0;           ///< noise_level: the lowest level of the spectrum, taken over the whole band
  double robust = 0;          ///< by the median of high differences: outliers do not reach it (Donoho & Johnstone 1994)
  Eigen::Index outliers = 0;  ///< rows whose differences stand out of it by more than 6 deviations
  double exponent = 0;        ///< of the background S ~ f^-exponent: 0 white, 1 pink, 2 brown, -2 of a velocity
  double exponent_std = 0;
  double background = 0;               ///< standard deviation of that background over the band
  Eigen::VectorXd frequency, density;  ///< the background's levels that the line was laid through [Hz, unit^2/Hz]
};
/// The background is the lower quartile of the spectrum over bands of equal ratio, so that tones and resonances in a
/// band do not count; the line through its logarithms is Theil's and Sen's. Broad-band motion cannot be told from
/// noise.
NoiseReport noise_report(std::span<const double> x, double dt);

/// A single row that a smooth signal cannot have: off what its neighbours say by far more than their noise, and mended
/// by one value (a kink, or a jump, of the signal is not).
struct WildRow {
  Eigen::Index row;
  double value;  ///< by its neighbours: the sixth difference about it is zero
};
std::vector<WildRow> wild_rows(std::span<const double> x);

/// The step of a quantised signal, in which its values lie; 0 where it has none.
double quantisation_step(std::span<const double> x);

/// What a channel's rows are like, for print(record).
struct ChannelSummary {
  double least = 0, most = 0, mean = 0, std = 0;  ///< of the rows that are numbers
  Eigen::Index missing = 0;                       ///< rows that are not
  Eigen::Index held = 0;                          ///< longest run of rows that repeat the value before them
};
ChannelSummary summary(std::span<const double> x);
/// Several lines: rows, rate, span; each channel's range, deviation, noise and derivation; what was done; warnings.
std::string describe(const Record& record);

}  // namespace lunid
