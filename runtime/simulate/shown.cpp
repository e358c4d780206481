// What channels show of a run: their states, or what the model makes of them.
#include <algorithm>
#include <limits>

#include "simulate/measures.hpp"
#include "simulate/simulate.hpp"

namespace lunid {
namespace {

using Eigen::Index;

/// Runs the tape of a measured channel over the rows of a run.
class MeasureRows {
 public:
  MeasureRows(const System& system, const Tape& tape, std::span<const double> theta)
      : tape_(tape), n_(system.states()), in_(tape.inputs()), out_(tape.outputs()), scratch_(tape.registers() + 1) {
    std::copy(theta.begin(), theta.end(), in_.begin() + 1 + n_);
  }

  /// The value, then its derivatives by the states and by theta.
  const std::vector<double>& row(const Run& run, Index row) {
    in_[0] = run.t0 + run.dt * static_cast<double>(row);
    for (int i = 0; i < n_; ++i) in_[1 + i] = run.x(row, i);
    tape_.run_point(in_.data(), out_.data(), scratch_.data());
    return out_;
  }

 private:
  const Tape& tape_;
  int n_;
  std::vector<double> in_, out_, scratch_;
};

int own_state(const System& system, std::string_view channel) {
  const int state = state_of(system.model(), channel);
  if (state < 0)
    throw InputError("shown: expected a displacement or velocity of the model, got '" + std::string(channel) + "'");
  return state;
}

}  // namespace

int state_of(const Model& model, std::string_view channel) {
  for (int i = 0; i < model.degrees(); ++i) {
    if (channel == model.channel('y', i)) return 2 * i;
    if (channel == model.channel('v', i)) return 2 * i + 1;
  }
  return -1;
}

std::vector<int> shown_states(const System& system, std::string_view channel) {
  const int own = own_state(system, channel);
  for (const auto& [name, map] : system.model().measures) {
    if (name != channel) continue;
    std::vector<int> states;
    for (int i = 0; i < system.states(); ++i)
      if (depends_on(map, system.equations().states[static_cast<std::size_t>(i)])) states.push_back(i);
    return states;
  }
  return {own};
}

Eigen::VectorXd shown(const System& system, std::span<const double> theta, const Run& run, std::string_view channel) {
  const Tape* tape = system.measure(channel);
  if (!tape) return run.x.col(own_state(system, channel));
  MeasureRows rows(system, *tape, theta);
  Eigen::VectorXd out(run.x.rows());
  for (Index row = 0; row < out.size(); ++row) {
    const double value = rows.row(run, row)[0];
    out[row] = run.x.row(row).allFinite() ? value : std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

Eigen::MatrixXd shown_slopes(const System& system, std::span<const double> theta, const SensitivityRun& run,
                             std::string_view channel) {
  const Tape* tape = system.measure(channel);
  if (!tape) return run.dx[static_cast<std::size_t>(own_state(system, channel))];
  const std::vector<int> states = shown_states(system, channel);
  const int n = system.states(), p = system.parameters();
  MeasureRows rows(system, *tape, theta);
  Eigen::MatrixXd out(run.run.x.rows(), p + n);
  for (Index row = 0; row < out.rows(); ++row) {
    const std::vector<double>& values = rows.row(run.run, row);
    out.row(row).setZero();
    for (const int i : states) out.row(row) += values[1 + i] * run.dx[static_cast<std::size_t>(i)].row(row);
    for (int i = 0; i < p; ++i) out(row, i) += values[1 + n + i];
  }
  return out;
}

}  // namespace lunid
