#include "simulate/first_states.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "simulate/fit_steps.hpp"
#include "simulate/integrator.hpp"
#include "simulate/measures.hpp"

namespace lunid {
namespace {

/// The first value of a state: what a channel shows of it, or that which is declared.
double shown_or(const Model& model, std::size_t state, const Eigen::VectorXd& measured, const Record& record,
                Eigen::Index row) {
  for (const auto& [channel, map] : model.measures) {
    if (map != model.states[state].symbol) continue;
    if (const int own = state_of(model, channel); own >= 0) return measured[own];
    if (record.has(channel)) return record[channel][static_cast<std::size_t>(row)];
  }
  return model.states[state].initial;
}

}  // namespace

Eigen::VectorXd measured_state(const System& system, std::span<const double> theta, const Record& record,
                               Eigen::Index row) {
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
    x0[2 * model.degrees() + static_cast<Eigen::Index>(i)] = shown_or(model, i, x0, record, row);
  const double t = record.start() + static_cast<double>(row) * record.dt();
  for (int i = 0; i < model.degrees(); ++i)
    if (record.has(model.channel('y', i))) x0.segment<2>(2 * i) = motion_behind(system, theta, record, i, t, x0);
  return x0;
}

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// What is known of a first state beside the record, as rows of the normal equations.
struct Known {
  VectorXd start, weights;  ///< per state; weight 0: nothing
};

/// Levenberg-Marquardt on one segment's first state, parameters held.
class FirstState {
 public:
  /// `moves`: the states that may move.
  FirstState(Problem& problem, const VectorXd& theta, std::vector<Index> moves, Known known)
      : problem_(problem), theta_(theta), moves_(std::move(moves)), known_(std::move(known)) {}

  /// The normal equations where it ends; their cost is infinite where the segment cannot be run.
  Normal settle(FitSegment& segment, int iterations, double tolerance) {
    std::vector<FitSegment> at{segment};
    problem_.prepare(at);
    Normal now = evaluate(at);
    double lambda = 1e-6;
    for (int iteration = 0; iteration < iterations && std::isfinite(now.cost) && lambda < 1e6; ++iteration) {
      std::vector<FitSegment> trial = at;
      trial[0].x0(moves_) += step(now, lambda);
      Normal next = trial[0].x0.allFinite() ? evaluate(trial) : Normal{};
      if (!(next.cost < now.cost)) {
        lambda = lambda * 10 + 1e-9;
        continue;
      }
      const bool done = now.cost - next.cost < tolerance * now.cost;
      at = std::move(trial);
      now = std::move(next);
      lambda *= 0.1;
      if (done) break;
    }
    segment = std::move(at[0]);
    return now;
  }

 private:
  Normal evaluate(const std::vector<FitSegment>& at) {
    Normal normal = problem_.evaluate(theta_, at, true);
    if (!std::isfinite(normal.cost) || known_.weights.size() == 0) return normal;
    const VectorXd off = known_.start - at[0].x0;
    normal.cost += off.dot(known_.weights.asDiagonal() * off);
    normal.axx[0].diagonal() += known_.weights;
    normal.bx[0] += known_.weights.asDiagonal() * off;
    return normal;
  }

  VectorXd step(const Normal& normal, double lambda) const {
    Eigen::MatrixXd a = normal.axx[0](moves_, moves_);
    a.diagonal() *= 1 + lambda;
    return pseudo_inverse(a) * normal.bx[0](moves_);
  }

