#pragma once
// Inside statistics: columns that a measure can be taken of.
#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

namespace lunid {

using ColumnList = std::vector<std::span<const double>>;

/// Which columns a measure takes.
struct ColumnNeeds {
  std::size_t rows = 1;          ///< at least
  bool may_be_constant = false;  ///< a column of one value has a meaning
  bool may_differ = false;       ///< in their lengths
};
/// Throws InputError (Fault::data) naming `who`, the column (from 1) and the row (from 1): columns of different
/// lengths, too few rows, a value that is not finite, a constant column.
void check_columns(std::string_view who, const ColumnList& columns, const ColumnNeeds& needs = {});

inline std::span<const double> span_of(const Eigen::VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}
/// The columns of a matrix that lives on.
ColumnList columns_of(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

}  // namespace lunid
