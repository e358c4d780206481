#pragma once
// Inside regress: the columns of a regression, built by one tape in blocks of rows, and their statistics.
#include <Eigen/Core>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "expr/tape.hpp"
#include "record/record.hpp"
#include "regress/statistic.hpp"

namespace lunid::detail {

/// Features and target as one tape over the channels of a record.
class Columns {
 public:
  /// Throws InputError on a state, naming it. Parameters get their values at each run.
  Columns(std::vector<Expr> features, Expr target);

  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::string>& parameters() const { return parameters_; }

  /// False: only this thread may run them (external functions).
  bool thread_safe() const { return tape_.thread_safe(); }

  /// The statistic of rows [first, first + count) of a record. `values`: one for each of parameters().
  /// Throws InputError (Fault::data) naming record, feature and time of a value that is not finite.
  Statistic statistic(const Record& record, Eigen::Index first, Eigen::Index count,
                      std::span<const double> values) const;

 private:
  void run(const Record& record, Eigen::Index first, std::span<const double> values, Eigen::MatrixXd& work) const;
  [[noreturn]] void refuse(const Record& record, Eigen::Index first, const Eigen::MatrixXd& work) const;

  std::vector<std::string> names_, channels_, parameters_;
  Tape tape_;
};

/// Rows [first, first + count) of records[record].
struct TimeBlock {
  std::size_t record = 0;
  Eigen::Index first = 0, count = 0;
};
/// Each record in `blocks` parts of nearly equal length, fewer where a part would have less than `least` rows.
std::vector<TimeBlock> time_blocks(std::span<const Record> records, int blocks, Eigen::Index least);

/// One statistic for each block, computed by `threads` threads; the same bits for any number of them.
std::vector<Statistic> statistics(const Columns& columns, std::span<const Record> records,
                                  std::span<const TimeBlock> blocks, std::span<const double> values, int threads);

}  // namespace lunid::detail
