#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "sweep.hpp"

namespace lunid::lua {

namespace {

constexpr const char* title = "lunid ensemble 1 ";

void append_number(std::string& line, double value) {
  char text[40];
  std::snprintf(text, sizeof text, " %a", value);
  line += text;
}

/// "member stopped_at values... | cause" into the result; false when the line is not of that form.
bool take_line(const std::string& line, EnsembleResult& result) {
  const std::size_t bar = line.find('|');
  if (bar == std::string::npos) return false;
  const char* at = line.c_str();
  char* end = nullptr;
  const long long member = std::strtoll(at, &end, 10);
  if (end == at || member < 0 || member >= result.values.rows()) return false;
  const auto next = [&](double& value) {
    at = end;
    value = std::strtod(at, &end);
    return end != at;
  };
  double stopped_at = 0;
  if (!next(stopped_at)) return false;
  Eigen::RowVectorXd values(result.values.cols());
  for (double& value : values)
    if (!next(value)) return false;
  result.values.row(member) = values;
  result.stopped_at[member] = stopped_at;
  result.cause[static_cast<std::size_t>(member)] = line.substr(bar + 1);
  result.done[static_cast<std::size_t>(member)] = 1;
  return true;
}

}  // namespace

void PartialFile::read(const std::string& path, const std::string& key, EnsembleResult& result) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  if (!std::getline(in, line) || line != title + key) return;
  while (std::getline(in, line) && !in.eof())  // the end of the file within a line: it was not finished
    if (!take_line(line, result)) return;
}

void PartialFile::add(const EnsembleResult& result, std::span<const Eigen::Index> members) {
  for (const Eigen::Index member : members) {
    lines_ += std::to_string(member);
    append_number(lines_, result.stopped_at[member]);
    for (Eigen::Index j = 0; j < result.values.cols(); ++j) append_number(lines_, result.values(member, j));
    lines_ += "|" + result.cause[static_cast<std::size_t>(member)] + "\n";
  }
}

void PartialFile::flush() {
  if (!out_.is_open()) {
    out_.open(path_, std::ios::binary | std::ios::trunc);
    out_ << title << key_ << "\n";
  }
  out_ << lines_ << std::flush;
  lines_.clear();
  if (!out_) throw InputError("cannot write: what an ensemble keeps while it runs", {path_}, Fault::data);
}

}  // namespace lunid::lua
