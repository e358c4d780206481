#include "simulate/dynamics.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>

namespace lunid {
namespace {

/// A switching function without its sign and constant factors, so that v, -v and 2*v are one surface.
struct Canonical {
  Expr base;
  int sign = 1;
};

Canonical canonical(Expr g) {
  Canonical c{g, 1};
  for (;;) {
    const auto arguments = c.base.arguments();
    const auto strip = [&](int constant, int other) {
      if (!arguments[constant].is_constant() || !(arguments[constant].value() != 0)) return false;
      if (arguments[constant].value() < 0) c.sign = -c.sign;
      c.base = arguments[other];
      return true;
    };
    if (c.base.op() == Op::neg) {
      c.base = arguments[0];
      c.sign = -c.sign;
    } else if (c.base.op() == Op::mul) {
      if (!strip(0, 1) && !strip(1, 0)) return c;
    } else if (c.base.op() == Op::div) {
      if (!strip(1, 0)) return c;
    } else if (c.base.op() == Op::sub && arguments[0].is_constant(0)) {
      c.base = arguments[1];
      c.sign = -c.sign;
    } else if (c.base.op() == Op::sub && arguments[1].id() < arguments[0].id()) {
      c.base = arguments[1] - arguments[0];
      c.sign = -c.sign;
      if (c.base.op() != Op::sub) continue;
      return c;
    } else {
      return c;
    }
  }
}

/// The surfaces found so far, by their canonical form.
struct SurfaceTable {
  std::vector<Canonical> forms;

