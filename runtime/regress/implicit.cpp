#include "regress/implicit.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>

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

  int evaluations() const { return evaluations_; }

  std::vector<double> unscaled(const double* x) const {
    std::vector<double> p;
    for (std::size_t i = 0; i < implicit_.size(); ++i)
      p.push_back(implicit_[i].min + std::clamp(x[i], 0.0, 1.0) * (implicit_[i].max - implicit_[i].min));
    return p;
  }

  /// Half the mean square of the residual, and its gradient by the envelope theorem: the coefficients are optimal, so
  /// that only the features' own change counts.
  double value(const double* x, double* gradient) {
    const Statistic data = columns_at(unscaled(x));
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

  Statistic columns_at(const std::vector<double>& p) {
    ++evaluations_;
    std::vector<double> values;
    for (const std::string& name : columns_.parameters()) {
      const auto own = std::find_if(implicit_.begin(), implicit_.end(), [&](const auto& i) { return i.name == name; });
      values.push_back(own != implicit_.end() ? p[static_cast<std::size_t>(own - implicit_.begin())]
                                              : problem_.values->at(name));
    }
    return merged(statistics(columns_, problem_.records, problem_.blocks, values, problem_.threads));
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
  int evaluations_ = 0;
};

/// What crosses NLopt's frame: an exception is kept and thrown after it.
struct Call {
  Projection* projection;
  nlopt_opt optimiser;
  double scale = 1;
  std::exception_ptr fault;
};

double call_value(unsigned n, const double* x, double* gradient, void* data) {
  Call& call = *static_cast<Call*>(data);
  try {
    const double value = call.projection->value(x, gradient) / call.scale;
    if (gradient)
      for (unsigned i = 0; i < n; ++i) gradient[i] /= call.scale;
    return value;
  } catch (...) {
    call.fault = std::current_exception();
    nlopt_force_stop(call.optimiser);
    return HUGE_VAL;
  }
}

/// One local search from x; the value reached.
double descend(Projection& projection, std::vector<double>& x) {
  const unsigned n = static_cast<unsigned>(x.size());
  const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, void (*)(nlopt_opt)> optimiser(
      nlopt_create(NLOPT_LD_SLSQP, n), nlopt_destroy);
  const double first = projection.value(x.data(), nullptr);
  Call call{&projection, optimiser.get(), first > 0 ? first : 1, nullptr};
  nlopt_set_lower_bounds1(optimiser.get(), 0);
  nlopt_set_upper_bounds1(optimiser.get(), 1);
  nlopt_set_min_objective(optimiser.get(), call_value, &call);
  nlopt_set_xtol_rel(optimiser.get(), 1e-8);
  nlopt_set_ftol_rel(optimiser.get(), 1e-14);
  nlopt_set_maxeval(optimiser.get(), 200);
  double value = first / call.scale;
  // A code below 0 other than a fault of ours is the line search at its limit of rounding: x holds the best point.
  nlopt_optimize(optimiser.get(), x.data(), &value);
  if (call.fault) std::rethrow_exception(call.fault);
  return value * call.scale;
}

/// The k-th point of the van der Corput sequence in a prime base: starts spread evenly without a random number.
double spread(int k, int base) {
  double value = 0, part = 1;
  for (; k > 0; k /= base) value += (part /= base) * (k % base);
  return value;
}

}  // namespace

std::vector<ImplicitParameter> search(const ImplicitProblem& problem, std::vector<ImplicitParameter> implicit,
                                      int& evaluations) {
  constexpr int primes[] = {2, 3, 5, 7, 11, 13, 17, 19};
  Projection projection(problem, implicit);
  std::vector<double> best;
  double least = HUGE_VAL;
  for (int start = 0; start < problem.starts; ++start) {
    std::vector<double> x(implicit.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = start == 0 ? (implicit[i].value - implicit[i].min) / (implicit[i].max - implicit[i].min)
                        : spread(start, primes[i % std::size(primes)]);
    const double value = descend(projection, x);
    if (value < least) {
      least = value;
      best = x;
    }
  }
  const std::vector<double> values = projection.unscaled(best.data()), std = projection.deviations(best.data());
  for (std::size_t i = 0; i < implicit.size(); ++i) {
    implicit[i].value = values[i];
    implicit[i].std = std[i];
  }
  evaluations = projection.evaluations();
  return implicit;
}

}  // namespace lunid::detail
