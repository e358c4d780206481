#pragma once
// Fourier transforms and power spectra of evenly sampled signals.
#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

namespace lunid {

/// Fourier transform of a real signal, padded with zeros to `length` (a power of two >= its size): the bins
/// 0 .. length/2, X[k] = sum x[i] exp(-2 pi i k / length). No planning, so the same bits each time.
Eigen::VectorXcd half_spectrum(std::span<const double> x, Eigen::Index length);
/// The real signal whose half spectrum this is; `length` values.
Eigen::VectorXd inverse_half_spectrum(const Eigen::VectorXcd& spectrum, Eigen::Index length);

/// One-sided power spectral density by Welch's method: Hann window, half-overlapping segments, each rid of
/// its line.
struct Spectrum {
  Eigen::VectorXd density;  ///< bins 0 .. length/2; the mean over all bins of white noise is its variance
  Eigen::Index length = 0;  ///< of a segment; bin k is at k / (length * dt)
  Eigen::Index segments = 0;
};
/// `length`: of the segments, a power of two <= the number of samples. (Welch 1967, IEEE Trans. AU-15, 70.)
Spectrum welch(std::span<const double> x, Eigen::Index length);

/// The same of a signal that comes in pieces, to the same bits; holds no more than one segment beside a piece.
class WelchSum {
 public:
  /// `samples`: how many will come.
  WelchSum(Eigen::Index samples, Eigen::Index length);
  void add(std::span<const double> piece);
  Spectrum spectrum() const;

 private:
  Eigen::Index samples_, start_ = 0, first_ = 0;  // of the next segment; of the first sample held
  Eigen::VectorXd window_;
  std::vector<double> held_;
  Spectrum sum_;
};

/// The largest power of two <= n (n >= 1), and the smallest >= n.
Eigen::Index power_of_two_below(Eigen::Index n);
Eigen::Index power_of_two_above(Eigen::Index n);

/// x without its least-squares polynomial of `degree` 0, 1 or 2.
Eigen::VectorXd detrend(std::span<const double> x, int degree);

}  // namespace lunid
