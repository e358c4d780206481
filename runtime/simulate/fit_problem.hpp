#pragma once
// The least-squares problem of a trajectory fit: free runs against measured channels, and their normal equations.
// Internal to this room.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "record/parallel.hpp"
#include "simulate/fit.hpp"
#include "simulate/measures.hpp"

namespace lunid {

/// Normal equations over theta with each segment's first state eliminated.
struct Normal {
  double cost = std::numeric_limits<double>::infinity();
  Eigen::Index rows = 0;
  Eigen::MatrixXd a;  ///< theta x theta (before elimination)
  Eigen::VectorXd b;
  std::vector<Eigen::MatrixXd> ax, axx;  ///< per segment: theta x n, n x n
  std::vector<Eigen::VectorXd> bx;
  /// What the equations are made of, per segment.
  struct Part {
    Eigen::VectorXd residual;  ///< measured - model
    Eigen::VectorXd error;     ///< the same, whitened
    Eigen::MatrixXd columns;   ///< d model / d(theta, first state), whitened; without derivatives none
  };
  std::vector<Part> parts;
  Eigen::Index outliers = 0;
  std::string cause;  ///< why a run failed
};

/// A measured channel that the fit looks at.
struct Output {
  std::string channel;
  double weight;  ///< of its residual: the noise of the first over its own
};
/// The channels asked for, or of each coordinate what was measured of it (measured_channel). Throws InputError naming
/// what is missing.
std::vector<Output> outputs_of(const Model& model, const Record& record, const std::vector<std::string>& channels);

/// Inverse of a symmetric positive semi-definite matrix on its numerical range, scaled by its diagonal.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& m, double tolerance = 1e-12);
double spread_of(std::span<const double> x);

class Problem {
 public:
  Problem(const System& system, const std::vector<FitData>& data, const FitOptions& options, int substeps)
      : system_(system),
        data_(data),
        options_(options),
        layout_(system.parameters(), static_cast<int>(data.size()), options.separate) {
    run_options_.solver = options.solver == Solver::automatic ? Solver::fixed : options.solver;
    run_options_.substeps = substeps;
    run_options_.cancelled = options.cancelled;
    for (const FitData& d : data) outputs_.push_back(outputs_of(system.model(), d.record, options.channels));
  }

  const FitLayout& layout() const { return layout_; }
  /// Whitened residuals beyond this count linearly (Huber); 0: none does.
  double clip = 0;

  bool imposed() const { return system_.model().imposed_motion; }

  void prepare(const std::vector<FitSegment>& segments) {
    excitations_.clear();
    if (imposed()) return;
    for (const auto& s : segments)
      excitations_.push_back(data_[static_cast<std::size_t>(s.record)].excitation.part(s.first, s.count));
  }

  /// The cost at (theta, first states), and the normal equations when asked for.
  Normal evaluate(const Eigen::VectorXd& theta, const std::vector<FitSegment>& segments, bool derivatives) {
    std::vector<Ran> ran(segments.size());
    std::atomic<std::size_t> failed{segments.size()};  // the first one that did; what comes after it is not wanted
    parallel_for(static_cast<int>(segments.size()), options_.threads, [&](int i) {
      const auto s = static_cast<std::size_t>(i);
      if (s > failed) return;
      ran[s] = run_whitened(theta, segments[s], s, derivatives);
      std::size_t first = failed;
      while (ran[s].failed && s < first && !failed.compare_exchange_weak(first, s)) continue;
    });
    Normal normal;
    normal.cost = 0;
    normal.a.setZero(layout_.size(), layout_.size());
    normal.b.setZero(layout_.size());
    for (std::size_t s = 0; s < segments.size() && std::isfinite(normal.cost); ++s) {
      ++runs;
      add(std::move(ran[s]), segments[s], derivatives, normal);
    }
    return normal;
  }

  long runs = 0;

 private:
  /// Of one segment.
  struct Ran {
    Normal::Part part;
    Eigen::Index rows = 0;
    std::optional<std::string> failed;  ///< why, if it did
  };

  Ran run_whitened(const Eigen::VectorXd& theta, const FitSegment& segment, std::size_t index, bool derivatives) const {
    const FitData& data = data_[static_cast<std::size_t>(segment.record)];
    Ran out;
    Normal::Part& part = out.part;
    out.failed =
        run(layout_.of_record(theta, segment.record), segment, index, data, derivatives, part.residual, part.columns);
    if (out.failed) return out;
    std::vector<std::uint8_t> keep(static_cast<std::size_t>(segment.count), 1);
    for (Eigen::Index i = 0; i < segment.count; ++i)
      keep[static_cast<std::size_t>(i)] =
          (data.use.empty() || data.use[static_cast<std::size_t>(segment.first + i)] != 0);
    const Eigen::Index channels = part.residual.size() / segment.count;
    out.rows = channels * (std::count(keep.begin(), keep.end(), 1) / options_.whitening.average);
    whiten_channels(part.residual, keep, part.error);
    if (derivatives) whiten_columns(keep, part.error.size(), part.columns);
    part.error *= data.weight;
    if (derivatives) part.columns *= data.weight;
    if (derivatives && !layout_.shared()) part.columns = spread(part.columns, segment.record);
    return out;
  }

