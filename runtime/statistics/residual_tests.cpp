#include "statistics/residual_tests.hpp"

#include <Eigen/QR>
#include <array>
#include <cmath>

#include "expr/error.hpp"
#include "statistics/bootstrap.hpp"
#include "statistics/fit_measures.hpp"

namespace lunid {
namespace {

constexpr int degree = 5;

Eigen::Map<const Eigen::VectorXd> map_of(std::span<const double> x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}

void check_lengths(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size())
    throw InputError("statistics: series of " + std::to_string(a.size()) + " and of " + std::to_string(b.size()) +
                     " rows");
}

/// Legendre polynomials 0 .. degree of s in [-1, 1], one in each column.
Eigen::MatrixXd legendre(const Eigen::ArrayXd& s) {
  Eigen::MatrixXd p(s.size(), degree + 1);
  p.col(0).setOnes();
  p.col(1) = s;
  for (int k = 1; k < degree; ++k)
    p.col(k + 1) = ((2 * k + 1) * s * p.col(k).array() - k * p.col(k - 1).array()) / (k + 1);
  return p;
}

}  // namespace

Parity parity(std::span<const double> residual, std::span<const double> x, Eigen::Index block_length,
              std::uint64_t seed) {
  check_lengths(residual, x);
  Parity result;
  if (residual.empty()) return result;
  const Eigen::VectorXd r = map_of(residual);
  const double largest = map_of(x).cwiseAbs().maxCoeff(), square = r.squaredNorm();
  if (!(largest > 0) || !(square > 0)) return result;
  const Eigen::MatrixXd p = legendre(map_of(x).array() / largest);
  // Jointly, because the data need not be symmetric about 0.
  const Eigen::VectorXd coefficients = p.colPivHouseholderQr().solve(r);
  Eigen::VectorXd part[2] = {Eigen::VectorXd::Zero(r.size()), Eigen::VectorXd::Zero(r.size())};
  Eigen::MatrixXd scores[2] = {Eigen::MatrixXd(r.size(), 3), Eigen::MatrixXd(r.size(), 3)};
  for (int k = 0; k <= degree; ++k) {
    part[k % 2] += coefficients[k] * p.col(k);
    scores[k % 2].col(k / 2) = p.col(k).cwiseProduct(r);
  }
  result.even = part[0].squaredNorm() / square;
  result.odd = part[1].squaredNorm() / square;
  result.even_p_value = p_value_of_zero_mean(scores[0], block_length, seed);
  result.odd_p_value = p_value_of_zero_mean(scores[1], block_length, seed);
  return result;
}

Correlation correlation(std::span<const double> a, std::span<const double> b, Eigen::Index block_length,
                        std::uint64_t seed) {
  check_lengths(a, b);
  const double scale = standard_deviation(a) * standard_deviation(b);
  if (!(scale > 0)) return {};
  const Eigen::VectorXd product =
      (map_of(a).array() - mean(a)) * (map_of(b).array() - mean(b)) / scale;
  return {product.mean(), p_value_of_zero_mean(product, block_length, seed)};
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
