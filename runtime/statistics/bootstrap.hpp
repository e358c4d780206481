#pragma once
// Tests whose levels hold for coloured data: blocks of neighbouring rows are resampled, so that the
// dependence within a block stays as it was. (Kuensch 1989, Ann. Statist. 17, 1217; circular: Politis &
// Romano 1992.)
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

/// A p-value by simulation: the share of draws that go beyond what was found. It stops at 50 of them, when
/// the value is known well enough (Besag & Clifford 1991, Biometrika 78, 301), and never says less than 1 /
/// (most + 1).
class MonteCarlo {
 public:
  explicit MonteCarlo(std::uint64_t most) : most_(most) {}
  bool more() const { return draws_ < most_ && beyond_ < enough; }
  std::uint64_t draws() const { return draws_; }
  void add(bool beyond) {
    ++draws_;
    beyond_ += beyond;
  }
  double p_value() const {
    if (beyond_ >= enough) return static_cast<double>(beyond_) / static_cast<double>(draws_);
    return static_cast<double>(beyond_ + 1) / static_cast<double>(draws_ + 1);
  }

 private:
  static constexpr std::uint64_t enough = 50;
  std::uint64_t most_, draws_ = 0, beyond_ = 0;
};

/// The block length that a series' own correlation calls for. (Politis & White 2004, Econometric Rev. 23, 53,
/// with Patton's correction of 2009.) Between 1 and rows / 20.
Eigen::Index choose_block_length(std::span<const double> x);

/// Probability of a drop of the mean squared error as large as that from `before` to `after` (errors of two
/// runs on the same rows) if there were none: studentised block bootstrap of the differences of squares,
/// one-sided, never below 1e-4, no draw's deviation taken below half that of the data. `block_length` is a least
/// length, 0 for none: longer blocks are taken where the differences are correlated for longer, up to a twentieth of
/// the rows. 1 with fewer than 40 rows. An error that is not finite is one without bound.
double p_value_of_lower_error(std::span<const double> before, std::span<const double> after, Eigen::Index block_length,
                              std::uint64_t seed);

}  // namespace lunid
