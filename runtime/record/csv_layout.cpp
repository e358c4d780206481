#include "record/csv_layout.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lunid {
namespace {

constexpr std::size_t lines_looked_through = 200;

/// A line near the beginning of a file.
struct Line {
  std::string text;  ///< without the mark of a comment
  bool comment = false;
  int number = 0;
  std::string_view from, rest;  ///< what begins with it, and what follows it
};

/// '#', '%' or "//" at the start of a line: how long it is, 0 where there is none.
std::size_t comment_mark(std::string_view text) {
  if (text.starts_with('#') || text.starts_with('%')) return 1;
  return text.starts_with("//") ? 2 : 0;
}

/// The next line, whatever it holds.
bool any_line(std::string_view& rest, char ending, int& number, std::string_view& line) {
  if (rest.empty()) return false;
  const char* end = static_cast<const char*>(std::memchr(rest.data(), ending, rest.size()));
  const std::size_t length = end ? static_cast<std::size_t>(end - rest.data()) : rest.size();
  line = rest.substr(0, length);
  rest.remove_prefix(std::min(length + 1, rest.size()));
  ++number;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

std::string_view without_indent(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return line.substr(first == line.npos ? line.size() : first);
}

std::vector<Line> first_lines(std::string_view rest, char ending) {
  std::vector<Line> lines;
  std::string_view line;
  std::string_view from = rest;
  for (int number = 0; lines.size() < lines_looked_through && any_line(rest, ending, number, line); from = rest) {
    const std::string_view text = without_indent(line);
    if (text.empty()) continue;
    const std::size_t mark = comment_mark(text);
    if (mark && !lines.empty() && lines.back().comment) lines.pop_back();  // only the last of them may be the header
    lines.push_back({utf8(mark ? text.substr(mark) : line), mark > 0, number, from, rest});
  }
  return lines;
}

/// Cells of a line without the empty one that a separator at its end makes; none between blanks where other separators
/// are there too.
std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells = split_cells(line, separator);
  if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  const auto goes_on = [](const std::string& cell) { return cell.ends_with(',') || cell.ends_with(';'); };
  if (separator == ' ' && std::ranges::any_of(cells, goes_on)) cells.clear();
  return cells;
}

bool is_number(const std::string& cell) { return to_number(cell) || has_decimal_comma(cell); }

std::size_t count_numbers(const std::vector<std::string>& cells) {
  return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), is_number));
}

bool are_numbers(const std::vector<std::string>& cells) {
  return !cells.empty() && count_numbers(cells) == cells.size();
}

/// Of a line that is taken for the header; blanks may be part of names, and separate numbers alone.
char find_separator(std::string_view header) {
  for (char candidate : {'\t', ';', ','})
    if (split_cells(header, candidate).size() > 1) return candidate;
  return are_numbers(cells_of(header, ' ')) ? ' ' : ',';
}

/// Numbers, perhaps with some text after them.
bool is_row(const std::vector<std::string>& cells) {
  const std::size_t numbers = count_numbers(cells);
  return numbers >= 2 && 2 * numbers >= cells.size() && is_number(cells[0]);
}

bool are_names(const std::vector<std::string>& cells) {
  return cells.size() > 1 && count_numbers(cells) == 0 &&
         std::none_of(cells.begin(), cells.end(), [](const std::string& cell) { return cell.empty(); });
}

/// "mm" of "mm", "[mm]" or "(mm)".
std::string bare_unit(std::string_view cell) {
  cell = trim(cell);
  if (cell.size() > 2 && ((cell.front() == '[' && cell.back() == ']') || (cell.front() == '(' && cell.back() == ')')))
    cell = trim(cell.substr(1, cell.size() - 2));
  return std::string(cell);
}

bool is_unit(const std::string& cell) { return si_unit(bare_unit(cell)).has_value(); }

