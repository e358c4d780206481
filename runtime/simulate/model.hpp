#pragma once
// The equation of motion  m*a + restoring(y, v, z, t) = F,  one for each coordinate, with internal states dz/dt = rate,
// and its first-order form.
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "expr/tape.hpp"
#include "record/record.hpp"
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

  /// "k = 5e+04 +- 3 N/m", "k = 5e+04 N/m (fixed)", "k [N/m]: to fit, ..." where there is no value yet.
  std::string words() const;
};

/// dz/dt = rate(y, v, z, t); starts from `initial`. A bound is a mode: the state is held while the rate pushes outward.
/// `anchored`: of a state that only adds up (a path, a work done) no record tells where it began from what the
/// parameters were there, so that a fit takes it to be at `initial` where the first record begins.
struct InternalState {
  Expr symbol;
  Expr rate;
  double initial = 0;
  Expr min, max;  ///< empty: no bound
  bool anchored = false;
};

/// One row of the equation of motion: mass_i a_i + restoring_i = F_i.
struct Coordinate {
  Expr mass;       ///< [kg]; may hold parameters, y, v and t
  Expr restoring;  ///< may be affine in the accelerations: such terms join the mass matrix
};

/// A channel and what is known of it.
struct ChannelMap {
  std::string channel;
  Expr map;
};

/// An equation of motion with internal states. One degree of freedom is written in y v a F; several in y1 v1 a1 F1,
/// y2 ... All may hold the motion of a base, yb vb ab, and that of a shaft, shaft_angle shaft_speed shaft_rate. `motion
/// imposed`: y and v are inputs, the output is the force.
struct Model {
  std::shared_ptr<Pool> pool;
  Expr mass;                        ///< of the first coordinate; see Coordinate
  Expr restoring;                   ///< of the first coordinate
  std::vector<Coordinate> further;  ///< those of y2, y3 ...
  std::vector<int> driven;          ///< coordinates that a force acts on, from 0; empty: all
  Expr delay;                       ///< [s] >= 0, of parameters alone: the forces act so much later; empty: none
  std::vector<InternalState> states;
  /// What the channels of the motion show in a record, where it is not their true value: {"y", y + b}. Of t, all y v a
  /// z, and parameters.
  std::vector<ChannelMap> measures;
  /// The forces that act, where they are not what their channels show: {"F", g*F}, or {"F", F*(1 - b*y^2)} of a coil
  /// that leaves its field. Of t, y v, parameters, the channel, in which it is affine, and force_rate, the channel's
  /// time derivative (where one coordinate is driven).
  std::vector<ChannelMap> acts;
  std::vector<Parameter> parameters;
  bool imposed_motion = false;
  /// What recorded forces do between their rows, where neither the call nor the record says it; none: straight lines.
  std::optional<Interpolation> interpolation;

  int degrees() const { return 1 + static_cast<int>(further.size()); }
  Coordinate coordinate(int i) const { return i == 0 ? Coordinate{mass, restoring} : further[i - 1]; }
  /// "y" with one degree of freedom, else "y1", "y2" ...; the same for v, a, F. i counts from 0.
  std::string channel(char quantity, int i) const;

  /// The channels that drive it: the forces of the driven coordinates, then those of a base, of a shaft and of
  /// force_rate that it holds. Of a complete model (complete()). With imposed motion those of base and shaft alone.
  std::vector<std::string> inputs() const;
  std::vector<std::string> sides() const;  ///< of these the motion of a base and of a shaft

  const Parameter* find(std::string_view name) const;
  Parameter* find(std::string_view name);
  std::vector<double> values() const;
  void set_values(const std::vector<double>& theta);
  /// "m*a + k*y + c*v = F", one line per internal state below it.
  std::string equation(Format format = Format::plain) const;
};

/// Checks a model and completes its table: every parameter of its expressions gets a row (in order of appearance).
/// Throws InputError: terms not affine in `a`, constant mass <= 0 without imposed motion, a channel of a coordinate
/// that there is not, a parameter that no expression uses, bounds that cross, a first guess outside its bounds, a state
/// without rate.
Model complete(Model model);

struct InertiaRow;

