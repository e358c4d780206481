#include "discover/places.hpp"

#include <algorithm>
#include <cctype>

namespace lunid {

namespace {

using Replacements = std::vector<std::pair<Expr, Expr>>;

constexpr int all_pairs = 3;  // coordinates up to which a joint may be missing from the baseline altogether

std::string named(char quantity, int coordinate) { return quantity + std::to_string(coordinate + 1); }

/// True when the equation of coordinate i holds the motion of j.
bool couples(const Model& model, int i, int j) {
  for (const char quantity : {'y', 'v', 'a'})
    if (depends_on(model.coordinate(i).restoring, model.pool->channel(model.channel(quantity, j)))) return true;
  return false;
}

/// "_2", "_1_2": behind the names of what stands at a place.
std::string suffix_of(const Place& place) {
  return "_" + std::to_string(place.of + 1) + (place.joint() ? "_" + std::to_string(place.from + 1) : "");
}

/// What stands at a place: one variant of an entry speaks of the forces between the masses, of what a displacement's
/// channel shows, or of what the force's channel does.
bool stands_at(const Model& model, const Effect& effect, const EffectVariant& variant, const Place& place) {
  const bool driven =
      !place.joint() && std::find(model.driven.begin(), model.driven.end(), place.of) != model.driven.end();
  if (!variant.measures.empty()) return !place.joint();
  if (variant.delay.valid()) return driven && model.driven.size() == 1;
  const auto follows_rate = [&](const ChannelMap& map) {
    return depends_on(map.map, model.pool->channel("force_rate"));
  };
  if (!variant.acts.empty())
    return driven && (model.driven.size() == 1 || std::none_of(variant.acts.begin(), variant.acts.end(), follows_rate));
  return effect.family != "input" || driven;
}

/// The motion and the force by those at a place.
Replacements symbols_at(const Model& model, const Place& place) {
  Pool& pool = *model.pool;
  Replacements out;
  for (const char quantity : {'y', 'v', 'a'})
    out.emplace_back(pool.channel(std::string(1, quantity)), motion_at(model, place, quantity));
  if (place.joint())
    out.emplace_back(pool.channel("ab"), pool.constant(0));  // what moves all coordinates shows in no difference
  else
    out.emplace_back(pool.channel("F"), pool.channel(model.channel('F', place.of)));
  return out;
}

/// The entry at a place, with those of its variants that stand there; none where no variant does.
std::optional<Effect> at_place(const Model& model, const Effect& effect, const Place& place) {
  Effect out = effect;
  out.place = place;
  out.variants.clear();
  std::vector<int> kept;  // numbers of the variants, for what the entry says of each
  for (std::size_t i = 0; i < effect.variants.size(); ++i) {
    if (!stands_at(model, effect, effect.variants[i], place)) continue;
    EffectVariant variant = effect.variants[i];
    for (auto* maps : {&variant.measures, &variant.acts})
      for (auto& [channel, map] : *maps) channel = model.channel(channel[0], place.of);
    out.variants.push_back(std::move(variant));
    kept.push_back(static_cast<int>(i));
  }
  if (kept.empty()) return {};
  const auto number = [kept](int variant) { return kept[static_cast<std::size_t>(variant)]; };
  if (effect.guess)
    out.guess = [own = effect.guess, number](const RecordScales& scales, int v) { return own(scales, number(v)); };
  if (effect.range)
    out.range = [own = effect.range, number](const RecordScales& scales, int v) { return own(scales, number(v)); };
  return with_suffix(*model.pool, out, suffix_of(place), symbols_at(model, place));
}

/// A formula with each of its words replaced; `enclosed`: it stands alone in brackets.
std::string in_words(const std::string& formula,
                     const std::function<std::string(const std::string& word, bool enclosed)>& replace) {
  std::string out, word;
  for (const char c : formula + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') {
      word += c;
      continue;
    }
    if (!word.empty()) out += replace(word, !out.empty() && out.back() == '(' && c == ')');
    word.clear();
    out += c;
  }
  out.pop_back();
  return out;
}

/// "m/s^2" of "m" per second squared: what stands before "/s" is kept.
std::string per_seconds(const std::string& unit, int more) {
  if (unit.empty() || unit[0] != 'm') return unit;
  const std::size_t at = unit.find("/s");
  const int own = at == std::string::npos ? 0 : at + 2 == unit.size() ? 1 : std::stoi(unit.substr(at + 3));
  return unit.substr(0, at) + "/s" + (own + more == 1 ? "" : "^" + std::to_string(own + more));
}

/// Sizes as an entry of y asks for them, of what was measured in its place.
RecordScales as_shown(RecordScales scales) {
  scales.y_max = scales.shown_max;
  scales.y_min = scales.shown_min;
  scales.y_std = scales.shown_std;
  return scales;
}

}  // namespace

