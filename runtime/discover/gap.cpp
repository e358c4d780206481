#include "discover/gap.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "discover/views.hpp"
#include "record/motion.hpp"
#include "record/parallel.hpp"
#include "statistics/statistics.hpp"

namespace lunid {

namespace {

constexpr int most_substeps = 32;

/// A run that others are held against.
struct Nominal {
  const System& system;
  std::span<const double> theta;
  const FitData& data;
  const StateEstimate& state;
  const Run& run;
  const SimulateOptions& options;
};

/// Squared change of each output after the lead-in, under another force or first state; none where the run stops.
std::vector<double> squared_changes(const Nominal& at, const Excitations& excitation, const Eigen::VectorXd& x0,
                                    const std::vector<FreeRun>& outputs) {
  const Run run = simulate(at.system, at.theta, excitation, x0, at.options);
  if (!run.summary.completed) return {};
  std::vector<double> out;
  for (const FreeRun& o : outputs)
    out.push_back((shown(at.system, at.theta, run, o.output) - shown(at.system, at.theta, at.run, o.output))
                      .tail(o.rows)
                      .squaredNorm());
  return out;
}

/// Mean squared changes of the outputs that as much noise on the force channels again makes; zero where these have
/// none, NaN where a run stops.
std::vector<double> changes_by_input_noise(const Study& study, const Nominal& at, const std::vector<FreeRun>& outputs,
                                           int draws, std::uint64_t stream) {
  std::vector<double> squares(outputs.size(), 0.0);
  for (int draw = 0; draw < draws; ++draw) {
    Philox random(study.options->seed, stream + static_cast<std::uint64_t>(draw));
    const std::optional<Excitations> noisy = with_noise_again(at.data, random);
    if (!noisy) break;
    const std::vector<double> change = squared_changes(at, *noisy, at.state.x0, outputs);
    for (std::size_t i = 0; i < outputs.size(); ++i) squares[i] += (change.empty() ? NAN : change[i]) / draws;
  }
  return squares;
}

void add_input_noise(const Study& study, const Nominal& at, std::vector<FreeRun>& out) {
  const std::vector<double> squares = changes_by_input_noise(study, at, out, 2, 1000);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].input_squares = std::isfinite(squares[i]) ? squares[i] : 0;
}

/// Gaussian steps of a covariance, whatever the units of its rows.
class Steps {
 public:
  explicit Steps(const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd std = covariance.diagonal().cwiseMax(0).cwiseSqrt();
    const Eigen::VectorXd inverse = std.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(inverse.asDiagonal() * covariance *
                                                               inverse.asDiagonal());
    const Eigen::VectorXd lengths = parts.eigenvalues().cwiseMax(0).cwiseSqrt();
    root_ = std.asDiagonal() * parts.eigenvectors() * lengths.asDiagonal();
  }
  Eigen::VectorXd draw(Philox& random) const {
    return root_ * Eigen::VectorXd::NullaryExpr(root_.cols(), [&](Eigen::Index) { return random.normal(); });
  }

