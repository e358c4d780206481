#include "statistics/checks.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "expr/error.hpp"
#include "expr/number.hpp"

namespace lunid {
namespace {

[[noreturn]] void refuse(std::string_view who, const std::string& message) {
  throw InputError(std::string(who) + ": " + message, {}, Fault::data);
}

/// "the column", or "column 2" of several.
std::string name_of(std::size_t column, std::size_t count) {
  return count == 1 ? "the column" : "column " + std::to_string(column + 1);
}

}  // namespace

void check_columns(std::string_view who, const ColumnList& columns, const ColumnNeeds& needs) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::span<const double> x = columns[c];
    const std::string name = name_of(c, columns.size());
    if (!needs.may_differ && x.size() != columns[0].size())
      refuse(who, "columns 1 and " + std::to_string(c + 1) + " have " + std::to_string(columns[0].size()) + " and " +
                      std::to_string(x.size()) + " rows: cut them to one window");
    if (x.size() < needs.rows)
      refuse(who, name + ": expected " + std::to_string(needs.rows) + (needs.rows == 1 ? " row" : " rows") +
                      " or more, got " + std::to_string(x.size()));
    const auto bad = std::find_if(x.begin(), x.end(), [](double value) { return !std::isfinite(value); });
    if (bad != x.end())
      refuse(who, name + " is " + (std::isnan(*bad) ? "not a number" : "infinite") + " at row " +
                      std::to_string(bad - x.begin() + 1) + " of " + std::to_string(x.size()) +
                      ": leave such rows out of the window");
    if (needs.may_be_constant) continue;
    if (std::all_of(x.begin(), x.end(), [&](double value) { return value == x[0]; }))
      refuse(who, name + " is constant, " + write_number(x[0], Format::plain).text + ": nothing can vary with it");
  }
}

ColumnList columns_of(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  ColumnList list;
  for (Eigen::Index c = 0; c < matrix.cols(); ++c)
    list.emplace_back(matrix.col(c).data(), static_cast<std::size_t>(matrix.rows()));
  return list;
}

}  // namespace lunid
