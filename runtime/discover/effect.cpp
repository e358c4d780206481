#include "discover/effect.hpp"

namespace lunid {

namespace {

constexpr int most_times = 3;  // that an entry stands at one place

/// Guesses and ranges speak of the entry's names.
template <class Values>
Values renamed(const Values& values, const std::string& suffix) {
  Values out;
  for (const auto& [name, value] : values) out[name + suffix] = value;
  return out;
}

std::vector<Expr> parts_of(const EffectVariant& form) {
  std::vector<Expr> parts{form.force, form.delay};
  for (const auto* maps : {&form.measures, &form.acts})
    for (const ChannelMap& map : *maps) parts.push_back(map.map);
  return parts;
}

bool holds_parameter(Expr part, const std::string& name) {
  return part.valid() &&
         std::ranges::any_of(symbols(part, SymbolKind::parameter), [&](Expr symbol) { return symbol.name() == name; });
}

}  // namespace

bool follows_base(const Effect& effect) {
  return std::ranges::any_of(effect.variants, [](const EffectVariant& form) {
    return form.force.valid() && std::ranges::any_of(symbols(form.force, SymbolKind::channel), [](const Expr& held) {
             return held.name() == "yb" || held.name() == "vb" || held.name() == "ab";
           });
  });
}

std::vector<InternalState> states_of(const Effect& effect, int variant) {
  const std::vector<InternalState>& states = effect.states;
  std::vector<Expr> parts = parts_of(effect.variants[static_cast<std::size_t>(variant)]);
  std::vector<std::uint8_t> keep(states.size(), 0);
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < states.size(); ++i) {
      const auto holds = [&](Expr part) { return part.valid() && depends_on(part, states[i].symbol); };
      if (keep[i] || std::ranges::none_of(parts, holds)) continue;
      parts.insert(parts.end(), {states[i].rate, states[i].min, states[i].max});
      keep[i] = again = true;
    }
  }
  std::vector<InternalState> out;
  for (std::size_t i = 0; i < states.size(); ++i)
    if (keep[i]) out.push_back(states[i]);
  return out;
}

std::vector<Parameter> parameters_of(const Effect& effect, int variant) {
  std::vector<Expr> parts = parts_of(effect.variants[static_cast<std::size_t>(variant)]);
  for (const InternalState& state : states_of(effect, variant))
    parts.insert(parts.end(), {state.rate, state.min, state.max});
  std::vector<Parameter> out;
  for (const Parameter& p : effect.parameters)
    if (std::ranges::any_of(parts, [&](Expr part) { return holds_parameter(part, p.name); })) out.push_back(p);
  return out;
}

Effect with_suffix(Pool& pool, const Effect& effect, const std::string& suffix,
                   std::vector<std::pair<Expr, Expr>> symbols) {
  for (const Parameter& p : effect.parameters)
    symbols.emplace_back(pool.parameter(p.name), pool.parameter(p.name + suffix));
  for (const InternalState& z : effect.states) symbols.emplace_back(z.symbol, pool.state(z.symbol.name() + suffix));
  const auto move = [&](Expr& part) {
    if (part.valid()) part = substitute(part, symbols);
  };
  Effect out = effect;
  out.suffix += suffix;
  for (EffectVariant& variant : out.variants) {
    move(variant.force);
    move(variant.delay);
    for (auto* maps : {&variant.measures, &variant.acts})
      for (auto& [channel, map] : *maps) move(map);
  }
  for (Parameter& p : out.parameters) p.name += suffix;
  for (InternalState& z : out.states)
    for (Expr* part : {&z.symbol, &z.rate, &z.min, &z.max}) move(*part);
  for (Expr& margin : out.margins) move(margin);
  if (effect.guess)
    out.guess = [own = effect.guess, suffix](const RecordScales& scales, int variant) {
      std::vector<Guess> guesses;
      for (const Guess& guess : own(scales, variant)) guesses.push_back(renamed(guess, suffix));
      return guesses;
    };
  if (effect.range)
    out.range = [own = effect.range, suffix](const RecordScales& scales, int variant) {
      return renamed(own(scales, variant), suffix);
    };
  return out;
}

std::vector<Effect> with_repetitions(const Model& model, const std::vector<Effect>& catalogue) {
  std::vector<Effect> out;
  for (const Effect& effect : catalogue) {
    if (!effect.repeats) {
      out.push_back(effect);
      continue;
    }
    int number = 0;
    for (char letter = 'a'; number < most_times; ++letter) {
      Effect again = letter == 'a' ? effect : with_suffix(*model.pool, effect, std::string("_") + letter);
      if (is_element_of(model, again)) continue;
      again.number = ++number;
      out.push_back(std::move(again));
    }
  }
  return out;
}

bool is_element_of(const Model& model, const Effect& effect) {
  for (const Parameter& own : effect.parameters)
    if (model.find(own.name)) return true;
  return std::any_of(effect.states.begin(), effect.states.end(), [&](const InternalState& own) {
    return std::any_of(model.states.begin(), model.states.end(),
                       [&](const InternalState& known) { return known.symbol.name() == own.symbol.name(); });
  });
}

std::string own_name(const Effect& effect, std::string parameter) {
  parameter.resize(parameter.size() - effect.suffix.size());
  const bool own = parameter.rfind(effect.name + "_", 0) == 0;
  return own ? parameter.substr(effect.name.size() + 1) : parameter;
}

}  // namespace lunid
