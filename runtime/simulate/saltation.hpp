#pragma once
// The linearised motion where the motion changes its mode: it jumps with the rate (saltation: Aizerman & Gantmakher
// 1958; Leine & Nijmeijer 2004, Dynamics and bifurcations of non-smooth mechanical systems, chapter 7). The fixed path,
// CVODES and the adjoint take every jump from here. Internal to this room.
#include <vector>

#include "simulate/modes.hpp"

namespace lunid {

/// Takes the jumps of the linearised motion, each of the form dx += direction * (gx . dx + gtheta . dtheta).
struct JumpSink {
  virtual ~JumpSink() = default;
  virtual void jump(const double* gx, const double* gtheta, const double* direction) = 0;
};

/// Sensitivities of the states to (theta, x0) that take the jumps as they come.
class Sensitivities : public JumpSink {
 public:
  /// Those of a first state: 0 to theta, 1 to itself.
  explicit Sensitivities(const Dynamics& dynamics);
  void jump(const double* gx, const double* gtheta, const double* direction) override;

  const int columns;      ///< p + n
  std::vector<double> s;  ///< n x columns, row-major

 private:
  const int n_, p_;
  std::vector<double> moved_;  ///< of a jump: what its surface moves by, per column
};

/// Decides modes by a ModeMachine and tells a sink the jumps; without a sink only the former.
class Saltation {
 public:
  Saltation(ModeMachine& modes, JumpSink* sink);

  /// ModeMachine::start. What x is set to there (a bound, a surface) no longer depends on the first state.
  void start(const Drive& drive, double* x);
  /// ModeMachine::resolve. `now` is the observation at x, before and after.
  void resolve(int event, const Drive& drive, double* x, Observation& now);
  /// ModeMachine::project.
  void project(const Drive& drive, double* x);

  long grazing = 0;  ///< switches met so flatly that their jump is not to be trusted

 private:
  void cross(double* gradient, const std::vector<double>& before, const std::vector<double>& after);
  void rest(int surface, const Drive& drive, const double* x);
  void hold(const Drive& drive, const double* x);
  void set_on_bound(int bound, const Drive& drive, const double* x);

  ModeMachine& modes_;
  const Dynamics& d_;
  JumpSink* const sink_;
  std::vector<double> gradient_, direction_, before_;
};

}  // namespace lunid
