#include "regress/columns.hpp"

#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "record/parallel.hpp"
#include "regress/lag.hpp"

namespace lunid::detail {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// Rows that are built and folded in together: the folding's fixed cost is small beside them, and the work space of
/// 23 columns stays in the cache.
constexpr Index kRows = 4096;
/// Rows of a file that are read together.
constexpr Index kLoaded = 4 * kRows;

std::vector<Expr> inputs_of(const std::vector<Expr>& outputs, SymbolKind kind) {
  std::vector<Expr> found;
  for (const Expr& f : outputs)
    for (const Expr& s : symbols(f, kind))
      if (std::find(found.begin(), found.end(), s) == found.end()) found.push_back(s);
  return found;
}

}  // namespace

Columns::Columns(std::vector<Expr> features, Expr target, std::vector<std::string> names) : names_(std::move(names)) {
  for (std::size_t j = names_.size(); j < features.size(); ++j) names_.push_back(to_text(features[j]));
  features.push_back(target);
  const std::vector<Expr> states = inputs_of(features, SymbolKind::state);
  if (!states.empty())
    throw InputError("state '" + states.front().name() +
                     "' is not measured: a regression knows channels only, fit such a model on its trajectory");
  std::vector<Expr> inputs = inputs_of(features, SymbolKind::channel);
  for (const Expr& s : inputs) channels_.push_back(s.name());
  for (const Expr& s : inputs_of(features, SymbolKind::parameter)) {
    parameters_.push_back(s.name());
    inputs.push_back(s);
  }
  tape_ = Tape(features, inputs);
  lag_ = largest_lag(features);
}

std::vector<double> Columns::values(const std::map<std::string, double>& by_name) const {
  std::vector<double> out;
  for (const std::string& name : parameters_) out.push_back(by_name.at(name));
  return out;
}

Columns::Loaded Columns::load(const Stream& stream, Index first, Index count) const {
  return {stream, first - lag_, stream.read(first - lag_, count + lag_)};
}

void Columns::fill(const Loaded& data, Index first, std::span<const double> values, MatrixXd& work) const {
  evaluate(data, first, values, work);
  for (Index j = 1; j < work.cols(); ++j)
    if (!std::isfinite(work.col(j).sum())) refuse(data.stream, first, work);
}

void Columns::evaluate(const Loaded& data, Index first, std::span<const double> values, MatrixXd& work) const {
  const Record& record = data.rows;
  const Index rows = work.rows(), at = first - data.first;
  std::vector<double> time;
  std::vector<const double*> in;
  std::vector<int> stride;
  for (const std::string& name : channels_) {
    stride.push_back(1);
    if (name == "t" && !record.has("t")) {
      time.resize(static_cast<std::size_t>(rows));
      for (Index i = 0; i < rows; ++i) time[static_cast<std::size_t>(i)] = data.stream.time(first + i);
      in.push_back(time.data());
    } else if (const auto past = record.has(name) ? std::nullopt : lag_of(name)) {
      in.push_back(record[past->channel].data() + at - past->samples);
    } else {
      in.push_back(record[name].data() + at);
    }
  }
  for (const double& value : values) {
    stride.push_back(0);
    in.push_back(&value);
  }
  std::vector<double*> out;
  for (Index j = 1; j < work.cols(); ++j) out.push_back(work.col(j).data());
  tape_.run_columns(in, stride, static_cast<std::size_t>(rows), out);
}

void Columns::refuse(const Stream& record, Index first, const MatrixXd& work) const {
  tape_.rethrow();
  for (Index i = 0; i < work.rows(); ++i)
    for (Index j = 1; j < work.cols(); ++j) {
      if (std::isfinite(work(i, j))) continue;
      const bool target = j == work.cols() - 1;
      throw InputError(
          (target ? std::string("the target") : "feature '" + names_[static_cast<std::size_t>(j - 1)] + "'") + " is " +
              (std::isnan(work(i, j)) ? "not a number" : "infinite") + " at t = " + number(record.time(first + i)) +
              " s (row " + std::to_string(first + i + 1) + " of " + record.name() +
              "): leave such rows out of the window, or the feature out of the list",
          {}, Fault::data);
    }
  throw InputError("the columns overflow when added up: scale the features", {}, Fault::data);
}

Statistic Columns::statistic(const Stream& stream, Index first, Index count, std::span<const double> values,
                             const Visit& visit) const {
  Statistic sum(names_);
  MatrixXd work;
  for (Index from = first; from < first + count; from += kLoaded) {
    const Index to = std::min(from + kLoaded, first + count);
    const Loaded data = load(stream, from, to - from);
    for (Index at = from; at < to; at += kRows) {
      work.resize(std::min(kRows, to - at), static_cast<Index>(names_.size()) + 2);
      evaluate(data, at, values, work);
      if (visit) visit(at, work);
      try {
        sum.add_in_place(work);  // looks at each value
      } catch (const InputError&) {
        refuse(stream, at, work);
      }
    }
  }
  return sum;
}

std::vector<TimeBlock> time_blocks(std::span<const Stream> records, int blocks, Index least, Index skip) {
  std::vector<TimeBlock> out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Index rows = records[r].rows() - skip;
    if (rows < 1)
      throw InputError(records[r].name() + ": the largest lag is " + std::to_string(skip) + " rows, the record has " +
                           std::to_string(records[r].rows()),
                       {}, Fault::data);
    const Index count = std::clamp<Index>(rows / std::max<Index>(least, 1), 1, blocks);
    for (Index k = 0; k < count; ++k) {
      const Index from = rows * k / count, to = rows * (k + 1) / count;
      out.push_back({r, skip + from, to - from});
    }
  }
  return out;
}

std::vector<Statistic> statistics(const Columns& columns, std::span<const Stream> records,
                                  std::span<const TimeBlock> blocks, std::span<const double> values, int threads) {
  std::vector<Statistic> out(blocks.size());
  parallel_for(static_cast<int>(blocks.size()), columns.thread_safe() ? threads : 1, [&](int block) {
    const auto i = static_cast<std::size_t>(block);
    out[i] = columns.statistic(records[blocks[i].record], blocks[i].first, blocks[i].count, values);
  });
  return out;
}

}  // namespace lunid::detail
