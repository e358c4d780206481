#pragma once
// Inside record: what the treatments of a record in memory (treat.hpp) and of a stream (stream_treat.hpp) share.
#include <Eigen/Core>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "record/treat.hpp"

namespace lunid {

// ---- filters [butterworth.cpp] ----

/// Rows after which the rest of the impulse response is under 1e-13 of all of it, at most `most` + 1. (Its slowest pole
/// alone says too little: those of a high order stand close together and all but cancel.)
Eigen::Index filter_reach(const std::vector<Section>& sections, Eigen::Index most);
/// How far a signal of so many rows is continued for a filter.
Eigen::Index filter_extension(const std::vector<Section>& sections, Eigen::Index rows);
/// Forwards and backwards, in place, from rest.
void run_zero_phase(const std::vector<Section>& sections, Eigen::VectorXd& x);
/// Does the filter pass a constant? Then it passes a line as well; else it takes it off.
bool passes_line(const Band& band);
/// Deviation that is left of white noise of 1, forwards and backwards.
double noise_passed(const std::vector<Section>& sections, double dt);
/// "filter: y, v below 20 Hz, Butterworth of order 4 forwards and backwards"
std::string filter_note(const std::vector<std::string>& channels, const FilterOptions& options);

// ---- trends and integrals [trend.cpp] ----

/// "detrend: y, v less a line"
std::string detrend_note(const std::vector<std::string>& channels, int degree);

/// Which channels an integration goes through. Throws InputError as integrate().
struct IntegrationPlan {
  std::string from;    ///< the channel that is integrated
  int rank = 0;        ///< of it: 1 velocity, 2 acceleration
  std::string suffix;  ///< of its coordinate: "", "2", "b"
  std::string name(int r) const { return std::string(1, "yva"[r]) + suffix; }
};
IntegrationPlan integration_plan(const std::vector<Channel>& channels, const IntegrateOptions& options);
/// The integral number `times` (1 or 2) of a plan, without its values, for a signal of so many rows.
Channel integral_channel(const IntegrationPlan& plan, const Channel& source, const IntegrateOptions& options, int times,
                         Eigen::Index rows, double dt);
/// The high pass that takes drift off.
constexpr int drift_order = 4;
Band drift_band(const IntegrateOptions& options);

// ---- other rates [rate.cpp] ----

/// Values between the rows of a signal, by a Kaiser-windowed sinc (band_limited()).
class BandLimited {
 public:
  /// `step`: between the new rows, in old ones.
  explicit BandLimited(double step);
  /// Rows that are needed on either side.
  Eigen::Index margin() const { return static_cast<Eigen::Index>(std::ceil(reach_)) + 2; }
  /// Deviation that is left of white noise of 1.
  double noise_passed() const { return std::sqrt(cutoff_); }
  /// The value at row `at` of the signal, from the rows low .. low + x.size() - 1 of it.
  double operator()(const Eigen::VectorXd& x, Eigen::Index low, double at) const;

 private:
  double kernel(double at) const;

  double cutoff_, reach_;
  Eigen::VectorXd table_;  // of the kernel
};
/// New rows and what is said of them, after the checks of resample() and decimate().
struct NewRate {
  double step = 1, dt = 1;  ///< between the new rows, in old ones and in [s]
  Eigen::Index rows = 0;
  std::string note;
};
NewRate decimated(Eigen::Index rows, double dt, int factor);
NewRate resampled(Eigen::Index rows, double dt, double rate);

}  // namespace lunid
