#include "record/csv_table.hpp"

#include <fast_float/fast_float.h>
#include <fcntl.h>
#include <iconv.h>
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

bool is_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// The parts of a number between points and commas, without its sign.
std::vector<std::string_view> groups_of(std::string_view cell) {
  if (!cell.empty() && (cell.front() == '-' || cell.front() == '+')) cell.remove_prefix(1);
  std::vector<std::string_view> groups;
  for (std::size_t end; (end = cell.find_first_of(".,")) != cell.npos; cell.remove_prefix(end + 1))
    groups.push_back(cell.substr(0, end));
  groups.push_back(cell);
  return groups;
}

/// "1.234,5", "1,234,567": groups of three digits.
bool has_thousands(std::string_view cell) {
  const std::vector<std::string_view> groups = groups_of(cell);
  if (groups.size() < 3 || groups[0].size() > 3) return false;
  for (std::size_t i = 1; i + 1 < groups.size(); ++i)
    if (groups[i].size() != 3) return false;
  return std::all_of(groups.begin(), groups.end(), is_digits);
}

/// "1,234" may be a thousand or one; "0,234", "1,23" and "1234,567" may not.
bool may_be_thousands(std::string_view cell) {
  const std::vector<std::string_view> groups = groups_of(trim(cell));
  return groups.size() == 2 && is_digits(groups[0]) && is_digits(groups[1]) && groups[0][0] != '0' &&
         groups[0].size() <= 3 && groups[1].size() == 3;
}

void count_digits(std::string_view cell, PrintedDigits& digits) {
  int significant = 0, decimals = 0, exponent = 0;
  bool point = false;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const char c = cell[i];
    if (c >= '0' && c <= '9') {
      if (significant > 0 || c != '0') ++significant;
      if (point) ++decimals;
    } else if (c == '.' || c == ',') {
      point = true;
    } else if (c == 'e' || c == 'E') {
      if (const auto value = to_number(cell.substr(i + 1))) exponent = static_cast<int>(*value);
      break;
    }
  }
  digits.decimals = std::max(digits.decimals, decimals - exponent);
  digits.significant = std::max(digits.significant, significant);
}

/// What is wrong with a cell. `alone`: with this cell, not with how the file writes its numbers.
struct CellFault {
  std::string text;
  bool alone;
};

CellFault fault_of(const std::string& text, char point, const std::string& sample, int line) {
  const char other = point == ',' ? '.' : ',';
  const auto name = [](char mark) { return mark == ',' ? "decimal comma in '" : "decimal point in '"; };
  if (const auto value = to_number(text, point); value && std::abs(*value) > largest_measurement)
    return {"'" + text + "' is no measurement: beyond 1e60 powers and sums of it are no numbers", true};
  if (has_thousands(text)) return {"thousands separators in '" + text + "': export the file without them", false};
  if (text.find(other) != text.npos && to_number(text, other))
    return {name(other) + text + "', but a " + name(point) + sample + "', line " + std::to_string(line) +
                ": export the file with decimal points throughout",
            false};
  return {"expected a number, got '" + text + "'", true};
}

}  // namespace

void CsvParser::fail(const std::string& message, int line) const {
  throw InputError(message, {path_, line}, Fault::data);
}

std::string_view CsvParser::header(std::string_view text, std::vector<std::string>& warnings) {
  const CsvLayout layout = find_layout(path_, text, options_, warnings);
  ending_ = layout.ending;
  separator_ = layout.separator;
  line_ = layout.line;
  row_advice_ = layout.row_advice;
  if (separator_ == ',') point_.mark = '.', settled_ = true;
  const std::vector<HeaderCell>& header = layout.header;
  table_.header_line = layout.header_line;
  try {
    table_.plans = plan_columns(header, options_, {path_, table_.header_line}, warnings);
  } catch (const InputError& error) {
    throw InputError(error.message() + layout.header_advice, error.where(), error.fault());
  }
  table_.columns.resize(header.size());
  bad_.resize(header.size());
  for (auto& column : table_.columns) column.reserve(text.size() / layout.row_bytes);
  for (std::size_t i = 0; i < header.size(); ++i)
    if (table_.plans[i].channel == "t") time_ = i;
  return layout.rest;
}

void CsvParser::rows(std::string_view piece) {
  std::string_view line;
  while (next_line(piece, ending_, line_, line)) read_row(line);
}

void CsvParser::restart(int line) {
  line_ = line;
  table_.lines.clear();
  for (auto& column : table_.columns) column.clear();
}

