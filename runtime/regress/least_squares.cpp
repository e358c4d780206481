// Least squares, ridge and sequentially thresholded least squares.
#include <cmath>
#include <utility>

#include "expr/digits.hpp"
#include "regress/fit.hpp"
#include "regress/reduce.hpp"
#include "regress/stopwatch.hpp"

namespace lunid {

using detail::Problem;
using detail::Stopwatch;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// One pass: least squares (lambda = 0) or ridge on the features that are not zeroed.
Fit pass(const Statistic& data, double lambda, std::span<const Constraint> constraints,
         const std::vector<bool>& zero = {}) {
  Problem problem = detail::reduce(data, constraints, zero);
  if (lambda == 0) return report(problem, solve(problem, data, constraints), data, constraints);
  const Eigen::MatrixXd unpenalised = problem.r;
  const VectorXd size = detail::penalty_sizes(data);
  VectorXd weight(problem.r.cols());
  for (Index k = 0; k < weight.size(); ++k) {
    // |r u - z|^2 + rows * lambda * sum (size_j b_j)^2 with b_j = u_j / length_j
    const double ratio = size[problem.columns[static_cast<std::size_t>(k)]] / problem.size[k];
    weight[k] = static_cast<double>(data.rows()) * lambda * ratio * ratio;
  }
  penalise(problem, weight);
  return report(problem, solve(problem, data, constraints), data, constraints, &unpenalised);
}

}  // namespace

Fit least_squares(const Statistic& data, std::span<const Constraint> constraints) {
  const Stopwatch watch;
  Fit fit = pass(data, 0, constraints);
  fit.summary.solver = "least squares";
  fit.summary.seconds = watch.seconds();
  return fit;
}

void validate(const RidgeOptions& options) {
  if (!(options.lambda > 0) || std::isinf(options.lambda))
    throw InputError("ridge: lambda: expected > 0, got " + exact_number(options.lambda));
}

Fit ridge(const Statistic& data, const RidgeOptions& options, std::span<const Constraint> constraints) {
  const Stopwatch watch;
  validate(options);
  Fit fit = pass(data, options.lambda, constraints);
  fit.summary.solver = "ridge, lambda = " + number(options.lambda, 4);
  fit.summary.seconds = watch.seconds();
  return fit;
}

void validate(const StlsqOptions& options) {
  if (!(options.threshold > 0 && options.threshold < 1))
    throw InputError("stlsq: threshold: expected > 0 and < 1 (part of the target's rms), got " +
                     exact_number(options.threshold));
  if (!(options.ridge >= 0) || std::isinf(options.ridge))
    throw InputError("stlsq: ridge: expected >= 0, got " + exact_number(options.ridge));
  if (options.max_passes < 1)
    throw InputError("stlsq: max_passes: expected >= 1, got " + std::to_string(options.max_passes));
}

Fit stlsq(const Statistic& data, const StlsqOptions& options, std::span<const Constraint> constraints) {
  const Stopwatch watch;
  validate(options);
  std::vector<bool> zero(static_cast<std::size_t>(data.features()), false);
  std::vector<bool> kept = zero;  // what the constraints need
  Fit fit = pass(data, options.ridge, constraints);
  const std::vector<Unexcited> unexcited = fit.unexcited;
  int passes = 1;
  bool changed = true;
  while (changed && passes < options.max_passes) {
    std::vector<bool> smaller = zero;
    for (std::size_t j = 0; j < zero.size(); ++j)
      if (!kept[j] && fit.contribution[static_cast<Index>(j)] < options.threshold) smaller[j] = true;
    const std::vector<bool> wanted = smaller;
    smaller = detail::admissible(std::move(smaller), data, constraints);
    for (std::size_t j = 0; j < zero.size(); ++j) kept[j] = kept[j] || (wanted[j] && !smaller[j]);
    changed = smaller != zero;
    if (!changed) break;
    zero = std::move(smaller);
    fit = pass(data, options.ridge, constraints, zero);
    ++passes;
  }
  fit.unexcited = unexcited;  // of the whole library: later passes see only what is left
  fit.summary.solver = "stlsq, threshold = " + number(options.threshold, 4);
  fit.summary.iterations = passes;
  fit.summary.converged = fit.summary.converged && !changed;
  fit.summary.stopped = changed ? "max_passes reached" : "no coefficient below the threshold";
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace lunid