 private:
  Eigen::MatrixXd root_;
};

/// What the first state's error makes of the run where slopes do not tell: it grows along the run (several attractors,
/// chaos, no spring) until the motion itself bounds it.
void add_drawn_states(const Study& study, const Nominal& at, double share, std::vector<FreeRun>& out) {
  constexpr int draws = 16;
  const Steps steps(share * at.state.covariance);
  std::vector<std::vector<double>> squares(out.size());
  for (int draw = 0; draw < draws; ++draw) {
    Philox random(study.options->seed, stream_of("first state") + static_cast<std::uint64_t>(draw));
    const std::vector<double> change = squared_changes(at, at.data.excitation, at.state.x0 + steps.draw(random), out);
    for (std::size_t i = 0; i < change.size(); ++i)
      if (!std::isnan(change[i])) squares[i].push_back(change[i]);
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (squares[i].empty()) continue;
    const double deviation = standard_deviation(squares[i]);
    out[i].floor_squares +=
        std::accumulate(squares[i].begin(), squares[i].end(), 0.0) / static_cast<double>(squares[i].size());
    out[i].floor_variance = deviation * deviation;
  }
}

Eigen::VectorXd left_of(const FreeRun& run, const Record& record) {
  const Eigen::Map<const Eigen::VectorXd> measured(record[run.output].data(), record.rows());
  return measured.tail(run.rows) - run.model.tail(run.rows);
}

/// Of an output. Its own spectrum takes what is sharp in the motion (a blow, friction that turns round, in an
/// acceleration) for noise too; what a run leaves of it bounds the noise as well, and counts where it is clearly less.
double quietest_noise(const FreeRun& run, const Record& record) {
  constexpr double clearly = 0.8;
  constexpr Eigen::Index enough = 1000;  // rows: the lowest band of a short residual is low by chance
  const Channel& channel = record.channel(run.output);
  if (run.rows < enough) return channel.noise;
  const Eigen::VectorXd left = left_of(run, record);
  if (!left.allFinite()) return channel.noise;
  const double level = noise_level(view(left));
  return level < clearly * channel.noise ? level : channel.noise;
}

/// The forces over the rows of a run; none in a free decay.
Drives drives_of(const Study& study, const FreeRun& run, const Record& record) {
  Drives out;
  for (const std::string& force : study.forces) {
    const std::span<const double> rows = record[force].last(static_cast<std::size_t>(run.rows));
    if (standard_deviation(rows) > 0) out.push_back(rows);
  }
  return out;
}

/// The same, of noise that has a colour.
double noise_of(const Study& study, const FreeRun& run, const Record& record) {
  const double quietest = quietest_noise(run, record);
  if (!study.noise_has_colour) return quietest;
  const Eigen::VectorXd left = left_of(run, record), model = run.model.tail(run.rows);
  if (!left.allFinite()) return quietest;
  const double coloured = noise_beside(view(left), view(model), drives_of(study, run, record));
  return std::max(quietest, study.degrees() > 1 ? coloured : std::min(coloured, study.least_left));
}

void add_floor(const Study& study, const Nominal& at, std::vector<FreeRun>& out) {
  const StateEstimate& state = at.state;
  std::vector<double> noise;
  for (FreeRun& o : out) {
    noise.push_back(noise_of(study, o, at.data.record));
    o.floor_squares = noise.back() * noise.back() * static_cast<double>(o.rows);
  }
  const auto sensitivities = simulate_sensitivities(at.system, at.theta, at.data.excitation, state.x0, at.options);
  if (sensitivities.run.summary.completed && state.covariance.size() > 0) {
    // The lead-in's own residual may hold the misfit; the sensor's noise is what the floor is about.
    const double fitted =
        state.residual_variance > 0 ? std::min(1.0, noise.front() * noise.front() / state.residual_variance) : 1.0;
    std::vector<Eigen::MatrixXd> spreads;
    bool small = true;
    for (const FreeRun& o : out) {
      const Eigen::MatrixXd d = shown_slopes(at.system, at.theta, at.data.excitation, sensitivities, o.output)
                                    .rightCols(at.system.states())
                                    .bottomRows(o.rows);
      spreads.push_back(fitted * (d.transpose() * d) * state.covariance);
      small = small && spreads.back().allFinite() && spreads.back().trace() < o.floor_squares;
    }
    for (std::size_t i = 0; i < out.size() && small; ++i) {
      out[i].floor_squares += spreads[i].trace();
      out[i].floor_variance = 2 * (spreads[i] * spreads[i]).trace();  // of a quadratic form of a Gaussian first state
    }
    if (!small) add_drawn_states(study, at, fitted, out);
  }
  add_input_noise(study, at, out);
}

/// The first state of a run by its lead-in, in which internal states may be found as far from their start as they are
/// over the whole record. Where the soil was set before, or friction has slipped, the lead-in hardly says from that
/// start how far: they begin where the record itself leaves them too.
StateEstimate state_by_lead_in(const System& system, const Eigen::VectorXd& theta, const FitData& data,
                               Eigen::Index lead, const SimulateOptions& options) {
  constexpr double better = 0.9;  // of the squared error
  const Eigen::Index own = 2 * system.degrees(), inner = system.states() - own;
  if (inner == 0) return estimate_state(system, theta, data, 0, lead, options.substeps);
  const std::span<const double> values = view(theta);
  const Eigen::VectorXd start = measured_state(system, values, data.record, 0);
  const Run run = simulate(system, values, data.excitation, start, options);
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(system.states());
  if (!run.summary.completed) return estimate_state(system, theta, data, 0, lead, options.substeps, spread);
  for (Eigen::Index i = own; i < spread.size(); ++i)
    spread[i] = std::sqrt((run.x.col(i).array() - start[i]).square().mean());
  StateEstimate out = estimate_state(system, theta, data, 0, lead, options.substeps, spread);
  const Eigen::VectorXd left = run.x.row(run.x.rows() - 1).tail(inner);
  StateEstimate other = estimate_state(system, theta, data, 0, lead, options.substeps, spread, left);
  const bool closer = other.converged && !(other.residual_variance > better * out.residual_variance);
  return closer || !out.converged ? other : out;
}

/// The record with the noise of its sensors on the measured motion once more, and what is derived from it anew.
Record with_motion_noise_again(const Record& record, Philox& random) {
  Record out = record;
  for (const char* name : {"y", "v", "a"}) {
    Channel channel = of_window(record, name);
    if (channel.derived) continue;
    for (double& value : channel.values) value += channel.noise * random.normal();
    channel.noise *= M_SQRT2;  // what was there is joined by as much: taken for motion it would not be smoothed
    out = out.with(std::move(channel));
  }
  return derive_motion_anew(out);
}

/// What the noise of the sensors of a prescribed motion makes of the force along it: mean squares over the last rows.
double motion_noise_squares(const Study& study, const System& system, const Eigen::VectorXd& theta,
                            const Record& record, const Eigen::VectorXd& nominal, Eigen::Index rows) {
  constexpr int draws = 4;
  double squares = 0;
  for (int draw = 0; draw < draws; ++draw) {
    Philox random(study.options->seed, stream_of("imposed motion") + static_cast<std::uint64_t>(draw));
    const Eigen::VectorXd force = imposed_force(system, view(theta), with_motion_noise_again(record, random));
    squares += (force - nominal).tail(rows).squaredNorm();
  }
  return std::isfinite(squares) ? squares / draws : 0;
}

void force_run(const Study& study, const System& system, const Eigen::VectorXd& theta, const Record& record, bool floor,
               FreeRun& out) {
  out.model = imposed_force(system, view(theta), record);
  if (!floor) return;
  const double noise = record.channel("F").noise;
  out.floor_squares = noise * noise * static_cast<double>(out.rows) +
                      motion_noise_squares(study, system, theta, record, out.model, out.rows);
}

/// Two runs differ by what could be seen in the record.
bool tells_apart(const Record& record, const std::string& output, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  constexpr double of_noise = 0.2, of_motion = 1e-3;
  const double apart = std::sqrt((a - b).squaredNorm() / static_cast<double>(a.size()));
  return !(apart < std::max(of_noise * record.channel(output).noise, of_motion * standard_deviation(record[output])));
}

void motion_run(const Study& study, const System& system, const Eigen::VectorXd& theta, const Record& record,
                int substeps, bool floor, std::vector<FreeRun>& out) {
  const FitData data = fit_data(study, record);
  SimulateOptions options;
  options.solver = Solver::fixed;
  options.substeps = substeps;
  options.cancelled = study.options->cancelled;
  const std::span<const double> values = view(theta);
  StateEstimate state;
  Run run;
  // A test may go faster than what the substeps were chosen on: they are halved until the run is completed and halves
  // say the same.
  for (;; options.substeps *= 2) {
    state = state_by_lead_in(system, theta, data, out.front().lead, options);
    run = simulate(system, values, data.excitation, state.x0, options);
    if (2 * options.substeps > std::max(substeps, most_substeps)) break;
    if (!run.summary.completed) continue;
    SimulateOptions halves = options;
    halves.substeps *= 2;
    const Run finer = simulate(system, values, data.excitation, state.x0, halves);
    const auto told = [&](const FreeRun& o) {
      return !finer.summary.completed || tells_apart(record, o.output, shown(system, values, run, o.output),
                                                     shown(system, values, finer, o.output));
    };
    if (std::none_of(out.begin(), out.end(), told)) break;
  }
  for (FreeRun& o : out) {
    o.model = shown(system, values, run, o.output);
    if (run.summary.completed) continue;
    o.stopped_at = run.summary.stopped_at;
    o.cause = run.summary.cause;
  }
  if (run.summary.completed && floor) add_floor(study, {system, values, data, state, run, options}, out);
}

/// Friction that feeds the motion, say, would chatter for minutes.
Eigen::VectorXd within_bounds(const Model& model, Eigen::VectorXd theta) {
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const Parameter& p = model.parameters[static_cast<std::size_t>(i)];
    theta[i] = std::clamp(theta[i], p.min, p.max);
  }
  return theta;
}