/// The compiled first-order form; immutable, so that threads may share it. State x = (y, v, z...), with several
/// coordinates (y1, v1, y2, v2, ..., z...). Tape inputs: (t, u..., x..., theta...) where u are the forces F (F1, F2 ...
/// of the driven coordinates), then those of yb vb ab that the model holds; with imposed motion (t, y, v, a, z...,
/// theta...), where the integrated states are z alone; with several coordinates (t, y1, v1, a1, y2, ...).
class System {
 public:
  /// Completes the model first (complete()), with its errors. Changes the model's pool.
  explicit System(const Model& model);

  int states() const { return n_; }  ///< 2 per coordinate + internal states
  int degrees() const { return degrees_; }
  int parameters() const { return p_; }
  /// The channels that drive the model, in the order of the inputs u: "F", or "F1" "F2" ..., then "yb" "vb" "ab" and
  /// further ones (Model::inputs). With a delay the rates of the forces and the delay itself stand behind them
  /// (Excitations::of).
  const std::vector<std::string>& inputs() const { return inputs_; }
  const Model& model() const { return *model_; }

  /// x' = f(t, u, x; theta) as the integrators see it: the free motion, or with imposed motion the states z.
  const Dynamics& dynamics() const { return free_ ? *free_ : *imposed_; }
  /// The delay of the forces at these parameters; 0 without one. Throws InputError when it is negative or not finite.
  double delay(std::span<const double> theta) const;
  /// The equations that dynamics() was compiled from; of a free motion.
  const DynamicsSource& equations() const { return equations_; }
  /// The states z driven by measured (y, v, a); nullptr when a rate holds F.
  const Dynamics* imposed() const { return imposed_.get(); }

  /// outputs: x' (n integrated states), then what state bounds need (Dynamics)
  const Tape& rate() const { return dynamics().rate; }
  /// outputs: x' (n), dx'/dx (n*n, row-major), dx'/dtheta (n*p, row-major), then what state bounds need
  const Tape& rate_with_derivatives() const { return dynamics().derivatives; }
  /// outputs: per coordinate the force m*a + restoring at inputs (t, a..., x..., u..., theta...), with u the base
  /// motion that the model holds; with one coordinate and no base: (t, a, y, v, z..., theta...)
  const Tape& force() const { return force_; }
  /// outputs: these forces, then of each its derivatives by each z and by each theta; inputs as force(). With one
  /// coordinate, or with imposed motion, where both are of the channels as they show it (undo_measures, undo_acts).
  const Tape& force_with_derivatives() const { return force_with_derivatives_; }
  /// What a channel of the motion shows where it is not its state (Model::measures): the value, its derivatives by each
  /// state, each a and each theta; inputs (t, x..., a..., theta...). nullptr: it shows its state.
  const Tape* measure(std::string_view channel) const;
  /// output: per coordinate the mass that multiplies its a, terms of the restoring force included; inputs as force()
  const Tape& inertia() const { return inertia_; }
  /// A summand of the restoring force of a coordinate.
  struct Term {
    int coordinate;
    Expr expression;
  };
  /// The restoring forces as a list of summands, and one output for each; inputs as force()
  const std::vector<Term>& terms() const { return terms_; }
  const Tape& term_values() const { return term_values_; }
  /// True when the force of an imposed motion depends on the acceleration.
  bool needs_acceleration() const { return needs_acceleration_; }

 private:
  std::shared_ptr<const Model> model_;
  void compile_forces(const std::vector<InertiaRow>& rows, const std::vector<Expr>& inputs);
  void compile_measures();

  int n_ = 2, degrees_ = 1, p_ = 0;
  std::vector<std::string> inputs_;
  Tape delay_;
  DynamicsSource equations_;
  std::shared_ptr<const Dynamics> free_, imposed_;
  Tape force_, force_with_derivatives_, inertia_, term_values_;
  std::vector<std::pair<std::string, Tape>> measures_;
  std::vector<Term> terms_;
  bool needs_acceleration_ = true;
};

/// The rates x' = f(t, u, x, p) of a free motion as a function in C, with the names of all it takes. Throws InputError
/// for an imposed motion, a bounded state (a mode that a plain right-hand side cannot hold) or a name that is a word of
/// C.
std::string c_code(const System& system);

}  // namespace lunid
