#include "simulate/measures.hpp"

#include <algorithm>

namespace lunid {
namespace {

/// A*x + B, A and B of t and parameters alone; an empty A where it is not that.
struct Line {
  Expr slope, rest;
};

Line line_in(Pool& pool, Expr f, Expr x) {
  const Expr slope = derivative(f, x);
  const std::pair<Expr, Expr> zero[] = {{x, pool.constant(0)}};
  const Expr rest = substitute(f, zero);
  for (const Expr part : {slope, rest})
    for (const Expr& symbol : symbols(part))
      if (symbol.kind() != SymbolKind::parameter && symbol.name() != "t") return {};
  return slope.is_constant(0) ? Line{} : Line{slope, rest};
}

Expr sum(Expr a, Expr b) { return a.is_constant(0) ? b : b.is_constant(0) ? a : a + b; }
Expr product(Expr a, Expr b) {
  return a.is_constant(0) || b.is_constant(0) ? a.pool().constant(0)
         : a.is_constant(1)                   ? b
         : b.is_constant(1)                   ? a
                                              : a * b;
}

/// What the displacement of a coordinate shows of itself; an empty slope where that is itself, or cannot be undone.
Line shown_displacement(const Model& model, int i) {
  for (const auto& [channel, map] : model.measures)
    if (channel == model.channel('y', i)) return line_in(*model.pool, map, model.pool->channel(channel));
  return {};
}

}  // namespace

std::vector<std::pair<Expr, Expr>> undo_measures(const Model& model) {
  Pool& pool = *model.pool;
  std::vector<std::pair<Expr, Expr>> out;
  for (int i = 0; i < model.degrees(); ++i) {
    const Line shown = shown_displacement(model, i);
    if (!shown.slope.valid()) continue;
    const Expr t = pool.channel("t"), y = pool.channel(model.channel('y', i)), v = pool.channel(model.channel('v', i)),
               a = pool.channel(model.channel('a', i));
    const Expr difference = shown.rest.is_constant(0) ? y : y - shown.rest;
    const Expr true_y = shown.slope.is_constant(1) ? difference : difference / shown.slope;
    const Expr true_v = sum(product(derivative(true_y, y), v), derivative(true_y, t));
    const Expr true_a =
        sum(sum(product(derivative(true_v, v), a), product(derivative(true_v, y), v)), derivative(true_v, t));
    out.insert(out.end(), {{y, true_y}, {v, true_v}, {a, true_a}});
  }
  return out;
}

Expr undo_acts(const Model& model, int coordinate, Expr acting) {
  for (const auto& [channel, map] : model.acts) {
    if (channel != model.channel('F', coordinate)) continue;
    const Line line = line_in(*model.pool, map, model.pool->channel(channel));
    if (!line.slope.valid()) continue;
    const Expr rest = line.rest.is_constant(0) ? acting : acting - line.rest;
    return line.slope.is_constant(1) ? rest : rest / line.slope;
  }
  return acting;
}

bool can_be_undone(const Model& model) {
  for (const auto& [channel, map] : model.measures) {
    const int state = state_of(model, channel);
    if (state % 2 != 0 || !shown_displacement(model, state / 2).slope.valid()) return false;
  }
  for (const auto& [channel, map] : model.acts)
    if (!line_in(*model.pool, map, model.pool->channel(channel)).slope.valid()) return false;
  return true;
}

Model without_unfelt_states(Model model) {
  std::vector<Expr> felt{model.mass, model.restoring};
  for (const Coordinate& row : model.further) felt.insert(felt.end(), {row.mass, row.restoring});
  std::vector<std::uint8_t> keep(model.states.size(), 0);
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < model.states.size(); ++i) {
      const InternalState& z = model.states[i];
      if (keep[i] || std::none_of(felt.begin(), felt.end(), [&](Expr f) { return depends_on(f, z.symbol); })) continue;
      for (const Expr part : {z.rate, z.min, z.max})
        if (part.valid()) felt.push_back(part);
      keep[i] = again = true;
    }
  }
  std::vector<InternalState> states;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) states.push_back(model.states[i]);
  model.states = std::move(states);
  return model;
}

}  // namespace lunid
