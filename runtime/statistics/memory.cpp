// Does a force remember? See Memory in residual_tests.hpp.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "expr/error.hpp"
#include "statistics/dependence.hpp"
#include "statistics/moments.hpp"
#include "statistics/residual_tests.hpp"

namespace lunid {
namespace {

constexpr int descriptions = 3;
constexpr std::size_t fewest_in_cell = 12;  // a plane takes three, the past three more

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

/// Where the motion last turned, where it was and how large it was of late; of the rows before each row.
Eigen::MatrixXd describe_past(std::span<const double> y, std::span<const double> v, double period) {
  const auto n = static_cast<Eigen::Index>(y.size());
  const double forget = 1 - std::exp(-1 / std::max(period, 1.0));
  const auto first = std::clamp<std::size_t>(static_cast<std::size_t>(period), 1, y.size());
  double turned = y[0], middle = 0, amplitude = 0;
  for (double value : y.first(first)) {
    middle += value / static_cast<double>(first);
    amplitude += std::abs(value) / static_cast<double>(first);
  }
  Eigen::MatrixXd past(n, descriptions);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (k > 0 && (v[k] > 0) != (v[k - 1] > 0)) turned = y[k - 1];
    past.row(i) << turned, middle, amplitude;
    middle += forget * (y[k] - middle);
    amplitude += forget * (std::abs(y[k]) - amplitude);
  }
  return past;
}

/// Rows of each cell that holds enough of them.
std::vector<std::vector<Eigen::Index>> fill_cells(std::span<const double> y, std::span<const double> v) {
  const int per_side = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(y.size()) / 60) / 2), 2, 10);
  const std::vector<int> along_y = cells_along(y, per_side), along_v = cells_along(v, per_side);
  std::vector<std::vector<Eigen::Index>> cells(static_cast<std::size_t>(4 * per_side * per_side));
  for (std::size_t i = 0; i < y.size(); ++i)
    cells[static_cast<std::size_t>(2 * per_side * along_y[i] + along_v[i])].push_back(static_cast<Eigen::Index>(i));
  std::erase_if(cells, [](const auto& cell) { return cell.size() < fewest_in_cell; });
  return cells;
}

/// The residual less a smooth function of y and v (and steps at 0): noise and memory, with their colour,
/// which the planes of the cells would spoil. Where the function is too smooth, what it leaves makes the test
/// more careful.
Eigen::VectorXd noise_of(const Eigen::VectorXd& residual, std::span<const double> y, std::span<const double> v) {
  constexpr int degree = 3;
  const Eigen::Map<const Eigen::ArrayXd> displacement(y.data(), residual.size()), velocity(v.data(), residual.size());
  const Eigen::MatrixXd in_y = legendre(displacement / std::max(displacement.abs().maxCoeff(), 1e-300), degree);
  const Eigen::MatrixXd in_v = legendre(velocity / std::max(velocity.abs().maxCoeff(), 1e-300), degree);
  Eigen::MatrixXd columns(residual.size(), (degree + 1) * (degree + 2) / 2 + 2);
  Eigen::Index column = 0;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j) columns.col(column++) = in_y.col(i).cwiseProduct(in_v.col(j));
  columns.col(column++) = displacement.sign();
  columns.col(column++) = velocity.sign();
  return residual - columns * columns.colPivHouseholderQr().solve(residual);
}

/// What is left of the residual within the cells, and the past's functions in each.
struct Within {
  Eigen::VectorXd residual;
  std::vector<Projection> past;
  double contrast = 0;  ///< root mean square of what is left of the past, largest of its descriptions
};

Within within_cells(const Eigen::VectorXd& residual, const Eigen::MatrixXd& past, std::span<const double> y,
                    std::span<const double> v) {
  Within result{Eigen::VectorXd::Zero(residual.size()), {}, 0};
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(descriptions);
  for (const auto& cell : fill_cells(y, v)) {
    const auto count = static_cast<Eigen::Index>(cell.size());
    Eigen::MatrixXd plane(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto row = static_cast<std::size_t>(cell[static_cast<std::size_t>(i)]);
      plane.row(i) << 1, y[row], v[row];
    }
    const Eigen::MatrixXd basis = orthonormal_beside(plane, Eigen::MatrixXd(count, 0));
    const Eigen::VectorXd r = residual(cell);
    result.residual(cell) = r - basis * (basis.transpose() * r);
    const Eigen::MatrixXd history = past(cell, Eigen::all);
    squares += (history - basis * (basis.transpose() * history)).colwise().squaredNorm().transpose();
    result.past.push_back({cell, orthonormal_beside(history, plane)});
  }
  result.contrast = std::sqrt(squares.maxCoeff() / static_cast<double>(residual.size()));
  return result;
}

}  // namespace

Memory memory(std::span<const double> residual, std::span<const double> y, std::span<const double> v, double period,
              Eigen::Index block_length, std::uint64_t seed) {
  if (residual.size() != y.size() || residual.size() != v.size())
    throw InputError("memory: residual, y and v have " + std::to_string(residual.size()) + ", " +
                     std::to_string(y.size()) + " and " + std::to_string(v.size()) + " rows");
  Memory result;
  const auto n = static_cast<Eigen::Index>(residual.size());
  const double total = static_cast<double>(n) * std::pow(moments::standard_deviation(residual), 2);
  const double size = moments::standard_deviation(y);
  if (n < 100 || !(total > 0) || !(size > 0)) return result;
  const Eigen::VectorXd noise = noise_of(Eigen::Map<const Eigen::VectorXd>(residual.data(), n), y, v);
  const Within within = within_cells(noise, describe_past(y, v, period), y, v);
  const Eigen::Index block = std::max(block_length, static_cast<Eigen::Index>(std::ceil(period)));
  const Dependence found = dependence(within.residual, noise, within.past, block, seed);
  result.within = within.residual.squaredNorm() / total;
  result.explained = std::max(found.explained - found.by_chance, 0.0) / total;
  result.p_value = found.p_value;
  result.contrast = within.contrast / size;
  return result;
}

}  // namespace lunid
