#include "statistics/interval.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "expr/error.hpp"
#include "record/parallel.hpp"
#include "statistics/bootstrap.hpp"
#include "statistics/distributions.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void check(Index rows, const IntervalOptions& options) {
  if (!(options.level > 0 && options.level < 1))
    throw InputError("interval: level: expected > 0 and < 1, got " + std::to_string(options.level));
  if (options.draws < 99) throw InputError("interval: draws: expected >= 99, got " + std::to_string(options.draws));
  if (options.block_length < 1 || 5 * options.block_length > rows)
    throw InputError("interval: block: expected 1 to " + std::to_string(std::max<Index>(rows / 5, 1)) +
                     " rows, a fifth of them, got " + std::to_string(options.block_length));
}

/// The statistics of many choices of rows, one in each column.
template <class Choose>
MatrixXd evaluate(int choices, const RowStatistics& of, int threads, Choose choose) {
  std::vector<VectorXd> values(static_cast<std::size_t>(choices));
  parallel_for(choices, threads, [&](int i) { values[static_cast<std::size_t>(i)] = of(choose(i)); });
  MatrixXd table(values[0].size(), choices);
  for (int i = 0; i < choices; ++i) table.col(i) = values[static_cast<std::size_t>(i)];
  if (!table.allFinite())
    throw InputError(
        "interval: the statistic is not finite for some choice of the rows: take longer blocks or a longer "
        "window",
        {}, Fault::data);
  return table;
}

double quantile(const VectorXd& ordered, double p) {
  const double place =
      std::clamp(p * static_cast<double>(ordered.size() + 1) - 1, 0.0, static_cast<double>(ordered.size() - 1));
  const auto below = std::min(static_cast<Index>(place), ordered.size() - 2);
  return ordered[below] + (place - static_cast<double>(below)) * (ordered[below + 1] - ordered[below]);
}

}  // namespace

std::vector<Interval> bootstrap_intervals(Index rows, const RowStatistics& of, const IntervalOptions& options) {
  check(rows, options);
  const BlockBootstrap bootstrap(rows, options.block_length, options.seed);
  const MatrixXd table = evaluate(options.draws, of, options.threads,
                                  [&](int draw) { return bootstrap.indices(static_cast<std::uint64_t>(draw)); });
  std::vector<Interval> result;
  for (Index s = 0; s < table.rows(); ++s) {
    VectorXd ordered = table.row(s);
    std::sort(ordered.begin(), ordered.end());
    const double tail = (1 - options.level) / 2;
    const double deviation = std::sqrt((ordered.array() - ordered.mean()).square().sum() / (options.draws - 1));
    result.push_back({quantile(ordered, tail), quantile(ordered, 1 - tail), deviation});
  }
  return result;
}

std::vector<Interval> jackknife_intervals(Index rows, const RowStatistics& of, const IntervalOptions& options) {
  check(rows, options);
  const auto blocks = static_cast<int>(std::min<Index>(rows / options.block_length, 50));
  const auto all_but = [&](Index first, Index last) {
    std::vector<Index> kept;
    for (Index i = 0; i < rows; ++i)
      if (i < first || i >= last) kept.push_back(i);
    return kept;
  };
  const VectorXd whole = of(all_but(0, 0));
  const MatrixXd table =
      evaluate(blocks, of, options.threads, [&](int b) { return all_but(rows * b / blocks, rows * (b + 1) / blocks); });
  const double width = normal_quantile(0.5 + options.level / 2);
  std::vector<Interval> result;
  for (Index s = 0; s < table.rows(); ++s) {
    const double squares = (table.row(s).array() - table.row(s).mean()).square().sum();
    const double deviation = std::sqrt(squares * (blocks - 1) / blocks);
    result.push_back({whole[s] - width * deviation, whole[s] + width * deviation, deviation});
  }
  return result;
}

}  // namespace lunid
