#pragma once
// The equation of motion  m*a + restoring(y, v, z, t) = F  with internal states dz/dt = rate, and its first-order form.
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "expr/tape.hpp"
#include "simulate/dynamics.hpp"

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

/// The compiled first-order form; immutable, so that threads may share it. State x = (y, v, z...). Tape inputs:
/// (t, F, x..., theta...); with imposed motion (t, y, v, a, z..., theta...), where the integrated states are z alone.
class System {
 public:
  /// Completes the model first (complete()), with its errors. Changes the model's pool.
  explicit System(const Model& model);

  int states() const { return n_; }  ///< 2 + internal states
  int parameters() const { return p_; }
  const Model& model() const { return *model_; }

  /// x' = f(t, u, x; theta) as the integrators see it: the free motion, or with imposed motion the states z.
  const Dynamics& dynamics() const { return free_ ? *free_ : *imposed_; }
  /// The states z driven by measured (y, v, a); nullptr when a rate holds F.
  const Dynamics* imposed() const { return imposed_.get(); }

  /// outputs: x' (n integrated states), then what state bounds need (Dynamics)
  const Tape& rate() const { return dynamics().rate; }
  /// outputs: x' (n), dx'/dx (n*n, row-major), dx'/dtheta (n*p, row-major), then what state bounds need
  const Tape& rate_with_derivatives() const { return dynamics().derivatives; }
  /// outputs, for each switching surface: the derivative of g by every input of rate(), in their order
  const Tape& switch_gradients() const { return dynamics().gradients; }
  /// outputs: force m*a + restoring at inputs (t, a, y, v, z..., theta...)
  const Tape& force() const { return force_; }
  /// outputs: that force, its derivatives by each z and by each theta; inputs as force()
  const Tape& force_with_derivatives() const { return force_with_derivatives_; }
  /// output: the mass that multiplies a, terms of the restoring force included; inputs as force()
  const Tape& inertia() const { return inertia_; }
  /// The restoring force as a list of summands, and one output for each; inputs as force()
  const std::vector<Expr>& terms() const { return terms_; }
  const Tape& term_values() const { return term_values_; }
  /// True when the force of an imposed motion depends on the acceleration.
  bool needs_acceleration() const { return needs_acceleration_; }

 private:
  std::shared_ptr<const Model> model_;
  int n_ = 2, p_ = 0;
  std::shared_ptr<const Dynamics> free_, imposed_;
  Tape force_, force_with_derivatives_, inertia_, term_values_;
  std::vector<Expr> terms_;
  bool needs_acceleration_ = true;
};

}  // namespace lunid
