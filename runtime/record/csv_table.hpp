#pragma once
// Inside record: the text of a CSV file, taken apart.
#include <string>
#include <string_view>
#include <vector>

#include "record/columns.hpp"
#include "record/csv_layout.hpp"

namespace lunid {

/// How finely a column's numbers are printed: the most decimals and the most significant digits of any cell.
struct PrintedDigits {
  int decimals = 0;
  int significant = 0;
  /// The rounding step of a printed value.
  double resolution(double value) const;
};

/// Throws InputError (Fault::data) for text that no CSV file begins with: nothing, UTF-16, a binary file.
void check_text(const std::string& path, std::string_view text);
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

/// Takes the lines of a CSV file apart: all at once, or in pieces of whole lines. Copies go on from where it is.
class CsvParser {
 public:
  /// `advice`: what to do about a cell that is no number.
  CsvParser(std::string path, const ReadOptions& options, std::string advice)
      : path_(std::move(path)), options_(options), advice_(std::move(advice)) {}

  /// Reads the header off the text that the file begins with; gives what follows it.
  std::string_view header(std::string_view text, std::vector<std::string>& warnings);
  /// Adds the rows of a piece to the table.
  void rows(std::string_view piece);
  /// Throws on the earliest cell that is no number, of the columns that matter.
  void refuse_bad_cells() const;
  /// Takes the rows with such a cell for missing ones, with a warning, where they are not most of all and nothing is
  /// wrong but the cell.
  void drop_bad_rows(std::vector<std::string>& warnings);
  /// Throws as refuse_bad_cells(), and on commas that may be decimal or not; drops other columns that have such a cell.
  void judge(std::vector<std::string>& warnings);

  const CsvTable& table() const { return table_; }
  CsvTable take() { return std::move(table_); }
  /// Forgets the rows; the next piece begins after line `line`.
  void restart(int line);
  /// Takes decimal points or commas for what another parser of the file has found them to be.
  void agree_with(const CsvParser& other) { point_ = other.point_, settled_ = other.settled_; }
  int line() const { return line_; }          ///< of the last one read
  char ending() const { return ending_; }     ///< of lines, known after the header
  std::size_t time() const { return time_; }  ///< number of the time column

  struct BadCell {
    int line;
    std::string text;
  };
  struct BadCells {
    std::vector<BadCell> first;
    std::size_t count = 0;
  };

 private:
  [[noreturn]] void fail(const std::string& message, int line) const;
  void read_row(std::string_view line);
  void read_plain(std::string_view line, char separator);
  double slow(std::string_view cell, std::size_t column);
  void settle(std::string_view cell);
  std::string describe(std::size_t column, bool advise) const;
  [[noreturn]] void wrong_length(std::string_view line, char separator) const;

  /// A cell that tells what stands before the decimals.
  struct Evidence {
    char mark = '\0';  ///< '.' or ','; none yet
    std::string text{};
    int line = 0;
  };

  std::string path_;
  ReadOptions options_;
  std::string advice_, row_advice_;
  CsvTable table_;
  std::vector<BadCells> bad_;
  int line_ = 0;
  char ending_ = '\n', separator_ = ',';
  Evidence point_;
  bool settled_ = false;  ///< no further cell is asked
  std::size_t time_ = 0;
};

/// Throws InputError (Fault::data) with file and line; see read_csv.
CsvTable parse_table(const std::string& path, std::string_view text, const ReadOptions& options,
                     std::vector<std::string>& warnings);

}  // namespace lunid
