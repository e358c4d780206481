#include "simulate/fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <memory>

namespace lunid {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int variance_blocks = 20;  // over which sums of scores are taken to be independent

/// Normal equations over theta with each segment's first state eliminated.
struct Normal {
  double cost = infinity;
  Eigen::Index rows = 0;
  Eigen::MatrixXd a;  ///< theta x theta (before elimination)
  Eigen::VectorXd b;
  std::vector<Eigen::MatrixXd> ax, axx;  ///< per segment: theta x n, n x n
  std::vector<Eigen::VectorXd> bx;
  /// What the equations are made of, per segment.
  struct Part {
    Eigen::VectorXd residual;  ///< measured - model
    Eigen::VectorXd error;     ///< the same, whitened
    Eigen::MatrixXd columns;   ///< d model / d(theta, first state), whitened
  };
  std::vector<Part> parts;
  std::string cause;  ///< why a run failed
};

/// Inverse of a symmetric positive semi-definite matrix on its numerical range, scaled by its diagonal.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& m, double tolerance = 1e-12) {
  if (m.rows() == 0) return m;
  Eigen::VectorXd scale = m.diagonal().cwiseMax(0).cwiseSqrt();
  for (auto& s : scale) s = s > 0 ? 1 / s : 0;
  const Eigen::MatrixXd scaled = scale.asDiagonal() * m * scale.asDiagonal();
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  Eigen::VectorXd inverse = eigen.eigenvalues();
  const double largest = inverse.cwiseAbs().maxCoeff();
  for (auto& value : inverse) value = value > tolerance * largest ? 1 / value : 0;
  return scale.asDiagonal() * eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose() *
         scale.asDiagonal();
}

bool used(const FitData& data, Eigen::Index row) {
  return data.use.empty() || data.use[static_cast<std::size_t>(row)] != 0;
}

std::vector<FitSegment> cut(const System& system, const std::vector<FitData>& data, Eigen::Index length) {
  std::vector<FitSegment> segments;
  for (std::size_t r = 0; r < data.size(); ++r) {
    const Eigen::Index rows = data[r].record.rows();
    const Eigen::Index parts = length <= 0 ? 1 : std::max<Eigen::Index>(1, rows / length);
    for (Eigen::Index k = 0; k < parts; ++k) {
      const Eigen::Index first = rows * k / parts, last = rows * (k + 1) / parts;
      segments.push_back({static_cast<int>(r), first, last - first, measured_state(system, data[r].record, first)});
    }
  }
  return segments;
}

/// A measured channel that the fit looks at.
struct Output {
  int state;      ///< the state that it measures
  std::string channel;
  double weight;  ///< of its residual: the noise of the first over its own
};

double spread_of(std::span<const double> x) {
  const Eigen::Map<const Eigen::ArrayXd> values(x.data(), static_cast<Eigen::Index>(x.size()));
  return std::sqrt((values - values.mean()).square().mean());
}

/// The place in the state of a channel such as y, v2; -1 when it is none.
int state_of(const Model& model, const std::string& channel) {
  for (int i = 0; i < model.degrees(); ++i) {
    if (channel == model.channel('y', i)) return 2 * i;
    if (channel == model.channel('v', i)) return 2 * i + 1;
  }
  return -1;
}

std::vector<Output> outputs_of(const Model& model, const Record& record, const std::vector<std::string>& channels) {
  std::vector<Output> outputs;
  if (model.imposed_motion) return outputs;
  std::string wanted;
  for (int i = 0; channels.empty() && i < model.degrees(); ++i) {
    const std::string y = model.channel('y', i);
    wanted += (wanted.empty() ? "" : ", ") + y;
    if (record.has(y)) outputs.push_back({2 * i, y, 1});
  }
  for (const std::string& channel : channels) {
    const int state = state_of(model, channel);
    if (state < 0) throw InputError("fit_trajectory: channels: expected displacements or velocities of the model, got '" + channel + "'");
    wanted += (wanted.empty() ? "" : ", ") + channel;
    if (!record.has(channel))
      throw InputError("fit_trajectory: the record " + record.name() + " has no channel '" + channel + "'");
    outputs.push_back({state, channel, 1});
  }
  if (outputs.empty())
    throw InputError("fit_trajectory: the record " + record.name() + " has none of the channels " + wanted);
  const auto noise = [&](const Output& o) { return record.channel(o.channel).noise; };
  for (Output& o : outputs) {
    const bool known = noise(o) > 0 && noise(outputs[0]) > 0;
    o.weight = known ? noise(outputs[0]) / noise(o)
                     : spread_of(record[outputs[0].channel]) / std::max(spread_of(record[o.channel]), 1e-300);
  }
  outputs[0].weight = 1;
  return outputs;
}

