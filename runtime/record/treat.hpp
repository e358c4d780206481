#pragma once
// What is done to a whole record: filters, trends, rates, delays, integrals. Each gives a new record that remembers it.
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "record/record.hpp"

namespace lunid {

// ---- Butterworth filters ----

/// Passes `from` to `to` [Hz]; from = 0: all below `to`; to = 0: all above `from`. `stop`: all but that.
struct Band {
  double from = 0, to = 0;
  bool stop = false;
};
/// (b0 + b1/z + b2/z^2)/(1 + a1/z + a2/z^2)
struct Section {
  double b0, b1, b2, a1, a2;
};
/// Butterworth's filter (1930) by the bilinear transformation with prewarped cut-offs, in sections of second order. A
/// band's filter has twice the order. Throws InputError: cut-offs beyond the Nyquist frequency or in the wrong order,
/// order outside 1 to 12.
std::vector<Section> butterworth(const Band& band, int order, double dt);
/// Amplitude of the filter at a frequency [Hz].
double amplitude_at(const std::vector<Section>& sections, double frequency, double dt);
/// Forwards and backwards, so that nothing is delayed: the amplitude is that of the filter squared, 1/2 at a cut-off.
/// The ends are continued by linear prediction (extension.hpp), so that they neither ring nor jump; a line is passed or
/// taken off exactly.
Eigen::VectorXd filter_zero_phase(std::span<const double> x, const Band& band, int order, double dt);

struct FilterOptions {
  Band band;
  int order = 4;
  std::vector<std::string> channels;  ///< empty: all
};
Record filter(const Record& record, const FilterOptions& options);

// ---- trends ----

/// x without its least-squares polynomial of degree 0 to 12.
Eigen::VectorXd without_polynomial(std::span<const double> x, int degree);
Record detrend(const Record& record, int degree, const std::vector<std::string>& channels);

// ---- rates and delays ----

/// x at the positions first + i*step [rows], i < count, by a Kaiser-windowed sinc (80 dB and more); for step > 1 it is
/// also the anti-alias filter, flat to 0.8 and gone at 1.0 of the new Nyquist frequency. (Smith & Gossett 1984.)
Eigen::VectorXd band_limited(std::span<const double> x, double first, double step, Eigen::Index count);
/// Every `factor`-th row after the anti-alias filter.
Record decimate(const Record& record, int factor);
/// The same span at another rate [Hz].
Record resample(const Record& record, double rate);

struct AlignOptions {
  std::string channel = "y";  ///< that both records hold
  double most = 0;            ///< largest delay looked for [s]; 0: half of the shorter record
};
struct Aligned {
  Record record;           ///< on the rows of the other record
  double delay = 0;        ///< [s] by which it came later than the other
  double correlation = 0;  ///< of the two channels after that, -1 to 1
};
/// Moves a record onto the time of another: the delay of the largest correlation of one channel, to a small part of a
/// row, and the shift by band-limited interpolation. Throws InputError: other rates, no overlap.
Aligned align(const Record& record, const Record& other, const AlignOptions& options);

// ---- integrals ----

struct IntegrateOptions {
  std::string from;  ///< acceleration or velocity; "": the measured one
  int degree = 1;    ///< of the polynomial of drift taken off the first integral; one more off the second
  double below =
      0;  ///< [Hz]: drift is what lies below, taken off by a zero-phase high pass of order 4; 0: a polynomial
};
/// Velocity and displacement that were not measured, from an acceleration or a velocity.
Record integrate(const Record& record, const IntegrateOptions& options);

}  // namespace lunid