Effect of_channel(const Model& model, const Effect& effect, char measured) {
  const std::pair<Expr, Expr> motion[] = {{model.pool->channel("y"), model.pool->channel(std::string(1, measured))}};
  const int seconds = measured == 'a' ? 2 : 1;
  Effect out = effect;
  for (EffectVariant& variant : out.variants) {
    for (auto& [channel, map] : variant.measures) {
      channel = std::string(1, measured);
      map = substitute(map, motion);
    }
    variant.formula = in_words(
        variant.formula, [&](const std::string& word, bool) { return word == "y" ? std::string(1, measured) : word; });
  }
  for (InternalState& z : out.states)
    for (Expr* part : {&z.rate, &z.min, &z.max})
      if (part->valid()) *part = substitute(*part, motion);
  for (Parameter& p : out.parameters) p.unit = per_seconds(p.unit, seconds);
  out.sentence = in_words(out.sentence, [&](const std::string& word, bool) -> std::string {
    return word != "displacement" ? word : measured == 'a' ? "acceleration" : "velocity";
  });
  if (effect.guess)
    out.guess = [own = effect.guess](const RecordScales& scales, int variant) {
      return own(as_shown(scales), variant);
    };
  if (effect.range)
    out.range = [own = effect.range](const RecordScales& scales, int variant) {
      return own(as_shown(scales), variant);
    };
  return out;
}

std::string words_of(const Place& place) { return (place.joint() ? "in " : "at ") + motion_of(place); }

std::string motion_of(const Place& place) {
  return place.joint() ? named('y', place.of) + " - " + named('y', place.from) : named('y', place.of);
}

std::vector<Place> places_of(const Model& model) {
  const int n = model.degrees();
  std::vector<Place> places;
  if (n == 1) return places;
  for (int i = 0; i < n; ++i) places.push_back({i, -1});
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      if (n <= all_pairs || couples(model, i, j) || couples(model, j, i)) places.push_back({i, j});
  return places;
}

std::vector<Effect> at_places(const Model& model, const std::vector<Effect>& catalogue) {
  if (model.degrees() == 1) return catalogue;
  std::vector<Effect> out;
  for (const Effect& effect : catalogue)
    for (const Place& place : places_of(model))
      if (auto there = at_place(model, effect, place)) out.push_back(std::move(*there));
  return out;
}

Expr& restoring_of(Model& model, int coordinate) {
  return coordinate == 0 ? model.restoring : model.further[static_cast<std::size_t>(coordinate) - 1].restoring;
}

void add_force(Model& model, const std::optional<Place>& place, Expr force) {
  Expr& first = restoring_of(model, place ? place->of : 0);
  first = first + force;
  if (!place || !place->joint()) return;
  Expr& other = restoring_of(model, place->from);
  other = other - force;
}

Expr motion_at(const Model& model, const std::optional<Place>& place, char quantity) {
  const auto of = [&](int coordinate) { return model.pool->channel(model.channel(quantity, coordinate)); };
  if (!place) return of(0);
  return place->joint() ? of(place->of) - of(place->from) : of(place->of);
}

std::string sizes_at(std::string sentence, const Place& place) {
  for (const char quantity : {'y', 'v'}) {
    std::string motion = motion_of(place);
    std::replace(motion.begin(), motion.end(), 'y', quantity);
    const std::string size = std::string("|") + quantity + "|";
    for (std::size_t at = sentence.find(size); at != std::string::npos; at = sentence.find(size, at + 1))
      sentence.replace(at + 1, 1, motion);
  }
  return sentence;
}

std::string formula_at(const std::string& formula, const std::optional<Place>& place) {
  if (!place) return formula;
  return in_words(formula, [&](const std::string& word, bool enclosed) {
    if (word != "y" && word != "v" && word != "a") return word;
    if (!place->joint()) return named(word[0], place->of);
    const std::string difference = named(word[0], place->of) + " - " + named(word[0], place->from);
    return enclosed ? difference : "(" + difference + ")";
  });
}

}  // namespace lunid