class Problem {
 public:
  Problem(const System& system, const std::vector<FitData>& data, const FitOptions& options, int substeps)
      : system_(system), data_(data), options_(options) {
    run_options_.solver = Solver::fixed;
    run_options_.substeps = substeps;
    run_options_.cancelled = options.cancelled;
    for (const FitData& d : data) outputs_.push_back(outputs_of(system.model(), d.record, options.channels));
  }

  bool imposed() const { return system_.model().imposed_motion; }

  void prepare(const std::vector<FitSegment>& segments) {
    excitations_.clear();
    if (imposed()) return;
    for (const auto& s : segments)
      excitations_.push_back(data_[static_cast<std::size_t>(s.record)].excitation.part(s.first, s.count));
  }

  /// The cost at (theta, first states), and the normal equations when asked for.
  Normal evaluate(const Eigen::VectorXd& theta, const std::vector<FitSegment>& segments, bool derivatives) {
    Normal normal;
    normal.cost = 0;
    const Eigen::Index p = system_.parameters();
    normal.a.setZero(p, p);
    normal.b.setZero(p);
    for (std::size_t s = 0; s < segments.size() && std::isfinite(normal.cost); ++s)
      add(theta, segments[s], s, derivatives, normal);
    return normal;
  }

  long runs = 0;

 private:
  void add(const Eigen::VectorXd& theta, const FitSegment& segment, std::size_t index, bool derivatives,
           Normal& normal) {
    const FitData& data = data_[static_cast<std::size_t>(segment.record)];
    const Eigen::Index p = system_.parameters();
    Normal::Part part;
    if (!run(theta, segment, index, data, derivatives, part.residual, part.columns, normal)) return;
    std::vector<std::uint8_t> keep(static_cast<std::size_t>(segment.count), 1);
    for (Eigen::Index i = 0; i < segment.count; ++i) keep[static_cast<std::size_t>(i)] = used(data, segment.first + i);
    const Eigen::Index channels = part.residual.size() / segment.count;
    normal.rows += channels * (std::count(keep.begin(), keep.end(), 1) / options_.whitening.average);
    whiten_channels(part.residual, keep, part.error);
    normal.cost += part.error.squaredNorm();
    if (!derivatives) return;
    whiten_columns(keep, part.error.size(), part.columns);
    const auto jt = part.columns.leftCols(p);
    normal.a.noalias() += jt.transpose() * jt;
    normal.b.noalias() += jt.transpose() * part.error;
    if (!imposed()) {
      const auto jx = part.columns.rightCols(part.columns.cols() - p);
      normal.ax.push_back(jt.transpose() * jx);
      normal.axx.push_back(jx.transpose() * jx);
      normal.bx.push_back(jx.transpose() * part.error);
    }
    normal.parts.push_back(std::move(part));
  }