/// A line of so many cells that are units or empty.
bool are_units(std::string_view line, char separator, std::size_t count) {
  std::vector<std::string> cells = split_cells(line, separator);
  if (cells.size() == count + 1 && cells.back().empty()) cells.pop_back();
  return cells.size() == count && count_numbers(cells) < count && std::any_of(cells.begin(), cells.end(), is_unit) &&
         std::all_of(cells.begin(), cells.end(), [](const std::string& cell) { return cell.empty() || is_unit(cell); });
}

/// Where the header and the units below it are, as indices of lines.
struct Place {
  std::size_t header;
  std::optional<std::size_t> units;
  char separator;
};

using Lines = std::vector<Line>;

std::optional<std::size_t> following(const Lines& lines, std::size_t i) {
  while (++i < lines.size())
    if (!lines[i].comment) return i;
  return std::nullopt;
}

std::optional<std::size_t> preceding(const Lines& lines, std::size_t i) {
  while (i-- > 0)
    if (!lines[i].comment) return i;
  return std::nullopt;
}

/// The line as the header of those below it, where these are a row of as many cells, or units.
std::optional<Place> header_at(const Lines& lines, std::size_t i) {
  const char separator = find_separator(lines[i].text);
  const std::vector<std::string> names = cells_of(lines[i].text, separator);
  const auto next = following(lines, i);
  if (!next || !are_names(names)) return std::nullopt;
  if (are_units(lines[*next].text, separator, names.size())) return Place{i, *next, separator};
  const auto is_row_at = [&](const std::optional<std::size_t>& at) {
    const std::vector<std::string> cells = cells_of(lines[*at].text, separator);
    return cells.size() == names.size() && is_row(cells);
  };
  const auto second = following(lines, *next);  // one row alone: two settings of a logger, by name
  if (is_row_at(next) && (!second || is_row_at(second))) return Place{i, std::nullopt, separator};
  return std::nullopt;
}

/// The header above row `i` of `count` cells.
std::optional<Place> header_above(const Lines& lines, std::size_t i, char separator, std::size_t count) {
  const auto names_in = [&](const std::optional<std::size_t>& at) {
    if (!at) return false;
    const std::vector<std::string> cells = cells_of(lines[*at].text, separator);
    return cells.size() == count && are_names(cells);
  };
  const auto above = preceding(lines, i);
  if (above && are_units(lines[*above].text, separator, count))
    if (const auto header = preceding(lines, *above); names_in(header)) return Place{*header, *above, separator};
  if (names_in(above) && names_in(preceding(lines, *above))) return std::nullopt;  // which of them?
  if (names_in(above)) return Place{*above, std::nullopt, separator};
  const auto comment = above || i == 0 ? std::nullopt : std::optional(i - 1);
  return names_in(comment) ? std::optional(Place{*comment, std::nullopt, separator}) : std::nullopt;
}

/// The header above the first two rows of numbers.
std::optional<Place> header_above_rows(const Lines& lines, char separator) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].comment) continue;
    const std::vector<std::string> row = cells_of(lines[i].text, separator);
    const auto next = following(lines, i);
    if (!is_row(row) || !next) continue;
    const std::vector<std::string> other = cells_of(lines[*next].text, separator);
    if (other.size() == row.size() && is_row(other)) return header_above(lines, i, separator, row.size());
  }
  return std::nullopt;
}

std::optional<Place> place_of(const Lines& lines, std::size_t first) {
  if (const auto place = header_at(lines, first)) return place;
  for (const char separator : {'\t', ';', ',', ' '})
    if (const auto place = header_above_rows(lines, separator)) return place;
  return std::nullopt;
}

[[noreturn]] void fail(const std::string& path, int line, const std::string& message) {
  throw InputError(message, {path, line}, Fault::data);
}

constexpr const char* what_to_do = "; where lines before the table are no part of it, delete them or begin them with #";