void CsvParser::read_row(std::string_view line) {
  if (separator_ != ' ' && line.find('"') == line.npos) return read_plain(line, separator_);
  constexpr char between = '\n';  // which no cell holds
  std::string plain;
  const std::vector<std::string> cells = split_cells(line, separator_);
  for (const std::string& cell : cells) {
    if (separator_ == ',' && has_decimal_comma(cell))
      fail("decimal comma in '" + cell +
               "' between commas: export the file with decimal points, or with ; between "
               "the columns",
           line_);
    if (&cell != &cells.front()) plain += between;
    plain += cell;
  }
  read_plain(plain, between);
}

void CsvParser::read_plain(std::string_view line, char separator) {
  const char *cursor = line.data(), *const end = line.data() + line.size();
  const std::size_t width = table_.columns.size();
  const fast_float::parse_options form(fast_float::chars_format::general, point_.mark == ',' ? ',' : '.');
  table_.lines.push_back(line_);
  for (std::size_t i = 0;; ++i) {
    while (cursor < end && *cursor == ' ') ++cursor;
    double value = 0;
    auto [stop, error] = fast_float::from_chars_advanced(cursor, end, value, form);
    const char* tail = stop;
    while (tail < end && *tail == ' ') ++tail;
    const bool good =
        error == std::errc() && (tail == end || *tail == separator) && std::abs(value) <= largest_measurement;
    if (!good) {
      tail = std::find(cursor, end, separator);
      if (i == width && trim({cursor, static_cast<std::size_t>(end - cursor)}).empty()) return;  // trailing separator
    }
    if (i >= width) return wrong_length(line, separator);
    const std::string_view cell{cursor, static_cast<std::size_t>(tail - cursor)};
    if (!good) value = slow(cell, i);
    if (!settled_ && std::isfinite(value)) settle(cell);
    if (i == time_) count_digits(cell, table_.time_digits);
    table_.columns[i].push_back(value);
    if (tail == end) {
      if (i + 1 != width) wrong_length(line, separator);
      return;
    }
    cursor = tail + 1;
  }
}

double CsvParser::slow(std::string_view cell, std::size_t column) {
  for (const char mark : {'.', ','}) {
    if (point_.mark ? mark != point_.mark : mark != '.' && cell.find('.') != cell.npos) continue;
    if (const auto value = to_number(cell, mark); value && std::abs(*value) <= largest_measurement) return *value;
  }
  BadCells& bad = bad_[column];
  if (bad.count++ < shown_cells) bad.first.push_back({line_, utf8(trim(cell))});
  return std::nan("");
}

/// A point in a number says that commas are none, and the other way round. A comma that may stand before thousands does
/// not settle it.
void CsvParser::settle(std::string_view cell) {
  const char mark = cell.find(',') != cell.npos ? ',' : cell.find('.') != cell.npos ? '.' : '\0';
  if (mark && !point_.mark) point_ = {mark, std::string(trim(cell)), line_};
  settled_ = point_.mark == '.' || (mark == ',' && !may_be_thousands(cell));
}

void CsvParser::wrong_length(std::string_view line, char separator) const {
  const std::vector<std::string> cells = split_cells(line, separator);
  const bool whole = std::all_of(cells.begin(), cells.end(), [](const std::string& c) {
    return !c.empty() && c.find('.') == c.npos && to_number(c);
  });
  std::string text =
      "expected " + std::to_string(table_.columns.size()) + " cells, got " + std::to_string(cells.size());
  if (separator == ',' && whole && cells.size() > table_.columns.size())
    text +=
        "; the numbers seem to have decimal commas: export the file with decimal points, or with ; between the columns";
  else if (table_.lines.size() == 1)
    text += row_advice_;
  else
    text += "; a line that is no row, such as one behind the table, has to go or to begin with #";
  fail(text, line_);
}

std::string CsvParser::describe(std::size_t column, bool advise) const {
  const BadCells& bad = bad_[column];
  const ColumnPlan& plan = table_.plans[column];
  const CellFault fault = fault_of(bad.first[0].text, point_.mark, point_.text, point_.line);
  std::string message = "column '" + plan.header.text + "': " + fault.text;
  if (bad.count > 1) {
    message += "; " + std::to_string(bad.count) + " such cells, the first in lines ";
    for (std::size_t i = 0; i < bad.first.size(); ++i) message += (i ? ", " : "") + std::to_string(bad.first[i].line);
  }
  if (!advise || !fault.alone) return message;
  const bool all = bad.count >= table_.lines.size();
  if (all && plan.channel == "t")
    return message + "; where the rows are evenly spaced, give their rate in its place: rate = HZ (--rate HZ)";
  if (!row_advice_.empty() && bad.first[0].line == table_.lines.front()) return message + row_advice_;
  return all ? message : message + advice_;
}