  int find(const Canonical& form) const {
    for (std::size_t i = 0; i < forms.size(); ++i)
      if (forms[i].base == form.base) return static_cast<int>(i);
    return -1;
  }
};

/// True when g moves with displacements and t alone.
bool positional(Expr g, const DynamicsSource& s) {
  bool moves = false;
  for (const Expr& symbol : symbols(g)) {
    if (symbol.kind() == SymbolKind::parameter || symbol == s.t) continue;
    const auto state = std::find(s.states.begin(), s.states.end(), symbol) - s.states.begin();
    if (state >= 2 * s.degrees || state % 2 != 0) return false;
    moves = true;
  }
  return moves;
}

void map_rate_switches(Dynamics& d, SurfaceTable& table, const DynamicsSource& source) {
  const auto& functions = d.rate.switching_functions();
  for (std::size_t i = 0; i < functions.size(); ++i) {
    const Canonical form = canonical(functions[i]);
    int surface = table.find(form);
    if (surface < 0) {
      surface = static_cast<int>(table.forms.size());
      table.forms.push_back(form);
      const auto state = std::find(source.states.begin(), source.states.end(), form.base);
      d.surfaces.push_back({functions[i], static_cast<int>(i),
                            state == source.states.end() ? -1 : static_cast<int>(state - source.states.begin()),
                            positional(functions[i], source)});
    }
    d.rate_switches.surface.push_back(surface);
    d.rate_switches.orientation.push_back(form.sign == table.forms[surface].sign ? 1 : -1);
  }
}

Dynamics::SwitchMap map_switches(const Tape& tape, const SurfaceTable& table) {
  Dynamics::SwitchMap map;
  for (const Expr& g : tape.switching_functions()) {
    const Canonical form = canonical(g);
    const int surface = table.find(form);
    map.surface.push_back(surface);
    map.orientation.push_back(surface < 0 || form.sign == table.forms[surface].sign ? 1 : -1);
  }
  return map;
}

Expr total(std::optional<Expr> sum, Expr term) { return sum ? *sum + term : term; }

/// d f / dt along the motion.
Expr time_derivative(Expr f, const DynamicsSource& s) {
  std::optional<Expr> sum;
  const auto add = [&](Expr symbol, Expr rate) {
    if (!depends_on(f, symbol)) return;
    const Expr slope = derivative(f, symbol);
    if (!slope.is_constant(0)) sum = total(sum, slope.is_constant(1) ? rate : slope * rate);
  };
  for (std::size_t i = 0; i < s.states.size(); ++i) add(s.states[i], s.rates[i]);
  for (std::size_t i = 0; i < s.exogenous.size(); ++i)
    if (s.exogenous_rates[i].valid()) add(s.exogenous[i], s.exogenous_rates[i]);
  if (depends_on(f, s.t)) sum = total(sum, derivative(f, s.t));
  return sum ? *sum : f.pool().constant(0);
}

std::vector<Expr> all_inputs(const DynamicsSource& s) {
  std::vector<Expr> inputs{s.t};
  inputs.insert(inputs.end(), s.exogenous.begin(), s.exogenous.end());
  inputs.insert(inputs.end(), s.states.begin(), s.states.end());
  inputs.insert(inputs.end(), s.parameters.begin(), s.parameters.end());
  return inputs;
}

void append_gradient(std::vector<Expr>& outputs, Expr f, std::span<const Expr> inputs) {
  std::unordered_set<std::uint32_t> held;
  for (const Expr& symbol : symbols(f)) held.insert(symbol.id());
  for (const Expr& input : inputs)
    outputs.push_back(held.contains(input.id()) ? derivative(f, input) : f.pool().constant(0));
}

void compile_jacobian(Dynamics& d, const DynamicsSource& s, std::span<const Expr> inputs) {
  std::unordered_map<std::uint32_t, int> place;
  for (int i = 0; i < d.n; ++i) place.emplace(s.states[i].id(), i);
  std::vector<Expr> entries;
  for (int row = 0; row < d.n; ++row) {
    std::map<int, Expr> slopes;
    for (const Expr& symbol : symbols(s.rates[row]))
      if (const auto at = place.find(symbol.id()); at != place.end())
        slopes.emplace(at->second, derivative(s.rates[row], symbol));
    for (const auto& [column, slope] : slopes) {
      if (slope.is_constant(0)) continue;
      d.pattern.push_back({row, column});
      entries.push_back(slope);
    }
  }
  d.jacobian = Tape(entries, inputs);
}

void compile_derivatives(Dynamics& d, const DynamicsSource& s, std::span<const Expr> gap_rates,
                         std::span<const Expr> inputs) {
  std::vector<Expr> outputs = s.rates;
  for (const Expr& rate : s.rates) append_gradient(outputs, rate, s.states);
  for (const Expr& rate : s.rates) append_gradient(outputs, rate, s.parameters);
  for (const Expr& rate : gap_rates) {
    append_gradient(outputs, rate, s.states);
    append_gradient(outputs, rate, s.parameters);
  }
  d.derivatives = Tape(outputs, inputs, s.parameters.size());
}

/// Gradients are dense: beyond this many entries a model has too many switches for its size.
constexpr std::size_t gradient_limit = 4000000;

}  // namespace

Dynamics compile(const DynamicsSource& s) {
  Dynamics d;
  d.exogenous = static_cast<int>(s.exogenous.size());
  d.degrees = s.degrees;
  d.n = static_cast<int>(s.states.size());
  d.p = static_cast<int>(s.parameters.size());
  for (const Expr& x : s.states) d.names.push_back(x.name());
  const std::vector<Expr> inputs = all_inputs(s);

  std::vector<Expr> gaps, gap_rates;
  for (const auto& b : s.bounds) {
    const Expr z = s.states[b.state];
    gaps.push_back(b.side > 0 ? b.bound - z : z - b.bound);
    gap_rates.push_back(time_derivative(gaps.back(), s));
    d.bounds.push_back({b.state, b.side});
  }
  std::vector<Expr> outputs = s.rates;
  outputs.insert(outputs.end(), gaps.begin(), gaps.end());
  outputs.insert(outputs.end(), gap_rates.begin(), gap_rates.end());
  d.rate = Tape(outputs, inputs, s.parameters.size());

  compile_jacobian(d, s, inputs);
  if (d.dense()) compile_derivatives(d, s, gap_rates, inputs);

  SurfaceTable table;
  map_rate_switches(d, table, s);
  if (d.dense()) d.derivative_switches = map_switches(d.derivatives, table);
  if ((d.surfaces.size() + gaps.size()) * inputs.size() > gradient_limit)
    throw InputError("model: " + std::to_string(d.surfaces.size() + gaps.size()) + " switches and bounds over " +
                     std::to_string(d.n) + " states are more than can be located; replace some by smooth terms");

  std::vector<Expr> moving = gaps;
  for (const Surface& surface : d.surfaces) moving.push_back(surface.g);
  for (const Expr& f : moving)
    for (const Expr& u : s.exogenous) d.input_rates |= depends_on(f, u);

  outputs.clear();
  for (const Surface& surface : d.surfaces) append_gradient(outputs, surface.g, inputs);
  for (const Expr& gap : gaps) append_gradient(outputs, gap, inputs);
  for (const Surface& surface : d.surfaces)
    append_gradient(outputs, surface.positional ? time_derivative(surface.g, s) : surface.g.pool().constant(0), inputs);
  for (const Expr& f : outputs)
    for (const Expr& symbol : symbols(f)) d.constant_gradients &= symbol.kind() == SymbolKind::parameter;
  d.gradients = Tape(outputs, inputs, s.parameters.size());
  d.gradient_switches = map_switches(d.gradients, table);
  return d;
}

}  // namespace lunid
