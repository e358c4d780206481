#include "simulate/balance.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/FFT>

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A state far smaller than elsewhere on its branch is followed only to this part of its largest.
constexpr double least_scale = 1e-3;

/// The projection of J(tau) * (series) on the harmonics, J being given by its samples: products of two harmonics are
/// sums of the harmonics of J at the sum and the difference of their orders.
MatrixXd product_matrix(const VectorXd& slope, const FourierTable& fine, int harmonics) {
  const VectorXd mean = fine.values().transpose() * slope / static_cast<double>(slope.size());
  const auto c = [&](int k) { return k == 0 ? mean[0] : mean[2 * std::abs(k) - 1]; };
  const auto s = [&](int k) { return k == 0 ? 0 : k > 0 ? mean[2 * k] : -mean[-2 * k]; };
  MatrixXd m(2 * harmonics + 1, 2 * harmonics + 1);
  m(0, 0) = c(0);
  for (int l = 1; l <= harmonics; ++l) {
    m(0, 2 * l - 1) = c(l);
    m(0, 2 * l) = s(l);
    m(2 * l - 1, 0) = 2 * c(l);
    m(2 * l, 0) = 2 * s(l);
    for (int k = 1; k <= harmonics; ++k) {
      m(2 * k - 1, 2 * l - 1) = c(k - l) + c(k + l);
      m(2 * k - 1, 2 * l) = s(l + k) + s(l - k);
      m(2 * k, 2 * l - 1) = s(k + l) + s(k - l);
      m(2 * k, 2 * l) = c(k - l) - c(k + l);
    }
  }
  return m;
}

/// m * D where D takes a series to that of its phase derivative.
MatrixXd times_derivative(const MatrixXd& m) {
  MatrixXd out = MatrixXd::Zero(m.rows(), m.cols());
  for (Index k = 1; 2 * k < m.cols(); ++k) {
    out.col(2 * k - 1) = -static_cast<double>(k) * m.col(2 * k);
    out.col(2 * k) = static_cast<double>(k) * m.col(2 * k - 1);
  }
  return out;
}

}  // namespace

HarmonicBalance::HarmonicBalance(const Dynamics& dynamics, std::span<const double> theta,
                                 std::vector<HarmonicInput> inputs)
    : d_(dynamics),
      inputs_(std::move(inputs)),
      columns_(dynamics, theta),
      pairs_(displacement_pairs(dynamics)),
      place_(dynamics.n, -1),
      speed_of_(dynamics.n, -1) {
  std::vector<bool> follows(d_.n, false);
  for (const auto& [y, v] : pairs_) {
    speed_of_[v] = y;
    follows[y] = true;
  }
  for (int i = 0; i < d_.n; ++i) {
    if (!follows[i]) equation_.push_back(i);
    if (speed_of_[i] >= 0) continue;
    place_[i] = static_cast<int>(unknown_.size());
    unknown_.push_back(i);
  }
}

void HarmonicBalance::set_harmonics(int harmonics, Index samples) {
  harmonics_ = harmonics;
  table_ = FourierTable(harmonics, samples);
  fine_ = FourierTable(2 * harmonics, samples);
}

MatrixXd HarmonicBalance::series(const VectorXd& q, double omega) const {
  const Index rows = q.size() / static_cast<Index>(unknown_.size());
  MatrixXd x(rows, d_.n);
  for (std::size_t i = 0; i < unknown_.size(); ++i) x.col(unknown_[i]) = q.segment(static_cast<Index>(i) * rows, rows);
  for (const auto& [y, v] : pairs_) x.col(v) = omega * phase_derivative(x.col(y));
  return x;
}

VectorXd HarmonicBalance::resized(const VectorXd& q, int harmonics) const {
  const Index count = static_cast<Index>(unknown_.size()), before = q.size() / count, after = 2 * harmonics + 1;
  VectorXd out = VectorXd::Zero(count * after);
  for (Index i = 0; i < count; ++i)
    out.segment(i * after, std::min(before, after)) = q.segment(i * before, std::min(before, after));
  return out;
}

/// The rates and their slopes along a series.
bool HarmonicBalance::sample(const MatrixXd& series, double omega) {
  return columns_.run(input_values(inputs_, d_.exogenous, omega, table_.phase()), table_.sample(series));
}

/// d(residual of `row`)/d(series of `state`); empty when it is zero.
MatrixXd HarmonicBalance::block(int row, int state, double omega, double driving) const {
  const VectorXd slope = columns_.slope(row, state);
  const bool constant = (slope.array() == slope[0]).all();
  if (constant && slope[0] == 0 && row != state) return {};
  const MatrixXd identity = MatrixXd::Identity(rows(), rows());
  MatrixXd m = constant ? MatrixXd(-slope[0] * identity) : MatrixXd(-product_matrix(slope, fine_, harmonics_));
  if (row != state) return m;
  m += omega * times_derivative(identity);
  if (speed_of_[row] >= 0) m -= driving * identity;
  return m;
}

/// The part of the slopes of one equation that comes through one state; `turned`: the phase derivatives of all series.
void HarmonicBalance::add_block(int row, int state, double omega, double driving, Slopes& slopes,
                                const MatrixXd& turned) const {
  const MatrixXd m = block(equation_[row], state, omega, driving);
  if (m.size() == 0) return;
  const Index size = rows(), first = row * size;
  if (speed_of_[state] < 0) {
    slopes.q.block(first, place_[state] * size, size, size) += m;
    return;
  }
  const int y = speed_of_[state];
  slopes.q.block(first, place_[y] * size, size, size) += omega * times_derivative(m);
  slopes.omega.segment(first, size) += m * turned.col(y);
}