/// What to say where the first row has a word in place of a number: a line of units, one of which is none.
std::string of_unknown_unit(const Lines& lines, std::size_t header, char separator) {
  const auto next = following(lines, header);
  if (!next) return {};
  const std::vector<std::string> names = cells_of(lines[header].text, separator),
                                 units = cells_of(lines[*next].text, separator);
  if (names.size() != units.size() || count_numbers(units) > 0 || std::none_of(units.begin(), units.end(), is_unit))
    return {};
  for (std::size_t i = 0; i < units.size(); ++i)
    if (!units[i].empty() && !is_unit(units[i]))
      return "; where this is a line of units, '" + units[i] +
             "' is none that is known: write them into the header, as '" + split_header(names[i]).name +
             " [mm]', and delete it";
  return {};
}

/// Are columns asked for by their numbers?
bool are_numbered(const ReadOptions& options) {
  return std::ranges::any_of(options.columns, [](const ColumnMap& map) {
    return !map.header.empty() && map.header != "0" && map.header.find_first_not_of("0123456789") == map.header.npos;
  });
}

/// "1", "2" ... of a table without names.
std::vector<HeaderCell> numbers_for_names(std::size_t count) {
  std::vector<HeaderCell> header;
  for (std::size_t i = 1; i <= count; ++i) header.push_back({std::to_string(i), std::to_string(i), ""});
  return header;
}

/// Names and units of the columns. `units`: the line below, empty where it holds none.
std::vector<HeaderCell> header_cells(const std::string& path, int line, const std::vector<std::string>& cells,
                                     const std::vector<std::string>& units) {
  if (are_numbers(cells))
    fail(path, line,
         "no header: expected the names of the columns, got numbers; put a line such as 't [s],F [N],y [m]' first, or "
         "say the columns by their numbers: columns = \"t=1,F=2 [N],y=3 [mm]\" (--columns)");
  std::vector<HeaderCell> header;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].empty()) fail(path, line, "column " + std::to_string(i + 1) + " has no name");
    HeaderCell cell = split_header(cells[i]);
    const std::string below = i < units.size() ? bare_unit(units[i]) : "";
    if (!below.empty() && !cell.unit.empty() && cell.unit != below)
      fail(path, line + 1,
           "column '" + cell.text + "': its unit is '" + cell.unit + "' in the header and '" + below +
               "' in the line of units: expected one of them");
    if (!below.empty()) cell.unit = below;
    header.push_back(cell);
  }
  return header;
}

void warn_of_skipped(const Lines& lines, std::size_t header, std::vector<std::string>& warnings) {
  const auto first = std::find_if(lines.begin(), lines.end(), [](const Line& line) { return !line.comment; });
  const auto end = lines.begin() + static_cast<std::ptrdiff_t>(header);
  const auto count = first < end ? std::count_if(first, end, [](const Line& line) { return !line.comment; }) : 0;
  if (count == 0) return;
  warnings.push_back(std::to_string(count) + (count == 1 ? " line" : " lines") + " before the header in line " +
                     std::to_string(lines[header].number) + (count == 1 ? " is" : " are") +
                     " no part of the table and skipped, the first: '" + std::string(trim(first->text)) + "'");
}

}  // namespace

bool next_line(std::string_view& rest, char ending, int& number, std::string_view& line) {
  while (any_line(rest, ending, number, line)) {
    const std::string_view text = without_indent(line);
    if (!text.empty() && comment_mark(text) == 0) return true;
  }
  return false;
}

namespace {

/// Cells between any number of blanks; a bracket belongs to the name before it.
std::vector<std::string> split_at_blanks(std::string_view line) {
  std::vector<std::string> cells;
  bool between = true;
  int depth = 0;
  for (const char c : line) {
    const bool opens = c == '[' || c == '(', blank = c == ' ' || c == '\t';
    if (blank && depth == 0) {
      between = true;
      continue;
    }
    if (between && (cells.empty() || !opens)) cells.emplace_back();
    if (between && !cells.back().empty()) cells.back() += ' ';
    between = false;
    depth += opens ? 1 : c == ']' || c == ')' ? -1 : 0;
    cells.back() += c;
  }
  return cells;
}

}  // namespace

