#pragma once
// What a residual force looks like: parity, dependence on amplitude, memory. Levels are those of a block
// bootstrap, so they hold for coloured noise. All spans have one length; `block_length` is a least block, 0
// for none.
#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "statistics/correlation.hpp"

namespace lunid {

/// Shares of the residual's mean square that odd and even functions of x explain, less what chance explains,
/// and the probability of as much by chance. Functions: Legendre polynomials to degree 5 of x / max |x|,
/// sign(x) and |x|; a constant is even. Each kind counts for what it explains beside the other one.
struct Parity {
  double odd = 0, even = 0;
  double odd_p_value = 1, even_p_value = 1;
};
Parity parity(std::span<const double> residual, std::span<const double> x, Eigen::Index block_length,
              std::uint64_t seed);

/// Pearson's.
Correlation correlation(std::span<const double> a, std::span<const double> b, Eigen::Index block_length,
                        std::uint64_t seed);

/// Does the residual differ at equal (y, v) according to what came before? The (y, v) plane is cut into cells
/// (0 is an edge in both). Within each, the residual (less a smooth function of y and v) and three
/// descriptions of the past (the displacement at the last reversal; displacement and amplitude low-passed
/// over a period) are rid of their plane in y and v; what is left of the residual is tested for dependence on
/// what is left of the past, in each cell for itself.
struct Memory {
  double within = 0;     ///< share of the residual's variance that is left within cells: noise, and memory if any
  double explained = 0;  ///< share of the residual's variance that the past explains, less what chance explains
  double p_value = 1;
  /// How far the past differs at equal (y, v): standard deviation over that of y. Near 0 in one steady cycle,
  /// where memory cannot be told from a dependence on y and v.
  double contrast = 0;
};
/// `period`: of the motion, in rows.
Memory memory(std::span<const double> residual, std::span<const double> y, std::span<const double> v, double period,
              Eigen::Index block_length, std::uint64_t seed);

/// The residual force of a record in one look.
struct ResidualTests {
  Parity in_y, in_v;
  Correlation with_abs_y;       ///< residual and |y|
  Correlation size_with_abs_y;  ///< |residual| and |y|
  Memory past;
};
ResidualTests residual_tests(std::span<const double> residual, std::span<const double> y, std::span<const double> v,
                             double period, Eigen::Index block_length, std::uint64_t seed);

}  // namespace lunid
