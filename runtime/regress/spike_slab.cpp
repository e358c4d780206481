// Spike-and-slab selection: posterior probabilities of models from their residual sums of squares.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "expr/digits.hpp"
#include "regress/solvers.hpp"
#include "regress/stopwatch.hpp"
#include "regress/subset.hpp"

namespace lunid {

using detail::Subsets;
using Eigen::VectorXd;

void validate(const SpikeSlabOptions& options) {
  const auto part = [](const char* field, double value) {
    if (!(value > 0 && value < 1))
      throw InputError("spike_slab: " + std::string(field) + ": expected > 0 and < 1, got " + exact_number(value));
  };
  part("prior", options.prior);
  part("cut", options.cut);
  if (options.sweeps < 1) throw InputError("spike_slab: sweeps: expected >= 1, got " + std::to_string(options.sweeps));
}

namespace {

constexpr int kSummed = 15;  // features up to which all models are summed

/// Posterior of the models of some candidates.
class Posterior {
 public:
  Posterior(const Subsets& subsets, const SpikeSlabOptions& options) : subsets_(subsets), options_(options) {}

  /// Log of the posterior probability of a model, up to a constant.
  double log_weight(const std::vector<bool>& in) {
    const auto known = known_.find(in);
    if (known != known_.end()) return known->second;
    std::vector<int> list;
    for (int k = 0; k < subsets_.count(); ++k)
      if (in[static_cast<std::size_t>(k)]) list.push_back(k);
    const double g = subsets_.rows(), terms = static_cast<double>(list.size());
    const double left = subsets_.target() - g / (1 + g) * (subsets_.target() - subsets_.unconstrained(list));
    const double weight = -0.5 * terms * std::log1p(g) - 0.5 * subsets_.rows() * std::log(left / subsets_.target()) +
                          terms * std::log(options_.prior / (1 - options_.prior));
    return known_[in] = weight;
  }

  VectorXd summed() {
    const int n = subsets_.count();
    std::vector<double> weight(std::size_t{1} << n);
    for (std::size_t mask = 0; mask < weight.size(); ++mask) {
      std::vector<bool> in(static_cast<std::size_t>(n));
      for (int k = 0; k < n; ++k) in[static_cast<std::size_t>(k)] = mask >> k & 1;
      weight[mask] = log_weight(in);
    }
    const double most = *std::max_element(weight.begin(), weight.end());
    VectorXd inclusion = VectorXd::Zero(n);
    double all = 0;
    for (std::size_t mask = 0; mask < weight.size(); ++mask) {
      const double p = std::exp(weight[mask] - most);
      all += p;
      for (int k = 0; k < n; ++k)
        if (mask >> k & 1) inclusion[k] += p;
    }
    return inclusion / all;
  }

  /// Gibbs sampling, one feature after another; the conditional probabilities are averaged, not the draws.
  VectorXd sampled() {
    const int n = subsets_.count();
    std::mt19937_64 random(options_.seed);
    std::vector<bool> in(static_cast<std::size_t>(n), false);
    VectorXd inclusion = VectorXd::Zero(n);
    const int before = options_.sweeps / 10 + 1;
    for (int sweep = -before; sweep < options_.sweeps; ++sweep)
      for (int k = 0; k < n; ++k) {
        const std::size_t i = static_cast<std::size_t>(k);
        in[i] = true;
        const double with = log_weight(in);
        in[i] = false;
        const double p = 1 / (1 + std::exp(log_weight(in) - with));
        // 53 bits by hand: the standard's distributions differ between libraries
        in[i] = static_cast<double>(random() >> 11) * 0x1p-53 < p;
        if (sweep >= 0) inclusion[k] += p;
      }
    return inclusion / options_.sweeps;
  }

 private:
  const Subsets& subsets_;
  SpikeSlabOptions options_;
  std::map<std::vector<bool>, double> known_;
};

}  // namespace

Fit spike_slab(const Statistic& data, const SpikeSlabOptions& options, std::span<const Constraint> constraints) {
  const detail::Stopwatch watch;
  validate(options);
  detail::only_fixed("spike_slab", data, constraints);
  const Subsets subsets(data, constraints);
  Posterior posterior(subsets, options);
  const bool all = subsets.count() <= kSummed;
  const VectorXd inclusion =
      subsets.target() > 0 ? (all ? posterior.summed() : posterior.sampled()) : VectorXd::Zero(subsets.count());
  std::vector<int> in;
  for (int k = 0; k < subsets.count(); ++k)
    if (inclusion[k] >= options.cut) in.push_back(k);
  Fit fit = subsets.fit(in);
  fit.inclusion = VectorXd::Zero(data.features());
  for (int j = 0; j < data.features(); ++j) fit.inclusion[j] = fit.coefficients[j] != 0 ? 1 : 0;  // fixed ones
  for (int k = 0; k < subsets.count(); ++k)
    fit.inclusion[subsets.columns()[static_cast<std::size_t>(k)]] = inclusion[k];
  fit.summary.solver = "spike and slab, features of inclusion probability >= " + number(options.cut, 3);
  fit.summary.stopped = all ? "all models summed" : "sweeps done";
  fit.summary.iterations = all ? 1 << subsets.count() : options.sweeps;
  fit.summary.seconds = watch.seconds();
  return fit;
}

}  // namespace lunid
