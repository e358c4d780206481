#include "regress/robust.hpp"

#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "record/parallel.hpp"
#include "regress/reduce.hpp"
#include "regress/stopwatch.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void validate(const HuberOptions& options) {
  if (!(options.threshold > 0) || std::isinf(options.threshold))
    throw InputError("huber: threshold: expected > 0, got " + exact_number(options.threshold));
  if (!(options.outlier > options.threshold))
    throw InputError("huber: outlier: expected > threshold, which is " + exact_number(options.threshold) + ", got " +
                     exact_number(options.outlier));
  if (options.max_passes < 1)
    throw InputError("huber: max_passes: expected >= 1, got " + std::to_string(options.max_passes));
}

namespace detail {
namespace {

constexpr std::size_t kReported = 20;

/// E psi^2 at the standard normal.
double normal_square(double c) {
  const double inside = std::erf(c / std::sqrt(2.0)), density = std::exp(-c * c / 2) / std::sqrt(2 * M_PI);
  return inside - 2 * c * density + c * c * (1 - inside);
}

/// What one pass over a block finds, all in units of the scale.
struct Part {
  Statistic weighted;
  double square = 0;  // sum of psi^2
  Index inside = 0;   // rows below the threshold
  Outliers outliers;
};

void keep_largest(std::vector<Outlier>& list) {
  std::stable_sort(list.begin(), list.end(),
                   [](const Outlier& a, const Outlier& b) { return std::abs(a.size) > std::abs(b.size); });
  if (list.size() > kReported) list.resize(kReported);
}

Part weigh(const Pass& pass, std::size_t block, const VectorXd& b, double scale, const HuberOptions& options) {
  const TimeBlock& at = pass.blocks[block];
  const Stream& record = pass.records[at.record];
  Part part;
  const auto visit = [&](Index first, MatrixXd& work) {
    const VectorXd residual = (work.col(work.cols() - 1) - work.middleCols(1, b.size()) * b) / scale;
    for (Index i = 0; i < residual.size(); ++i) {
      const double size = std::abs(residual[i]), psi = std::min(size, options.threshold);
      part.square += psi * psi;
      part.inside += size <= options.threshold;
      if (size > options.threshold) work.row(i) *= std::sqrt(options.threshold / size);
      if (size <= options.outlier) continue;
      ++part.outliers.count;
      part.outliers.largest.push_back({at.record, first + i, record.time(first + i), residual[i]});
      if (part.outliers.largest.size() > 100 * kReported) keep_largest(part.outliers.largest);
    }
  };
  part.weighted = pass.columns.statistic(record, at.first, at.count, pass.values, visit);
  return part;
}

/// One pass over the data.
struct Sums {
  double square = 0;
  Index inside = 0;
};
Sums weigh_all(const Pass& pass, const VectorXd& b, double scale, const HuberOptions& options,
               std::vector<Statistic>& weighted, Outliers& outliers) {
  std::vector<Part> parts(pass.blocks.size());
  parallel_for(static_cast<int>(parts.size()), pass.columns.thread_safe() ? pass.threads : 1, [&](int block) {
    const auto i = static_cast<std::size_t>(block);
    parts[i] = weigh(pass, i, b, scale, options);
  });
  Sums sums;
  weighted.clear();
  outliers = {};
  for (Part& part : parts) {
    sums.square += part.square;
    sums.inside += part.inside;
    outliers.count += part.outliers.count;
    outliers.largest.insert(outliers.largest.end(), part.outliers.largest.begin(), part.outliers.largest.end());
    weighted.push_back(std::move(part.weighted));
  }
  keep_largest(outliers.largest);
  return sums;
}

}  // namespace

Fit huber(const Pass& pass, std::span<const Statistic> plain, const HuberOptions& options,
          std::span<const Constraint> constraints, std::vector<Statistic>& weighted, Outliers& outliers) {
  const Stopwatch watch;
  validate(options);
  const Statistic data = merged(plain);
  const Fit first = least_squares(data, constraints);
  Fit fit = first;
  const double rows = static_cast<double>(data.rows()), left = rows - fit.free;
  double scale = fit.residual_std;
  weighted.assign(plain.begin(), plain.end());
  if (!(left > 0) || !(scale > 1e-14 * data.rms()[data.features()])) {
    fit.summary.solver = "huber";
    fit.summary.stopped = "an exact equation, as least squares";
    return fit;
  }
  const double share = normal_square(options.threshold);
  Sums sums;
  int passes = 0;
  bool converged = false;
  while (!converged && passes < options.max_passes) {
    const VectorXd before = fit.coefficients;
    sums = weigh_all(pass, before, scale, options, weighted, outliers);
    fit = fit_selected(merged(weighted), constraints, {});
    const double next = scale * std::sqrt(sums.square / (left * share));
    const VectorXd moved = (fit.coefficients - before).cwiseAbs();
    converged = std::abs(next / scale - 1) < 1e-7;
    for (Index j = 0; j < moved.size(); ++j) converged = converged && !(moved[j] > 1e-6 * first.std[j]);
    scale = next;
    ++passes;
  }
  const double inside = static_cast<double>(sums.inside) / rows;
  const double correction = 1 + fit.free / rows * (1 - inside) / inside;
  const double deviation = correction * scale * std::sqrt(sums.square / left) / inside;
  const Fit weighted_fit = fit;
  fit = first;  // conditions, inflation and covariance of the plain rows
  fit.coefficients = weighted_fit.coefficients;
  fit.active = weighted_fit.active;
  fit.free = weighted_fit.free;
  const double ratio = deviation / first.residual_std;
  fit.covariance *= ratio * ratio;
  fit.std *= ratio;
  rescore(fit, data);
  fit.residual_std = scale;
  fit.summary = weighted_fit.summary;
  fit.summary.solver = "huber, threshold = " + number(options.threshold, 4) +
                       " (weighs the rows anew: " + std::to_string(passes + 1) + " passes over the data)";
  fit.summary.iterations = passes;
  fit.summary.converged = fit.summary.converged && converged;
  fit.summary.stopped = converged ? "coefficients and scale move no more" : "max_passes reached";
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace detail
}  // namespace lunid