bool HarmonicBalance::residual(const VectorXd& q, double omega, double driving, VectorXd& r, Slopes* slopes) {
  const MatrixXd x = series(q, omega);
  if (!x.allFinite() || !sample(x, omega)) return false;
  const MatrixXd turned = phase_derivative(x), f = table_.series(columns_.rate());
  const Index size = rows();
  r.resize(static_cast<Index>(equation_.size()) * size);
  for (std::size_t i = 0; i < equation_.size(); ++i) {
    const int state = equation_[i];
    auto part = r.segment(static_cast<Index>(i) * size, size);
    part = omega * turned.col(state) - f.col(state);
    if (speed_of_[state] >= 0) part -= driving * x.col(state);
  }
  if (!slopes) return true;
  slopes->q = MatrixXd::Zero(r.size(), r.size());
  slopes->omega = VectorXd::Zero(r.size());
  slopes->driving = VectorXd::Zero(r.size());
  for (int i = 0; i < static_cast<int>(equation_.size()); ++i) {
    const int state = equation_[i];
    slopes->omega.segment(i * size, size) += turned.col(state);
    if (speed_of_[state] >= 0) slopes->driving.segment(i * size, size) = -x.col(state);
    for (int j = 0; j < d_.n; ++j) add_block(i, j, omega, driving, *slopes, turned);
  }
  const bool moving = std::any_of(inputs_.begin(), inputs_.end(), [](const auto& h) { return h.derivative > 0; });
  if (moving) {  // the inputs themselves change with the frequency, as powers of it
    const double step = 1e-5 * omega;
    MatrixXd sides[2];
    for (const int side : {0, 1}) {
      const MatrixXd u = input_values(inputs_, d_.exogenous, omega + (side == 0 ? -step : step), table_.phase());
      if (!columns_.run(u, table_.sample(x))) return false;
      sides[side] = table_.series(columns_.rate());
    }
    for (std::size_t i = 0; i < equation_.size(); ++i)
      slopes->omega.segment(static_cast<Index>(i) * size, size) -=
          (sides[1].col(equation_[i]) - sides[0].col(equation_[i])) / (2 * step);
  }
  return true;
}

HarmonicBalance::Tail HarmonicBalance::tail(const VectorXd& q, double omega) {
  Tail tail;
  const MatrixXd x = series(q, omega);
  if (!x.allFinite() || !sample(x, omega)) return {INFINITY, INFINITY};
  const Index samples = table_.samples(), highest = samples / 2 - 1;
  Eigen::FFT<double> transform;
  Eigen::MatrixXcd f(samples, d_.n);
  for (int i = 0; i < d_.n; ++i) {
    const VectorXd rate = columns_.rate().col(i);
    Eigen::VectorXcd spectrum;
    transform.fwd(spectrum, rate);
    f.col(i) = spectrum * (2.0 / static_cast<double>(samples));
  }
  MatrixXd mean(d_.n, d_.n);
  for (int i = 0; i < d_.n; ++i)
    for (int j = 0; j < d_.n; ++j) mean(i, j) = columns_.slope(i, j).mean();
  VectorXd scale = x.bottomRows(x.rows() - 1).colwise().norm();
  double largest = 0;  // displacements share a scale
  for (const auto& [y, v] : pairs_) largest = std::max(largest, scale[y]);
  for (const auto& [y, v] : pairs_) scale[y] = largest;
  for (Index k = harmonics_ + 1; k <= highest; ++k) {
    Eigen::MatrixXcd a = -mean.cast<std::complex<double>>();
    a.diagonal().array() += std::complex<double>(0, static_cast<double>(k) * omega);
    const Eigen::VectorXcd answer = a.partialPivLu().solve(f.row(k).transpose());
    double worst = 0;
    for (const int state : unknown_)
      if (scale[state] > 0) worst = std::max(worst, std::abs(answer[state]) / scale[state]);
    if (2 * k <= highest)
      tail.left_out += worst;  // they may all peak at one moment
    else
      tail.aliased = std::max(tail.aliased, worst);
  }
  return tail;
}

VectorXd series_weights(const HarmonicBalance& balance, const VectorXd& q, VectorXd& largest) {
  const Index rows = balance.rows(), count = static_cast<Index>(balance.unknowns().size());
  VectorXd scale(count);
  for (Index i = 0; i < count; ++i) scale[i] = q.segment(i * rows, rows).norm();
  double common = 0;
  const auto is_displacement = [&](Index i) {
    for (const auto& [y, v] : balance.pairs())
      if (y == balance.unknowns()[static_cast<std::size_t>(i)]) return true;
    return false;
  };
  for (Index i = 0; i < count; ++i)
    if (is_displacement(i)) common = std::max(common, scale[i]);
  VectorXd weights(q.size());
  for (Index i = 0; i < count; ++i) {
    if (is_displacement(i)) scale[i] = common;
    largest[i] = std::max(largest[i], scale[i]);
    const double size = std::max(scale[i], least_scale * largest[i]);
    weights.segment(i * rows, rows).setConstant(size > 0 ? 1 / (size * std::sqrt(static_cast<double>(count))) : 1);
  }
  return weights;
}

}  // namespace lunid
