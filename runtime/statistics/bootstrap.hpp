#pragma once
// Tests whose levels hold for coloured data: blocks of neighbouring rows are resampled, so that the dependence within
// a block stays as it was. (Kuensch 1989, Ann. Statist. 17, 1217; circular: Politis & Romano 1992.)
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace lunid {

/// Row indices of resampled series. Each draw depends on (seed, draw) alone, whatever thread asks for it.
class BlockBootstrap {
 public:
  /// Blocks of `block_length` rows out of `rows` rows that are closed to a ring; 1 <= block_length <= rows.
  BlockBootstrap(Eigen::Index rows, Eigen::Index block_length, std::uint64_t seed);
  Eigen::Index blocks() const { return blocks_; }  ///< in a draw
  /// First row of each block of a draw.
  std::vector<Eigen::Index> starts(std::uint64_t draw) const;
  /// `rows` row indices.
  std::vector<Eigen::Index> indices(std::uint64_t draw) const;

 private:
  Eigen::Index rows_, block_length_, blocks_;
  std::uint64_t seed_;
};

/// The block length that a series' own correlation calls for. (Politis & White 2004, Econometric Rev. 23, 53, with
/// Patton's correction of 2009.) Between 1 and rows / 20.
Eigen::Index choose_block_length(std::span<const double> x);

/// Probability of data so far from zero mean if the mean of every column of `scores` is zero: Hotelling's statistic of
/// block sums against its block bootstrap. `block_length` is a least length, 0 for none: longer blocks are taken where
/// the scores are correlated for longer. Columns without variation do not count. 1 with fewer than 40 rows.
double p_value_of_zero_mean(const Eigen::Ref<const Eigen::MatrixXd>& scores, Eigen::Index block_length,
                            std::uint64_t seed);

/// Probability of a drop of the mean squared error as large as that from `before` to `after` (errors of two runs on the
/// same rows) if there were none: studentised block bootstrap of the differences of squares, one-sided, never below
/// 1e-4. `block_length` as above. An error that is not finite is one without bound.
double p_value_of_lower_error(std::span<const double> before, std::span<const double> after,
                              Eigen::Index block_length, std::uint64_t seed);

}  // namespace lunid
