// The fit where parameters are many: L-BFGS on the gradient by the adjoint.
#include <nlopt.h>

#include <exception>
#include <memory>
#include <type_traits>

#include "simulate/fit_problem.hpp"
#include "simulate/gradient.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Evaluations that count as an iteration of Levenberg-Marquardt, and the part of its tolerance at which the slower
/// descent of L-BFGS has come as far.
constexpr int evaluations_per_iteration = 25;
constexpr double finer = 1e-4;

/// The cost over theta and the first states of all segments, in units of what each may change by.
class AdjointCost {
 public:
  AdjointCost(const System& system, const std::vector<FitData>& data, const FitOptions& options,
              std::vector<FitSegment> segments, int substeps, double clip)
      : segments(std::move(segments)),
        layout(system.parameters(), static_cast<int>(data.size()), options.separate),
        system_(system),
        data_(data),
        adjoint_(system),
        clip_(clip) {
    run_options_.solver = Solver::fixed;
    run_options_.substeps = substeps;
    run_options_.cancelled = options.cancelled;
    for (const FitData& d : data) {
      outputs_.push_back(outputs_of(system.model(), d.record, options.channels));
      for (Output& output : outputs_.back()) output.weight *= d.weight;
    }
    for (const FitSegment& s : this->segments)
      excitations_.push_back(data[static_cast<std::size_t>(s.record)].excitation.part(s.first, s.count));
  }

  /// The cost at theta and the segments' first states; its gradient by theta, then by each first state.
  double at(const VectorXd& theta, VectorXd& gradient) {
    gradient.setZero(layout.size() + static_cast<Index>(segments.size()) * system_.states());
    outliers = rows = 0;
    double cost = 0;
    for (std::size_t s = 0; s < segments.size(); ++s) {
      const VectorXd own = layout.of_record(theta, segments[s].record);
      const GradientRun run = adjoint_.run(
          {own.data(), static_cast<std::size_t>(own.size())}, excitations_[s], segments[s].x0, run_options_,
          [&](const Run& r, Eigen::MatrixXd& slope) { return residual(segments[s], r, slope); });
      ++runs;
      if (!run.run.summary.completed || !run.gradient.allFinite()) {
        cause = run.run.summary.cause;
        return std::numeric_limits<double>::infinity();
      }
      cost += run.value;
      for (Index i = 0; i < own.size(); ++i)
        gradient[layout.place(segments[s].record, static_cast<int>(i))] += run.gradient[i];
      Eigen::MatrixXd by_state = run.gradient.tail(system_.states()).transpose();
      hold_anchored(system_.model(), segments[s], by_state);
      gradient.segment(first_state(s), system_.states()) = by_state.transpose();
    }
    return cost;
  }

  Index first_state(std::size_t segment) const {
    return layout.size() + static_cast<Index>(segment) * system_.states();
  }

  /// Largest value of each state over the rows from a first state on: what the first state is measured by.
  VectorXd scales(const VectorXd& theta, std::size_t segment) const {
    const VectorXd own = layout.of_record(theta, segments[segment].record);
    const Run run = simulate(system_, {own.data(), static_cast<std::size_t>(own.size())}, excitations_[segment],
                             segments[segment].x0, run_options_);
    VectorXd largest = VectorXd::Constant(system_.states(), 1e-12);
    for (Index row = 0; row < run.x.rows() && run.x.row(row).allFinite(); ++row)
      largest = largest.cwiseMax(run.x.row(row).transpose().cwiseAbs());
    return largest;
  }

  std::vector<FitSegment> segments;
  const FitLayout layout;
  long runs = 0;
  Index outliers = 0, rows = 0;
  std::string cause;

 private:
  /// Squared (beyond the clip: Huber's) residuals of a run and their slope by its states.
  double residual(const FitSegment& segment, const Run& run, Eigen::MatrixXd& slope) {
    const FitData& data = data_[static_cast<std::size_t>(segment.record)];
    double cost = 0;
    for (const Output& o : outputs_[static_cast<std::size_t>(segment.record)]) {
      const std::span<const double> measured = data.record[o.channel];
      const int state = state_of(system_.model(), o.channel);
      for (Index i = 0; i < segment.count; ++i) {
        const auto row = static_cast<std::size_t>(segment.first + i);
        if (!data.use.empty() && !data.use[row]) continue;
        ++rows;
        const double error = o.weight * (measured[row] - run.x(i, state)), size = std::abs(error);
        const bool outlier = clip_ > 0 && size > clip_;
        outliers += outlier;
        cost += outlier ? 2 * clip_ * size - clip_ * clip_ : error * error;
        slope(i, state) -= 2 * o.weight * (outlier ? std::copysign(clip_, error) : error);
      }
    }
    return cost;
  }

