#pragma once
// The backward sweeps of the adjoint. Internal to this room.
#include "simulate/fixed.hpp"
#include "simulate/segment.hpp"

namespace lunid {

/// What flows back: lambda = d cost / d x at the present place, and the gradient by theta so far.
struct Backward {
  Eigen::VectorXd lambda, by_theta;
  long evaluations = 0;
};

/// Back over a completed run without switches, whose rows are `x`, by the tape of Adjoint.
Backward sweep_smooth(const FixedProblem& problem, const Tape& tape, const Eigen::MatrixXd& x,
                      const Eigen::MatrixXd& slope);

/// What a run with switches was made of, in order.
class MotionRecord : public MotionSink {
 public:
  MotionRecord(const Dynamics& dynamics) : d_(dynamics) {}
  void row(Eigen::Index row) { parts_.push_back({Part::row, row}); }
  void step(const ModeMachine& modes, const Segment& segment, double from, double to, const double* x) override;
  void jump(const double* gx, const double* gtheta, const double* direction) override;

  /// Back over it.
  Backward sweep(const FixedProblem& problem, const Eigen::MatrixXd& slope) const;

 private:
  struct Part {
    enum Kind { row, step, jump } kind;
    Eigen::Index index;  ///< the row, or the place among steps or jumps
  };
  struct Step {
    Eigen::Index row;
    int substep;
    std::size_t mode;
    double from, to;
  };
  void back_over(const Step& step, const double* x, const FixedProblem& problem, ModeMachine& modes,
                 Backward& back) const;
  void back_over_jump(const double* values, Backward& back) const;

  const Dynamics& d_;
  std::vector<Part> parts_;
  std::vector<Step> steps_;
  std::vector<ModeMachine::Mode> modes_;
  std::vector<double> states_, jumps_;  ///< n per step; gx, gtheta, direction per jump
};

}  // namespace lunid
