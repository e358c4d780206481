// What symbols were declared as, carried along with the expressions that they stand in.
#include <algorithm>
#include <cmath>

#include "types.hpp"

namespace lunid::lua {

namespace {

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool same(const Parameter& a, const Parameter& b) {
  return same(a.value, b.value) && same(a.min, b.min) && same(a.max, b.max) && a.unit == b.unit && a.fixed == b.fixed &&
         same(a.std, b.std);
}

bool same(const InternalState& a, const InternalState& b) {
  return a.rate == b.rate && same(a.initial, b.initial) && a.min == b.min && a.max == b.max && a.anchored == b.anchored;
}

std::string places(const std::string& a, const std::string& b) {
  if (a.empty() && b.empty()) return "";
  return ": at " + (a.empty() ? "another place" : a) + " and at " + (b.empty() ? "another place" : b);
}

template <class Item>
const std::string& name_of(const Item& item) {
  if constexpr (requires { item.parameter; }) {
    return item.parameter.name;
  } else {
    return item.state.symbol.name();
  }
}

template <class Item>
void join_lists(std::vector<Item>& into, const std::vector<Item>& more, const char* kind) {
  for (const Item& item : more) {
    const std::string& name = name_of(item);
    const auto found =
        std::find_if(into.begin(), into.end(), [&](const Item& other) { return name_of(other) == name; });
    if (found == into.end()) {
      into.push_back(item);
      continue;
    }
    bool equal;
    if constexpr (requires { item.parameter; }) {
      equal = same(found->parameter, item.parameter);
    } else {
      equal = same(found->state, item.state);
    }
    if (!equal) {
      throw InputError(std::string(kind) + " '" + name + "' is declared twice, differently" +
                       places(found->place, item.place));
    }
  }
}

}  // namespace

DeclarationsPtr join(const DeclarationsPtr& a, const DeclarationsPtr& b) {
  if (!a || a == b) return b;
  if (!b) return a;
  Declarations both = *a;
  join_lists(both.parameters, b->parameters, "parameter");
  join_lists(both.states, b->states, "state");
  return std::make_shared<const Declarations>(std::move(both));
}

const Parameter* find_declared(const DeclarationsPtr& declared, const std::string& name) {
  if (!declared) return nullptr;
  for (const DeclaredParameter& row : declared->parameters) {
    if (row.parameter.name == name) return &row.parameter;
  }
  return nullptr;
}

DeclarationsPtr declarations_of(const Model& model) {
  Declarations all;
  for (const Parameter& parameter : model.parameters) all.parameters.push_back({parameter, {}});
  for (const InternalState& state : model.states) all.states.push_back({state, {}});
  return std::make_shared<const Declarations>(std::move(all));
}

}  // namespace lunid::lua
