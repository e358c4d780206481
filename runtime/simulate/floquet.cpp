#include "simulate/floquet.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Norm of the exponent of one slice: the error of the fourth-order expansion is then below 1e-7 per period.
constexpr double slice_norm = 0.25;
constexpr Index least_slices = 64, most_slices = 8192;
/// A multiplier is outside beyond this distance from the unit circle; a rest that may lie anywhere (a mass on no
/// spring) has one at +1 exactly.
constexpr double margin = 1e-6;

/// Matrices up to this size stay out of the heap.
constexpr int small = 8;
template <int Most>
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, Most, Most>;

/// exp(a) by Taylor's series on a / 2^k and squaring; a is balanced, so its norm is near its spectral radius.
template <int Most>
void exponential(const Square<Most>& a, Square<Most>& result, Square<Most>& term, Square<Most>& work) {
  const Index n = a.rows();
  const double norm = a.cwiseAbs().colwise().sum().maxCoeff();
  const int squarings = norm > 0.5 ? static_cast<int>(std::ceil(std::log2(norm / 0.5))) : 0;
  const double scale = std::ldexp(1.0, -squarings);
  result = Square<Most>::Identity(n, n);
  term = result;
  for (int k = 1; k <= 16; ++k) {
    work.noalias() = term.lazyProduct(a);
    term = work * (scale / k);
    result += term;
    if (term.cwiseAbs().maxCoeff() < 1e-17) break;
  }
  for (int i = 0; i < squarings; ++i) {
    work.noalias() = result.lazyProduct(result);
    result = work;
  }
}

/// Powers of two that make rows and columns of `a` alike in size (Osborne 1960): x = d * x_balanced.
VectorXd balance(MatrixXd a) {
  const Index n = a.rows();
  VectorXd d = VectorXd::Ones(n);
  for (int sweep = 0; sweep < 20; ++sweep)
    for (Index i = 0; i < n; ++i) {
      const double column = a.col(i).sum() - a(i, i), row = a.row(i).sum() - a(i, i);
      if (!(column > 0) || !(row > 0)) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      a.col(i) *= factor;
      a.row(i) /= factor;
      d[i] *= factor;
    }
  return d;
}

/// df/dx at one sample, in balanced states.
template <int Most>
void slope_at(const DerivativeColumns& columns, Index sample, const VectorXd& d, Square<Most>& a) {
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < a.cols(); ++j)
      a(i, j) = columns.slope(static_cast<int>(i), static_cast<int>(j))[sample] * d[j] / d[i];
}

/// The product over slices of exp(h/6 (A0 + 4 Am + A1) - h^2/12 [A0, A1]).
template <int Most>
MatrixXd product(const DerivativeColumns& columns, Index slices, double h, const VectorXd& d) {
  const Index n = d.size();
  Square<Most> a0(n, n), am(n, n), a1(n, n), exponent(n, n), e(n, n), term(n, n), work(n, n), phi(n, n);
  phi.setIdentity();
  slope_at(columns, 0, d, a0);
  for (Index i = 0; i < slices; ++i) {
    slope_at(columns, 2 * i + 1, d, am);
    slope_at(columns, (2 * i + 2) % (2 * slices), d, a1);
    exponent = (h / 6) * (a0 + 4 * am + a1);
    exponent.noalias() -= (h * h / 12) * a0.lazyProduct(a1);
    exponent.noalias() += (h * h / 12) * a1.lazyProduct(a0);
    exponential<Most>(exponent, e, term, work);
    work.noalias() = e.lazyProduct(phi);
    phi = work;
    a0 = a1;
  }
  MatrixXd full(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) full(i, j) = phi(i, j) * d[i] / d[j];
  return full;
}

}  // namespace

Monodromy::Monodromy(const Dynamics& dynamics, std::span<const double> theta, std::vector<HarmonicInput> inputs)
    : columns_(dynamics, theta), inputs_(std::move(inputs)) {}

const FourierTable& Monodromy::table(int harmonics, Index samples) {
  auto& entry = tables_[{harmonics, samples}];
  if (entry.samples() == 0) entry = FourierTable(harmonics, samples);
  return entry;
}

MatrixXd Monodromy::along(const MatrixXd& series, double omega) {
  const Dynamics& d = columns_.dynamics();
  const int harmonics = static_cast<int>(series.rows() / 2);
  const auto run = [&](Index slices) {
    const FourierTable& at = table(harmonics, 2 * slices);
    return columns_.run(input_values(inputs_, d.exogenous, omega, at.phase()), at.sample(series));
  };
  const MatrixXd undefined = MatrixXd::Constant(d.n, d.n, std::nan(""));
  Index slices = least_slices;
  if (!run(slices)) return undefined;
  MatrixXd mean(d.n, d.n);
  for (int i = 0; i < d.n; ++i)
    for (int j = 0; j < d.n; ++j) mean(i, j) = columns_.slope(i, j).cwiseAbs().mean();
  const VectorXd scale = balance(mean);
  const double norm = (scale.cwiseInverse().asDiagonal() * mean * scale.asDiagonal()).colwise().sum().maxCoeff();
  const double period = 2 * std::numbers::pi / omega;
  const double wanted = std::max(period * norm / slice_norm, 8.0 * harmonics);
  while (static_cast<double>(slices) < wanted && slices < most_slices) slices *= 2;
  if (slices > least_slices && !run(slices)) return undefined;
  const double h = period / static_cast<double>(slices);
  return d.n <= small ? product<small>(columns_, slices, h, scale)
                      : product<Eigen::Dynamic>(columns_, slices, h, scale);
}

Multipliers multipliers_of(const MatrixXd& monodromy) {
  if (!monodromy.allFinite()) return Multipliers(monodromy.rows(), {std::nan(""), 0});
  const Eigen::VectorXcd values = monodromy.eigenvalues();
  Multipliers list(values.begin(), values.end());
  std::stable_sort(list.begin(), list.end(), [](auto a, auto b) { return std::abs(a) > std::abs(b); });
  return list;
}

Outside outside(const Multipliers& multipliers) {
  Outside o;
  for (const auto& m : multipliers) {
    if (std::abs(m) <= 1 + margin) continue;
    ++(m.imag() != 0 ? o.complex : m.real() > 0 ? o.plus : o.minus);
  }
  return o;
}

}  // namespace lunid
