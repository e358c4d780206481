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

/// One coordinate's channels at one state.
class ShownAt {
 public:
  ShownAt(const System& system, std::span<const double> theta, double t, const Eigen::VectorXd& x)
      : system_(system), theta_(theta) {
    at_.t0 = t;
    at_.x = x.transpose();
    at_.a = Eigen::MatrixXd::Zero(1, system.degrees());
  }

  /// What a channel shows and its slope along a column of its values (MeasureRows::row()).
  struct Value {
    double shows, slope;
  };
  Value along(const Tape& tape, int column) {
    MeasureRows rows(system_, tape, theta_);
    const std::vector<double>& values = rows.row(at_, 0);
    return {values[0], values[1 + static_cast<std::size_t>(column)]};
  }

  /// Moves a state until its channel shows what it was; leaves it where the channel does not follow it.
  void move(const Tape& tape, int state) {
    constexpr int passes = 4;
    const double was = at_.x(0, state);
    for (int pass = 0; pass < passes; ++pass) {
      const auto [shows, slope] = along(tape, state);
      if (!std::isfinite(shows) || !follows(slope)) {
        at_.x(0, state) = was;
        return;
      }
      at_.x(0, state) -= (shows - was) / slope;
    }
    if (!std::isfinite(at_.x(0, state))) at_.x(0, state) = was;
  }

  void divide(int state, double slope) {
    if (follows(slope)) at_.x(0, state) /= slope;
  }

  double value(int state) const { return at_.x(0, state); }

 private:
  static bool follows(double slope) {
    constexpr double least_slope = 0.1;
    return std::isfinite(slope) && std::abs(slope) > least_slope;
  }

  const System& system_;
  std::span<const double> theta_;
  Run at_;
};

}  // namespace

Eigen::Vector2d motion_behind(const System& system, std::span<const double> theta, const Record& record, int coordinate,
                              double t, const Eigen::VectorXd& x) {
  const Model& model = system.model();
  const int y = 2 * coordinate, v = y + 1;
  const std::string measured = measured_channel(record, model.channel('y', coordinate).substr(1));
  const int from = state_of(model, measured);
  ShownAt at(system, theta, t, x);
  for (const int state : {y, v}) {
    const std::string channel = model.channel(state == y ? 'y' : 'v', coordinate);
    const Tape* tape = system.measure(channel);
    if (tape && !record.channel(channel).derived) at.move(*tape, state);
  }
  if (const Tape* tape = system.measure(measured)) {
    const double slope = at.along(*tape, from >= 0 ? from : system.states() + coordinate).slope;
    for (const int state : {y, v})
      if (state != from && record.channel(model.channel(state == y ? 'y' : 'v', coordinate)).derived)
        at.divide(state, slope);
  }
  return {at.value(y), at.value(v)};
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
