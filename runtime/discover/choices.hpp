#pragma once
// Sets of entries of the catalogue, and how two of them stand to each other.
#include <cstddef>
#include <string>
#include <vector>

#include "discover/effect.hpp"

namespace lunid {

struct Choice {
  const Effect* effect = nullptr;
  int variant = 0;
  const EffectVariant& form() const { return effect->variants[static_cast<std::size_t>(variant)]; }
  /// Of the entry's, those that the form leads to.
  std::vector<Parameter> parameters() const { return parameters_of(*effect, variant); }
  /// By the entries' word for it, which is about the first form and others with as many parameters; or a form of the
  /// same entry with fewer.
  bool is_special_case(const Choice& general) const;
  friend bool operator==(const Choice&, const Choice&) = default;
};
using Choices = std::vector<Choice>;
/// "coulomb_friction + constant_force"; "baseline" of none.
std::string name_of(const Choices& choices);
bool holds_name(const std::vector<Choices>& sets, const std::string& name);

/// The set with one more.
Choices with(Choices set, const Choice& more);

bool holds(const Choices& set, const Effect* effect);
/// It is not in the set, and where it is a repetition the one before it is.
bool may_join(const Choices& set, const Effect& effect);
/// The same entries in the same forms at the same places, whichever of its repetitions an entry is.
bool same(const Choices& a, const Choices& b);
bool is_among(const std::vector<Choices>& sets, const Choices& set);
/// Every choice of `part` is in `whole`, with its variant, as often.
bool within(const Choices& part, const Choices& whole);
/// What a set holds beyond another: a choice for each that is not in the other, with its variant, as often.
Choices beyond(const Choices& set, const Choices& other);
/// Related by special_case_of, either way: the simpler is named without doubt.
bool related(const Choices& a, const Choices& b);
/// As many entries, each that of `special` or one of which it is a special case.
bool is_general_form(const Choices& general, const Choices& special);

/// A mean force has none that could follow another's.
bool has_shape(const Choice& choice);
/// The most at one place.
std::ptrdiff_t springs_among(const Choices& set);
/// Three springs and stops at one place: a curve of another kind, which takes as many of them as its noise shows.
bool is_series(const Choices& set);

}  // namespace lunid
