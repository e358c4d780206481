#pragma once
// Inside record: what every treatment of a record asks of its channels.
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "record/record.hpp"

namespace lunid {

/// The values of a channel within the window. Throws InputError `where: ...`: no such channel, a value that is not a
/// number (with its time), fewer than `rows` rows.
std::span<const double> numbers(const Record& record, std::string_view channel, std::string_view where,
                                Eigen::Index rows = 6);
/// The same, and not all of one value.
std::span<const double> varying(const Record& record, std::string_view channel, std::string_view where,
                                Eigen::Index rows = 6);
/// The names as given, or those of all channels. Throws InputError for a name that is none of them.
std::vector<std::string> names_or_all(const std::vector<Channel>& channels, const std::vector<std::string>& names,
                                      std::string_view where);
/// This record's channels (within its window) over another time base: warnings and history go along.
Record remade(const Record& record, double t0, double dt, std::vector<Channel> channels);
/// First row and number of rows with from <= t <= to [s] of a record that starts there. Throws InputError as
/// Record::window.
std::pair<Eigen::Index, Eigen::Index> rows_of_window(const std::string& name, double start, double dt,
                                                     Eigen::Index rows, double from, double to);
/// A channel within the window, with other values.
Channel with_values(const Record& record, std::string_view channel, Eigen::VectorXd values);

}  // namespace lunid
