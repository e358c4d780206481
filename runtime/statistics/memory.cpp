// Does a force remember? See Memory in residual_tests.hpp.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "expr/error.hpp"
#include "statistics/bootstrap.hpp"
#include "statistics/residual_tests.hpp"

namespace lunid {
namespace {

constexpr int descriptions = 3;
constexpr std::size_t fewest_in_cell = 8;  // a plane takes three

/// Cell numbers along one axis: equally many values in each, on either side of 0.
std::vector<int> cells_along(std::span<const double> x, int per_side) {
  std::vector<double> positive, negative;
  for (double value : x) (value > 0 ? positive : negative).push_back(value);
  std::sort(positive.begin(), positive.end());
  std::sort(negative.begin(), negative.end());
  std::vector<int> cells(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::vector<double>& side = x[i] > 0 ? positive : negative;
    const auto rank = std::lower_bound(side.begin(), side.end(), x[i]) - side.begin();
    const int cell = static_cast<int>(rank * per_side / static_cast<std::ptrdiff_t>(side.size()));
    cells[i] = x[i] > 0 ? per_side + cell : cell;
  }
  return cells;
}

/// Where the motion last turned, which way it went, and how large it was, of late.
Eigen::MatrixXd describe_past(std::span<const double> y, std::span<const double> v, double period) {
  const auto n = static_cast<Eigen::Index>(y.size());
  Eigen::MatrixXd past(n, descriptions);
  const double forget = 1 - std::exp(-1 / std::max(period, 1.0));
  double turned = y[0], direction = 0, amplitude = std::abs(y[0]);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    past.row(i) << turned, direction, amplitude;  // of the rows before this one
    if (k > 0 && (v[k] > 0) != (v[k - 1] > 0)) turned = y[k];
    direction += forget * (v[k] > 0 ? 1 - direction : -1 - direction);
    amplitude += forget * (std::abs(y[k]) - amplitude);
  }
  return past;
}

/// Rows of each cell that holds enough of them.
std::vector<std::vector<Eigen::Index>> fill_cells(std::span<const double> y, std::span<const double> v) {
  const int per_side = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(y.size()) / 30) / 2), 2, 10);
  const std::vector<int> along_y = cells_along(y, per_side), along_v = cells_along(v, per_side);
  std::vector<std::vector<Eigen::Index>> cells(static_cast<std::size_t>(4 * per_side * per_side));
  for (std::size_t i = 0; i < y.size(); ++i)
    cells[static_cast<std::size_t>(2 * per_side * along_y[i] + along_v[i])].push_back(static_cast<Eigen::Index>(i));
  std::erase_if(cells, [](const auto& cell) { return cell.size() < fewest_in_cell; });
  return cells;
}

/// Columns rid of their plane in y and v within each cell; rows outside all cells become 0.
Eigen::MatrixXd within_cells(const Eigen::MatrixXd& columns, std::span<const double> y, std::span<const double> v) {
  Eigen::MatrixXd left = Eigen::MatrixXd::Zero(columns.rows(), columns.cols());
  for (const auto& cell : fill_cells(y, v)) {
    const auto count = static_cast<Eigen::Index>(cell.size());
    Eigen::MatrixXd plane(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto row = static_cast<std::size_t>(cell[static_cast<std::size_t>(i)]);
      plane.row(i) << 1, y[row], v[row];
    }
    const Eigen::MatrixXd values = columns(cell, Eigen::all);
    const Eigen::MatrixXd fitted = plane * plane.colPivHouseholderQr().solve(values);
    left(cell, Eigen::all) = values - fitted;
  }
  return left;
}

double variance(const Eigen::VectorXd& x) { return (x.array() - x.mean()).square().mean(); }

}  // namespace

Memory memory(std::span<const double> residual, std::span<const double> y, std::span<const double> v, double period,
              Eigen::Index block_length, std::uint64_t seed) {
  if (residual.size() != y.size() || residual.size() != v.size())
    throw InputError("memory: residual, y and v have " + std::to_string(residual.size()) + ", " +
                     std::to_string(y.size()) + " and " + std::to_string(v.size()) + " rows");
  Memory result;
  const auto n = static_cast<Eigen::Index>(residual.size());
  if (n < 100) return result;
  Eigen::MatrixXd columns(n, 1 + descriptions);
  columns.col(0) = Eigen::Map<const Eigen::VectorXd>(residual.data(), n);
  columns.rightCols(descriptions) = describe_past(y, v, period);
  const double total = variance(columns.col(0));
  if (!(total > 0)) return result;
  const Eigen::MatrixXd left = within_cells(columns, y, v);
  const Eigen::VectorXd r = left.col(0);
  Eigen::MatrixXd past = left.rightCols(descriptions);
  for (int k = 0; k < descriptions; ++k) {
    const double of_past = variance(columns.col(1 + k));
    if (of_past > 0) result.contrast = std::max(result.contrast, past.col(k).squaredNorm() / static_cast<double>(n) / of_past);
  }
  result.within = r.squaredNorm() / static_cast<double>(n) / total;
  const Eigen::VectorXd fitted = past * past.colPivHouseholderQr().solve(r);
  result.explained = fitted.squaredNorm() / static_cast<double>(n) / total;
  result.p_value = p_value_of_zero_mean(past.array().colwise() * r.array(),
                                        std::max(block_length, static_cast<Eigen::Index>(std::ceil(period))), seed);
  return result;
}

}  // namespace lunid