  /// A column of all channels, one after another, each whitened for itself.
  void whiten_channels(const Eigen::VectorXd& column, const std::vector<std::uint8_t>& keep,
                       Eigen::VectorXd& out) const {
    const auto rows = static_cast<Eigen::Index>(keep.size()), channels = column.size() / rows;
    if (channels == 1) return whiten(column, keep, options_.whitening, out);
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

  /// error = measured - model and its (negative) Jacobian d model / d(theta, x0); false when the run failed.
  bool run(const Eigen::VectorXd& theta, const FitSegment& segment, std::size_t index, const FitData& data,
           bool derivatives, Eigen::VectorXd& error, Eigen::MatrixXd& jacobian, Normal& normal) {
    ++runs;
    const std::span<const double> parameters(theta.data(), static_cast<std::size_t>(theta.size()));
    if (imposed()) {
      const auto force = data.record["F"];
      const Eigen::VectorXd model =
          imposed_force(system_, parameters, data.record, derivatives ? &jacobian : nullptr, run_options_.substeps);
      error = Eigen::Map<const Eigen::VectorXd>(force.data(), static_cast<Eigen::Index>(force.size())) - model;
      if (!error.allFinite()) return fail(normal, "the model's force is not finite");
      return true;
    }
    const std::vector<Output>& outputs = outputs_[static_cast<std::size_t>(segment.record)];
    if (derivatives) {
      std::vector<int> wanted;
      for (const Output& o : outputs) wanted.push_back(o.state);
      SensitivityRun r =
          simulate_sensitivities(system_, parameters, excitations_[index], segment.x0, run_options_, wanted);
      if (!r.run.summary.completed) return fail(normal, r.run.summary.cause);
      error = difference(data.record, segment, outputs, r.run);
      if (outputs.size() == 1) {
        jacobian = std::move(r.dx[static_cast<std::size_t>(outputs[0].state)]);
      } else {
        jacobian.resize(error.size(), theta.size() + system_.states());
        Eigen::Index row = 0;
        for (const Output& o : outputs) {
          jacobian.middleRows(row, segment.count) = o.weight * r.dx[static_cast<std::size_t>(o.state)];
          row += segment.count;
        }
      }
      if (!jacobian.allFinite()) return fail(normal, "the sensitivities are not finite");
    } else {
      const Run r = simulate(system_, parameters, excitations_[index], segment.x0, run_options_);
      if (!r.summary.completed) return fail(normal, r.summary.cause);
      error = difference(data.record, segment, outputs, r);
    }
    return true;
  }

  /// Measured - model, weighted, channel after channel.
  static Eigen::VectorXd difference(const Record& record, const FitSegment& segment, const std::vector<Output>& outputs,
                                    const Run& run) {
    Eigen::VectorXd error(segment.count * static_cast<Eigen::Index>(outputs.size()));
    Eigen::Index row = 0;
    for (const Output& o : outputs) {
      const Eigen::Map<const Eigen::VectorXd> measured(record[o.channel].data() + segment.first, segment.count);
      error.segment(row, segment.count) = o.weight * (measured - run.x.col(o.state));
      row += segment.count;
    }
    return error;
  }

  static bool fail(Normal& normal, std::string cause) {
    normal.cost = infinity;
    normal.cause = std::move(cause);
    return false;
  }

  const System& system_;
  const std::vector<FitData>& data_;
  const FitOptions& options_;
  SimulateOptions run_options_;
  std::vector<Excitations> excitations_;
  std::vector<std::vector<Output>> outputs_;  ///< per record
};

struct Step {
  Eigen::VectorXd theta;
  std::vector<Eigen::VectorXd> x0;
};

/// The damped Gauss-Newton step; rows of frozen parameters are left out.
Step damped_step(const Normal& normal, double lambda, const std::vector<std::uint8_t>& frozen) {
  Eigen::MatrixXd a = normal.a;
  Eigen::VectorXd b = normal.b;
  a.diagonal() *= 1 + lambda;
  std::vector<Eigen::MatrixXd> inverse;
  for (std::size_t s = 0; s < normal.axx.size(); ++s) {
    Eigen::MatrixXd axx = normal.axx[s];
    axx.diagonal() *= 1 + lambda;
    inverse.push_back(pseudo_inverse(axx));
    a.noalias() -= normal.ax[s] * inverse[s] * normal.ax[s].transpose();
    b.noalias() -= normal.ax[s] * (inverse[s] * normal.bx[s]);
  }
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    if (frozen[static_cast<std::size_t>(i)]) {
      a.row(i).setZero();
      a.col(i).setZero();
      b[i] = 0;
    }
  Step step;
  step.theta = pseudo_inverse(a, 1e-13) * b;
  for (std::size_t s = 0; s < normal.axx.size(); ++s)
    step.x0.push_back(inverse[s] * (normal.bx[s] - normal.ax[s].transpose() * step.theta));
  return step;
}

/// J'J of theta with first states projected out.
Eigen::MatrixXd schur(const Normal& normal) {
  Eigen::MatrixXd a = normal.a;
  for (std::size_t s = 0; s < normal.axx.size(); ++s)
    a.noalias() -= normal.ax[s] * pseudo_inverse(normal.axx[s]) * normal.ax[s].transpose();
  return a;
}

struct Bounds {
  Eigen::VectorXd min, max;
  explicit Bounds(const Model& model) {
    const auto n = static_cast<Eigen::Index>(model.parameters.size());
    min.resize(n);
    max.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& p = model.parameters[static_cast<std::size_t>(i)];
      min[i] = p.min;
      max[i] = p.max;
    }
  }
};

