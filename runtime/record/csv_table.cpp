#include "record/csv_table.hpp"

#include <fast_float/fast_float.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <optional>

namespace lunid {
namespace {

constexpr std::size_t shown_cells = 4;  ///< faults that a message lists before it only counts

/// Cells of a line; quotes protect separators and are removed, a doubled quote stands for one.
std::vector<std::string> split_cells(std::string_view line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        cells.back() += line[i++];
      else
        quoted = !quoted;
    } else if (line[i] == separator && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  for (std::string& cell : cells) cell = std::string(trim(cell));
  return cells;
}

char find_separator(std::string_view header) {
  for (char candidate : {'\t', ';', ','})
    if (split_cells(header, candidate).size() > 1) return candidate;
  return ',';
}

std::optional<double> to_number(std::string_view cell) {
  cell = trim(cell);
  if (!cell.empty() && cell.front() == '+') cell.remove_prefix(1);
  double value = 0;
  const auto [end, error] = fast_float::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

bool has_decimal_comma(std::string cell) {
  const std::size_t comma = cell.find(',');
  if (comma == std::string::npos || cell.find(',', comma + 1) != std::string::npos) return false;
  cell[comma] = '.';
  return to_number(cell).has_value();
}

void count_digits(std::string_view cell, PrintedDigits& digits) {
  int significant = 0, decimals = 0, exponent = 0;
  bool point = false;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const char c = cell[i];
    if (c >= '0' && c <= '9') {
      if (significant > 0 || c != '0') ++significant;
      if (point) ++decimals;
    } else if (c == '.') {
      point = true;
    } else if (c == 'e' || c == 'E') {
      if (const auto value = to_number(cell.substr(i + 1))) exponent = static_cast<int>(*value);
      break;
    }
  }
  digits.decimals = std::max(digits.decimals, decimals - exponent);
  digits.significant = std::max(digits.significant, significant);
}

using BadCells = CsvParser::BadCells;

std::string describe(const ColumnPlan& plan, const BadCells& bad) {
  const std::string& text = bad.first[0].text;
  const std::string column = "column '" + plan.header.text + "': ";
  if (has_decimal_comma(text))
    return column + "decimal comma in '" + text +
           "': expected a decimal point; export the file with points, or replace the commas";
  std::string message = column + "expected a number, got '" + text + "'";
  if (bad.count == 1) return message;
  message += "; " + std::to_string(bad.count) + " such cells, the first in lines ";
  for (std::size_t i = 0; i < bad.first.size(); ++i) message += (i ? ", " : "") + std::to_string(bad.first[i].line);
  return message;
}

}  // namespace

void CsvParser::fail(const std::string& message, int line) const {
  throw InputError(message, {path_, line}, Fault::data);
}

/// The next line that holds something: no comment, not blank.
bool CsvParser::next(std::string_view& rest, std::string_view& line) {
  while (!rest.empty()) {
    const char* end = static_cast<const char*>(std::memchr(rest.data(), ending_, rest.size()));
    const std::size_t length = end ? static_cast<std::size_t>(end - rest.data()) : rest.size();
    line = rest.substr(0, length);
    rest.remove_prefix(std::min(length + 1, rest.size()));
    ++line_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    std::size_t i = 0;
    while (i < line.size() && (line[i] == ' ' || line[i] == '\t')) ++i;
    if (i < line.size() && line[i] != '#') return true;
  }
  return false;
}

std::string_view CsvParser::header(std::string_view text, std::vector<std::string>& warnings) {
  const std::size_t size = text.size();
  ending_ = text.find('\n') == text.npos ? '\r' : '\n';
  std::string_view line;
  if (!next(text, line)) fail("no header: the file holds no more than comments and blank lines", 0);
  separator_ = find_separator(line);
  std::vector<std::string> cells = split_cells(line, separator_);
  if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  if (std::all_of(cells.begin(), cells.end(),
                  [](const std::string& c) { return to_number(c) || has_decimal_comma(c); }))
    fail("no header: expected the names of the columns, got numbers; put a line such as 't [s],F [N],y [m]' first",
         line_);
  std::vector<HeaderCell> header;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].empty()) fail("column " + std::to_string(i + 1) + " has no name", line_);
    header.push_back(split_header(cells[i]));
  }
  if (header.size() == 1)
    fail("expected columns separated by , ; or tab, got one column '" + header[0].text + "'", line_);
  table_.plans = plan_columns(header, options_, {path_, line_}, warnings);
  table_.header_line = line_;
  table_.columns.resize(header.size());
  bad_.resize(header.size());
  for (auto& column : table_.columns) column.reserve(size / (line.size() + 1));
  for (std::size_t i = 0; i < header.size(); ++i)
    if (table_.plans[i].channel == "t") time_ = i;
  return text;
}

void CsvParser::rows(std::string_view piece) {
  std::string_view line;
  while (next(piece, line)) read_row(line);
}

void CsvParser::restart(int line) {
  line_ = line;
  table_.lines.clear();
  for (auto& column : table_.columns) column.clear();
}

