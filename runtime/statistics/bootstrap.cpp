#include "statistics/bootstrap.hpp"

#include <algorithm>
#include <cmath>

#include "expr/error.hpp"
#include "record/random.hpp"
#include "statistics/correlation.hpp"

namespace lunid {
namespace {

constexpr Eigen::Index fewest_rows = 40, fewest_blocks = 20;

std::span<const double> span_of(const Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

/// Draws enough for a p-value of 1e-4, fewer where the blocks are many (and the normal limit is near anyway).
std::uint64_t number_of_draws(Eigen::Index blocks) {
  return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(100'000'000 / std::max<Eigen::Index>(blocks, 1)), 1999,
                                   9999);
}

/// Sums of a series over all blocks of a length, on the ring of its first rows (a whole number of blocks).
struct BlockSums {
  Eigen::Index length = 1, count = 0;  ///< of a block; of blocks in the data
  Eigen::VectorXd sums;                ///< entry i: of the block that starts at row i
};

BlockSums block_sums(const Eigen::VectorXd& x, Eigen::Index length) {
  BlockSums result{length, x.size() / length, {}};
  const Eigen::Index rows = result.count * length;
  result.sums.resize(rows);
  double sum = x.head(length).sum();
  for (Eigen::Index i = 0; i < rows; ++i) {
    result.sums[i] = sum;
    // A running sum loses digits; it is formed afresh at each whole block.
    if ((i + 1) % length == 0)
      sum = i + 1 < rows ? x.segment(i + 1, length).sum() : 0;
    else
      sum += x[(i + length) % rows] - x[i];
  }
  return result;
}

/// The mean of the chosen blocks about `centre` and its standard deviation.
struct BlockMean {
  double value, std;
};
BlockMean mean_of(const BlockSums& blocks, const std::vector<Eigen::Index>& starts, double centre) {
  double sum = 0, square = 0;
  for (Eigen::Index start : starts) {
    const double d = blocks.sums[start] - centre;
    sum += d;
    square += d * d;
  }
  const double m = static_cast<double>(starts.size()), average = sum / m;
  return {average, std::sqrt(std::max(square / m - average * average, 0.0) / (m - 1))};
}

double ratio(double value, double std) {
  return std > 0 ? value / std : value > 0 ? INFINITY : value < 0 ? -INFINITY : 0;
}

std::vector<Eigen::Index> blocks_of_the_data(const BlockSums& blocks) {
  std::vector<Eigen::Index> starts;
  for (Eigen::Index i = 0; i < blocks.count; ++i) starts.push_back(i * blocks.length);
  return starts;
}

}  // namespace

BlockBootstrap::BlockBootstrap(Eigen::Index rows, Eigen::Index block_length, std::uint64_t seed)
    : rows_(rows), block_length_(block_length), blocks_(0), seed_(seed) {
  if (block_length < 1 || block_length > rows)
    throw InputError("bootstrap: block length: expected 1 to " + std::to_string(rows) + " rows, got " +
                     std::to_string(block_length));
  blocks_ = (rows + block_length - 1) / block_length;
}

std::vector<Eigen::Index> BlockBootstrap::starts(std::uint64_t draw) const {
  Philox random(seed_, draw);
  std::vector<Eigen::Index> result(static_cast<std::size_t>(blocks_));
  for (Eigen::Index& start : result) start = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(rows_)));
  return result;
}

std::vector<Eigen::Index> BlockBootstrap::indices(std::uint64_t draw) const {
  std::vector<Eigen::Index> result;
  result.reserve(static_cast<std::size_t>(blocks_ * block_length_));
  for (Eigen::Index start : starts(draw))
    for (Eigen::Index i = 0; i < block_length_; ++i) result.push_back((start + i) % rows_);
  result.resize(static_cast<std::size_t>(rows_));
  return result;
}

Eigen::Index choose_block_length(std::span<const double> x) {
  const auto n = static_cast<double>(x.size());
  const auto most = std::max<Eigen::Index>(static_cast<Eigen::Index>(x.size()) / fewest_blocks, 1);
  if (most == 1) return 1;
  // The lag after which a few correlations in a row are within chance; twice that is the flat-top window's
  // width.
  const int in_a_row = std::max(5, static_cast<int>(std::sqrt(std::log10(n))));
  const int search = static_cast<int>(std::min<double>(std::ceil(std::sqrt(n)) + in_a_row, n / 2));
  const double chance = 2 * std::sqrt(std::log10(n) / n);
  const Eigen::VectorXd near = autocorrelation(x, search + in_a_row);
  int last = 0;
  for (int lag = 1, quiet = 0; lag <= search && quiet < in_a_row; ++lag) {
    quiet = std::abs(near[lag]) < chance ? quiet + 1 : 0;
    if (quiet == 0) last = lag;
  }
  if (last == 0) return 1;
  const int width = 2 * last;
  const Eigen::VectorXd r = autocorrelation(x, std::min<int>(width, static_cast<int>(n) - 1));
  double level = 1, slope = 0;
  for (int k = 1; k < r.size(); ++k) {
    const double s = static_cast<double>(k) / width, window = s <= 0.5 ? 1 : 2 * (1 - s);
    level += 2 * window * r[k];
    slope += 2 * window * k * r[k];
  }
  const double length = std::cbrt(2 * slope * slope / (4.0 / 3 * level * level) * n);
  if (!std::isfinite(length)) return most;
  return std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::ceil(length)), 1, most);
}

double p_value_of_lower_error(std::span<const double> before, std::span<const double> after, Eigen::Index block_length,
                              std::uint64_t seed) {
  if (before.size() != after.size())
    throw InputError("p_value_of_lower_error: " + std::to_string(before.size()) + " errors before, " +
                     std::to_string(after.size()) + " after");
  const auto n = static_cast<Eigen::Index>(before.size());
  const Eigen::ArrayXd a = Eigen::Map<const Eigen::ArrayXd>(before.data(), n);
  const Eigen::ArrayXd b = Eigen::Map<const Eigen::ArrayXd>(after.data(), n);
  if (!b.allFinite()) return 1;
  if (!a.allFinite()) return 1e-4;
  Eigen::VectorXd drop = a.square() - b.square();
  const double scale = n > 0 ? drop.cwiseAbs().maxCoeff() : 0;
  if (n < fewest_rows || !(scale > 0)) return 1;
  drop /= scale;
  const Eigen::Index least = std::max(block_length, choose_block_length(span_of(drop)));
  const BlockSums blocks = block_sums(drop, std::clamp<Eigen::Index>(least, 1, n / fewest_blocks));
  const BlockMean data = mean_of(blocks, blocks_of_the_data(blocks), 0);
  const double found = ratio(data.value, data.std), centre = blocks.sums.mean();
  const BlockBootstrap bootstrap(blocks.sums.size(), blocks.length, seed);
  MonteCarlo chance(number_of_draws(blocks.count));
  while (chance.more()) {
    // A draw that misses the few blocks unlike the rest has next to no deviation of its own: it gets half the data's.
    const BlockMean draw = mean_of(blocks, bootstrap.starts(chance.draws()), centre);
    chance.add(ratio(draw.value, std::max(draw.std, 0.5 * data.std)) >= found);
  }
  return chance.p_value();
}

}  // namespace lunid
