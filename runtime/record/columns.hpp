#pragma once
// Inside record: which column of a file is which channel, and in which unit.
#include <string>
#include <string_view>
#include <vector>

#include "record/record.hpp"

namespace lunid {

/// Beyond this a number is no measurement: its fifth power, and sums of that over a record, would not be finite.
constexpr double largest_measurement = 1e60;

/// All unit names, for messages.
std::string known_units();
/// The unit that a name stands for, in full ("inches"), in other letters ("KN", "nm" for Nm) or in the plural; "" of
/// any other.
std::string unit_alike(std::string_view name);
/// The same of a product, whose names that are known stay: "kN/in" of "KN/inch".
std::string unit_meant(std::string_view word);

/// A header cell taken apart: "F (kN)" is {"F (kN)", "F", "kN"}.
struct HeaderCell {
  std::string text, name, unit;
};
/// Understands `name [unit]`, `name (unit)` and, where the unit is known or the name is a channel's,
/// `name/unit`.
HeaderCell split_header(std::string_view text);

/// What becomes of a column of the file.
struct ColumnPlan {
  std::string channel;  ///< "" : the column is left out
  HeaderCell header;
  double factor = 1;        ///< to SI
  std::string unit;         ///< SI unit
  std::string source_unit;  ///< the column's: as was asked for, else as its header has it
  bool derived = false;     ///< from another channel, by its header's name (derived_ending)
  bool clock = false;       ///< a time that is left out, since a rate or interval stands for it
  bool required = false;    ///< a cell that is no number is an error; else the column is dropped with a warning
};

/// Maps header cells to channels: by options.columns, else by name and the usual synonyms. Exactly one plan
/// is "t", or with `needs_time` false or an interval in the options none may be. Throws InputError (Fault::data, at
/// `where`): no time column, a time column that is asked for beside an interval, ambiguous or repeated names, unknown
/// units.
std::vector<ColumnPlan> plan_columns(const std::vector<HeaderCell>& header, const ReadOptions& options,
                                     const SourceSpan& where, std::vector<std::string>& warnings,
                                     bool needs_time = true);

/// The channel that an SI unit alone speaks for: y of "m", F of "N m"; 0 of one that may be of several ("V"), and of
/// the time.
char channel_of_unit(std::string_view unit);

/// SI unit of a force that no file names: "N m" beside an angle, else "N".
std::string unit_of_force(const Record& record);

/// The number of "F=0": a channel that the file lacks and that is the same in every row (nothing drives a free decay).
/// A column of that header goes before. Nothing for other maps, and for the time.
std::optional<double> constant_of(const ColumnMap& map);
/// The record with those channels. Throws InputError (Fault::data) for a unit that is none of the channel's.
Record with_constants(const Record& record, const std::vector<ColumnMap>& columns);

/// What a derived channel's column is called in files, after its name, so that it is not read back as a measured one.
inline constexpr std::string_view derived_ending = "_derived";
std::string name_in_files(const Channel& channel);

/// The channel that a column becomes, without its values.
Channel channel_of(const ColumnPlan& plan);

/// Text without white space at its ends.
std::string_view trim(std::string_view text);

}  // namespace lunid
