// What channels show of a run: their states, or what the model makes of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "simulate/acceleration.hpp"
#include "simulate/measures.hpp"
#include "simulate/simulate.hpp"

namespace lunid {
namespace {

using Eigen::Index;

/// Runs the tape of a measured channel over the rows of a run.
class MeasureRows {
 public:
  MeasureRows(const System& system, const Tape& tape, std::span<const double> theta)
      : tape_(tape),
        n_(system.states()),
        degrees_(system.degrees()),
        in_(tape.inputs()),
        out_(tape.outputs()),
        scratch_(tape.registers() + 1) {
    std::copy(theta.begin(), theta.end(), in_.begin() + 1 + n_ + degrees_);
  }

  /// The value, then its derivatives by the states, by the accelerations and by theta.
  const std::vector<double>& row(const Run& run, Index row) {
    in_[0] = run.t0 + run.dt * static_cast<double>(row);
    for (int i = 0; i < n_; ++i) in_[1 + i] = run.x(row, i);
    for (int i = 0; i < degrees_; ++i) in_[1 + n_ + i] = run.a(row, i);
    tape_.run_point(in_.data(), out_.data(), scratch_.data());
    return out_;
  }

 private:
  const Tape& tape_;
  int n_, degrees_;
  std::vector<double> in_, out_, scratch_;
};

int own_state(const System& system, std::string_view channel) {
  const int state = state_of(system.model(), channel);
  if (state < 0)
    throw InputError("shown: expected a displacement, velocity or acceleration of the model, got '" +
                     std::string(channel) + "'");
  return state;
}

/// The coordinate whose acceleration a channel is, from 0; -1 where it is none.
int accelerated(const Model& model, std::string_view channel) {
  for (int i = 0; i < model.degrees(); ++i)
    if (channel == model.channel('a', i)) return i;
  return -1;
}

}  // namespace

int state_of(const Model& model, std::string_view channel) {
  for (int i = 0; i < model.degrees(); ++i) {
    if (channel == model.channel('y', i)) return 2 * i;
    if (channel == model.channel('v', i)) return 2 * i + 1;
  }
  return -1;
}

bool is_shown(const Model& model, std::string_view channel) {
  return state_of(model, channel) >= 0 || accelerated(model, channel) >= 0;
}

namespace {

/// What a model says that a channel shows; empty: the channel itself.
Expr map_of(const Model& model, std::string_view channel) {
  for (const auto& [name, map] : model.measures)
    if (name == channel) return map;
  return {};
}

/// The accelerations follow from all states.
bool holds_acceleration(const Model& model, Expr map) {
  for (int i = 0; i < model.degrees(); ++i)
    if (depends_on(map, model.pool->channel(model.channel('a', i)))) return true;
  return false;
}

/// The slopes of each acceleration. A row in sliding, whose acceleration the branches' own signs do not give, says
/// nothing of the parameters.
std::vector<Eigen::MatrixXd> told_acceleration_slopes(const System& system, std::span<const double> theta,
                                                      const Excitations& excitation, const SensitivityRun& run) {
  std::vector<Eigen::MatrixXd> all = acceleration_slopes(system, theta, excitation, run);
  for (Eigen::MatrixXd& slopes : all)
    for (Index row = 0; row < slopes.rows(); ++row)
      if (run.run.x.row(row).allFinite() && !slopes.row(row).allFinite()) slopes.row(row).setZero();
  return all;
}

}  // namespace

std::vector<int> shown_states(const System& system, std::string_view channel) {
  const Model& model = system.model();
  std::vector<int> all(static_cast<std::size_t>(system.states()));
  std::iota(all.begin(), all.end(), 0);
  const Expr map = map_of(model, channel);
  if (!map.valid() && accelerated(model, channel) < 0) return {own_state(system, channel)};
  if (!map.valid() || holds_acceleration(model, map)) return all;
  std::vector<int> states;
  for (const int i : all)
    if (depends_on(map, system.equations().states[static_cast<std::size_t>(i)])) states.push_back(i);
  return states;
}

Eigen::VectorXd shown(const System& system, std::span<const double> theta, const Run& run, std::string_view channel) {
  const Tape* tape = system.measure(channel);
  const int accelerates = accelerated(system.model(), channel);
  if (!tape) return accelerates >= 0 ? run.a.col(accelerates) : run.x.col(own_state(system, channel));
  MeasureRows rows(system, *tape, theta);
  Eigen::VectorXd out(run.x.rows());
  for (Index row = 0; row < out.size(); ++row) {
    const double value = rows.row(run, row)[0];
    out[row] = run.x.row(row).allFinite() ? value : std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

namespace {

/// A channel that follows less than this of a state says nothing of it.
bool follows(double slope) {
  constexpr double least_slope = 0.1;
  return std::isfinite(slope) && std::abs(slope) > least_slope;
}

/// The value of a state at which its channel shows what the state holds now (Newton's method); as it is where the
/// channel does not follow it.
double behind(const System& system, const Tape& tape, std::span<const double> theta, Run at, int state) {
  constexpr int passes = 4;
  MeasureRows rows(system, tape, theta);
  double& x = at.x(0, state);
  const double was = x;
  for (int pass = 0; pass < passes; ++pass) {
    const std::vector<double>& shows = rows.row(at, 0);
    const double slope = shows[1 + static_cast<std::size_t>(state)];
    if (!std::isfinite(shows[0]) || !follows(slope)) return was;
    x -= (shows[0] - was) / slope;
  }
  return std::isfinite(x) ? x : was;
}

}  // namespace

Eigen::Vector2d motion_behind(const System& system, std::span<const double> theta, const Record& record, int coordinate,
                              double t, const Eigen::VectorXd& x) {
  const Model& model = system.model();
  const int first = 2 * coordinate;
  const std::string channels[] = {model.channel('y', coordinate), model.channel('v', coordinate)};
  const auto derived = [&](int i) { return record.channel(channels[i]).derived; };
  Run at;
  at.t0 = t;
  at.x = x.transpose();
  at.a = Eigen::MatrixXd::Zero(1, system.degrees());
  for (int i = 0; i < 2; ++i)
    if (const Tape* tape = system.measure(channels[i]); tape && !derived(i))
      at.x(0, first + i) = behind(system, *tape, theta, at, first + i);
  const std::string measured = measured_channel(record, channels[0].substr(1));
  if (const Tape* tape = system.measure(measured)) {
    const int from = state_of(model, measured), column = from >= 0 ? from : system.states() + coordinate;
    const double slope = MeasureRows(system, *tape, theta).row(at, 0)[1 + static_cast<std::size_t>(column)];
    for (int i = 0; i < 2; ++i)
      if (first + i != from && derived(i) && follows(slope)) at.x(0, first + i) /= slope;
  }
  return {at.x(0, first), at.x(0, first + 1)};
}

Eigen::MatrixXd shown_slopes(const System& system, std::span<const double> theta, const Excitations& excitation,
                             const SensitivityRun& run, std::string_view channel) {
  const Tape* tape = system.measure(channel);
  const int accelerates = accelerated(system.model(), channel);
  if (!tape && accelerates >= 0)
    return std::move(told_acceleration_slopes(system, theta, excitation, run)[static_cast<std::size_t>(accelerates)]);
  if (!tape) return run.dx[static_cast<std::size_t>(own_state(system, channel))];
  const std::vector<int> states = shown_states(system, channel);
  const int n = system.states(), p = system.parameters();
  std::vector<Eigen::MatrixXd> accelerations;
  if (holds_acceleration(system.model(), map_of(system.model(), channel)))
    accelerations = told_acceleration_slopes(system, theta, excitation, run);
  MeasureRows rows(system, *tape, theta);
  Eigen::MatrixXd out(run.run.x.rows(), p + n);
  for (Index row = 0; row < out.rows(); ++row) {
    const std::vector<double>& values = rows.row(run.run, row);
    const double *by_state = values.data() + 1, *by_acceleration = by_state + n,
                 *by_theta = by_acceleration + system.degrees();
    out.row(row).setZero();
    for (const int i : states) out.row(row) += by_state[i] * run.dx[static_cast<std::size_t>(i)].row(row);
    for (std::size_t i = 0; i < accelerations.size(); ++i)
      out.row(row) += by_acceleration[i] * accelerations[i].row(row);
    for (int i = 0; i < p; ++i) out(row, i) += by_theta[i];
  }
  return out;
}

}  // namespace lunid