  void add(Ran ran, const FitSegment& segment, bool derivatives, Normal& normal) const {
    if (ran.failed) {
      normal.cost = std::numeric_limits<double>::infinity();
      normal.cause = std::move(*ran.failed);
      return;
    }
    Normal::Part& part = ran.part;
    normal.rows += ran.rows;
    if (clip > 0) clip_outliers(part, derivatives, normal);
    normal.cost += part.error.squaredNorm();
    if (derivatives) {
      const Eigen::Index p = layout_.size();
      const auto jt = part.columns.leftCols(p);
      normal.a.noalias() += jt.transpose() * jt;
      normal.b.noalias() += jt.transpose() * part.error;
      if (!imposed()) {
        const auto jx = part.columns.rightCols(part.columns.cols() - p);
        normal.ax.push_back(jt.transpose() * jx);
        normal.axx.push_back(jx.transpose() * jx);
        normal.bx.push_back(jx.transpose() * part.error);
      }
    }
    normal.parts.push_back(std::move(part));
  }

  /// The columns of a record's own parameters at their places among all.
  Eigen::MatrixXd spread(const Eigen::MatrixXd& columns, int record) const {
    const Eigen::Index own = system_.parameters(), rest = columns.cols() - own;
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(columns.rows(), layout_.size() + rest);
    for (int j = 0; j < own; ++j) out.col(layout_.place(record, j)) = columns.col(j);
    out.rightCols(rest) = columns.rightCols(rest);
    return out;
  }

  /// Huber's loss (1964, Ann. Math. Statist. 35, 73) as a sum of squares: beyond the clip c a residual e becomes
  /// sqrt(2 c |e| - c^2), and its derivatives are scaled alike.
  void clip_outliers(Normal::Part& part, bool derivatives, Normal& normal) const {
    for (Eigen::Index i = 0; i < part.error.size(); ++i) {
      const double size = std::abs(part.error[i]);
      if (!(size > clip)) continue;
      const double clipped = std::sqrt(2 * clip * size - clip * clip);
      part.error[i] = std::copysign(clipped, part.error[i]);
      if (derivatives) part.columns.row(i) *= clip / clipped;
      ++normal.outliers;
    }
  }

  /// A column of all channels, one after another, each whitened for itself.
  void whiten_channels(const Eigen::VectorXd& column, const std::vector<std::uint8_t>& keep,
                       Eigen::VectorXd& out) const {
    const auto rows = static_cast<Eigen::Index>(keep.size()), channels = column.size() / rows;
    if (channels == 1) return lunid::whiten(column, keep, options_.whitening, out);
    const Eigen::Index kept = rows / options_.whitening.average;
    out.resize(channels * kept);
    Eigen::VectorXd part;
    for (Eigen::Index c = 0; c < channels; ++c) {
      whiten(column.segment(c * rows, rows), keep, options_.whitening, part);
      out.segment(c * kept, kept) = part;
    }
  }

  void whiten_columns(const std::vector<std::uint8_t>& keep, Eigen::Index rows, Eigen::MatrixXd& columns) const {
    const bool all = std::find(keep.begin(), keep.end(), 0) == keep.end();
    if (all && options_.whitening.average == 1 && options_.whitening.ar.empty()) return;
    Eigen::MatrixXd out(rows, columns.cols());
    Eigen::VectorXd column;
    for (Eigen::Index j = 0; j < columns.cols(); ++j) {
      whiten_channels(columns.col(j), keep, column);
      out.col(j) = column;
    }
    columns = std::move(out);
  }

