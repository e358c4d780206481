#include "simulate/inertia.hpp"
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

/// y' = v, v' = (F - f) / m with the terms in a moved to the mass; a in a state's rate is that same v'.
DynamicsSource free_motion(const Model& model, Expr inertia, Expr force) {
  Pool& pool = *model.pool;
  DynamicsSource source;
  source.t = pool.channel("t");
  source.exogenous = {pool.channel("F")};
  source.exogenous_rates = {Expr()};
  source.states = {pool.channel("y"), pool.channel("v")};
  const Expr f = force.is_constant(0) ? source.exogenous[0] : source.exogenous[0] - force;
  const Expr acceleration = f / inertia;
  source.rates = {pool.channel("v"), acceleration};
  add_internal_states(source, model);
  const std::pair<Expr, Expr> replacement{pool.channel("a"), acceleration};
  for (Expr& rate : source.rates) rate = substitute(rate, std::span(&replacement, 1));
  source.parameters = parameter_symbols(model);
  return source;
}

DynamicsSource imposed_motion(const Model& model) {
  Pool& pool = *model.pool;
  DynamicsSource source;
  source.t = pool.channel("t");
  source.exogenous = {pool.channel("y"), pool.channel("v"), pool.channel("a")};
  source.exogenous_rates = {pool.channel("v"), pool.channel("a"), Expr()};
  add_internal_states(source, model);
  source.parameters = parameter_symbols(model);
  return source;
}

bool rates_hold_force(const Model& model) {
  const Expr force = model.pool->channel("F");
  for (const InternalState& z : model.states)
    if (depends_on(z.rate, force)) return true;
  return false;
}

}  // namespace

System::System(const Model& given) : model_(std::make_shared<const Model>(complete(given))) {
  const Model& model = *model_;
  Pool& pool = *model.pool;
  n_ = 2 + static_cast<int>(model.states.size());
  p_ = static_cast<int>(model.parameters.size());
  const auto [added, force] = split_inertia(model.restoring, pool.channel("a"));
  const Expr inertia = added.valid() ? model.mass + added : model.mass;

  if (!rates_hold_force(model)) imposed_ = std::make_shared<const Dynamics>(compile(imposed_motion(model)));
  if (!model.imposed_motion)
    free_ = std::make_shared<const Dynamics>(compile(free_motion(model, inertia, force)));
  else if (!imposed_)
    throw InputError("model: the rate of a state holds F, which is the output where the motion is imposed");

  std::vector<Expr> inputs{pool.channel("t"), pool.channel("a"), pool.channel("y"), pool.channel("v")};
  for (const InternalState& z : model.states) inputs.push_back(z.symbol);
  for (const Expr& theta : parameter_symbols(model)) inputs.push_back(theta);
  const Expr whole = model.mass.is_constant(0) ? model.restoring : model.mass * pool.channel("a") + model.restoring;
  force_ = Tape(std::span(&whole, 1), inputs);
  std::vector<Expr> outputs{whole};
  for (std::size_t i = 4; i < inputs.size(); ++i) outputs.push_back(derivative(whole, inputs[i]));
  force_with_derivatives_ = Tape(outputs, inputs);
  inertia_ = Tape(std::span(&inertia, 1), inputs);
  terms_ = summands(model.restoring);
  term_values_ = Tape(terms_, inputs);
  needs_acceleration_ = depends_on(whole, pool.channel("a"));
  for (const InternalState& z : model.states) needs_acceleration_ |= depends_on(z.rate, pool.channel("a"));
}

}  // namespace lunid
