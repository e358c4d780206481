#include "regress/implicit.hpp"

#include <algorithm>
#include <cmath>

#include "regress/minimise.hpp"
#include "regress/reduce.hpp"

namespace lunid::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Residual sum of squares of the inner regression as a function of the implicit parameters, scaled to 0..1.
class Projection {
 public:
  Projection(const ImplicitProblem& problem, const std::vector<ImplicitParameter>& implicit)
      : problem_(problem),
        implicit_(implicit),
        features_(static_cast<int>(problem.features.size())),
        columns_(extended(problem, implicit), problem.target) {}

  /// Passes over all rows.
  int evaluations() const { return static_cast<int>(std::ceil(passes_)); }
  int blocks() const { return static_cast<int>(problem_.blocks.size()); }

  std::vector<double> unscaled(const double* x) const {
    std::vector<double> p;
    for (std::size_t i = 0; i < implicit_.size(); ++i)
      p.push_back(implicit_[i].min + std::clamp(x[i], 0.0, 1.0) * (implicit_[i].max - implicit_[i].min));
    return p;
  }

  /// Half the mean square of the residual, and its gradient by the envelope theorem: the coefficients are optimal, so
  /// that only the features' own change counts.
  double value(const double* x, double* gradient) { return value(columns_at(unscaled(x)), gradient); }

  /// The same of one block of time alone.
  double part(const double* x, double* gradient, int block) {
    return value(columns_at(unscaled(x), problem_.blocks.subspan(static_cast<std::size_t>(block), 1)), gradient);
  }

  /// Standard deviations of the implicit parameters, joint with the coefficients that are not zero.
  std::vector<double> deviations(const double* x) {
    const Statistic data = columns_at(unscaled(x));
    const Fit fit = inner(data);
    const LongMatrix factor = data.factor();
    const LongVector b = fit.coefficients.cast<long double>();
    std::vector<Index> used;
    for (Index j = 0; j < features_; ++j)
      if (fit.std[j] > 0) used.push_back(j);
    const Index linear = static_cast<Index>(used.size()), k = linear + static_cast<Index>(implicit_.size());
    LongMatrix block(factor.rows(), k), r = LongMatrix::Zero(k, k);
    for (Index j = 0; j < linear; ++j) block.col(j) = factor.col(used[static_cast<std::size_t>(j)]);
    for (Index i = linear; i < k; ++i) block.col(i) = direction(factor, b, static_cast<std::size_t>(i - linear));
    triangularise(r, std::move(block));
    const LongMatrix root = r.triangularView<Eigen::Upper>().solve(LongMatrix::Identity(k, k));
    const double freedom = static_cast<double>(data.rows() - k);
    const double variance = fit.rmse * fit.rmse * static_cast<double>(data.rows()) / freedom;
    std::vector<double> out;
    for (Index i = linear; i < k; ++i) out.push_back(std::sqrt(variance) * static_cast<double>(root.row(i).norm()));
    return out;
  }

 private:
  double value(const Statistic& data, double* gradient) const {
    const LongMatrix factor = data.factor();
    const LongVector b = inner(data).coefficients.cast<long double>();
    const LongVector residual = factor.rightCols(1) - factor.leftCols(features_) * b;
    const double rows = static_cast<double>(data.rows());
    if (gradient)
      for (std::size_t i = 0; i < implicit_.size(); ++i)
        gradient[i] =
            -static_cast<double>(residual.dot(direction(factor, b, i))) / rows * (implicit_[i].max - implicit_[i].min);
    return static_cast<double>(residual.squaredNorm()) / (2 * rows);
  }

  /// Features, then for each implicit parameter the derivatives of the features that depend on it.
  std::vector<Expr> extended(const ImplicitProblem& problem, const std::vector<ImplicitParameter>& implicit) {
    std::vector<Expr> out = problem.features;
    for (const ImplicitParameter& p : implicit) {
      const Expr symbol = problem.target.pool().find(p.name);
      slopes_.emplace_back();
      for (int j = 0; j < features_; ++j) {
        const Expr feature = problem.features[static_cast<std::size_t>(j)];
        if (!symbol.valid() || !depends_on(feature, symbol)) continue;
        const Expr slope = derivative(feature, symbol);
        const auto known = std::find(out.begin(), out.end(), slope);
        slopes_.back().emplace_back(j, known - out.begin());
        if (known == out.end()) out.push_back(slope);
      }
      if (slopes_.back().empty()) throw InputError("implicit parameter '" + p.name + "' is in no feature");
    }
    return out;
  }

  Statistic columns_at(const std::vector<double>& p) { return columns_at(p, problem_.blocks); }

  Statistic columns_at(const std::vector<double>& p, std::span<const TimeBlock> blocks) {
    passes_ += static_cast<double>(blocks.size()) / static_cast<double>(problem_.blocks.size());
    std::vector<double> values;
    for (const std::string& name : columns_.parameters()) {
      const auto own = std::find_if(implicit_.begin(), implicit_.end(), [&](const auto& i) { return i.name == name; });
      values.push_back(own != implicit_.end() ? p[static_cast<std::size_t>(own - implicit_.begin())]
                                              : problem_.values->at(name));
    }
    std::vector<Statistic> parts = statistics(columns_, problem_.records, blocks, values, problem_.threads);
    for (Statistic& part : parts) part.weigh_mean(problem_.mean_force);
    return merged(parts);
  }

  /// The inner regression. A feature may vanish at a bound (tanh(p*y) at p = 0); it is then left out.
  Fit inner(const Statistic& extended) const {
    const Statistic data = extended.leading(features_);
    const VectorXd rms = data.rms();
    std::vector<bool> zero(problem_.features.size());
    for (std::size_t j = 0; j < zero.size(); ++j) zero[j] = rms[static_cast<Index>(j)] == 0;
    const Problem linear = reduce(data, problem_.constraints, zero);
    return report(linear, solve(linear, data, problem_.constraints), data, problem_.constraints);
  }

  /// Sum over features of coefficient * d feature / d p, in the coordinates of the factor.
  LongVector direction(const LongMatrix& factor, const LongVector& b, std::size_t i) const {
    LongVector sum = LongVector::Zero(factor.rows());
    for (const auto& [feature, column] : slopes_[i]) sum += b[feature] * factor.col(column);
    return sum;
  }

  const ImplicitProblem& problem_;
  const std::vector<ImplicitParameter>& implicit_;
  int features_;
  std::vector<std::vector<std::pair<int, Index>>> slopes_;  // for each parameter: feature, column of its derivative
  Columns columns_;
  double passes_ = 0;
};

}  // namespace

std::vector<ImplicitParameter> search(const ImplicitProblem& problem, std::vector<ImplicitParameter> implicit,
                                      int& evaluations) {
  Projection projection(problem, implicit);
  Objective objective;
  objective.size = static_cast<int>(implicit.size());
  objective.value = [&](const double* x, double* gradient) { return projection.value(x, gradient); };
  objective.blocks = projection.blocks();
  objective.part = [&](const double* x, double* gradient, int block) { return projection.part(x, gradient, block); };
  std::vector<double> start;
  for (const ImplicitParameter& p : implicit) start.push_back((p.value - p.min) / (p.max - p.min));
  const Minimum best = minimise(objective, start, problem.search);
  const std::vector<double> values = projection.unscaled(best.x.data()), std = projection.deviations(best.x.data());
  for (std::size_t i = 0; i < implicit.size(); ++i) {
    implicit[i].value = values[i];
    implicit[i].std = std[i];
  }
  evaluations = projection.evaluations();
  return implicit;
}

}  // namespace lunid::detail
