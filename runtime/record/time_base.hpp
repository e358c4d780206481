#pragma once
// Inside record: from time stamps to t = t0 + i*dt.
#include <span>
#include <string>
#include <vector>

#include "record/csv_table.hpp"

namespace lunid {

struct TimeBase {
  double t0 = 0, dt = 1;
  Eigen::Index rows = 0;
  bool resampled = false;  ///< the rows are not the file's: use resample()
};

/// The even time base of stamps t [s]. Rounded stamps are even time. Adds warnings; throws InputError
/// (Fault::data) with the line: fewer than 6 rows, time that runs backwards or stands, missing rows, uneven
/// steps. With `resample` missing rows and uneven steps give the median step instead. `resolution[i]`:
/// printed rounding step of t[i] [s].
TimeBase fit_time_base(std::span<const double> t, std::span<const double> resolution, std::span<const int> lines,
                       const std::string& path, bool resample, std::vector<std::string>& warnings);

/// Values at t0 + i*dt from values at uneven, increasing times t, by cubics through the four nearest samples.
Eigen::VectorXd resample(std::span<const double> t, std::span<const double> x, const TimeBase& base);

}  // namespace lunid
