#pragma once
// Inside record: which variables of a MAT or HDF5 file are the channels of a record.
#include <string>
#include <vector>

#include "record/columns.hpp"
#include "record/container.hpp"

namespace lunid {

/// The vectors of a file that may become channels, each with the header that a CSV file would give it.
struct ContainerPlan {
  std::vector<ContainerChoice> choices;
  std::vector<HeaderCell> header;
  std::vector<ColumnPlan> plans;
  std::vector<std::string> warnings;
  std::size_t time = 0;               ///< number of the time; has_time() is false where an interval is given instead
  std::size_t rows = 0;               ///< of the record: those of the time, else of the first channel
  double interval = 0;                ///< [s], without a time
  std::vector<std::size_t> channels;  ///< numbers of those that are channels of so many rows

  bool has_time() const { return time < plans.size(); }
};
/// Throws InputError (Fault::data): no time, no such variable, lengths that differ.
ContainerPlan plan_container(Container& file, const std::string& path, ReadOptions options);

/// By how much the stamps `t` may be off even time: the rounding of single precision, or that of sums t + dt + dt ...,
/// within a part in a million of a step. `all`: of all stamps of the record.
struct StampRange {
  double count, first, last;
};
Eigen::VectorXd stamp_resolution(const Eigen::VectorXd& t, const StampRange& all, bool single);

/// "variable 'F': row 12: expected a finite number, got NaN" for the first such value; "" where there is none. `first`:
/// number of the first row.
std::string not_finite(const ContainerPlan& plan, std::size_t channel, std::size_t first,
                       const Eigen::VectorXd& values);

}  // namespace lunid