std::vector<std::string> split_cells(std::string_view line, char separator) {
  if (separator == ' ') return split_at_blanks(line);
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && (quoted || trim(cells.back()).empty())) {
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

namespace {

/// "1.5E-3" of Fortran's "1.5D-3" and of a minus that is a typographer's; nothing where the cell has neither.
std::optional<std::string> in_plain_signs(std::string_view cell) {
  static constexpr std::string_view minus = "\u2212";
  std::string plain;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const bool is_minus = cell.substr(i).starts_with(minus);
    plain += is_minus ? '-' : cell[i] == 'D' || cell[i] == 'd' ? 'E' : cell[i];
    if (is_minus) i += minus.size() - 1;
  }
  return plain == cell ? std::nullopt : std::optional(plain);
}

}  // namespace

std::optional<double> to_number(std::string_view cell, char decimal) {
  cell = trim(cell);
  const std::string_view whole = cell;
  if (!cell.empty() && cell.front() == '+') cell.remove_prefix(1);
  double value = 0;
  const fast_float::parse_options options(fast_float::chars_format::general, decimal);
  const auto [end, error] = fast_float::from_chars_advanced(cell.data(), cell.data() + cell.size(), value, options);
  if (error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value)) return value;
  const auto plain = in_plain_signs(whole);
  return plain ? to_number(*plain, decimal) : std::nullopt;
}

bool has_decimal_comma(std::string_view cell) {
  return cell.find(',') != cell.npos && to_number(cell, ',').has_value();
}

std::string utf8(std::string_view text) {
  std::string latin;
  bool valid = true;
  int more = 0;  // bytes that a character still needs
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (more > 0) {
      valid = valid && (byte & 0xC0) == 0x80;
      --more;
    } else if (byte >= 0x80) {
      more = byte >= 0xF0 ? 3 : byte >= 0xE0 ? 2 : 1;
      valid = valid && byte >= 0xC2 && byte <= 0xF4;
    }
    if (byte < 0x80) {
      latin += c;
    } else {
      latin += static_cast<char>(0xC0 | byte >> 6);
      latin += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return valid && more == 0 ? std::string(text) : latin;
}

CsvLayout find_layout(const std::string& path, std::string_view text, const ReadOptions& options,
                      std::vector<std::string>& warnings) {
  CsvLayout layout;
  layout.ending = text.find('\n') == text.npos ? '\r' : '\n';
  const Lines lines = first_lines(text, layout.ending);
  const auto content = std::find_if(lines.begin(), lines.end(), [](const Line& line) { return !line.comment; });
  if (content == lines.end()) fail(path, 0, "no header: the file holds no more than comments and blank lines");
  const auto first = static_cast<std::size_t>(content - lines.begin());
  std::optional<Place> place = place_of(lines, first);
  if (place) {
    warn_of_skipped(lines, place->header, warnings);
  } else {
    place = Place{first, std::nullopt, find_separator(content->text)};
    layout.header_advice = what_to_do;
    layout.row_advice = of_unknown_unit(lines, first, place->separator);
    if (layout.row_advice.empty()) layout.row_advice = what_to_do;
  }
  const Line& header = lines[place->header];
  const Line& last = place->units ? lines[*place->units] : header;
  layout.separator = place->separator;
  layout.header_line = header.number;
  layout.line = last.number;
  layout.rest = last.rest;
  layout.row_bytes = header.text.size() + 1;
  const std::vector<std::string> cells = cells_of(header.text, layout.separator);
  if (are_numbers(cells) && are_numbered(options)) {
    layout.header = numbers_for_names(cells.size());
    layout.line = header.number - 1;
    layout.rest = header.from;
    return layout;
  }
  layout.header = header_cells(path, header.number, cells,
                               place->units ? split_cells(last.text, layout.separator) : std::vector<std::string>{});
  if (layout.header.size() == 1 && !(options.interval > 0))
    fail(path, header.number,
         "expected columns separated by , ; tab or blanks, got one column '" + layout.header[0].text +
             "'; where it is one alone give the rows per second: rate = HZ (--rate HZ)" + layout.header_advice);
  return layout;
}

}  // namespace lunid
