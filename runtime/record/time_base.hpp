#pragma once
// Inside record: from time stamps to t = t0 + i*dt.
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "record/csv_table.hpp"

namespace lunid {

struct TimeBase {
  double t0 = 0, dt = 1;
  Eigen::Index rows = 0;
  bool resampled = false;                         ///< the rows are not the file's: use resample()
  std::vector<std::pair<double, double>> gaps{};  ///< stamps on either side of three missing rows and more [s]
};

/// The even time base of stamps t [s]. Rounded stamps are even time. Adds warnings; throws InputError
/// (Fault::data) with the line: fewer than 6 rows, time that runs backwards or stands, missing rows, uneven
/// steps. With `resample` missing rows and uneven steps give the median step instead. `resolution[i]`:
/// printed rounding step of t[i] [s].
TimeBase fit_time_base(std::span<const double> t, std::span<const double> resolution, std::span<const int> lines,
                       const std::string& path, bool resample, std::vector<std::string>& warnings);

/// Stamps that come in pieces, of which only those are kept that decide whether all are even: the corners of the band
/// that rounding allows. For a record whose time is even, fit() gives what fit_time_base() gives of all of them.
class Stamps {
 public:
  /// The next stamps [s], as fit_time_base() takes them. The first piece sets the step that others are held against.
  void add(std::span<const double> t, std::span<const double> resolution, std::span<const int> lines);
  /// Throws InputError as fit_time_base(): a stream is not resampled.
  TimeBase fit(const std::string& path, std::vector<std::string>& warnings) const;

  struct Corner {
    double row, t, half;  ///< number of the row, its stamp, and by how much that may be rounded
  };

 private:
  Eigen::Index rows_ = 0;
  double first_ = 0, last_ = 0, step_ = 0, resolution_ = 0;  // stamps, median step, resolution of the last one
  long double sum_ = 0, moment_ = 0, square_ = 0;            // of t - first - row*step
  std::vector<Corner> low_, high_;
  Eigen::Index unusual_ = 0;
  double least_ = std::numeric_limits<double>::infinity(), most_ = -least_;  // steps
  int most_line_ = 0, backward_line_ = 0;
  std::string backward_;
};

/// Rows that stand an interval [s] apart, from 0 s on. Throws InputError (Fault::data) for fewer than 6.
TimeBase even_base(Eigen::Index rows, double interval, const std::string& path);

/// Warns of a time that is left out, since an interval [s] is given, and tells of another. `column`: the values of a
/// plan's column.
void compare_clock(const std::vector<ColumnPlan>& plans, double interval,
                   const std::function<Eigen::VectorXd(std::size_t)>& column, std::vector<std::string>& warnings);

/// Values at t0 + i*dt from values at uneven, increasing times t, by cubics through the four nearest samples.
Eigen::VectorXd resample(std::span<const double> t, std::span<const double> x, const TimeBase& base);

/// The channel that a column's values [the file's unit] at the stamps t [s] become; t is not read unless the base is
/// resampled.
Channel channel_of(const ColumnPlan& plan, std::span<const double> values, std::span<const double> t,
                   const TimeBase& base);

}  // namespace lunid
