// Block bootstrap on the blocks' statistics.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "regress/quadratic.hpp"
#include "regress/reduce.hpp"
#include "regress/solvers.hpp"

namespace lunid {
namespace {

using detail::Problem;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The blocks' Gram matrices in coordinates in which their sum is 1: adding them up costs no digits that matter, and a
/// replicate is a weighted sum of small matrices.
class Replicates {
 public:
  Replicates(std::span<const Statistic> blocks, const Statistic& data, const Problem& problem)
      : problem_(problem), f_(problem.r.cols()), factor_(f_ + 1, f_ + 1) {
    const Index n = data.features();
    LongMatrix whole = problem.exact;
    const long double rest = data.factor()(n, n), floor = 1e-9L * whole.col(f_).norm();
    whole(f_, f_) = std::max(std::hypot(whole(f_, f_), rest), floor > 0 ? floor : 1);
    factor_ = whole.cast<double>();
    for (const Statistic& block : blocks) {
      const LongMatrix r = block.factor();
      LongMatrix columns(n + 1, f_ + 1);
      for (Index k = 0; k < f_; ++k)
        columns.col(k) = r.col(problem.columns[static_cast<std::size_t>(k)]) / problem.size[k];
      columns.col(f_) = r.col(n) - r.leftCols(n) * problem.held.cast<long double>();
      const MatrixXd turned =
          whole.transpose().triangularView<Eigen::Lower>().solve(columns.transpose()).transpose().cast<double>();
      gram_.push_back(turned.transpose() * turned);
    }
  }

  /// Coefficients where block b counts count[b] times; false where the features are not all excited.
  bool solve(const std::vector<int>& count, VectorXd& u) const {
    MatrixXd sum = MatrixXd::Zero(f_ + 1, f_ + 1);
    for (std::size_t b = 0; b < gram_.size(); ++b)
      if (count[b] > 0) sum += count[b] * gram_[b];
    const Eigen::LLT<MatrixXd> root(sum.topLeftCorner(f_, f_));
    if (root.info() != Eigen::Success || root.matrixLLT().diagonal().cwiseAbs().minCoeff() < 1e-7) return false;
    // [sum's root] * factor is the triangle of the replicate's [features, target].
    const MatrixXd square = MatrixXd(root.matrixU()) * factor_.topLeftCorner(f_, f_);
    const VectorXd cross =
        sum.topLeftCorner(f_, f_) * factor_.col(f_).head(f_) + sum.col(f_).head(f_) * factor_(f_, f_);
    const VectorXd z = root.matrixL().solve(cross);
    if (problem_.c.rows() == 0) {
      u = square.triangularView<Eigen::Upper>().solve(z);
      return true;
    }
    QuadraticSolution s = solve_quadratic(square, z, problem_.c, problem_.d, problem_.equalities);
    u = std::move(s.x);
    return s.blocked < 0;
  }

 private:
  const Problem& problem_;
  Index f_;
  MatrixXd factor_;
  std::vector<MatrixXd> gram_;
};

/// The value below which a part p of the sorted values lies, between neighbours by proportion.
double quantile(const std::vector<double>& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const std::size_t i = static_cast<std::size_t>(place), next = std::min(i + 1, sorted.size() - 1);
  return sorted[i] + (place - static_cast<double>(i)) * (sorted[next] - sorted[i]);
}

}  // namespace

Bootstrap bootstrap(std::span<const Statistic> blocks, std::span<const Constraint> constraints, const Fit& fit,
                    int replicates, std::uint64_t seed) {
  if (replicates < 20) throw InputError("bootstrap: expected 20 replicates or more, got " + std::to_string(replicates));
  if (blocks.size() < 3)
    throw InputError("bootstrap: expected at least 3 blocks of time, got " + std::to_string(blocks.size()));
  const Index n = fit.coefficients.size();
  std::vector<bool> zero(static_cast<std::size_t>(n));
  for (Index j = 0; j < n; ++j) zero[static_cast<std::size_t>(j)] = fit.coefficients[j] == 0;
  const Statistic data = merged(blocks);
  const Problem problem = detail::reduce(data, constraints, detail::admissible(zero, data, constraints));
  const Replicates draws(blocks, data, problem);
  std::mt19937_64 random(seed);
  std::vector<std::vector<double>> values(static_cast<std::size_t>(n));
  VectorXd u;
  for (int i = 0; i < replicates; ++i) {
    std::vector<int> count(blocks.size(), 0);
    for (std::size_t b = 0; b < blocks.size(); ++b) ++count[random() % blocks.size()];
    if (!draws.solve(count, u)) continue;
    const VectorXd b = expand(problem, u);
    for (Index j = 0; j < n; ++j) values[static_cast<std::size_t>(j)].push_back(b[j]);
  }
  Bootstrap out{VectorXd::Constant(n, std::nan("")), {}, {}, static_cast<int>(values[0].size())};
  out.lower = out.upper = out.std;
  if (out.replicates < 0.95 * replicates) return out;
  for (Index j = 0; j < n; ++j) {
    std::vector<double>& v = values[static_cast<std::size_t>(j)];
    std::sort(v.begin(), v.end());
    const Eigen::Map<const VectorXd> all(v.data(), static_cast<Index>(v.size()));
    out.std[j] = std::sqrt((all.array() - all.mean()).square().sum() / static_cast<double>(v.size() - 1));
    out.lower[j] = quantile(v, 0.025);
    out.upper[j] = quantile(v, 0.975);
  }
  return out;
}

}  // namespace lunid
