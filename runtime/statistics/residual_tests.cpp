#include "statistics/residual_tests.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "expr/error.hpp"
#include "statistics/dependence.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

Eigen::Map<const Eigen::VectorXd> map_of(std::span<const double> x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}

void check_lengths(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size())
    throw InputError("statistics: series of " + std::to_string(a.size()) + " and of " + std::to_string(b.size()) +
                     " rows");
}

/// Does the residual follow `columns` beyond what `nuisance` explains?
Dependence beside(const Eigen::VectorXd& residual, const Eigen::MatrixXd& columns, const Eigen::MatrixXd& nuisance,
                  Eigen::Index block_length, std::uint64_t seed) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(residual.size()));
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  const Eigen::VectorXd left = residual - nuisance * nuisance.colPivHouseholderQr().solve(residual);
  const Eigen::VectorXd noise = left.array() - left.mean();
  return dependence(left, noise, {{rows, orthonormal_beside(columns, nuisance)}}, block_length, seed);
}

double share(const Dependence& found, double square) {
  return std::max(found.explained - found.by_chance, 0.0) / square;
}

}  // namespace

Parity parity(std::span<const double> residual, std::span<const double> x, Eigen::Index block_length,
              std::uint64_t seed) {
  check_lengths(residual, x);
  constexpr int degree = 5;
  const Eigen::VectorXd r = map_of(residual);
  const double largest = residual.empty() ? 0 : map_of(x).cwiseAbs().maxCoeff(), square = r.squaredNorm();
  if (!(largest > 0) || !(square > 0)) return {};
  const Eigen::ArrayXd scaled = map_of(x).array() / largest;
  const Eigen::MatrixXd p = legendre(scaled, degree);
  Eigen::MatrixXd even(r.size(), 4), odd(r.size(), 4);
  even << p.col(0), p.col(2), p.col(4), scaled.abs().matrix();
  odd << p.col(1), p.col(3), p.col(5), scaled.sign().matrix();
  const Dependence on_even = beside(r, even, odd, block_length, seed),
                   on_odd = beside(r, odd, even, block_length, seed);
  return {share(on_odd, square), share(on_even, square), on_odd.p_value, on_even.p_value};
}

Correlation correlation(std::span<const double> a, std::span<const double> b, Eigen::Index block_length,
                        std::uint64_t seed) {
  check_lengths(a, b);
  const double scale = moments::standard_deviation(a) * moments::standard_deviation(b);
  if (!(scale > 0)) return {};
  const Eigen::VectorXd first = map_of(a).array() - moments::mean(a), second = map_of(b).array() - moments::mean(b);
  const double coefficient = first.dot(second) / static_cast<double>(a.size()) / scale;
  return {coefficient, beside(first, second, Eigen::MatrixXd::Ones(second.size(), 1), block_length, seed).p_value};
}

ResidualTests residual_tests(std::span<const double> residual, std::span<const double> y, std::span<const double> v,
                             double period, Eigen::Index block_length, std::uint64_t seed) {
  ResidualTests result;
  result.in_y = parity(residual, y, block_length, seed);
  result.in_v = parity(residual, v, block_length, seed);
  const Eigen::VectorXd abs_y = map_of(y).cwiseAbs(), abs_r = map_of(residual).cwiseAbs();
  const std::span<const double> amplitude{abs_y.data(), y.size()};
  result.with_abs_y = correlation(residual, amplitude, block_length, seed);
  result.size_with_abs_y = correlation({abs_r.data(), residual.size()}, amplitude, block_length, seed);
  result.past = memory(residual, y, v, period, block_length, seed);
  return result;
}

}  // namespace lunid