/// In units of the first output's noise; numbers of a single one stay as they are.
void weigh(double weight, FreeRun& out) {
  const double square = weight * weight;
  for (double* squares : {&out.squares, &out.variance, &out.floor_squares, &out.input_squares}) *squares *= square;
  out.floor_variance *= square * square;
}

}  // namespace

Eigen::Index lead_in(const Study& study, const Record& record) {
  const auto rows = static_cast<double>(record.rows());
  const double periods = study.omega > 0 ? 2 * 2 * M_PI / study.omega / record.dt() : rows;
  const double part = study.run_length > 0 ? 0.2 : 0.05;
  return std::max<Eigen::Index>(5, static_cast<Eigen::Index>(std::min(periods, part * rows)));
}

std::vector<FreeRun> free_run(const Study& study, const System& system, const Eigen::VectorXd& theta,
                              const Record& record, int substeps, bool floor) {
  std::vector<FreeRun> out;
  for (const std::string& output : study.outputs()) {
    out.emplace_back();
    out.back().output = output;
    out.back().lead = lead_in(study, record);
    out.back().rows = record.rows() - out.back().lead;
  }
  if (study.imposed)
    force_run(study, system, theta, record, floor, out.front());
  else
    motion_run(study, system, theta, record, substeps, floor, out);
  const std::vector<double> weights = study.weights(record);
  for (std::size_t i = 0; i < out.size(); ++i) {
    FreeRun& o = out[i];
    const auto channel = record[o.output];
    const Eigen::Map<const Eigen::VectorXd> measured(channel.data(), record.rows());
    const Eigen::VectorXd tail = measured.tail(o.rows);
    o.squares = (tail - o.model.tail(o.rows)).squaredNorm();
    o.variance = (tail.array() - tail.mean()).square().sum();
    o.model.head(o.lead).setConstant(NAN);
    weigh(weights[i], o);
  }
  return out;
}

