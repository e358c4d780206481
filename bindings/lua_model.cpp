// Models: the equation of motion and its table of parameters.
#include <algorithm>
#include <cmath>

#include "record/columns.hpp"
#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {

void push_parameter(lua_State* L, const Parameter& parameter) {
  lua_newtable(L);
  push_text(L, parameter.name);
  lua_setfield(L, -2, "name");
  push_text(L, parameter.unit);
  lua_setfield(L, -2, "unit");
  lua_pushboolean(L, parameter.fixed);
  lua_setfield(L, -2, "fixed");
  for (const auto& [field, value] : {std::pair{"value", parameter.value}, std::pair{"min", parameter.min},
                                     std::pair{"max", parameter.max}, std::pair{"std", parameter.std}}) {
    if (!std::isfinite(value)) continue;
    lua_pushnumber(L, value);
    lua_setfield(L, -2, field);
  }
}

void push_parameters(lua_State* L, const std::vector<Parameter>& parameters) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Parameter& parameter : parameters) {
    push_parameter(L, parameter);
    lua_pushvalue(L, -1);
    lua_setfield(L, -3, parameter.name.c_str());
    lua_rawseti(L, -2, ++i);
  }
}

namespace {

/// Adds to `model` every declared state that `expr` needs, and those that their rates need.
void add_states(Model& model, const Declarations& declared, Expr expr) {
  if (!expr.valid()) return;
  for (const Expr symbol : symbols(expr, SymbolKind::state)) {
    const auto known = [&](const InternalState& state) { return state.symbol == symbol; };
    if (std::any_of(model.states.begin(), model.states.end(), known)) continue;
    for (const DeclaredState& row : declared.states) {
      if (row.state.symbol != symbol) continue;
      model.states.push_back(row.state);
      for (const Expr part : {row.state.rate, row.state.min, row.state.max}) add_states(model, declared, part);
    }
  }
}

/// One row per parameter, in order of first appearance, as declared.
void add_parameters(Model& model, const Declarations& declared) {
  std::vector<Expr> parts;
  for (int i = 0; i < model.degrees(); ++i) {
    parts.push_back(model.coordinate(i).mass);
    parts.push_back(model.coordinate(i).restoring);
  }
  parts.push_back(model.delay);
  for (const auto* maps : {&model.measures, &model.acts})
    for (const auto& [channel, map] : *maps) parts.push_back(map);
  for (const InternalState& state : model.states) parts.insert(parts.end(), {state.rate, state.min, state.max});
  for (const Expr part : parts) {
    if (!part.valid()) continue;
    for (const Expr symbol : symbols(part, SymbolKind::parameter)) {
      if (model.find(symbol.name())) continue;
      Parameter parameter;
      parameter.name = symbol.name();
      for (const DeclaredParameter& row : declared.parameters) {
        if (row.parameter.name == symbol.name()) parameter = row.parameter;
      }
      model.parameters.push_back(parameter);
    }
  }
}

/// The table { channel = expression } of a field, in the order of its channels.
std::vector<ChannelMap> read_maps(lua_State* L, const char* field, DeclarationsPtr& declared) {
  std::vector<ChannelMap> maps;
  with_field(L, 1, field, [&] {
    lua_pushnil(L);
    while (lua_next(L, -2)) {
      const Value value = check_value(L, -1);
      declared = join(declared, value.declared);
      maps.push_back({lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : describe(L, -2), value.expr});
      lua_pop(L, 1);
    }
  });
  std::sort(maps.begin(), maps.end(), [](const auto& a, const auto& b) { return a.channel < b.channel; });
  return maps;
}

/// model{mass = {m1...}, restoring = {f1...}, forces = {1...}, measures = {y = f...}, acts = {F = f...}, states =
/// {z...}, imposed_motion=, interpolation=}
int make_model(lua_State* L) {
  check_table(L, 1);
  DeclarationsPtr declared;
  std::vector<Expr> masses, restoring, listed;
  for (const auto& [field, rows] : {std::pair{"mass", &masses}, std::pair{"restoring", &restoring}})
    with_field(L, 1, field, [&, rows = rows] {
      for_each(L, -1, [&](lua_Integer) {
        const Value value = check_value(L, -1);
        declared = join(declared, value.declared);
        rows->push_back(value.expr);
        listed.push_back(value.expr);
      });
    });
  if (masses.empty() || masses.size() != restoring.size()) throw InputError("model: needs mass and restoring");
  Model model;
  model.pool = runtime(L).pool();
  model.mass = masses[0];
  model.restoring = restoring[0];
  for (std::size_t i = 1; i < masses.size(); ++i) model.further.push_back({masses[i], restoring[i]});
  with_field(L, 1, "forces", [&] {
    for_each(L, -1, [&](lua_Integer) { model.driven.push_back(static_cast<int>(check_integer(L, -1)) - 1); });
  });
  const Value delay = field_value(L, 1, "delay");
  declared = join(declared, delay.declared);
  model.delay = delay.expr;
  model.measures = read_maps(L, "measures", declared);
  model.acts = read_maps(L, "acts", declared);
  for (const auto& measured : model.measures) listed.push_back(measured.map);
  model.imposed_motion = boolean_field(L, 1, "imposed_motion", false);
  model.interpolation = interpolation_field(L, 1);
  if (model.imposed_motion && model.degrees() > 1)
    throw InputError("model: motion can be imposed on one coordinate, got " + std::to_string(model.degrees()));
  with_field(L, 1, "states", [&] {
    for_each(L, -1, [&](lua_Integer) {
      const Value state = check_value(L, -1);
      if (symbols(state.expr, SymbolKind::state).empty())
        throw InputError("model: states: expected states from lunid.state, got " + to_text(state.expr));
      declared = join(declared, state.declared);
      listed.push_back(state.expr);
    });
  });
  if (!declared) declared = std::make_shared<const Declarations>();
  for (const Expr part : listed) add_states(model, *declared, part);
  add_parameters(model, *declared);
  push<Model>(L, complete(std::move(model)));
  return 1;
}

/// Takes over the fields of a row of values that stands at the top of the stack.
void take_row(lua_State* L, Parameter& parameter) {
  for (const auto& [field, target] : {std::pair{"value", &parameter.value}, std::pair{"min", &parameter.min},
                                      std::pair{"max", &parameter.max}, std::pair{"std", &parameter.std}})
    *target = number_field(L, -1, field).value_or(*target);
  parameter.unit = string_field(L, -1, "unit").value_or(parameter.unit);
  parameter.fixed = boolean_field(L, -1, "fixed", parameter.fixed);
}

/// model_with(model, { k = 3, c = { fixed = true, min = 0 } }) -> a copy; what models.lua checked before.
int with(lua_State* L) {
  Model model = check<Model>(L, 1);
  check_table(L, 2);
  lua_pushnil(L);
  while (lua_next(L, 2)) {
    const std::string name = check_string(L, -2);
    Parameter* parameter = model.find(name);
    if (!parameter) throw InputError("with: the model has no parameter '" + name + "'");
    if (lua_type(L, -1) == LUA_TNUMBER)
      parameter->value = lua_tonumber(L, -1);
    else
      take_row(L, *parameter);
    lua_pop(L, 1);
  }
  push<Model>(L, complete(std::move(model)));
  return 1;
}

/// si_unit("kN/m") -> 1000, "N/m"; nil where it is unknown
int read_unit(lua_State* L) {
  const auto si = si_unit(check_string(L, 1));
  if (!si) return 0;
  lua_pushnumber(L, si->factor);
  push_text(L, si->unit);
  return 2;
}

/// unit_meant("inches") -> "in"; nil of a word that stands for none
int read_unit_word(lua_State* L) {
  const std::string unit = unit_meant(check_string(L, 1));
  if (unit.empty()) return 0;
  push_text(L, unit);
  return 1;
}

int list_units(lua_State* L) {
  push_text(L, known_units());
  return 1;
}

int equation(lua_State* L) {
  const Model& model = check<Model>(L, 1);
  const std::string format = lua_isnoneornil(L, 2) ? "plain" : check_string(L, 2);
  push_text(L, model.equation(format == "latex" ? Format::latex : Format::plain));
  return 1;
}

/// model:c_code() -> the rates as a function in C
int write_c(lua_State* L) {
  push_text(L, c_code(System(check<Model>(L, 1))));
  return 1;
}

void push_states(lua_State* L, const Model& model) {
  const DeclarationsPtr declared = declarations_of(model);
  lua_newtable(L);
  lua_Integer i = 0;
  for (const InternalState& state : model.states) {
    lua_newtable(L);
    push_text(L, state.symbol.name());
    lua_setfield(L, -2, "name");
    lua_pushnumber(L, state.initial);
    lua_setfield(L, -2, "initial");
    lua_pushboolean(L, state.anchored);
    lua_setfield(L, -2, "anchored");
    for (const auto& [field, expr] : {std::pair{"symbol", state.symbol}, std::pair{"rate", state.rate},
                                      std::pair{"min", state.min}, std::pair{"max", state.max}}) {
      if (!expr.valid()) continue;
      push<Value>(L, {expr, declared});
      lua_setfield(L, -2, field);
    }
    lua_rawseti(L, -2, ++i);
  }
}

/// { channel = expression }; nil where no channel has one.
void push_maps(lua_State* L, const Model& model, const std::vector<ChannelMap>& maps) {
  if (maps.empty()) return lua_pushnil(L);
  const DeclarationsPtr declared = declarations_of(model);
  lua_newtable(L);
  for (const auto& [channel, map] : maps) {
    push<Value>(L, {map, declared});
    lua_setfield(L, -2, channel.c_str());
  }
}

/// The masses or the restoring forces: of several coordinates a list.
void push_rows(lua_State* L, const Model& model, Expr Coordinate::*part) {
  const DeclarationsPtr declared = declarations_of(model);
  if (model.degrees() == 1) {
    push<Value>(L, {model.coordinate(0).*part, declared});
    return;
  }
  lua_newtable(L);
  for (int i = 0; i < model.degrees(); ++i) {
    push<Value>(L, {model.coordinate(i).*part, declared});
    lua_rawseti(L, -2, i + 1);
  }
}

/// Fields mass, restoring, degrees, inputs, forces, measures, acts, states, parameters, imposed_motion, interpolation;
/// or a method.
int get(lua_State* L) {
  const Model& model = check<Model>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "mass")
    push_rows(L, model, &Coordinate::mass);
  else if (key == "restoring")
    push_rows(L, model, &Coordinate::restoring);
  else if (key == "degrees")
    lua_pushinteger(L, model.degrees());
  else if (key == "delay") {
    if (model.delay.valid())
      push<Value>(L, {model.delay, declarations_of(model)});
    else
      lua_pushnil(L);
  } else if (key == "measures" || key == "acts")
    push_maps(L, model, key == "acts" ? model.acts : model.measures);
  else if (key == "inputs") {
    lua_newtable(L);
    lua_Integer i = 0;
    for (const std::string& input : model.inputs()) {
      push_text(L, input);
      lua_rawseti(L, -2, ++i);
    }
  } else if (key == "forces") {
    lua_newtable(L);
    lua_Integer i = 0;
    for (const int coordinate : model.driven) {
      lua_pushinteger(L, coordinate + 1);
      lua_rawseti(L, -2, ++i);
    }
  } else if (key == "interpolation") {
    if (model.interpolation)
      push_text(L, to_string(*model.interpolation));
    else
      lua_pushnil(L);
  } else if (key == "imposed_motion")
    lua_pushboolean(L, model.imposed_motion);
  else if (key == "parameters")
    push_parameters(L, model.parameters);
  else if (key == "states")
    push_states(L, model);
  else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1)) {
      throw InputError(
          "a model has no '" + key +
          "' (fields: mass restoring degrees inputs forces delay measures acts states parameters imposed_motion "
          "interpolation; methods: "
          "equation force with save export)");
    }
  }
  return 1;
}

int to_string(lua_State* L) {
  const Model& model = check<Model>(L, 1);
  std::string text = model.equation();
  for (const Parameter& parameter : model.parameters) text += "\n  " + parameter.words();
  push_text(L, text);
  return 1;
}

}  // namespace

void open_models(lua_State* L) {
  static constexpr Entry methods[] = {{"equation", guarded<equation>}, {"c_code", guarded<write_c>}};
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<Model>(L, methods, meta);
  static constexpr Entry functions[] = {{"model", guarded<make_model>},
                                        {"model_with", guarded<with>},
                                        {"si_unit", guarded<read_unit>},
                                        {"unit_meant", guarded<read_unit_word>},
                                        {"known_units", guarded<list_units>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