/// Parameters that may not move: fixed ones, and those at a bound that the gradient pushes against.
std::vector<std::uint8_t> frozen(const Model& model, const Bounds& bounds, const Eigen::VectorXd& theta,
                                 const Eigen::VectorXd& descent, std::vector<std::uint8_t>* at_bound) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(theta.size()), 0);
  if (at_bound) at_bound->assign(out.size(), 0);
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const bool held = (theta[i] <= bounds.min[i] && descent[i] <= 0) || (theta[i] >= bounds.max[i] && descent[i] >= 0);
    if (held && at_bound) (*at_bound)[static_cast<std::size_t>(i)] = 1;
    out[static_cast<std::size_t>(i)] = held || model.parameters[static_cast<std::size_t>(i)].fixed;
  }
  return out;
}

/// Widens a covariance where the residual is not white: A^-1 B A^-1 with B the sum over blocks of the squared sums of
/// the scores (batch means: whatever the correlation within a block). Never narrows it.
void widen(const std::vector<Eigen::MatrixXd>& scores, const Eigen::MatrixXd& inverse, Eigen::MatrixXd& covariance) {
  Eigen::Index rows = 0;
  for (const auto& s : scores) rows += s.rows();
  const auto length = std::max<Eigen::Index>(1, rows / variance_blocks);
  const Eigen::Index p = covariance.rows();
  Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(p, p);
  double blocks = 0;
  for (const auto& s : scores)
    for (Eigen::Index first = 0; first + length <= s.rows(); first += length, ++blocks) {
      const Eigen::VectorXd sum = s.middleRows(first, length).colwise().sum();
      middle.noalias() += sum * sum.transpose();
    }
  if (blocks < variance_blocks / 2) return;
  const Eigen::MatrixXd robust = inverse * middle * inverse * (blocks / (blocks - 1));
  Eigen::VectorXd factor(p);
  for (Eigen::Index i = 0; i < p; ++i)
    factor[i] = covariance(i, i) > 0 ? std::sqrt(std::max(1.0, robust(i, i) / covariance(i, i))) : 1;
  covariance = factor.asDiagonal() * covariance * factor.asDiagonal();
}

/// Per row the gradient of half its squared error by theta, first states projected out; a matrix per segment.
std::vector<Eigen::MatrixXd> scores_of(const Normal& normal) {
  const Eigen::Index p = normal.a.rows();
  std::vector<Eigen::MatrixXd> scores;
  for (std::size_t s = 0; s < normal.parts.size(); ++s) {
    const auto& [residual, error, columns] = normal.parts[s];
    Eigen::MatrixXd projected = columns.leftCols(p);
    if (!normal.axx.empty())
      projected -= columns.rightCols(columns.cols() - p) * (pseudo_inverse(normal.axx[s]) * normal.ax[s].transpose());
    scores.push_back(error.asDiagonal() * projected);
  }
  return scores;
}

