#include "discover/choices.hpp"

#include <algorithm>
#include <utility>

namespace lunid {

namespace {

/// The same of an entry and its repetitions.
std::pair<std::string, int> content(const Choice& c) { return {c.effect->label(), c.variant}; }

/// What a set holds, in one order.
std::vector<std::pair<std::string, int>> contents(const Choices& set) {
  std::vector<std::pair<std::string, int>> out;
  for (const Choice& c : set) out.push_back(content(c));
  std::ranges::sort(out);
  return out;
}

}  // namespace

bool Choice::is_special_case(const Choice& general) const {
  if (effect == general.effect) return parameters().size() < general.parameters().size();
  return effect->is_special_case(*general.effect) && parameters().size() == parameters_of(*effect, 0).size();
}

std::string name_of(const Choices& choices) {
  std::string text;
  for (const auto& c : choices) text += (text.empty() ? "" : " + ") + c.effect->label();
  return text.empty() ? "baseline" : text;
}

bool holds_name(const std::vector<Choices>& sets, const std::string& name) {
  return std::ranges::any_of(sets, [&](const Choices& set) { return name_of(set) == name; });
}

Choices with(Choices set, const Choice& more) {
  set.push_back(more);
  return set;
}

bool holds(const Choices& set, const Effect* effect) {
  return std::any_of(set.begin(), set.end(), [&](const Choice& c) { return c.effect == effect; });
}

bool may_join(const Choices& set, const Effect& effect) {
  const auto is_before = [&](const Choice& c) {
    return c.effect->number + 1 == effect.number && c.effect->label() == effect.label();
  };
  return !holds(set, &effect) && (effect.number == 1 || std::ranges::any_of(set, is_before));
}

bool same(const Choices& a, const Choices& b) { return a.size() == b.size() && contents(a) == contents(b); }

bool is_among(const std::vector<Choices>& sets, const Choices& set) {
  return std::ranges::any_of(sets, [&](const Choices& c) { return same(c, set); });
}

bool within(const Choices& part, const Choices& whole) {
  return std::ranges::includes(contents(whole), contents(part));
}

Choices beyond(const Choices& set, const Choices& other) {
  std::vector<std::pair<std::string, int>> rest = contents(other);
  Choices out;
  for (const Choice& c : set)
    if (const auto at = std::ranges::find(rest, content(c)); at != rest.end())
      rest.erase(at);
    else
      out.push_back(c);
  return out;
}

bool related(const Choices& a, const Choices& b) {
  const auto are = [](const Choice& x, const Choice& y) { return x.is_special_case(y) || y.is_special_case(x); };
  return std::ranges::any_of(
      a, [&](const Choice& x) { return std::ranges::any_of(b, [&](const Choice& y) { return are(x, y); }); });
}

bool is_general_form(const Choices& general, const Choices& special) {
  const auto is_covered = [&](const Choice& s) {
    return std::ranges::any_of(general, [&](const Choice& g) { return s.effect == g.effect || s.is_special_case(g); });
  };
  return general.size() == special.size() && std::ranges::all_of(special, is_covered);
}

bool has_shape(const Choice& choice) { return choice.effect->name != "constant_force"; }

std::ptrdiff_t springs_among(const Choices& set) {
  const auto is_spring = [](const Choice& c) { return c.effect->family == "stiffness" && has_shape(c); };
  std::ptrdiff_t most = 0;
  for (const Choice& one : set)
    most = std::max(most, std::ranges::count_if(set, [&](const Choice& c) {
                      return is_spring(c) && c.effect->place == one.effect->place;
                    }));
  return most;
}

bool is_series(const Choices& set) { return springs_among(set) > 2; }

}  // namespace lunid
