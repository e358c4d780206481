#pragma once
// Inside regress: the columns of a regression, built by one tape in blocks of rows, and their statistics.
#include <Eigen/Core>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "expr/tape.hpp"
#include "record/stream.hpp"
#include "regress/statistic.hpp"

namespace lunid::detail {

/// Features and target as one tape over the channels of a record.
class Columns {
 public:
  /// Throws InputError on a state, naming it. Parameters get their values at each run. `names`: of the features; empty:
  /// their texts.
  Columns(std::vector<Expr> features, Expr target, std::vector<std::string> names = {});

  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::string>& parameters() const { return parameters_; }
  /// Of the tape's parameters, in their order, as runs take them.
  std::vector<double> values(const std::map<std::string, double>& by_name) const;

  /// False: only this thread may run them (external functions).
  bool thread_safe() const { return tape_.thread_safe(); }

  /// Rows of a stream that are in memory.
  struct Loaded {
    const Stream& stream;
    Eigen::Index first;  ///< number of the first of them in the stream
    Record rows;
  };
  /// Rows [first, first + count) of a stream and those before them that lags need.
  Loaded load(const Stream& stream, Eigen::Index first, Eigen::Index count) const;
  /// Rows [first, first + work.rows()) of the stream into columns 1.. of `work` (features, then the target). `values`:
  /// as values() gives them. A channel such as y_lag3 is y three rows before: `first` is at least the largest
  /// lag. Throws InputError (Fault::data) naming record, feature and time of a value that is not finite.
  void fill(const Loaded& data, Eigen::Index first, std::span<const double> values, Eigen::MatrixXd& work) const;

  /// What is done to the rows from `first` on, filled in, before they are folded in.
  using Visit = std::function<void(Eigen::Index first, Eigen::MatrixXd& work)>;
  /// The statistic of rows [first, first + count) of a stream, of which no more than a few ten thousand are in memory.
  Statistic statistic(const Stream& stream, Eigen::Index first, Eigen::Index count, std::span<const double> values,
                      const Visit& visit = {}) const;

 private:
  /// As fill(), whatever the values are.
  void evaluate(const Loaded& data, Eigen::Index first, std::span<const double> values, Eigen::MatrixXd& work) const;
  [[noreturn]] void refuse(const Stream& stream, Eigen::Index first, const Eigen::MatrixXd& work) const;

  std::vector<std::string> names_, channels_, parameters_;
  Eigen::Index lag_ = 0;  // the largest one
  Tape tape_;
};

/// Rows [first, first + count) of records[record].
struct TimeBlock {
  std::size_t record = 0;
  Eigen::Index first = 0, count = 0;
};
/// Each record in `blocks` parts of nearly equal length, fewer where a part would have less than `least` rows; the
/// first `skip` rows are left out. Throws InputError (Fault::data) when a record has no row left.
std::vector<TimeBlock> time_blocks(std::span<const Stream> records, int blocks, Eigen::Index least,
                                   Eigen::Index skip = 0);

/// One statistic for each block, computed by `threads` threads; the same bits for any number of them.
std::vector<Statistic> statistics(const Columns& columns, std::span<const Stream> records,
                                  std::span<const TimeBlock> blocks, std::span<const double> values, int threads);

}  // namespace lunid::detail
