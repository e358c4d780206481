#pragma once
// Inside record: the text of a CSV file, taken apart.
#include <string>
#include <string_view>
#include <vector>

#include "record/columns.hpp"

namespace lunid {

/// How finely a column's numbers are printed: the most decimals and the most significant digits of any cell.
struct PrintedDigits {
  int decimals = 0;
  int significant = 0;
  /// The rounding step of a printed value.
  double resolution(double value) const;
};

/// Reads a whole file. Throws InputError (Fault::data) for a missing or empty one, or one that is no text.
std::string read_text(const std::string& path);

/// A CSV file's columns as numbers, as printed (no units applied).
struct CsvTable {
  std::vector<ColumnPlan> plans;             ///< of the columns that were kept
  std::vector<std::vector<double>> columns;  ///< one for each plan
  std::vector<int> lines;                    ///< line of each row in the file
  PrintedDigits time_digits;
  int header_line = 0;
};

/// Throws InputError (Fault::data) with file and line; see read_csv.
CsvTable parse_table(const std::string& path, std::string_view text, const ReadOptions& options,
                     std::vector<std::string>& warnings);

}  // namespace lunid