  const System& system_;
  const std::vector<FitData>& data_;
  const Adjoint adjoint_;
  const double clip_;
  SimulateOptions run_options_;
  std::vector<Excitations> excitations_;
  std::vector<std::vector<Output>> outputs_;
};

/// The free entries of theta and the first states, as NLopt moves them: over their scales.
class Descent {
 public:
  Descent(AdjointCost& cost, const Bounds& bounds, VectorXd theta) : cost_(cost), theta_(std::move(theta)) {
    for (Index i = 0; i < theta_.size(); ++i) {
      if (bounds.fixed[static_cast<std::size_t>(i)]) continue;
      free_.push_back(i);
      const double range = bounds.max[i] - bounds.min[i];
      const double scale = theta_[i] != 0 ? std::abs(theta_[i]) : std::isfinite(range) && range > 0 ? range : 1;
      add(scale, theta_[i], bounds.min[i], bounds.max[i]);
    }
    constexpr double open = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < cost.segments.size(); ++s) {
      const VectorXd scales = cost.scales(theta_, s);
      for (Index i = 0; i < scales.size(); ++i) add(scales[i], cost.segments[s].x0[i], -open, open);
    }
  }

  double value(const double* z, double* slope) {
    put(z);
    VectorXd gradient;
    double value = cost_.at(theta_, gradient);
    if (unit_ == 0) unit_ = value > 0 && std::isfinite(value) ? value : 1;
    if (!std::isfinite(value)) {  // the line search turns back
      std::fill_n(slope, scale_.size(), 0.0);
      return 1e6;
    }
    for (std::size_t i = 0; i < scale_.size(); ++i) slope[i] = scale_[i] * gradient[place(i)] / unit_;
    return value / unit_;
  }

  /// Sets theta and the first states of the segments.
  void put(const double* z) {
    for (std::size_t i = 0; i < free_.size(); ++i) theta_[free_[i]] = std::clamp(scale_[i] * z[i], min_[i], max_[i]);
    std::size_t at = free_.size();
    for (FitSegment& segment : cost_.segments)
      for (double& x : segment.x0) {
        x = scale_[at] * z[at];
        ++at;
      }
  }

  std::vector<double> start, low, high;  ///< in units of the scales
  const VectorXd& theta() const { return theta_; }
  double unit() const { return unit_; }
  nlopt_opt optimiser = nullptr;
  std::exception_ptr fault;

 private:
  void add(double scale, double value, double min, double max) {
    scale_.push_back(scale);
    min_.push_back(min);
    max_.push_back(max);
    start.push_back(value / scale);
    low.push_back(min / scale);
    high.push_back(max / scale);
  }
  /// Of an entry of z in the gradient.
  Index place(std::size_t i) const {
    return i < free_.size() ? free_[i] : cost_.layout.size() + static_cast<Index>(i - free_.size());
  }

  AdjointCost& cost_;
  VectorXd theta_;
  std::vector<Index> free_;
  std::vector<double> scale_, min_, max_;
  double unit_ = 0;  ///< the first cost
};