void CsvParser::refuse_bad_cells() const {
  // The earliest fault of the columns that matter is the one to tell.
  std::size_t worst = bad_.size();
  for (std::size_t i = 0; i < bad_.size(); ++i) {
    if (!bad_[i].count || !table_.plans[i].required) continue;
    if (worst == bad_.size() || bad_[i].first[0].line < bad_[worst].first[0].line) worst = i;
  }
  if (worst < bad_.size()) fail(describe(worst, true), bad_[worst].first[0].line);
}

void CsvParser::judge(std::vector<std::string>& warnings) {
  refuse_bad_cells();
  if (point_.mark == ',' && !settled_)
    fail("the comma in '" + point_.text +
             "' may stand before decimals or thousands, and no number of the file tells: "
             "export it with decimal points",
         point_.line);
  for (std::size_t i = bad_.size(); i-- > 0;) {
    if (!bad_[i].count) continue;
    if (!table_.plans[i].channel.empty())  // else that is said
      warnings.push_back("left out: line " + std::to_string(bad_[i].first[0].line) + ": " + describe(i, false));
    table_.plans.erase(table_.plans.begin() + static_cast<std::ptrdiff_t>(i));
    table_.columns.erase(table_.columns.begin() + static_cast<std::ptrdiff_t>(i));
    bad_.erase(bad_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void CsvParser::drop_bad_rows(std::vector<std::string>& warnings) {
  std::vector<std::string> faults;
  std::vector<bool> bad(table_.lines.size(), false);
  for (std::size_t i = 0; i < bad_.size(); ++i) {
    if (!bad_[i].count || !table_.plans[i].required) continue;
    for (const BadCell& cell : bad_[i].first)
      if (!fault_of(cell.text, point_.mark, point_.text, point_.line).alone) return;
    faults.push_back("line " + std::to_string(bad_[i].first[0].line) + ": " + describe(i, false) +
                     ": what stands there is taken for a missing row");
    for (std::size_t row = 0; row < bad.size(); ++row) bad[row] = bad[row] || std::isnan(table_.columns[i][row]);
  }
  if (faults.empty() || 2 * std::ranges::count(bad, true) > std::ssize(bad)) return;
  const auto keep = [&](auto& values) {
    std::size_t kept = 0;
    for (std::size_t row = 0; row < bad.size(); ++row)
      if (!bad[row]) values[kept++] = values[row];
    values.resize(kept);
  };
  for (auto& column : table_.columns) keep(column);
  keep(table_.lines);
  for (std::size_t i = 0; i < bad_.size(); ++i)
    if (table_.plans[i].required) bad_[i] = {};
  warnings.insert(warnings.end(), faults.begin(), faults.end());
}

double PrintedDigits::resolution(double value) const {
  const double fixed = std::pow(10.0, -decimals);
  if (value == 0) return fixed;
  return std::max(fixed, std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - significant));
}

namespace {

bool is_utf16(std::string_view text) { return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"); }

/// Of UTF-16, which says by its first two bytes in which order they are.
std::string from_utf16(const std::string& path, std::string text) {
  const iconv_t converter = ::iconv_open("UTF-8", "UTF-16");
  std::string out(2 * text.size(), '\0');
  char *from = text.data(), *to = out.data();
  std::size_t left = text.size() / 2 * 2, room = out.size();
  const bool good = ::iconv(converter, &from, &left, &to, &room) != static_cast<std::size_t>(-1);
  ::iconv_close(converter);
  if (!good) throw InputError("expected UTF-8 or UTF-16 text, got neither", {path}, Fault::data);
  out.resize(out.size() - room);
  return out;
}

}  // namespace

void check_text(const std::string& path, std::string_view text) {
  const auto fail = [&](const std::string& message) { throw InputError(message, {path}, Fault::data); };
  if (text.empty()) fail("the file is empty");
  if (text.starts_with("\x1f\x8b")) fail("expected text, got a file that gzip has packed: unpack it (gunzip)");
  if (text.starts_with("PK\x03\x04")) fail("expected text, got a workbook or an archive: export the table as CSV");
  if (is_utf16(text)) fail("expected UTF-8 text, got UTF-16: save it as UTF-8, or read it whole with lunid.read");
  if (text.find('\0') != text.npos) fail("expected UTF-8 text, got UTF-16 or a binary file");
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
  if (is_utf16(text)) text = from_utf16(path, std::move(text));
  check_text(path, text);
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  return text;
}

CsvTable parse_table(const std::string& path, std::string_view text, const ReadOptions& options,
                     std::vector<std::string>& warnings) {
  CsvParser parser(path, options,
                   options.interval > 0
                       ? "; mend it: beside a rate no row may be missing"
                       : "; mend it, or set resample = true (--resample), which interpolates such rows as "
                         "missing ones");
  parser.rows(parser.header(text, warnings));
  if (options.resample && !(options.interval > 0)) parser.drop_bad_rows(warnings);
  parser.judge(warnings);
  return parser.take();
}

}  // namespace lunid
