#include <charconv>

#include "record/atomic_file.hpp"
#include "record/columns.hpp"
#include "record/record.hpp"

namespace lunid {
namespace {

void append(std::string& text, double value) {
  char digits[32];
  const auto result = std::to_chars(digits, digits + sizeof digits, value);  // shortest that reads back the same
  text.append(digits, result.ptr);
}

std::string header_cell(const std::string& name, const std::string& unit) {
  std::string cell = unit.empty() ? name : name + " [" + unit + "]";
  if (cell.find_first_of(",\"") == cell.npos) return cell;
  for (std::size_t i = 0; (i = cell.find('"', i)) != cell.npos; i += 2) cell.insert(i, 1, '"');
  return '"' + cell + '"';
}

}  // namespace

void write_csv(const Record& record, const std::string& path) {
  std::string text = "t [s]";
  std::vector<std::span<const double>> columns;
  for (const Channel& channel : record.channels()) {
    text += ',' + header_cell(name_in_files(channel), channel.unit);
    columns.push_back(record[channel.name]);
  }
  text += '\n';
  for (Eigen::Index row = 0; row < record.rows(); ++row) {
    append(text, record.time(row));
    for (const auto& column : columns) {
      text += ',';
      append(text, column[static_cast<std::size_t>(row)]);
    }
    text += '\n';
  }
  write_file_atomically(path, text);
}

}  // namespace lunid