/// Measured - model of each record's first fitted channel, then of its second, as they are weighted ...
void fill_residuals(const System& system, const std::vector<FitData>& data, const FitOptions& options,
                    FitResult& result) {
  const FitLayout layout(system.parameters(), static_cast<int>(data.size()), options.separate);
  SimulateOptions run_options;
  run_options.solver = Solver::fixed;
  run_options.substeps = result.substeps;
  for (const FitSegment& s : result.segments) {
    const auto record = static_cast<std::size_t>(s.record);
    const FitData& d = data[record];
    const std::vector<Output> outputs = outputs_of(system.model(), d.record, options.channels);
    while (result.residual.size() < outputs.size() * data.size())
      result.residual.push_back(VectorXd::Constant(data[result.residual.size() % data.size()].record.rows(), NAN));
    const VectorXd own = layout.of_record(result.theta, s.record);
    const std::span<const double> theta(own.data(), static_cast<std::size_t>(own.size()));
    const Run run = simulate(system, theta, d.excitation.part(s.first, s.count), s.x0, run_options);
    for (std::size_t c = 0; c < outputs.size(); ++c) {
      const Eigen::Map<const VectorXd> measured(d.record[outputs[c].channel].data() + s.first, s.count);
      result.residual[c * data.size() + record].segment(s.first, s.count) =
          outputs[c].weight * (measured - shown(system, theta, run, outputs[c].channel));
    }
  }
}

/// What crosses NLopt's frame: an exception is kept and thrown after it.
double call_value(unsigned, const double* z, double* slope, void* data) {
  Descent& descent = *static_cast<Descent*>(data);
  try {
    return descent.value(z, slope);
  } catch (...) {
    descent.fault = std::current_exception();
    nlopt_force_stop(descent.optimiser);
    return HUGE_VAL;
  }
}

const char* words_of(nlopt_result code) {
  return code == NLOPT_MAXEVAL_REACHED ? "iterations"
         : code < 0                    ? "no step lowers the cost"
                                       : "relative drop of the cost below its tolerance";
}

}  // namespace

FitResult minimise_by_adjoint(const System& system, const VectorXd& given, const std::vector<FitData>& data,
                              const FitOptions& options, std::vector<FitSegment> segments, int substeps, double clip) {
  AdjointCost cost(system, data, options, std::move(segments), substeps, clip);
  const Bounds bounds(system.model(), cost.layout, options);
  Descent descent(cost, bounds, cost.layout.expanded(given).cwiseMax(bounds.min).cwiseMin(bounds.max));
  const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, void (*)(nlopt_opt)> optimiser(
      nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(descent.start.size())), nlopt_destroy);
  descent.optimiser = optimiser.get();
  std::vector<double> z = descent.start;
  nlopt_set_lower_bounds(optimiser.get(), descent.low.data());
  nlopt_set_upper_bounds(optimiser.get(), descent.high.data());
  nlopt_set_min_objective(optimiser.get(), call_value, &descent);
  nlopt_set_ftol_rel(optimiser.get(), finer * options.tolerance);
  nlopt_set_maxeval(optimiser.get(), evaluations_per_iteration * options.max_iterations);
  double value = 0;
  const nlopt_result code = nlopt_optimize(optimiser.get(), z.data(), &value);
  if (descent.fault) std::rethrow_exception(descent.fault);
  descent.put(z.data());

  // the solution once more: its curvature where sensitivities can be had, else its residual alone
  const long runs = cost.runs;
  FitResult result;
  if (system.dynamics().dense()) {
    FitOptions last = options;
    last.gradient = Gradient::forward;
    last.max_iterations = 0;
    result = minimise(system, descent.theta(), data, last, cost.segments, substeps, clip);
  } else {
    VectorXd gradient;
    result.theta = descent.theta();
    result.cost = cost.at(result.theta, gradient);
    result.rows = cost.rows;
    result.outliers = cost.outliers;
    result.freedom = std::max(1.0, static_cast<double>(cost.rows) - static_cast<double>(z.size()));
    result.covariance.setZero(result.theta.size(), result.theta.size());
    result.information = result.covariance;
    result.at_bound.assign(static_cast<std::size_t>(result.theta.size()), 0);
    result.unseen = result.at_bound;
    result.segments = cost.segments;
    result.clip = clip;
    result.substeps = substeps;
    result.solver = fit_solver_name(options, substeps);
    fill_residuals(system, data, options, result);
  }
  result.gradient = Gradient::adjoint;
  result.runs += runs;
  result.iterations = static_cast<int>(runs / static_cast<long>(std::max<std::size_t>(1, cost.segments.size())));
  result.converged = std::isfinite(result.cost) && code != NLOPT_MAXEVAL_REACHED;
  result.stopped = std::isfinite(result.cost) ? words_of(code) : "free run: " + cost.cause;
  return result;
}

}  // namespace lunid
