// Total-variation smoothing by its dual: least |D^T z|^2/2 - (D x).z with |z| <= weight, by a primal-dual interior
// point method whose steps are banded.
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "record/method_parts.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Differences of order k as a matrix of n - k rows.
Sparse difference_matrix(Index n, int k) {
  std::vector<double> binomial{1};
  for (int i = 0; i < k; ++i) {
    binomial.push_back(0);
    for (std::size_t j = binomial.size() - 1; j > 0; --j) binomial[j] = binomial[j - 1] - binomial[j];
    binomial[0] = -binomial[0];
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n - k; ++i)
    for (int j = 0; j <= k; ++j) entries.emplace_back(i, i + j, binomial[static_cast<std::size_t>(j)]);
  Sparse d(n - k, n);
  d.setFromTriplets(entries.begin(), entries.end());
  return d;
}

/// One problem: the iterates z (dual), p and q > 0 (multipliers of z <= weight and z >= -weight).
class InteriorPoint {
 public:
  InteriorPoint(const Eigen::Map<const VectorXd>& x, int k, double weight)
      : weight_(weight), d_(difference_matrix(x.size(), k)), square_(d_ * Sparse(d_.transpose())), target_(d_ * x) {
    const Index m = target_.size();
    z_ = VectorXd::Zero(m);
    p_ = q_ = VectorXd::Constant(m, std::max(1e-8, target_.cwiseAbs().mean()));
    factor_.analyzePattern(square_);
  }
  /// Until the duality gap is `tolerance` of the objective.
  int run(double tolerance) {
    constexpr int most_steps = 200;
    for (int step = 0; step < most_steps; ++step) {
      if (gap() <= tolerance) return step;
      if (!advance()) return step;
    }
    return most_steps;
  }
  VectorXd smooth(const Eigen::Map<const VectorXd>& x) const { return x - d_.transpose() * z_; }
  const VectorXd& dual() const { return z_; }
  const Sparse& difference() const { return d_; }

 private:
  /// Relative: primal less dual objective over the primal one.
  double gap() const {
    const double half = 0.5 * (d_.transpose() * z_).squaredNorm();
    const double primal = half + weight_ * (target_ - square_ * z_).lpNorm<1>(), dual = target_.dot(z_) - half;
    return (primal - dual) / std::max(primal, 1e-300);
  }
  bool advance() {
    const VectorXd up = (weight_ - z_.array()).matrix(), down = (weight_ + z_.array()).matrix();
    // A tenth of the mean complementarity is aimed at.
    const double mu = 0.1 * (p_.dot(up) + q_.dot(down)) / static_cast<double>(2 * z_.size());
    Sparse matrix = square_;
    matrix.diagonal() += p_.cwiseQuotient(up) + q_.cwiseQuotient(down);
    factor_.factorize(matrix);
    if (factor_.info() != Eigen::Success) return false;
    const VectorXd right = target_ - square_ * z_ - mu * (up.cwiseInverse() - down.cwiseInverse());
    const VectorXd dz = factor_.solve(right);
    const VectorXd dp = (mu + p_.array() * dz.array()).matrix().cwiseQuotient(up) - p_;
    const VectorXd dq = (mu - q_.array() * dz.array()).matrix().cwiseQuotient(down) - q_;
    double length = 1;
    for (Index i = 0; i < z_.size(); ++i) {
      if (dz[i] > 0) length = std::min(length, 0.99 * up[i] / dz[i]);
      if (dz[i] < 0) length = std::min(length, -0.99 * down[i] / dz[i]);
      if (dp[i] < 0) length = std::min(length, -0.99 * p_[i] / dp[i]);
      if (dq[i] < 0) length = std::min(length, -0.99 * q_[i] / dq[i]);
    }
    if (!(length > 1e-12)) return false;
    z_ += length * dz;
    p_ += length * dp;
    q_ += length * dq;
    return true;
  }

  double weight_;
  Sparse d_, square_;
  VectorXd target_, z_, p_, q_;
  Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
};

}  // namespace

Variation fit_variation(std::span<const double> x, int order, double weight) {
  const Eigen::Map<const VectorXd> values(x.data(), static_cast<Index>(x.size()));
  InteriorPoint problem(values, order + 1, weight);
  Variation result;
  result.steps = problem.run(1e-9);
  result.values = problem.smooth(values);
  result.dual = problem.dual();
  const VectorXd bends = problem.difference() * result.values;
  const double largest = bends.cwiseAbs().maxCoeff();
  for (Index i = 0; i < bends.size(); ++i)  // strict complementarity: one of the two is zero
    result.pieces += std::abs(bends[i]) / largest > (weight - std::abs(result.dual[i])) / weight;
  return result;
}

Derivative differentiate_by(const TotalVariation& method, std::span<const double> x, double dt, double noise,
                            int derivative) {
  if (method.order < 1 || method.order > 3)
    refuse("total_variation", "order: expected 1 to 3, got " + std::to_string(method.order));
  const double n = static_cast<double>(x.size());
  const Eigen::Map<const VectorXd> signal(x.data(), static_cast<Index>(x.size()));
  const double size = std::max(noise, 1e-9 * signal.cwiseAbs().maxCoeff());
  double weight = method.weight;
  if (!(weight > 0)) {
    const auto weight_of = [&](double h) { return size * std::pow(h, method.order + 0.5); };  // h: rows of a piece
    const double h = minimise_over_scale(0.5, n / 8, 2, [&](double scale) {
      const Variation fit = fit_variation(x, method.order, weight_of(scale));
      const double squares = (fit.values - signal).squaredNorm();
      return squares / n + 2 * size * size * (fit.pieces + method.order + 1) / n;  // Tibshirani & Taylor 2012
    });
    weight = weight_of(h);
  }
  const Variation fit = fit_variation(x, method.order, weight);
  const double scale = std::pow(dt, derivative);
  const VectorXd values = derivative ? differences({fit.values.data(), x.size()}, derivative, 4, 1) : fit.values;
  // As many free numbers leave as much noise as an ideal filter of so wide a band.
  const double band = std::numbers::pi * std::min(1.0, (fit.pieces + method.order + 1) / n);
  const double gain = std::pow(band, derivative) * std::sqrt(band / (std::numbers::pi * (2 * derivative + 1)));
  return {values / scale, noise * gain / scale,
          "total variation of order " + std::to_string(method.order) + ", weight " + short_number(weight) + ", " +
              std::to_string(fit.pieces + 1) + " pieces"};
}

}  // namespace lunid
