#pragma once
// A compiled first-order system x' = f(t, u, x; theta) with exogenous inputs u: what the integrators work on.
#include <cstdint>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "expr/tape.hpp"

namespace lunid {

/// Inputs that can drive a system at most, forces and base motion together.
inline constexpr int max_inputs = 16;

/// A surface g(t, u, x; theta) = 0 on which the right-hand side changes its branch.
struct Surface {
  Expr g;
  int switch_index = 0;  ///< the switch of rate() whose value is g
  int component = -1;    ///< g is this state, up to a constant factor; -1: it is not a single state
  /// g depends on displacements and t alone: its rate is continuous, and rest on it has g = dg/dt = 0
  bool positional = false;
};

/// A bound of a state: gap = side * (bound - state) >= 0. side +1: max, -1: min.
struct StateBound {
  int state = 0;
  int side = 1;
};

/// What the integrators need, all on the inputs (t, u..., x..., theta...).
struct Dynamics {
  int exogenous = 0;  ///< inputs u: forces and base motion (System::inputs), or (y, v, a) with imposed motion
  int degrees = 0;    ///< the first 2 * degrees states are (y1, v1, y2, v2, ...); 0 with imposed motion
  int n = 0;          ///< states x
  int p = 0;          ///< parameters theta
  Tape rate;          ///< x' (n), gap of each bound, rate of each gap (bounds not held)
  /// x' (n), dx'/dx (n*n), dx'/dtheta (n*p), then per bound d(gap rate)/dx (n) and /dtheta (p); matrices row-major.
  /// Up to dense_limit states; beyond them there are no sensitivities.
  Tape derivatives;
  /// The entries of dx'/dx that are not zero everywhere, by rows, and where they stand.
  Tape jacobian;
  struct Entry {
    int row, column;
  };
  std::vector<Entry> pattern;
  /// The derivative by every input, in their order: of g per surface, of the gap per bound, of dg/dt per surface (zero
  /// where it is not positional)
  Tape gradients;
  bool constant_gradients = true;  ///< gradients depend on theta alone
  bool input_rates = false;        ///< a surface or a bound moves with an exogenous input
  std::vector<Surface> surfaces;
  std::vector<StateBound> bounds;
  std::vector<std::string> names;  ///< of the states

  /// One entry per switch of a tape: mode = orientation * mode of its surface; surface -1: branch by the sign of g.
  struct SwitchMap {
    std::vector<int> surface;
    std::vector<std::int8_t> orientation;
  };
  SwitchMap rate_switches, derivative_switches, gradient_switches;

  static constexpr int dense_limit = 64;
  bool dense() const { return n <= dense_limit; }
  int inputs() const { return 1 + exogenous + n + p; }
  bool smooth() const { return surfaces.empty() && bounds.empty(); }
};

/// States with their rates and bounds, and the symbols that drive them.
struct DynamicsSource {
  int degrees = 0;
  Expr t;
  std::vector<Expr> exogenous, exogenous_rates;  ///< rates: the symbol's time derivative where it is known, or empty
  std::vector<Expr> states, rates;
  struct Bound {
    int state;
    int side;
    Expr bound;
  };
  std::vector<Bound> bounds;
  std::vector<Expr> parameters;
};
/// Throws InputError when the switches are too many for the states.
Dynamics compile(const DynamicsSource& source);

}  // namespace lunid
