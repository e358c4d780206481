#pragma once
// A tape of rates that is run in place: its inputs are written straight into its registers, its results are read where
// it leaves them. Internal to this room.
#include <algorithm>
#include <array>
#include <vector>

#include "simulate/fixed.hpp"

namespace lunid {

class RateInPlace {
 public:
  RateInPlace(const FixedProblem& problem, const Tape& tape)
      : tape_(tape),
        timed_(tape.reads(0)),
        bare_(only_speeds_are_copies(*problem.dynamics, tape)),
        code_(bare_ && tape.last_written() == 1 ? tape.point_code() : nullptr),
        inputs_(problem.dynamics->exogenous),
        drive_(problem.drive),
        // with room for loads of whole vectors behind the last result
        registers_(static_cast<std::size_t>(std::max(tape.registers(), tape.inputs()) + 4), 0.0),
        r_(registers_.data()) {
    const Dynamics& d = *problem.dynamics;
    std::copy(problem.theta.begin(), problem.theta.end(), r_ + (d.inputs() - d.p));
    tape.prepare(r_);
  }

  double* state() const noexcept { return r_ + 1 + inputs_; }
  /// The rates of displacements may be missing: they are the speeds.
  const double* results() const noexcept { return results_; }

  /// At the inputs of a node of the stage grid, counted from the start of the record.
  void run(double t, Eigen::Index node) const noexcept {
    load(t, node);
    bare_ ? tape_.run_prepared_without_copies(r_) : tape_.run_prepared(r_);
  }
  /// The same, with the rate of the second state, handed over in a register where that can be.
  double acceleration(double t, Eigen::Index node) const noexcept {
    if (code_) {
      load(t, node);
      return code_(r_);
    }
    run(t, node);
    return results_[1];
  }

 private:
  void load(double t, Eigen::Index node) const noexcept {
    if (timed_) r_[0] = t;
    for (int i = 0; i < inputs_; ++i) r_[1 + i] = drive_[static_cast<std::size_t>(i)][node];
  }
  static bool only_speeds_are_copies(const Dynamics& d, const Tape& tape) {
    for (int i = 0; i < tape.outputs(); ++i)
      if (tape.copy_of(i) >= 0 && !(i < 2 * d.degrees && i % 2 == 0)) return false;
    return true;
  }

  const Tape& tape_;
  bool timed_, bare_;
  Tape::PointCode code_;
  int inputs_;
  std::array<const double*, max_inputs> drive_;
  std::vector<double> registers_;
  double* r_;
  const double* results_ = r_ + tape_.output_place();
};

}  // namespace lunid