double driven_part(const Study& study, const std::vector<FreeRun>& runs, const std::vector<Record>& records) {
  if (study.imposed) return 0;
  const std::size_t outputs = study.outputs().size();
  double driven = 0, squares = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const FreeRun& run = runs[i];
    const Record& record = records[i / outputs];
    const Eigen::VectorXd left = left_of(run, record);
    if (!left.allFinite()) return 0;
    driven += driven_part(view(left), drives_of(study, run, record)) * run.squares;
    squares += run.squares;
  }
  return squares > 0 ? driven / squares : 0;
}

std::vector<FreeRun> of_output(const std::vector<FreeRun>& runs, const std::string& output) {
  std::vector<FreeRun> out;
  for (const FreeRun& run : runs)
    if (run.output == output) out.push_back(run);
  return out;
}

bool learn_motion_noise(Study& study, const Candidate& baseline) {
  if (!study.imposed || !baseline.ran()) return false;
  double squares = 0, rows = 0;
  for (const Record& record : study.full) {
    const Eigen::VectorXd force = imposed_force(*baseline.system, view(baseline.fit.theta), record);
    squares += motion_noise_squares(study, *baseline.system, baseline.fit.theta, record, force, force.size());
    rows += static_cast<double>(force.size());
  }
  study.motion_noise = std::sqrt(squares / rows);
  return study.motion_noise > 0;
}

