#include "discover/gap.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "statistics/statistics.hpp"

namespace lunid {

namespace {

/// White noise beyond this part of the force's standard deviation is taken for the excitation itself.
constexpr double roughest_noise = 0.3;
constexpr int most_substeps = 32;

/// Squared change of what is shown after the lead-in, under another force or first state; NaN where the run stops.
double squared_change(const System& system, std::span<const double> theta, const Excitations& excitation,
                      const Eigen::VectorXd& x0, const Run& nominal, Eigen::Index rows, const std::string& channel,
                      const SimulateOptions& options) {
  const Run run = simulate(system, theta, excitation, x0, options);
  if (!run.summary.completed) return NAN;
  return (shown(system, theta, run, channel) - shown(system, theta, nominal, channel)).tail(rows).squaredNorm();
}

/// Mean squared displacement that white noise on the force channel causes, by a run with a noisy force.
double input_noise_squares(const Study& study, const System& system, const Eigen::VectorXd& theta, const FitData& data,
                           const Eigen::VectorXd& x0, const Run& nominal, Eigen::Index lead,
                           const SimulateOptions& options) {
  const Record& record = data.record;
  const double noise = record.channel("F").noise;
  // A force that is as rough as that is a random excitation, not a noisy sensor.
  if (!(noise > 0) || noise > roughest_noise * standard_deviation(record["F"])) return 0;
  double squares = 0;
  constexpr int draws = 2;
  for (int draw = 0; draw < draws; ++draw) {
    Philox random(study.options->seed, static_cast<std::uint64_t>(1000 + draw));
    Eigen::VectorXd force = Eigen::Map<const Eigen::VectorXd>(record["F"].data(), record.rows());
    for (auto& f : force) f += noise * random.normal();
    const Excitation noisy(record.start(), record.dt(), {force.data(), static_cast<std::size_t>(force.size())},
                           data.excitation.interpolation());
    const std::span<const double> values(theta.data(), static_cast<std::size_t>(theta.size()));
    squares += squared_change(system, values, data.excitation.replaced("F", noisy), x0, nominal, record.rows() - lead,
                              study.output(), options);
  }
  return std::isfinite(squares) ? squares / draws : 0;
}

/// What the first state's error makes of the run where slopes do not tell: it grows along the run (several attractors,
/// chaos, no spring) until the motion itself bounds it.
void add_drawn_states(const Study& study, const System& system, const Eigen::VectorXd& theta, const FitData& data,
                      const StateEstimate& state, double share, const Run& nominal, const SimulateOptions& options,
                      FreeRun& out) {
  constexpr int draws = 16;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(share * state.covariance);
  const Eigen::VectorXd lengths = parts.eigenvalues().cwiseMax(0).cwiseSqrt();
  const std::span<const double> values(theta.data(), static_cast<std::size_t>(theta.size()));
  std::vector<double> squares;
  for (int draw = 0; draw < draws; ++draw) {
    Philox random(study.options->seed, stream_of("first state") + static_cast<std::uint64_t>(draw));
    Eigen::VectorXd step(lengths.size());
    for (Eigen::Index i = 0; i < step.size(); ++i) step[i] = lengths[i] * random.normal();
    const double change = squared_change(system, values, data.excitation, state.x0 + parts.eigenvectors() * step,
                                         nominal, out.rows, study.output(), options);
    if (!std::isnan(change)) squares.push_back(change);
  }
  if (squares.empty()) return;
  const double deviation = standard_deviation(squares);
  out.floor_squares += std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(squares.size());
  out.floor_variance = deviation * deviation;
}

void add_floor(const Study& study, const System& system, const Eigen::VectorXd& theta, const FitData& data,
               const StateEstimate& state, const Run& run, const SimulateOptions& options, FreeRun& out) {
  const double noise = data.record.channel(study.output()).noise;
  out.floor_squares = noise * noise * static_cast<double>(out.rows);
  const std::span<const double> values(theta.data(), static_cast<std::size_t>(theta.size()));
  const auto sensitivities = simulate_sensitivities(system, values, data.excitation, state.x0, options);
  if (sensitivities.run.summary.completed && state.covariance.size() > 0) {
    const Eigen::MatrixXd d = shown_slopes(system, values, data.excitation, sensitivities, study.output())
                                  .rightCols(system.states())
                                  .bottomRows(out.rows);
    // The lead-in's own residual may hold the misfit; the sensor's noise is what the floor is about.
    const double fitted = state.residual_variance > 0 ? std::min(1.0, noise * noise / state.residual_variance) : 1.0;
    const Eigen::MatrixXd spread = fitted * (d.transpose() * d) * state.covariance;
    const bool small = spread.allFinite() && spread.trace() < out.floor_squares;
    if (small) {
      out.floor_squares += spread.trace();
      out.floor_variance = 2 * (spread * spread).trace();  // of a quadratic form of a Gaussian first state
    } else {
      add_drawn_states(study, system, theta, data, state, fitted, run, options, out);
    }
  }
  out.input_squares = input_noise_squares(study, system, theta, data, state.x0, run, out.lead, options);
}

/// How far internal states are from where they start, over the whole record: what a lead-in may find them to be.
Eigen::VectorXd spread_of_states(const System& system, const Eigen::VectorXd& theta, const FitData& data,
                                 const SimulateOptions& options) {
  const Eigen::Index own = 2 * system.degrees();
  if (system.states() == own) return {};
  const Eigen::VectorXd start = measured_state(system, data.record, 0);
  const Run run =
      simulate(system, {theta.data(), static_cast<std::size_t>(theta.size())}, data.excitation, start, options);
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(system.states());
  if (!run.summary.completed) return spread;
  for (Eigen::Index i = own; i < spread.size(); ++i)
    spread[i] = std::sqrt((run.x.col(i).array() - start[i]).square().mean());
  return spread;
}

void force_run(const System& system, const Eigen::VectorXd& theta, const Record& record, FreeRun& out) {
  out.model = imposed_force(system, {theta.data(), static_cast<std::size_t>(theta.size())}, record);
  const double noise = record.channel("F").noise;
  out.floor_squares = noise * noise * static_cast<double>(out.rows);
}

}  // namespace

Eigen::Index lead_in(const Record& record, double omega) {
  const auto rows = static_cast<double>(record.rows());
  const double periods = omega > 0 ? 2 * 2 * M_PI / omega / record.dt() : rows;
  return std::max<Eigen::Index>(5, static_cast<Eigen::Index>(std::min(periods, 0.05 * rows)));
}

FreeRun free_run(const Study& study, const System& system, const Eigen::VectorXd& theta, const Record& record,
                 int substeps, bool floor) {
  FreeRun out;
  out.lead = lead_in(record, study.omega);
  out.rows = record.rows() - out.lead;
  const bool imposed = system.model().imposed_motion;
  if (imposed) {
    force_run(system, theta, record, out);
  } else {
    const FitData data = fit_data(study, record);
    SimulateOptions options;
    options.solver = Solver::fixed;
    options.substeps = substeps;
    options.cancelled = study.options->cancelled;
    const std::span<const double> values(theta.data(), static_cast<std::size_t>(theta.size()));
    StateEstimate state;
    Run run;
    // A test may go faster than what the substeps were chosen on: shorter ones are tried before a run counts as
    // stopped.
    for (; options.substeps <= std::max(substeps, most_substeps); options.substeps *= 2) {
      const Eigen::VectorXd spread = spread_of_states(system, theta, data, options);
      state = estimate_state(system, theta, data, 0, out.lead, options.substeps, spread);
      run = simulate(system, values, data.excitation, state.x0, options);
      if (run.summary.completed) break;
    }
    out.model = shown(system, values, run, study.output());
    if (!run.summary.completed) {
      out.stopped_at = run.summary.stopped_at;
      out.cause = run.summary.cause;
    } else if (floor) {
      add_floor(study, system, theta, data, state, run, options, out);
    }
  }
  const auto channel = record[study.output()];
  const Eigen::Map<const Eigen::VectorXd> measured(channel.data(), record.rows());
  const Eigen::VectorXd tail = measured.tail(out.rows);
  out.squares = (tail - out.model.tail(out.rows)).squaredNorm();
  out.variance = (tail.array() - tail.mean()).square().sum();
  out.model.head(out.lead).setConstant(NAN);
  return out;
}

Gap pool_gap(const std::vector<FreeRun>& runs, double input_share) {
  Gap gap;
  double squares = 0, variance = 0, floor = 0, floor_variance = 0, rows = 0;
  for (const auto& r : runs) {
    squares += r.squares;
    variance += r.variance;
    floor += r.floor_squares + input_share * r.input_squares;
    floor_variance += r.floor_variance;
    rows += static_cast<double>(r.rows);
    if (!r.cause.empty() && gap.cause.empty()) {
      gap.cause = r.cause;
      gap.stopped_at = r.stopped_at;
    }
  }
  gap.value = std::sqrt(squares / variance);
  gap.floor = std::sqrt(floor / variance);
  // The noise level is known to about 5 % (noise_level), the record has finitely many rows, and the first state is one
  // draw of its error: std of a root is half the relative std of its square.
  const double state = floor > 0 ? 0.25 * floor_variance / (floor * floor) : 0;
  gap.floor_std = gap.floor * std::sqrt(0.05 * 0.05 + 0.5 / std::max(1.0, rows) + state);
  return gap;
}

double input_noise_share(const std::vector<FreeRun>& train) {
  double excess = 0, input = 0;
  for (const auto& r : train) {
    excess += r.squares - r.floor_squares;
    input += r.input_squares;
  }
  return input > 0 && std::isfinite(excess) ? std::clamp(excess / input, 0.0, 1.0) : 0.0;
}

}  // namespace lunid
