#include "discover/twins.hpp"

#include <algorithm>
#include <cmath>

#include "discover/places.hpp"
#include "discover/sensor.hpp"

namespace lunid {

namespace {

using Replacements = std::vector<std::pair<Expr, Expr>>;

/// Of the equation of each coordinate; empty where a slope holds a parameter, or nothing of it.
std::vector<Expr> slopes_of(const Model& model, const std::string& parameter) {
  const Expr p = model.pool->parameter(parameter);
  std::vector<Expr> out;
  bool any = false;
  for (int i = 0; i < model.degrees(); ++i) {
    const auto [mass, restoring] = model.coordinate(i);
    const Expr slope = derivative(restoring, p);
    if (depends_on(mass, p) || !symbols(slope, SymbolKind::parameter).empty()) return {};
    any = any || !slope.is_constant(0);
    out.push_back(slope);
  }
  for (const InternalState& state : model.states)
    for (const Expr part : {state.rate, state.min, state.max})
      if (part.valid() && depends_on(part, p)) return {};
  return any ? out : std::vector<Expr>{};
}

bool same_but_for_sign(const std::vector<Expr>& a, const std::vector<Expr>& b) {
  if (a.empty() || a.size() != b.size()) return false;
  std::vector<Expr> negative;
  for (const Expr part : b) negative.push_back(part.pool().apply(Op::neg, {part}));
  return a == b || a == negative;
}

/// It has no bounds, or three of its deviations to the next of them.
bool is_free(const Parameter& p) {
  if (p.fixed) return false;
  return (std::isinf(p.min) && std::isinf(p.max)) || std::min(p.value - p.min, p.max - p.value) > 3 * p.std;
}

/// The name of the baseline's parameter; empty where there is none.
std::string twin_of(const Model& baseline, const Model& extended, const std::string& parameter) {
  const std::vector<Expr> own = slopes_of(extended, parameter);
  if (own.empty()) return "";
  const auto twin = std::ranges::find_if(baseline.parameters, [&](const Parameter& known) {
    return is_free(known) && same_but_for_sign(own, slopes_of(baseline, known.name));
  });
  return twin != baseline.parameters.end() ? twin->name : "";
}

/// That of a force in every variant.
std::string twin_of(const Model& baseline, const Effect& effect, const Parameter& parameter) {
  if (!(parameter.min <= 0 && parameter.max >= 0)) return "";
  std::string twin;
  for (int i = 0; i < static_cast<int>(effect.variants.size()); ++i) {
    const EffectVariant& variant = effect.variants[static_cast<std::size_t>(i)];
    if (!variant.force.valid() || !variant.measures.empty() || !variant.acts.empty()) return "";
    Model extended = baseline;
    extended.parameters.insert(extended.parameters.end(), effect.parameters.begin(), effect.parameters.end());
    add_variant(extended, effect, i);
    twin = twin_of(baseline, extended, parameter.name);
    if (twin.empty()) return "";
  }
  return twin;
}

/// A formula without some of its numbers; as it was where it is no expression.
std::string formula_without(const Effect& effect, const std::string& text, const std::vector<std::string>& names) {
  Pool pool;
  try {
    Replacements zero;
    const Expr formula = parse(pool, text);
    for (const std::string& name : names) zero.emplace_back(pool.parameter(own_name(effect, name)), pool.constant(0));
    return to_text(substitute(formula, zero));
  } catch (const InputError&) {
    return text;
  }
}

}  // namespace

Effect without_twins(const Model& baseline, const Effect& effect) {
  if (effect.parameters.size() < 2) return effect;
  std::vector<std::string> names;
  std::vector<Twin> twins;
  Replacements zero;
  for (const Parameter& p : effect.parameters)
    if (const std::string twin = twin_of(baseline, effect, p); !twin.empty()) {
      names.push_back(p.name);
      twins.push_back({own_name(effect, p.name), twin});
      zero.emplace_back(baseline.pool->parameter(p.name), baseline.pool->constant(0));
    }
  if (names.empty() || names.size() == effect.parameters.size()) return effect;
  Effect out = effect;
  out.twins = std::move(twins);
  std::erase_if(out.parameters, [&](const Parameter& p) { return std::ranges::find(names, p.name) != names.end(); });
  for (EffectVariant& variant : out.variants) {
    variant.force = substitute(variant.force, zero);
    variant.formula = formula_without(effect, variant.formula, names);
  }
  for (Expr& margin : out.margins) margin = substitute(margin, zero);
  return out;
}

}  // namespace lunid