bool lower_noise(Study& study, const Candidate& candidate) {
  if (study.imposed || study.run_length > 0 || !candidate.ran()) return false;
  bool lowered = false;
  for (std::size_t r = 0; r < study.full.size(); ++r)
    for (const FreeRun& run :
         free_run(study, *candidate.system, candidate.fit.theta, study.full[r], candidate.fit.substeps, false)) {
      const double known = study.full[r].channel(run.output).noise, noise = quietest_noise(run, study.full[r]);
      if (!(noise < known)) continue;
      lowered = true;
      for (Record* record : {&study.full[r], &study.train[r].record}) {
        Channel channel = of_window(*record, run.output);
        channel.noise *= noise / known;
        *record = record->with(channel);
      }
    }
  if (lowered) smooth_all(study);
  return lowered;
}

double noise_alone(const Study& study, const Candidate& candidate) {
  constexpr int draws = 4;
  const double sensors = study.sensor_noise();
  if (study.imposed || !candidate.ran()) return sensors;
  const std::span<const double> theta = view(candidate.fit.theta);
  const SimulateOptions options = steps_of(study, candidate.fit);
  double squares = 0, rows = 0;
  for (const FitSegment& segment : candidate.fit.segments) {
    const FitData data = study.train[static_cast<std::size_t>(segment.record)].part(segment.first, segment.count);
    StateEstimate state;
    state.x0 = segment.x0;
    const Run run = simulate(*candidate.system, theta, data.excitation, state.x0, options);
    if (!run.summary.completed) return sensors;
    std::vector<FreeRun> outputs;
    for (const std::string& name : study.outputs()) {
      outputs.emplace_back().output = name;
      outputs.back().rows = segment.count;
    }
    const std::vector<double> weights = study.weights(data.record),
                              changes =
                                  changes_by_input_noise(study, {*candidate.system, theta, data, state, run, options},
                                                         outputs, draws, stream_of("noise of the forces"));
    for (std::size_t i = 0; i < outputs.size(); ++i) squares += weights[i] * weights[i] * changes[i];
    rows += static_cast<double>(segment.count) * static_cast<double>(outputs.size());
  }
  return std::isfinite(squares) && rows > 0 ? std::sqrt(sensors * sensors + squares / rows) : sensors;
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
  // Where it hangs on the first state it is known badly, and a run that comes nearer to the data bounds it.
  const bool vague = gap.floor_std > 0.2 * gap.floor || gap.floor - gap.value > 3 * gap.floor_std;
  if (vague && gap.value < gap.floor) gap.floor = gap.value;
  return gap;
}

double parameter_spread(const Study& study, const Candidate& model, const std::vector<Record>& records) {
  constexpr int draws = 12;
  const FitResult& fit = model.fit;
  if (fit.covariance.size() == 0 || !fit.covariance.allFinite()) return 0;
  const Steps steps(fit.covariance);
  double squares = 0, variance = 0;
  for (const Record& record : records) {
    const std::vector<double> weights = study.weights(record);
    const auto run = [&](const Eigen::VectorXd& theta) {
      return free_run(study, *model.system, theta, record, std::max(1, fit.substeps), false);
    };
    const std::vector<FreeRun> nominal = run(fit.theta);
    for (const FreeRun& o : nominal) variance += o.variance;
    std::vector<double> apart(draws, 0.0);
    parallel_for(draws, study.options->threads, [&](int draw) {
      Philox random(study.options->seed, stream_of("parameters") + static_cast<std::uint64_t>(draw));
      const std::vector<FreeRun> moved = run(within_bounds(model.system->model(), fit.theta + steps.draw(random)));
      for (std::size_t i = 0; i < moved.size(); ++i)
        apart[static_cast<std::size_t>(draw)] +=
            std::pow(weights[i], 2) * (moved[i].model - nominal[i].model).tail(nominal[i].rows).squaredNorm();
    });
    squares = std::accumulate(apart.begin(), apart.end(), squares);
  }
  return std::isfinite(squares) ? std::sqrt(squares / draws / variance) : 0;
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
