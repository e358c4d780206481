#pragma once
// Which branch of a piecewise smooth system holds, and when that ends. Each surface g = 0 has a mode: on its positive
// side, on its negative side, or sliding along it (Filippov 1988, Differential equations with discontinuous right-hand
// sides): where both sides push towards the surface, the motion stays on it with the convex combination of both rates
// that keeps g = 0. Dry friction sticks so. On a surface of the displacement (a preload sign(y)) the motion can rest in
// the same way: there g = dg/dt = 0, and both sides push back by their accelerations. A bound of a state is a mode too:
// the state is held there while its rate pushes outward. Both integrators, fixed step and SUNDIALS, decide by this one
// class.
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "expr/frozen.hpp"
#include "simulate/dynamics.hpp"

namespace lunid {

/// Time, exogenous inputs and their time derivatives.
struct Drive {
  /// All inputs and their derivatives 0; those beyond `inputs` are left open.
  Drive(double t, int inputs) noexcept : t(t) {
    for (int i = 0; i < inputs; ++i) u[i] = rate[i] = 0;
  }
  double t;
  double u[max_inputs], rate[max_inputs];
};

/// The system at one state, with the event functions of the present mode: an event is the fall of one below zero.
struct Observation {
  std::vector<double> f;      ///< x' (n)
  std::vector<double> event;  ///< per surface, then per bound
  std::vector<double> slope;  ///< time derivative of `event` where it is that of a side or a gap, else NaN
};

/// x' (n), dx'/dx (n*n) and dx'/dtheta (n*p), row-major.
struct Derivatives {
  const double* f;
  const double* jx;
  const double* jtheta;
};

class ModeMachine {
 public:
  /// `dt`: the time over which a surface crossed at full speed counts as a distance: 1e-13 of that is the width within
  /// which a point is on the surface, so that rounding is no event.
  ModeMachine(const Dynamics& dynamics, std::span<const double> theta, double dt);

  int events() const { return static_cast<int>(surfaces_.size() + bounds_.size()); }
  bool sliding() const { return !sliding_.empty(); }
  Observation observation() const;  ///< of the right sizes
  long evaluations = 0;

  /// x' in the present mode: every branch follows its mode also beyond its surface. Where such a branch has no value
  /// (a root of a negative number) each follows the sign of its g instead. No throw, no allocation.
  void rate(const Drive& drive, const double* x, double* f) noexcept;
  /// The same with the event functions.
  void observe(const Drive& drive, const double* x, Observation& out) noexcept;
  /// The same with its derivatives; exact in sliding where g is affine. Valid until the next call.
  Derivatives derivatives(const Drive& drive, const double* x) noexcept;
  /// Derivative of a surface's g or a bound's gap (index as in events) by every input of the rate.
  const double* gradient(int event, const Drive& drive, const double* x) noexcept;

  /// Modes by the sides on which x lies; a state beyond a bound is set on it. Points on a surface are decided as in
  /// resolve().
  void start(const Drive& drive, double* x);
  /// Decides what follows an event at x (crossing, sliding, leaving, held, released); sets x on the surface exactly
  /// when it slides.
  void resolve(int event, const Drive& drive, double* x);
  /// Leaves what no longer holds at x (after a jump of the force or another event).
  void settle(const Drive& drive, double* x);
  /// Takes away what a step has drifted off the sliding surfaces and held bounds.
  void project(const Drive& drive, double* x) noexcept;
  bool needs_projection() const { return drifting_; }

  /// The present mode, so that it can be taken up again.
  struct Mode {
    std::vector<std::int8_t> side;
    std::vector<std::pair<int, int>> sliding;  ///< surface and order
    std::vector<std::uint8_t> held;
    bool operator==(const Mode&) const = default;
  };
  Mode mode() const;
  void take_up(const Mode& mode);

