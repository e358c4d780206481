#pragma once
// Inside regress: what a regression says of itself: terms with units and intervals, block errors, warnings.
#include <span>
#include <string>
#include <vector>

#include "regress/dispatch.hpp"

namespace lunid::detail {

/// Throws InputError (Fault::data) where a channel of the regression has one unit in one record, another in the next.
void check_units(std::span<const Stream> records, const std::vector<Expr>& expressions);

/// Spread of the coefficients when each block of time is left out in turn (Efron & Stein 1981, Ann. Stat. 9, 586), on
/// the selected features. NaN with fewer than 3 blocks, or where a block alone excites a feature.
Eigen::VectorXd block_deviations(const Solved& solved, int threads);

/// Fills in terms with their units and intervals.
void add_terms(Regression& result, const RegressOptions& options, const Solved& solved,
               std::span<const Stream> records);

/// What no solver can see from the result alone. `constant`: the feature that is constant on the data, or -1.
std::vector<std::string> warnings(const Regression& result, std::span<const Stream> records,
                                  const RegressOptions& options, int constant);

/// "run3.csv, 2 to 10 s, 6401 rows"
std::string describe(const Stream& record);

}  // namespace lunid::detail
