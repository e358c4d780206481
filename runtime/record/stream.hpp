#pragma once
// A record that lies in a file and is read block by block: larger than memory. One in memory is a stream too.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "record/derive.hpp"
#include "record/record.hpp"

namespace lunid {

class RowSource;  // row_source.hpp

/// Value type; copies and windows share the file.
class Stream {
 public:
  /// A record in memory.
  Stream(Record record);  // NOLINT: a record is a stream
  /// Rows that lie elsewhere.
  explicit Stream(std::shared_ptr<const RowSource> rows);
  bool in_memory() const { return record_.has_value(); }

  const std::string& name() const;
  Eigen::Index rows() const { return count_; }
  double dt() const;                                                          ///< [s]
  double start() const;                                                       ///< [s] of the first row of the window
  double duration() const { return dt() * static_cast<double>(count_ - 1); }  ///< [s]
  double time(Eigen::Index row) const { return start() + dt() * static_cast<double>(row); }
  bool has(std::string_view channel) const;
  /// Name, unit, noise and derivation of a channel; only a record in memory has its values there. Throws InputError
  /// naming the channels that there are.
  const Channel& channel(std::string_view channel) const;
  const std::vector<Channel>& channels() const;
  const std::vector<std::string>& warnings() const;
  const std::vector<std::string>& history() const;  ///< what was done to it since it was read

  /// Rows with from <= t <= to [s], as Record::window.
  Stream window(double from, double to) const;
  /// Rows [first, first + count) of this window, in memory. Derived channels are those of the whole record: more rows
  /// are read on both sides where their filters need them. Throws InputError (Fault::data): the file has changed.
  Record read(Eigen::Index first, Eigen::Index count) const;
  /// Calls visit(first, rows) for all rows, in order, some ten thousand at a time.
  void for_each_block(const std::function<void(Eigen::Index first, const Record& rows)>& visit) const;

  /// The record, of a stream in memory.
  const Record& record() const { return *record_; }
  /// Where the rows of this window are, of any other.
  std::shared_ptr<const RowSource> source() const;

 private:
  std::optional<Record> record_;
  std::shared_ptr<const RowSource> rows_;
  Eigen::Index first_ = 0, count_ = 0;
};

struct StreamOptions {
  ReadOptions read;  ///< resample must be false
  /// Of what was not measured. Windows give the bits of the whole record; a smoothing spline and a Kalman smoother
  /// reach so far beyond a block that they give its numbers to 1e-9 of a deviation, their parameters chosen on 32768
  /// rows where there are more. A Fourier filter and total variation need the whole record.
  DerivativeMethod derivative = PolynomialWindow{};
  bool smooth = false;  ///< measured y, v and a as well are replaced by what the method makes of them
  std::function<void(double fraction)> progress;  ///< of the first looks; may throw, which ends them
  /// After rows were read later on. Several threads call it; may throw.
  std::function<void(Eigen::Index rows)> reading{};
};
/// Looks through a CSV, HDF5 or MAT (version 7.3) file, twice: time base and faults, then noise. Memory does not grow
/// with the rows. Time base, units, noise and derived v and a are those of read_record() and derive_motion(), to the
/// last bit; y is not integrated: see integrate() [stream_treat.hpp]. Throws InputError as read_record() does, with
/// file and line; and for uneven time, for a MAT file of version 5, and for a method that needs the whole record.
Stream open_stream(const std::string& path, const StreamOptions& options = {});

}  // namespace lunid