  /// True when the state of a bound is held by the other one: the two bounds have met.
  bool held_by_opposite(int bound) const {
    return bounds_[bound].opposite >= 0 && bounds_[bounds_[bound].opposite].held;
  }
  /// True when reaching this event changes x' by a jump at a time that depends on the motion: a side crossed or slid
  /// upon, a bound reached. Ask before resolve().
  bool jumps(int event) const;
  /// The greatest |dg/dt| met so far.
  double speed(int event) const {
    const int count = static_cast<int>(surfaces_.size());
    return event < count ? surfaces_[event].scale : bounds_[event - count].scale;
  }
  void set_speed(int event, double speed) {
    const int count = static_cast<int>(surfaces_.size());
    (event < count ? surfaces_[event].scale : bounds_[event - count].scale) = speed;
  }
  /// What an event function is raised by for each unit of its speed, so that rounding is no event.
  double width_time() const { return width_time_; }
  /// Beside that.
  static constexpr double least_width = 1e-200;
  /// The side of a surface, +1 or -1.
  int side(int surface) const { return surfaces_[surface].mode; }
  /// No surface is slid upon, no bound held: nothing but the sides of the surfaces makes the mode.
  bool plain() const {
    return !sliding() && std::none_of(bounds_.begin(), bounds_.end(), [](const BoundState& b) { return b.held; });
  }
  bool slides_on(int surface) const { return surfaces_[surface].order != 0; }
  /// True when the motion rests on a surface of the displacement: g = dg/dt = 0.
  bool rests_on(int surface) const { return surfaces_[surface].order == 2; }
  /// The jump of x' across a surface that is slid or rested upon: the direction in which it acts.
  const double* jump_of(int surface) const noexcept;
  /// The derivative of a surface's dg/dt by every input, after gradient().
  const double* rate_gradient(int surface) const noexcept { return row(events() + surface); }
  bool held(int bound) const { return bounds_[bound].held; }
  const Dynamics& dynamics() const { return d_; }

 private:
  struct SurfaceState {
    std::int8_t mode = 1;
    int order = 0;            ///< 1: slides on g = 0; 2: rests on g = dg/dt = 0
    double scale = 0;         ///< largest |dg/dt| met so far
    double second_scale = 0;  ///< the same of d2g/dt2 where it was looked at
  };
  struct BoundState {
    bool held = false;
    int opposite = -1;  ///< the other bound of the same state
    double scale = 0;   ///< largest rate of the gap met so far
  };

  ModeMachine(const ModeMachine&) = delete;
  double* inputs() noexcept { return rate_r_.data(); }
  /// Into the registers of another tape: all but the parameters, which do not change.
  void take_inputs(double* to) const noexcept {
    for (int i = 0; i < 1 + d_.exogenous + d_.n; ++i) to[i] = rate_r_[static_cast<std::size_t>(i)];
  }
  void load(const Drive& drive, const double* x) noexcept;
  void run_rate(const std::vector<std::int8_t>& mode, double* out) noexcept;
  void set_mode(int surface, std::int8_t mode) noexcept;
  void set_sliding(int surface, int order);
  void hold_rates(double* out) const noexcept;
  void hold_derivatives(double* out) const noexcept;
  void refresh_gradients() noexcept;
  const double* row(int index) const noexcept { return gradient_ + static_cast<std::ptrdiff_t>(index) * d_.inputs(); }
  const double* condition(int surface) const noexcept;
  int still_component(int surface) const noexcept;
  double along(const double* gradient, const Drive& drive, const double* f) const noexcept;
  void run(const Drive& drive) noexcept;
  void combine(const Drive& drive) noexcept;
  const double* run_derivatives() noexcept;
  void copy_derivatives(double* out) noexcept;
  void combine_derivatives() noexcept;
  void project_column(double* column, int stride) noexcept;
  bool solve_weights(const Drive& drive) noexcept;
  bool rests(int bound) const noexcept;
  bool decide_rest(int surface, const Drive& drive, const double (&slope)[2]) noexcept;
  void decide(int surface, const Drive& drive, double* x, bool arriving);
  void set_on_surface(int surface, const Drive& drive, double* x) noexcept;
  void set_on_bound(int bound, double* x) noexcept;
  void update_drifting() noexcept;

  const Dynamics& d_;
  const double width_time_;  ///< [s]
  std::vector<SurfaceState> surfaces_;
  std::vector<BoundState> bounds_;
  std::vector<int> sliding_;
  std::vector<std::int8_t> rate_mode_, derivative_mode_, gradient_mode_, free_mode_;  ///< per switch of a tape; free: 0
  bool drifting_ = false;
  FrozenRun run_rate_, run_derivatives_, run_gradients_;
  std::vector<double> rate_r_, derivative_r_, gradient_r_;  ///< registers of the tapes, run in place: inputs first
  const double* g_ = nullptr;                               ///< within rate_r_
  const double* gradient_ = nullptr;                        ///< within gradient_r_
  std::vector<double> plus_;                                ///< rates on the plus side of a surface under decision
  std::vector<double> out_, side_;               ///< rate outputs; of each side slid upon: difference plus - minus
  std::vector<double> full_, full_side_;         ///< the same of the derivatives
  std::vector<double> matrix_, weight_, delta_;  ///< of the sliding condition
};

}  // namespace lunid
