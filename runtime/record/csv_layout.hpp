#pragma once
// Inside record: how a CSV file is laid out: what stands before its table, its header, units, separator and line ends.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "record/columns.hpp"

namespace lunid {

/// The next line that holds something: not blank, no comment (#, % or //). Takes it and those before it off `rest`;
/// `number` is that of the line before, and then of the line. False at the end.
bool next_line(std::string_view& rest, char ending, int& number, std::string_view& line);

/// Cells of a line; quotes round a cell protect separators and are removed, a doubled quote in them stands for one.
/// Blanks separate in any number.
std::vector<std::string> split_cells(std::string_view line, char separator);
/// The whole of a cell as a finite number, with `decimal` for its point; nullopt where it is none.
std::optional<double> to_number(std::string_view cell, char decimal = '.');
/// One comma, and a number with it for the point.
bool has_decimal_comma(std::string_view cell);
/// The text, or where it is no UTF-8 what it is in Latin-1, as UTF-8: loggers write the one byte B5 for a micro sign.
std::string utf8(std::string_view text);

struct CsvLayout {
  char ending = '\n', separator = ',';
  std::vector<HeaderCell> header;
  int header_line = 0;
  int line = 0;               ///< the last one before the rows: that of the header, or of the units below it
  std::string_view rest;      ///< what follows that line
  std::size_t row_bytes = 1;  ///< about as many as a row has
  /// To be added to what is wrong with the header and with the first row; "" where that is a row of numbers.
  std::string header_advice, row_advice;
};

/// Finds the header in the text that a file begins with: the first line of names that has rows of numbers below it, or
/// a line of units and then rows. What stands before it is skipped with a warning. A comment of as many names as the
/// first row has numbers is a header too, where no other line precedes the rows. Where there is none of these the first
/// line is taken for the header. A table of numbers alone has those of its columns for names, where the options ask
/// by them; one column is a table where they give an interval. Throws InputError (Fault::data): no header, no columns,
/// a column without a name, units twice.
CsvLayout find_layout(const std::string& path, std::string_view text, const ReadOptions& options,
                      std::vector<std::string>& warnings);

}  // namespace lunid
