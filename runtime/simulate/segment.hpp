#pragma once
// One substep of the fixed path, with its inputs at any part of it; and who is told what the path is made of.
#include "simulate/dormand_prince.hpp"
#include "simulate/fixed.hpp"
#include "simulate/saltation.hpp"

namespace lunid {

/// Time, length, and the inputs at the places of the stages, the end the last.
class Segment {
 public:
  static constexpr int places = dormand_prince::nodes + 1;

  double t = 0, h = 0;
  Eigen::Index row = 0;
  int substep = 0;
  int exogenous = 0;
  double input[max_inputs][places];

  /// At the place of a stage of the whole substep.
  Drive at_node(int node) const noexcept {
    Drive d(t + dormand_prince::place[node] * h, exogenous);
    for (int i = 0; i < exogenous; ++i) d.u[i] = input[i][node];
    return d;
  }
  /// The polynomial through all places, at the part s of the substep.
  Drive drive(double s) noexcept;
  /// The same with the time derivatives of the inputs.
  Drive drive_with_rates(double s) noexcept;

 private:
  Drive within(double s) noexcept;
  const double* polynomial(int i) noexcept;

  bool known_ = false;
  double coefficient_[max_inputs][places];
};

/// Substep `substep` after a row; after the last row one of constant inputs.
Segment segment_of(const FixedProblem& problem, Eigen::Index row, int substep) noexcept;

/// The input at a stage of the step from one part of the substep to another.
Drive stage_drive(Segment& segment, double from, double to, int stage) noexcept;

/// Receives every step that a run with switches takes, and every jump of the linearised motion, in order.
struct MotionSink : JumpSink {
  /// From x at the part `from` of the segment to its part `to`, in the present mode.
  virtual void step(const ModeMachine& modes, const Segment& segment, double from, double to, const double* x) = 0;
};

}  // namespace lunid