/// Covariance, ranks and residuals at the solution.
void finish(const System& system, const std::vector<FitData>& data, const Normal& normal, FitResult& result) {
  const Eigen::Index p = system.parameters();
  result.rows = normal.rows;
  for (const auto& d : data) result.residual.push_back(Eigen::VectorXd::Constant(d.record.rows(), NAN));
  for (std::size_t s = 0; s < result.segments.size(); ++s) {
    const FitSegment& segment = result.segments[s];
    result.residual[static_cast<std::size_t>(segment.record)].segment(segment.first, segment.count) =
        normal.parts[s].residual.head(segment.count);
  }
  result.information = schur(normal);
  Eigen::VectorXd full = normal.a.diagonal();
  result.unseen.assign(static_cast<std::size_t>(p), 0);
  Eigen::MatrixXd information = result.information;
  Eigen::Index free = 0;
  for (Eigen::Index i = 0; i < p; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(information(i, i) > 1e-10 * full[i])) result.unseen[k] = 1;
    if (result.at_bound[k] || system.model().parameters[k].fixed) {
      information.row(i).setZero();
      information.col(i).setZero();
    } else {
      ++free;
    }
  }
  const double states = system.model().imposed_motion ? 0 : static_cast<double>(result.segments.size()) * 2;
  const double freedom = std::max(1.0, static_cast<double>(normal.rows - free) - states);
  const Eigen::MatrixXd inverse = pseudo_inverse(information);
  result.covariance = inverse * (normal.cost / freedom);
  widen(scores_of(normal), inverse, result.covariance);
}

FitResult minimise(const System& system, const Eigen::VectorXd& start, const std::vector<FitData>& data,
                   const FitOptions& options, std::vector<FitSegment> segments, int substeps) {
  const Bounds bounds(system.model());
  Problem problem(system, data, options, substeps);
  problem.prepare(segments);
  FitResult result;
  result.substeps = substeps;
  result.theta = start.cwiseMax(bounds.min).cwiseMin(bounds.max);
  result.at_bound.assign(static_cast<std::size_t>(start.size()), 0);
  Normal normal = problem.evaluate(result.theta, segments, true);
  double lambda = 1e-4;
  result.stopped = "iterations";
  if (!std::isfinite(normal.cost)) {
    result.cost = infinity;
    result.segments = std::move(segments);
    result.stopped = "free run: " + normal.cause;
    result.runs = problem.runs;
    return result;
  }
  for (; result.iterations < options.max_iterations && !result.converged; ++result.iterations) {
    bool improved = false;
    for (int attempt = 0; attempt < 12 && !improved; ++attempt) {
      auto hold = frozen(system.model(), bounds, result.theta, normal.b, &result.at_bound);
      Step step = damped_step(normal, lambda, hold);
      Eigen::VectorXd theta = (result.theta + step.theta).cwiseMax(bounds.min).cwiseMin(bounds.max);
      if (!theta.allFinite()) {
        lambda = lambda * 10 + 1e-6;
        continue;
      }
      std::vector<FitSegment> trial = segments;
      for (std::size_t s = 0; s < step.x0.size(); ++s) trial[s].x0 += step.x0[s];
      bool finite = true;
      for (const auto& t : trial) finite = finite && t.x0.allFinite();
      if (!finite) {
        lambda = lambda * 10 + 1e-6;
        continue;
      }
      // The first step of an iteration is nearly always taken: its derivatives are computed along with its cost.
      Normal full = problem.evaluate(theta, trial, attempt == 0);
      if (full.cost < normal.cost) {
        const double drop = (normal.cost - full.cost) / normal.cost;
        if (attempt > 0) full = problem.evaluate(theta, trial, true);
        if (!std::isfinite(full.cost)) {
          lambda = lambda * 10 + 1e-6;
          continue;
        }
        result.theta = std::move(theta);
        segments = std::move(trial);
        normal = std::move(full);
        improved = true;
        lambda = std::max(lambda * 0.1, 1e-12);
        if (drop < options.tolerance) {
          result.converged = true;
          result.stopped = "relative drop of the cost below " + std::to_string(options.tolerance);
        }
      } else {
        lambda = lambda * 10 + 1e-9;
      }
    }
    if (!improved) {
      result.converged = true;
      result.stopped = "no step lowers the cost";
    }
  }
  frozen(system.model(), bounds, result.theta, normal.b, &result.at_bound);
  result.cost = normal.cost;
  result.segments = std::move(segments);
  finish(system, data, normal, result);
  result.runs = problem.runs;
  return result;
}