  /// error = measured - model and its (negative) Jacobian d model / d(theta, x0); why the run failed, if it did.
  std::optional<std::string> run(const Eigen::VectorXd& theta, const FitSegment& segment, std::size_t index,
                                 const FitData& data, bool derivatives, Eigen::VectorXd& error,
                                 Eigen::MatrixXd& jacobian) const {
    const std::span<const double> parameters(theta.data(), static_cast<std::size_t>(theta.size()));
    if (imposed()) {
      const Eigen::VectorXd model =
          imposed_force(system_, parameters, data.record, derivatives ? &jacobian : nullptr, run_options_.substeps);
      error = acting_forces(system_.model(), data.record) - model;
      if (!error.allFinite()) return "the model's force is not finite";
      return {};
    }
    const SimulateOptions run_options = with_fewer_events(segment.count);
    const std::vector<Output>& outputs = outputs_[static_cast<std::size_t>(segment.record)];
    if (derivatives) {
      std::vector<int> wanted;
      for (const Output& o : outputs)
        for (const int state : shown_states(system_, o.channel)) wanted.push_back(state);
      SensitivityRun r =
          simulate_sensitivities(system_, parameters, excitations_[index], segment.x0, run_options, wanted);
      if (!r.run.summary.completed) return r.run.summary.cause;
      error = difference(data.record, segment, outputs, parameters, r.run);
      const int state = state_of(system_.model(), outputs[0].channel);
      if (outputs.size() == 1 && state >= 0 && !system_.measure(outputs[0].channel)) {
        jacobian = std::move(r.dx[static_cast<std::size_t>(state)]);
      } else {
        jacobian.resize(error.size(), theta.size() + system_.states());
        Eigen::Index row = 0;
        for (const Output& o : outputs) {
          jacobian.middleRows(row, segment.count) =
              o.weight * shown_slopes(system_, parameters, excitations_[index], r, o.channel);
          row += segment.count;
        }
      }
      if (!jacobian.allFinite()) return "the sensitivities are not finite";
      hold_anchored(system_.model(), segment, jacobian);
    } else {
      const Run r = simulate(system_, parameters, excitations_[index], segment.x0, run_options);
      if (!r.summary.completed) return r.summary.cause;
      error = difference(data.record, segment, outputs, parameters, r);
    }
    return {};
  }

  /// A motion that chatters between its samples is not what was measured; it would be followed for minutes. Of a run
  /// of so many rows: each switch twice a row, and in a long one each every other row (of an element that slips four
  /// times a period, of eight rows and more), but any of them once.
  SimulateOptions with_fewer_events(Eigen::Index rows) const {
    SimulateOptions options = run_options_;
    const auto switches =
        static_cast<Eigen::Index>(system_.dynamics().surfaces.size() + system_.dynamics().bounds.size());
    const Eigen::Index most =
        std::min(100 + 2 * rows * switches, 1000 + rows * std::max<Eigen::Index>(1, switches / 2));
    options.max_events = static_cast<int>(std::min<Eigen::Index>(most, SimulateOptions().max_events));
    return options;
  }

  /// Measured - model, weighted, channel after channel.
  Eigen::VectorXd difference(const Record& record, const FitSegment& segment, const std::vector<Output>& outputs,
                             std::span<const double> theta, const Run& run) const {
    Eigen::VectorXd error(segment.count * static_cast<Eigen::Index>(outputs.size()));
    Eigen::Index row = 0;
    for (const Output& o : outputs) {
      const Eigen::Map<const Eigen::VectorXd> measured(record[o.channel].data() + segment.first, segment.count);
      error.segment(row, segment.count) = o.weight * (measured - shown(system_, theta, run, o.channel));
      row += segment.count;
    }
    return error;
  }

  const System& system_;
  const std::vector<FitData>& data_;
  const FitOptions& options_;
  FitLayout layout_;
  SimulateOptions run_options_;
  std::vector<Excitations> excitations_;
  std::vector<std::vector<Output>> outputs_;  ///< per record
};

struct Step {
  Eigen::VectorXd theta;
  std::vector<Eigen::VectorXd> x0;
};
/// The damped Gauss-Newton step; rows of frozen parameters are left out.
Step damped_step(const Normal& normal, double lambda, const std::vector<std::uint8_t>& frozen);

/// What each entry of the fitted vector may be.
struct Bounds {
  Eigen::VectorXd min, max;
  std::vector<std::uint8_t> fixed;
  Bounds(const Model& model, const FitLayout& layout, const FitOptions& options) {
    min.resize(layout.size());
    max.resize(layout.size());
    fixed.resize(static_cast<std::size_t>(layout.size()));
    for (int i = 0; i < layout.size(); ++i) {
      const auto& p = model.parameters[static_cast<std::size_t>(layout.parameter(i))];
      min[i] = p.min;
      max[i] = p.max;
      fixed[static_cast<std::size_t>(i)] = p.fixed || std::ranges::find(options.hold, i) != options.hold.end();
    }
  }
};

/// L-BFGS by the adjoint, from the same. Throws InputError where there is none (Adjoint), or a whitened residual.
FitResult minimise_by_adjoint(const System& system, const Eigen::VectorXd& start, const std::vector<FitData>& data,
                              const FitOptions& options, std::vector<FitSegment> segments, int substeps,
                              double clip = 0);

/// "fixed DP5, 2 substeps", "CVODE BDF" ...
std::string fit_solver_name(const FitOptions& options, int substeps);

/// Levenberg-Marquardt from `start` (of one record, or of all) and the first states of the segments.
FitResult minimise(const System& system, const Eigen::VectorXd& start, const std::vector<FitData>& data,
                   const FitOptions& options, std::vector<FitSegment> segments, int substeps, double clip = 0);

/// Adds to the covariance of a fit what the noise of its forces does to it, or a disturbance that nothing recorded
/// (FitOptions::force_noise).
void count_noise_of_forces(const System& system, const std::vector<FitData>& data, const FitOptions& options,
                           FitResult& result);

}  // namespace lunid