void CsvParser::read_row(std::string_view line) {
  if (line.find('"') != line.npos) {  // rare: unquote, then as usual
    std::string plain;
    for (const std::string& cell : split_cells(line, separator_)) {
      if (separator_ == ',' && has_decimal_comma(cell))
        fail("decimal comma in '" + cell + "': expected a decimal point", line_);
      plain += (plain.empty() ? "" : std::string(1, separator_)) + cell;
    }
    return read_plain(plain);
  }
  read_plain(line);
}

void CsvParser::read_plain(std::string_view line) {
  const char *cursor = line.data(), *const end = line.data() + line.size();
  const std::size_t width = table_.columns.size();
  table_.lines.push_back(line_);
  for (std::size_t i = 0;; ++i) {
    while (cursor < end && *cursor == ' ') ++cursor;
    double value = 0;
    auto [stop, error] = fast_float::from_chars(cursor, end, value);
    const char* tail = stop;
    while (tail < end && *tail == ' ') ++tail;
    const bool good = error == std::errc() && (tail == end || *tail == separator_) && std::isfinite(value);
    if (!good) {
      tail = std::find(cursor, end, separator_);
      if (i == width && trim({cursor, static_cast<std::size_t>(end - cursor)}).empty()) return;  // trailing separator
    }
    if (i >= width) return wrong_length(line);
    const std::string_view cell{cursor, static_cast<std::size_t>(tail - cursor)};
    if (!good) value = slow(cell, i);
    if (i == time_) count_digits(cell, table_.time_digits);
    table_.columns[i].push_back(value);
    if (tail == end) {
      if (i + 1 != width) wrong_length(line);
      return;
    }
    cursor = tail + 1;
  }
}

double CsvParser::slow(std::string_view cell, std::size_t column) {
  if (const auto value = to_number(cell)) return *value;
  BadCells& bad = bad_[column];
  if (bad.count++ < shown_cells) bad.first.push_back({line_, std::string(trim(cell))});
  return std::nan("");
}

void CsvParser::wrong_length(std::string_view line) const {
  const std::vector<std::string> cells = split_cells(line, separator_);
  const bool whole = std::all_of(cells.begin(), cells.end(), [](const std::string& c) {
    return !c.empty() && c.find('.') == c.npos && to_number(c);
  });
  std::string text =
      "expected " + std::to_string(table_.columns.size()) + " cells, got " + std::to_string(cells.size());
  if (separator_ == ',' && whole && cells.size() > table_.columns.size())
    text += "; the numbers seem to have decimal commas: export the file with decimal points";
  fail(text, line_);
}

void CsvParser::refuse_bad_cells() const {
  // The earliest fault of the columns that matter is the one to tell.
  const ColumnPlan* worst = nullptr;
  const BadCells* faults = nullptr;
  for (std::size_t i = 0; i < bad_.size(); ++i) {
    if (!bad_[i].count || !table_.plans[i].required) continue;
    if (faults && faults->first[0].line <= bad_[i].first[0].line) continue;
    worst = &table_.plans[i];
    faults = &bad_[i];
  }
  if (faults) fail(describe(*worst, *faults), faults->first[0].line);
}

void CsvParser::judge(std::vector<std::string>& warnings) {
  refuse_bad_cells();
  for (std::size_t i = bad_.size(); i-- > 0;) {
    if (!bad_[i].count) continue;
    warnings.push_back("left out: line " + std::to_string(bad_[i].first[0].line) + ": " +
                       describe(table_.plans[i], bad_[i]));
    table_.plans.erase(table_.plans.begin() + static_cast<std::ptrdiff_t>(i));
    table_.columns.erase(table_.columns.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

double PrintedDigits::resolution(double value) const {
  const double fixed = std::pow(10.0, -decimals);
  if (value == 0) return fixed;
  return std::max(fixed, std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - significant));
}

void check_text(const std::string& path, std::string_view text) {
  if (text.empty()) throw InputError("the file is empty", {path}, Fault::data);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") || text.find('\0') != text.npos)
    throw InputError("expected UTF-8 text, got UTF-16 or a binary file", {path}, Fault::data);
}

std::string read_text(const std::string& path) {
  const auto fail = [&](const std::string& message) { throw InputError(message, {path}, Fault::data); };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(errno == ENOENT ? "no such file" : "cannot read: " + std::string(std::strerror(errno)));
  std::string text;
  struct stat info {};
  if (::fstat(descriptor, &info) == 0 && info.st_size > 0) text.reserve(static_cast<std::size_t>(info.st_size) + 1);
  constexpr std::size_t chunk = 1 << 22;
  for (;;) {
    const std::size_t used = text.size();
    text.resize(used + chunk);
    ssize_t got = ::read(descriptor, text.data() + used, chunk);
    const int reason = errno;
    text.resize(used + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got == 0) break;
    if (got < 0 && reason != EINTR) {
      ::close(descriptor);
      fail("cannot read: " + std::string(std::strerror(reason)));
    }
  }
  ::close(descriptor);
  check_text(path, text);
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  return text;
}

CsvTable parse_table(const std::string& path, std::string_view text, const ReadOptions& options,
                     std::vector<std::string>& warnings) {
  CsvParser parser(path, options);
  parser.rows(parser.header(text, warnings));
  parser.judge(warnings);
  return parser.take();
}

}  // namespace lunid