int substeps_for(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                 const FitOptions& options) {
  if (system.model().imposed_motion) return 4;
  int most = 1;
  for (const auto& d : data) {
    const Eigen::Index rows = std::min<Eigen::Index>(d.record.rows(), 400);
    const Eigen::Index first = (d.record.rows() - rows) / 2;
    const std::string channel = outputs_of(system.model(), d.record, options.channels)[0].channel;
    // A tenth of what the sensor's noise hides.
    const double tolerance =
        std::clamp(0.1 * d.record.channel(channel).noise / spread_of(d.record[channel]), 1e-5, 1e-3);
    const int chosen =
        choose_substeps(system, {theta.data(), static_cast<std::size_t>(theta.size())}, d.excitation.part(first, rows),
                        measured_state(system, d.record, first), tolerance);
    most = std::max(most, chosen);
  }
  return std::min(most, 64);
}

void check(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data) {
  if (theta.size() != system.parameters())
    throw InputError("fit_trajectory: theta: expected " + std::to_string(system.parameters()) + " values, got " +
                     std::to_string(theta.size()));
  if (!theta.allFinite()) throw InputError("fit_trajectory: theta: every first guess must be a finite number");
  if (data.empty()) throw InputError("fit_trajectory: expected at least one record, got none");
  for (const auto& d : data)
    if (!d.use.empty() && static_cast<Eigen::Index>(d.use.size()) != d.record.rows())
      throw InputError("fit_trajectory: use: expected one entry per row of the record");
}

}  // namespace

void whiten(const Eigen::VectorXd& column, const std::vector<std::uint8_t>& use, const Whitening& whitening,
            Eigen::VectorXd& out) {
  if (whitening.average == 1 && whitening.ar.empty()) {
    out = column;
    for (Eigen::Index i = 0; i < out.size(); ++i)
      if (!use.empty() && !use[static_cast<std::size_t>(i)]) out[i] = 0;
    return;
  }
  const Eigen::Index average = whitening.average, rows = column.size() / average;
  const auto order = static_cast<Eigen::Index>(whitening.ar.size());
  Eigen::VectorXd mean(rows);
  std::vector<std::uint8_t> keep(static_cast<std::size_t>(rows), 1);
  for (Eigen::Index i = 0; i < rows; ++i) {
    mean[i] = column.segment(i * average, average).mean();
    for (Eigen::Index j = 0; j < average && !use.empty(); ++j)
      if (!use[static_cast<std::size_t>(i * average + j)]) keep[static_cast<std::size_t>(i)] = 0;
  }
  out.setZero(rows);
  Eigen::Index history = 0;  // rows in use without a break before this one
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (!keep[static_cast<std::size_t>(i)]) {
      history = 0;
      continue;
    }
    if (history++ < order) continue;
    out[i] = mean[i];
    for (Eigen::Index j = 0; j < order; ++j) out[i] -= whitening.ar[static_cast<std::size_t>(j)] * mean[i - 1 - j];
  }
}

void validate(const FitOptions& o) {
  auto refuse = [](const std::string& what) { throw InputError("fit_trajectory: " + what); };
  if (o.segment < 0) refuse("segment: expected >= 0 rows, got " + std::to_string(o.segment));
  if (o.max_iterations < 1) refuse("max_iterations: expected >= 1, got " + std::to_string(o.max_iterations));
  if (!(o.tolerance > 0)) refuse("tolerance: expected > 0, got " + std::to_string(o.tolerance));
  if (o.whitening.average < 1)
    refuse("whitening.average: expected >= 1 rows, got " + std::to_string(o.whitening.average));
  if (o.substeps < 0) refuse("substeps: expected >= 0, got " + std::to_string(o.substeps));
}