  Problem& problem_;
  const VectorXd& theta_;
  std::vector<Index> moves_;
  Known known_;
};

constexpr Index shortest_stretch = 8;  // rows

/// The motion of the coordinates that were measured.
std::vector<Index> measured_motion(const System& system, const Record& record) {
  std::vector<Index> out;
  for (int i = 0; i < system.degrees(); ++i)
    if (system.degrees() == 1 || record.has(system.model().channel('y', i))) out.insert(out.end(), {2 * i, 2 * i + 1});
  return out;
}

/// Weighted squares of a record's measured channels about their means, per row.
double power_of(const System& system, const Record& record, const FitOptions& options) {
  double sum = 0;
  for (const Output& o : outputs_of(system.model(), record, options.channels))
    sum += std::pow(o.weight * spread_of(record[o.channel]), 2);
  return sum;
}

/// A run leaves less than a third of the motion.
bool follows(const Normal& run, double power, const FitSegment& segment) {
  constexpr double lost = 0.1;  // squared
  return std::isfinite(run.cost) &&
         run.parts[0].residual.squaredNorm() < lost * power * static_cast<double>(segment.count);
}

/// The measured motion at the segment's first row, from a stretch that doubles as long as the run follows it and the
/// longer one says more of that row: damping makes a run forget it.
void settle(FirstState& state, double power, FitSegment& segment) {
  constexpr int iterations = 4;
  constexpr double alike = 0.01, more = 1.05;  // squared
  FitSegment part = segment;
  VectorXd known = VectorXd::Zero(segment.x0.size());
  for (Index rows = shortest_stretch; rows < 2 * segment.count; rows *= 2) {
    FitSegment longer = part;
    longer.count = std::min(rows, segment.count);
    const Normal normal = state.settle(longer, iterations, alike);
    if (!follows(normal, power, longer)) break;
    part = std::move(longer);
    const VectorXd before = std::exchange(known, normal.axx[0].diagonal());
    if ((known.array() <= more * before.array()).all()) break;
  }
  part.count = segment.count;
  segment = std::move(part);
}

}  // namespace

void settle_first_states(const System& system, const VectorXd& theta, const std::vector<FitData>& data,
                         const FitOptions& options, std::vector<FitSegment>& segments) {
  Problem problem(system, data, options, options.substeps);
  const VectorXd all = problem.layout().expanded(theta);
  std::vector<double> powers;  // of each record, which may be cut into very many segments
  for (const FitData& d : data) powers.push_back(power_of(system, d.record, options));
  for (FitSegment& segment : segments) {
    const auto r = static_cast<std::size_t>(segment.record);
    FirstState state(problem, all, measured_motion(system, data[r].record), {});
    FitSegment settled = segment;
    settle(state, powers[r], settled);
    const auto cost = [&](const FitSegment& s) {
      problem.prepare({s});
      return problem.evaluate(all, {s}, false).cost;
    };
    if (cost(settled) < cost(segment)) segment = std::move(settled);
  }
}

StateEstimate estimate_state(const System& system, const VectorXd& theta, const FitData& data, Index first, Index count,
                             int substeps, const VectorXd& spread, const VectorXd& inner) {
  StateEstimate out;
  FitOptions options;
  options.substeps = substeps;
  const std::vector<FitData> one{data};
  Problem problem(system, one, options, substeps);
  FitSegment segment{0, first, count, measured_state(system, own_values(system, theta), data.record, first)};
  if (inner.size() > 0) segment.x0.tail(inner.size()) = inner;
  const double noise = data.record.channel(outputs_of(system.model(), data.record, {})[0].channel).noise;
  Known known{segment.x0, VectorXd::Zero(segment.x0.size())};
  for (Index i = 0; i < spread.size(); ++i)
    if (spread[i] > 0) known.weights[i] = noise * noise / (spread[i] * spread[i]);
  FirstState motion(problem, theta, measured_motion(system, data.record), {});
  settle(motion, power_of(system, data.record, options), segment);
  std::vector<Index> all(static_cast<std::size_t>(segment.x0.size()));
  std::iota(all.begin(), all.end(), Index{0});
  const Normal normal = FirstState(problem, theta, std::move(all), known).settle(segment, 30, 1e-9);
  out.x0 = segment.x0;
  out.converged = std::isfinite(normal.cost);
  if (out.converged) {
    const Index used = normal.parts[0].residual.size();  // of all channels
    out.residual_variance = normal.cost / std::max<double>(1, static_cast<double>(used - 2 * system.degrees()));
    out.covariance = pseudo_inverse(normal.axx[0]) * out.residual_variance;
  }
  return out;
}

}  // namespace lunid
