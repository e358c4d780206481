#pragma once
// The equation of motion  m*a + restoring(y, v, z, t) = F  with internal states dz/dt = rate, and its first-order form.
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "expr/tape.hpp"

namespace lunid {

/// A parameter's row in the model's table. The expression node holds only the name.
struct Parameter {
  std::string name;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN: no first guess, read off the data
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string unit;
  bool fixed = false;
  double std = std::numeric_limits<double>::quiet_NaN();  ///< after a fit
};

/// dz/dt = rate(y, v, z, t); starts from `initial`. A bound is a mode: the state is held while the rate pushes outward.
struct InternalState {
  Expr symbol;
  Expr rate;
  double initial = 0;
  Expr min, max;  ///< empty: no bound
};

/// One degree of freedom with internal states. `motion imposed`: y and v are inputs, the output is the force.
struct Model {
  std::shared_ptr<Pool> pool;
  Expr mass;       ///< [kg]; may hold parameters
  Expr restoring;  ///< may be affine in `a`; those terms join the mass
  std::vector<InternalState> states;
  std::vector<Parameter> parameters;
  bool imposed_motion = false;

  const Parameter* find(std::string_view name) const;
  Parameter* find(std::string_view name);
  std::vector<double> values() const;
  void set_values(const std::vector<double>& theta);
  /// "m*a + k*y + c*v = F", one line per internal state below it.
  std::string equation(Format format = Format::plain) const;
};

/// Checks a model and completes its table: every parameter of its expressions gets a row (in order of appearance).
/// Throws InputError: terms not affine in `a`, constant mass <= 0 without imposed motion, a parameter that no
/// expression uses, bounds that cross, a first guess outside its bounds, a state without rate.
Model complete(Model model);

/// The compiled first-order form. State x = (y, v, z...). Tape inputs: (t, F, x..., theta...); with imposed motion
/// (t, y, v, z..., theta...), whose output is the force F and the rates of z.
class System {
 public:
  explicit System(const Model& model);

  int states() const { return n_; }        ///< 2 + internal states
  int parameters() const { return p_; }
  const Model& model() const { return *model_; }

  /// outputs: dx/dt (n)
  const Tape& rate() const { return rate_; }
  /// outputs: dx/dt (n), d(dx/dt)/dx (n*n, row-major), d(dx/dt)/dtheta (n*p, row-major)
  const Tape& rate_with_derivatives() const { return derivatives_; }
  /// outputs, for each switching function of rate(): dg/dx (n), dg/dtheta (p)
  const Tape& switch_gradients() const { return switch_gradients_; }
  /// outputs: force m*a + restoring at inputs (t, a, y, v, z..., theta...)
  const Tape& force() const { return force_; }

 private:
  std::shared_ptr<const Model> model_;
  int n_ = 2, p_ = 0;
  Tape rate_, derivatives_, switch_gradients_, force_;
};

}  // namespace lunid
