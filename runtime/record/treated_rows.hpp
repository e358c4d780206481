#pragma once
// Inside record: the treatments of treat.hpp on rows that are read block by block. Each is a source on top of another,
// of which it reads so many rows more on either side as its filter reaches; what it needs to know of all rows (a line,
// a polynomial, where an integral stands) it sums up in one pass when it is made.
#include <memory>
#include <vector>

#include "record/row_source.hpp"
#include "record/treat_parts.hpp"

namespace lunid {

using Rows = std::shared_ptr<const RowSource>;
/// Of channels of a source, by their places in it.
using Places = std::vector<std::size_t>;

/// Rows [first, first + count).
Rows part_of(const Rows& rows, Eigen::Index first, Eigen::Index count);
/// Some channels filtered as by filter_zero_phase(). Throws InputError: the filter reaches beyond furthest_reach.
Rows filtered_rows(const Rows& rows, const Places& places, const FilterOptions& options);
/// Some channels without their least-squares polynomials.
Rows detrended_rows(const Rows& rows, const Places& places, int degree);
/// All channels at another rate.
Rows rated_rows(const Rows& rows, const NewRate& rate);
/// One channel more at the end: the integral of the one at `place`. Throws InputError where that is constant.
Rows integrated_rows(const Rows& rows, std::size_t place);
/// These channels alone, in this order, with what is to be said of each and of the record.
Rows arranged_rows(const Rows& rows, const Places& places, std::vector<Channel> channels,
                   std::vector<std::string> history);

}  // namespace lunid
