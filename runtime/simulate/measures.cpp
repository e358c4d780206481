#include "simulate/measures.hpp"

#include <algorithm>

namespace lunid {
namespace {

/// A*x + B; an empty A where it is not that.
struct Line {
  Expr slope, rest;
};

/// A and B of parameters and the channels of these quantities.
Line line_in(Pool& pool, Expr f, Expr x, std::string_view quantities) {
  const Expr slope = derivative(f, x);
  const std::pair<Expr, Expr> zero[] = {{x, pool.constant(0)}};
  const Expr rest = substitute(f, zero);
  const auto may_hold = [&](const Expr& symbol) {
    const bool is_channel = symbol.kind() == SymbolKind::channel;
    return symbol.kind() == SymbolKind::parameter ||
           (is_channel && quantities.find(symbol.name()[0]) != quantities.npos);
  };
  for (const Expr part : {slope, rest})
    if (!std::ranges::all_of(symbols(part), may_hold)) return {};
  return slope.is_constant(0) ? Line{} : Line{slope, rest};
}

Expr sum(Expr a, Expr b) { return a.is_constant(0) ? b : b.is_constant(0) ? a : a + b; }
Expr product(Expr a, Expr b) {
  return a.is_constant(0) || b.is_constant(0) ? a.pool().constant(0)
         : a.is_constant(1)                   ? b
         : b.is_constant(1)                   ? a
                                              : a * b;
}

/// (shown - rest) / slope
Expr undone(const Line& line, Expr shown) {
  const Expr difference = line.rest.is_constant(0) ? shown : shown - line.rest;
  return line.slope.is_constant(1) ? difference : difference / line.slope;
}

/// What a channel shows of itself where that can be undone: of velocities and accelerations, whose integrals follow
/// their factor alone, a factor that does not change. An empty slope where it cannot.
Line undoable(const Model& model, const ChannelMap& measured) {
  const Expr own = model.pool->channel(measured.channel);
  const Line line = line_in(*model.pool, measured.map, own, "t");
  const bool integrated = measured.channel[0] != 'y';
  return integrated && line.slope.valid() && depends_on(line.slope, model.pool->channel("t")) ? Line{} : line;
}

}  // namespace

std::vector<std::pair<Expr, Expr>> undo_measures(const Model& model) {
  Pool& pool = *model.pool;
  std::vector<std::pair<Expr, Expr>> out;
  for (const ChannelMap& measured : model.measures) {
    const Line line = undoable(model, measured);
    if (!line.slope.valid()) continue;
    const char quantity = measured.channel[0];
    const std::string coordinate = measured.channel.substr(1);
    const Expr t = pool.channel("t"), y = pool.channel("y" + coordinate), v = pool.channel("v" + coordinate),
               a = pool.channel("a" + coordinate);
    const Line factor{line.slope, pool.constant(0)};
    const auto rate = [&](Expr f) {
      return sum(sum(product(derivative(f, v), a), product(derivative(f, y), v)), derivative(f, t));
    };
    const Expr true_y = undone(quantity == 'y' ? line : factor, y);
    const Expr true_v = quantity == 'y' ? rate(true_y) : undone(quantity == 'v' ? line : factor, v);
    const Expr true_a = quantity == 'a' ? undone(line, a) : rate(true_v);
    out.insert(out.end(), {{y, true_y}, {v, true_v}, {a, true_a}});
  }
  return out;
}

namespace {

/// Of a force that acts, along a motion that is known.
Line line_of(const Model& model, const std::string& channel, Expr map) {
  return line_in(*model.pool, map, model.pool->channel(channel), "tyv");
}

}  // namespace

Expr undo_acts(const Model& model, int coordinate, Expr acting) {
  for (const auto& [channel, map] : model.acts) {
    if (channel != model.channel('F', coordinate)) continue;
    const Line line = line_of(model, channel, map);
    if (!line.slope.valid()) continue;
    return undone(line, acting);
  }
  return acting;
}

bool can_be_undone(const Model& model) {
  for (const ChannelMap& measured : model.measures)
    if (!undoable(model, measured).slope.valid()) return false;
  for (const auto& [channel, map] : model.acts)
    if (!line_of(model, channel, map).slope.valid()) return false;
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