Eigen::VectorXd measured_state(const System& system, const Record& record, Eigen::Index row) {
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(system.states());
  const Model& model = system.model();
  const Eigen::Index width = std::min<Eigen::Index>(record.rows(), 201);
  const Eigen::Index first = std::clamp<Eigen::Index>(row - width / 2, 0, record.rows() - width);
  for (int i = 0; i < model.degrees(); ++i) {
    const std::string y = model.channel('y', i), v = model.channel('v', i);
    if (model.degrees() > 1 && !record.has(y)) continue;  // a coordinate that no sensor sees starts at rest
    const auto part = record[y].subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(width));
    const SavitzkyGolay options = choose_savitzky_golay(part, record.channel(y).noise, 0);
    x0[2 * i] = savitzky_golay(part, record.dt(), 0, options)[row - first];
    x0[2 * i + 1] = record[v][static_cast<std::size_t>(row)];
  }
  for (std::size_t i = 0; i < model.states.size(); ++i)
    x0[2 * model.degrees() + static_cast<Eigen::Index>(i)] = model.states[i].initial;
  return x0;
}

FitResult fit_trajectory(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                         const FitOptions& options) {
  validate(options);
  check(system, theta, data);
  const int substeps = options.substeps > 0 ? options.substeps : substeps_for(system, theta, data, options);
  return minimise(system, theta, data, options, cut(system, data, options.segment), substeps);
}

FitResult fit_progressively(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                            const FitOptions& options) {
  validate(options);
  check(system, theta, data);
  if (system.model().imposed_motion) return fit_trajectory(system, theta, data, options);
  Eigen::Index longest = 0, length = 0;
  for (const auto& d : data) {
    longest = std::max(longest, d.record.rows());
    const std::string channel = outputs_of(system.model(), d.record, options.channels)[0].channel;
    const double omega = dominant_frequency(d.record[channel], d.record.dt());
    const double period = omega > 0 ? 2 * M_PI / omega / d.record.dt() : static_cast<double>(d.record.rows());
    length = std::max(length, static_cast<Eigen::Index>(2 * period));
  }
  length = std::clamp<Eigen::Index>(length, 20, longest);
  FitOptions stage = options;
  stage.substeps = options.substeps > 0 ? options.substeps : substeps_for(system, theta, data, options);
  stage.whitening = {};
  stage.tolerance = std::max(options.tolerance, 1e-3);
  stage.max_iterations = std::min(options.max_iterations, 12);
  Eigen::VectorXd current = theta;
  const Eigen::Index last = options.segment > 0 ? options.segment : longest;
  for (; length < last; length *= 5) {
    stage.segment = length;
    const FitResult fit = fit_trajectory(system, current, data, stage);
    if (std::isfinite(fit.cost)) current = fit.theta;
  }
  FitOptions final_stage = options;
  final_stage.substeps = stage.substeps;
  return fit_trajectory(system, current, data, final_stage);
}

StateEstimate estimate_state(const System& system, const Eigen::VectorXd& theta, const FitData& data,
                             Eigen::Index first, Eigen::Index count, int substeps) {
  StateEstimate out;
  FitOptions options;
  options.substeps = substeps;
  const std::vector<FitData> one{data};
  Problem alone(system, one, options, substeps);
  std::vector<FitSegment> segments{{0, first, count, measured_state(system, data.record, first)}};
  alone.prepare(segments);
  Normal normal = alone.evaluate(theta, segments, true);
  std::vector<std::uint8_t> hold(static_cast<std::size_t>(theta.size()), 1);
  double lambda = 1e-6;
  for (int iteration = 0; iteration < 30 && std::isfinite(normal.cost); ++iteration) {
    const Step step = damped_step(normal, lambda, hold);
    auto trial = segments;
    trial[0].x0 += step.x0[0];
    Normal next = alone.evaluate(theta, trial, true);
    if (!(next.cost < normal.cost)) {
      lambda = lambda * 10 + 1e-9;
      if (lambda > 1e6) break;
      continue;
    }
    const bool done = normal.cost - next.cost < 1e-9 * normal.cost;
    segments = trial;
    normal = std::move(next);
    lambda *= 0.1;
    if (done) break;
  }
  out.x0 = segments[0].x0;
  out.converged = std::isfinite(normal.cost);
  if (out.converged) {
    out.residual_variance = normal.cost / std::max<double>(1, static_cast<double>(count - 2));
    out.covariance = pseudo_inverse(normal.axx[0]) * out.residual_variance;
  }
  return out;
}

}  // namespace lunid
