#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "simulate/inertia.hpp"
#include "simulate/measures.hpp"
#include "simulate/model.hpp"

namespace lunid {
namespace {

std::vector<Expr> parameter_symbols(const Model& model) {
  std::vector<Expr> theta;
  for (const Parameter& p : model.parameters) theta.push_back(model.pool->parameter(p.name));
  return theta;
}

void add_internal_states(DynamicsSource& source, const Model& model) {
  for (const InternalState& z : model.states) {
    const int index = static_cast<int>(source.states.size());
    source.states.push_back(z.symbol);
    source.rates.push_back(z.rate);
    if (z.min.valid()) source.bounds.push_back({index, -1, z.min});
    if (z.max.valid()) source.bounds.push_back({index, 1, z.max});
  }
}

/// The time derivative of an input where it is another one, or an empty Expr.
Expr input_rate(Pool& pool, const std::vector<std::string>& inputs, const std::string& name) {
  const std::string rate = name == "yb" ? "vb" : name == "vb" ? "ab" : "";
  const bool there = std::find(inputs.begin(), inputs.end(), rate) != inputs.end();
  return there ? pool.channel(rate) : Expr();
}

/// What acts on the driven coordinates, of what their channels show. A delayed force is an input that is shifted
/// already; F + F' (shifted - delay), with its rate and the shift as further inputs, has that value and the exact
/// derivative by the delay.
std::vector<Expr> delayed_forces(const Model& model, DynamicsSource& source) {
  Pool& pool = *model.pool;
  std::vector<Expr> forces(source.exogenous.begin(),
                           source.exogenous.begin() + static_cast<std::ptrdiff_t>(model.driven.size()));
  const auto acting = [&] {
    for (const auto& [channel, map] : model.acts)
      for (std::size_t i = 0; i < model.driven.size(); ++i) {
        if (channel != model.channel('F', model.driven[i])) continue;
        const std::pair<Expr, Expr> replacement[] = {{pool.channel(channel), forces[i]}};
        forces[i] = substitute(map, replacement);
      }
    return forces;
  };
  if (!model.delay.valid()) return acting();
  const Expr shifted = pool.state("delay_now");
  for (Expr& force : forces) {
    const Expr rate = pool.state("rate_of_" + force.name());
    source.exogenous.push_back(rate);
    source.exogenous_rates.emplace_back();
    force = force + rate * (shifted - model.delay);
  }
  source.exogenous.push_back(shifted);
  source.exogenous_rates.emplace_back();
  return acting();
}

/// y' = v, v' = M^-1 (F - f) with the terms in a moved to the mass; a in a state's rate is that same v'.
DynamicsSource free_motion(const Model& model, const std::vector<InertiaRow>& rows,
                           const std::vector<std::string>& inputs) {
  Pool& pool = *model.pool;
  DynamicsSource source;
  source.degrees = model.degrees();
  source.t = pool.channel("t");
  for (const std::string& input : inputs) {
    source.exogenous.push_back(pool.channel(input));
    source.exogenous_rates.push_back(input_rate(pool, inputs, input));
  }
  std::vector<Expr> right;
  const std::vector<Expr> delayed = delayed_forces(model, source);
  for (int i = 0; i < model.degrees(); ++i) {
    const Expr force = rows[i].force;
    const auto at = std::find(model.driven.begin(), model.driven.end(), i) - model.driven.begin();
    const bool driven = at < static_cast<std::ptrdiff_t>(model.driven.size());
    const Expr applied = driven ? delayed[static_cast<std::size_t>(at)] : pool.constant(0);
    right.push_back(force.is_constant(0) ? applied : driven ? applied - force : -force);
  }
  const std::vector<Expr> accelerations = solve_accelerations(rows, right);
  std::vector<std::pair<Expr, Expr>> replacements;
  for (int i = 0; i < model.degrees(); ++i) {
    const Expr v = pool.channel(model.channel('v', i));
    source.states.push_back(pool.channel(model.channel('y', i)));
    source.states.push_back(v);
    source.rates.push_back(v);
    source.rates.push_back(accelerations[i]);
    replacements.emplace_back(pool.channel(model.channel('a', i)), accelerations[i]);
  }
  add_internal_states(source, model);
  for (std::size_t i = 2 * accelerations.size(); i < source.rates.size(); ++i)
    source.rates[i] = substitute(source.rates[i], replacements);
  source.parameters = parameter_symbols(model);
  return source;
}

DynamicsSource imposed_motion(const Model& model) {
  Pool& pool = *model.pool;
  DynamicsSource source;
  source.t = pool.channel("t");
  for (int i = 0; i < model.degrees(); ++i) {
    const Expr v = pool.channel(model.channel('v', i)), a = pool.channel(model.channel('a', i));
    for (const Expr& input : {pool.channel(model.channel('y', i)), v, a}) source.exogenous.push_back(input);
    for (const Expr& rate : {v, a, Expr()}) source.exogenous_rates.push_back(rate);
  }
  for (const std::string& side : model.sides()) {
    source.exogenous.push_back(pool.channel(side));
    source.exogenous_rates.emplace_back();
  }
  add_internal_states(source, model);
  if (const auto undone = undo_measures(model); model.imposed_motion && !undone.empty()) {
    for (Expr& rate : source.rates) rate = substitute(rate, undone);
    for (auto& bound : source.bounds) bound.bound = substitute(bound.bound, undone);
  }
  source.parameters = parameter_symbols(model);
  return source;
}

/// A displacement, velocity or acceleration of a coordinate.
bool is_motion(const Model& model, const std::string& channel) {
  for (int i = 0; i < model.degrees(); ++i)
    for (const char quantity : {'y', 'v', 'a'})
      if (channel == model.channel(quantity, i)) return true;
  return false;
}

/// True when states follow a force.
bool rates_hold_force(const Model& model) {
  const std::vector<std::string> sides = model.sides();
  for (const InternalState& z : model.states)
    for (const Expr& symbol : symbols(z.rate, SymbolKind::channel))
      if (symbol.name() != "t" && !is_motion(model, symbol.name()) &&
          std::find(sides.begin(), sides.end(), symbol.name()) == sides.end())
        return true;
  return false;
}

}  // namespace

System::System(const Model& given)
    : model_(std::make_shared<const Model>(given.imposed_motion ? without_unfelt_states(complete(given))
                                                                : complete(given))) {
  const Model& model = *model_;
  Pool& pool = *model.pool;
  degrees_ = model.degrees();
  n_ = 2 * degrees_ + static_cast<int>(model.states.size());
  p_ = static_cast<int>(model.parameters.size());
  const std::vector<InertiaRow> rows = inertia_rows(model);

  if ((degrees_ == 1 || model.imposed_motion) && !rates_hold_force(model))
    imposed_ = std::make_shared<const Dynamics>(compile(imposed_motion(model)));
  inputs_ = model.inputs();
  if (!model.imposed_motion) {
    equations_ = free_motion(model, rows, inputs_);
    free_ = std::make_shared<const Dynamics>(compile(equations_));
  } else if (!imposed_) {
    throw InputError("model: the rate of a state holds F, which is the output where the motion is imposed");
  }

  if (model.delay.valid()) delay_ = Tape(std::span(&model.delay, 1), parameter_symbols(model));

  std::vector<Expr> inputs{pool.channel("t")};
  for (int i = 0; i < degrees_; ++i) inputs.push_back(pool.channel(model.channel('a', i)));
  for (int i = 0; i < degrees_; ++i) {
    inputs.push_back(pool.channel(model.channel('y', i)));
    inputs.push_back(pool.channel(model.channel('v', i)));
  }
  for (const InternalState& z : model.states) inputs.push_back(z.symbol);
  for (const std::string& side : model.sides()) inputs.push_back(pool.channel(side));
  for (const Expr& theta : parameter_symbols(model)) inputs.push_back(theta);
  compile_forces(rows, inputs);
  compile_measures();
}

void System::compile_measures() {
  const Model& model = *model_;
  if (model.imposed_motion) return;
  std::vector<Expr> inputs{model.pool->channel("t")};
  inputs.insert(inputs.end(), equations_.states.begin(), equations_.states.end());
  for (int i = 0; i < degrees_; ++i) inputs.push_back(model.pool->channel(model.channel('a', i)));
  inputs.insert(inputs.end(), equations_.parameters.begin(), equations_.parameters.end());
  for (const auto& [channel, map] : model.measures) {
    std::vector<Expr> outputs{map};
    for (std::size_t i = 1; i < inputs.size(); ++i) outputs.push_back(derivative(map, inputs[i]));
    measures_.emplace_back(channel, Tape(outputs, inputs));
  }
}

const Tape* System::measure(std::string_view channel) const {
  for (const auto& [name, tape] : measures_)
    if (name == channel) return &tape;
  return nullptr;
}

double System::delay(std::span<const double> theta) const {
  if (!model_->delay.valid()) return 0;
  std::vector<double> scratch(delay_.registers() + 1);
  double value = 0;
  delay_.run_point(theta.data(), &value, scratch.data());
  if (!(value >= 0) || !std::isfinite(value))
    throw InputError("simulate: delay: expected a finite value >= 0, got " + number(value));
  return value;
}

/// The tapes of the force side: the whole, its derivatives, the masses and the single terms.
void System::compile_forces(const std::vector<InertiaRow>& rows, const std::vector<Expr>& inputs) {
  const Model& model = *model_;
  std::vector<Expr> whole, masses, terms;
  for (int i = 0; i < degrees_; ++i) {
    const auto [mass, restoring] = model.coordinate(i);
    const Expr a = model.pool->channel(model.channel('a', i));
    whole.push_back(mass.is_constant(0) ? restoring : mass * a + restoring);
    masses.push_back(rows[i].mass.at(i));
    for (const Expr& term : summands(restoring)) {
      terms_.push_back({i, term});
      terms.push_back(term);
    }
  }
  if (model.imposed_motion) {
    const auto undone = undo_measures(model);
    for (int i = 0; i < degrees_; ++i) {
      Expr& force = whole[static_cast<std::size_t>(i)];
      force = undo_acts(model, i, force);
      if (!undone.empty()) force = substitute(force, undone);
    }
  }
  force_ = Tape(whole, inputs);
  inertia_ = Tape(masses, inputs);
  term_values_ = Tape(terms, inputs);
  if (degrees_ > 1 && !model.imposed_motion) return;
  std::vector<Expr> outputs = whole;
  for (const Expr& force : whole)
    for (std::size_t i = 1 + 3 * whole.size(); i < inputs.size(); ++i) outputs.push_back(derivative(force, inputs[i]));
  force_with_derivatives_ = Tape(outputs, inputs);
  if (degrees_ > 1) return;
  const Expr a = model.pool->channel("a");
  needs_acceleration_ = depends_on(whole[0], a);
  for (const InternalState& z : model.states) needs_acceleration_ |= depends_on(z.rate, a);
}

}  // namespace lunid
