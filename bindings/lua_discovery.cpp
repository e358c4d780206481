// Discovery: the catalogue's entries cross from Lua as data plus a guess function; the result goes back whole.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "discovery.hpp"
#include "model_threads.hpp"
#include "progress.hpp"
#include "runtime.hpp"
#include "stream.hpp"

namespace lunid::lua {

namespace {

/// A Lua value kept in the registry for as long as this lives.
class Reference {
 public:
  /// Takes the value on top of the stack.
  explicit Reference(lua_State* L) : L_(L), key_(luaL_ref(L, LUA_REGISTRYINDEX)) {}
  ~Reference() { luaL_unref(L_, LUA_REGISTRYINDEX, key_); }
  Reference(const Reference&) = delete;
  Reference& operator=(const Reference&) = delete;
  void push() const { lua_rawgeti(L_, LUA_REGISTRYINDEX, key_); }
  lua_State* state() const { return L_; }

 private:
  lua_State* L_;
  int key_;
};

void push_scales(lua_State* L, const RecordScales& scales) {
  lua_newtable(L);
  for (const auto& [field, value] :
       {std::pair{"y_max", scales.y_max}, std::pair{"y_min", scales.y_min}, std::pair{"y_std", scales.y_std},
        std::pair{"v_max", scales.v_max}, std::pair{"v_std", scales.v_std}, std::pair{"force_std", scales.force_std},
        std::pair{"residual_std", scales.residual_std}, std::pair{"omega", scales.omega},
        std::pair{"stiffness", scales.stiffness}, std::pair{"interval", scales.interval},
        std::pair{"duration", scales.duration}}) {
    lua_pushnumber(L, value);
    lua_setfield(L, -2, field);
  }
  for (const auto& [field, values] :
       {std::pair{"lines", &scales.lines}, std::pair{"modulations", &scales.modulations}}) {
    lua_newtable(L);
    for (std::size_t i = 0; i < values->size(); ++i) {
      lua_pushnumber(L, (*values)[i]);
      lua_rawseti(L, -2, static_cast<lua_Integer>(i) + 1);
    }
    lua_setfield(L, -2, field);
  }
}

/// The list of guesses on top of the stack, under the entry's private names.
std::vector<Guess> read_guesses(lua_State* L, const std::string& effect) {
  const std::string where = "effect " + effect + ": guess: ";
  if (lua_type(L, -1) != LUA_TTABLE) throw InputError(where + "expected a list of guesses, got " + describe(L, -1));
  std::vector<Guess> guesses;
  for_each(L, -1, [&](lua_Integer i) {
    if (lua_type(L, -1) != LUA_TTABLE) {
      throw InputError(where + "entry " + std::to_string(i) + ": expected a table, got " + describe(L, -1));
    }
    Guess guess;
    lua_pushnil(L);
    while (lua_next(L, -2)) {
      if (lua_type(L, -2) != LUA_TSTRING || lua_type(L, -1) != LUA_TNUMBER) {
        throw InputError(where + "entry " + std::to_string(i) + ": expected name = number");
      }
      guess[effect + "_" + lua_tostring(L, -2)] = lua_tonumber(L, -1);
      lua_pop(L, 1);
    }
    guesses.push_back(std::move(guess));
  });
  return guesses;
}

/// The limits on top of the stack, under the entry's private names.
Ranges read_ranges(lua_State* L, const std::string& effect) {
  const std::string where = "effect " + effect + ": range: ";
  if (lua_type(L, -1) != LUA_TTABLE)
    throw InputError(where + "expected name = { least, most }, got " + describe(L, -1));
  Ranges ranges;
  lua_pushnil(L);
  while (lua_next(L, -2)) {
    std::vector<double> ends;
    if (lua_type(L, -2) == LUA_TSTRING && lua_type(L, -1) == LUA_TTABLE) {
      for_each(L, -1, [&](lua_Integer) {
        if (lua_type(L, -1) == LUA_TNUMBER) ends.push_back(lua_tonumber(L, -1));
      });
    }
    if (ends.size() != 2 || !(ends[0] < ends[1])) throw InputError(where + "expected name = { least, most }");
    ranges[effect + "_" + lua_tostring(L, -2)] = {ends[0], ends[1]};
    lua_pop(L, 1);
  }
  return ranges;
}

/// Calls the user's function below so many arguments; its one result is on top. An error of its is thrown behind
/// `where`.
void call(lua_State* L, int arguments, const std::string& where) {
  if (lua_pcall(L, arguments, 1, 0) == LUA_OK) return;
  const char* said = lua_tostring(L, -1);
  throw InputError(where + (said ? said : describe(L, -1)));
}

/// Calls `function(scale, variant)` of an entry and reads what it returns. The stack is as before, also when it throws.
template <class Read>
auto call_entry(const Reference& function, const std::string& effect, const char* field, const RecordScales& scales,
                int variant, Read read) {
  lua_State* L = function.state();
  const StackTop restore(L);
  function.push();
  push_scales(L, scales);
  lua_pushinteger(L, variant + 1);
  call(L, 2, "effect " + effect + ": " + field + ": ");
  return read(L, effect);
}

std::vector<Parameter> read_rows(lua_State* L) {
  std::vector<Parameter> rows;
  with_field(L, -1, "rows", [&] {
    for_each(L, -1, [&](lua_Integer) {
      Parameter row;
      row.name = string_field(L, -1, "name").value_or("");
      row.unit = string_field(L, -1, "unit").value_or("");
      row.min = number_field(L, -1, "min").value_or(row.min);
      row.max = number_field(L, -1, "max").value_or(row.max);
      row.fixed = boolean_field(L, -1, "fixed", false);
      rows.push_back(std::move(row));
    });
  });
  return rows;
}

/// The variants of the entry on top of the stack: a force each, or where `maps` says so what a channel makes of it or
/// the delay of the force.
std::vector<EffectVariant> read_variants(lua_State* L) {
  std::vector<EffectVariant> variants;
  with_field(L, -1, "variants",
             [&] { for_each(L, -1, [&](lua_Integer) { variants.emplace_back(check_value(L, -1).expr); }); });
  const std::vector<std::string> formulas = strings_field(L, -1, "formulas");
  for (std::size_t i = 0; i < variants.size(); ++i) variants[i].formula = formulas.at(i);
  with_field(L, -1, "maps", [&] {
    for_each(L, -1, [&](lua_Integer i) {
      EffectVariant& variant = variants.at(static_cast<std::size_t>(i - 1));
      const auto field = string_field(L, -1, "field");
      if (!field) return;
      if (*field == "delay") {
        variant.delay = std::exchange(variant.force, {});
        return;
      }
      const ChannelMap map{string_field(L, -1, "channel").value_or(""), variant.force};
      (*field == "acts" ? variant.acts : variant.measures).push_back(map);
      variant.force = {};
    });
  });
  return variants;
}

/// The entry on top of the stack, as stdlib/effect.lua made it.
Effect read_effect(lua_State* L) {
  Effect effect;
  effect.name = string_field(L, -1, "name").value_or("");
  effect.family = string_field(L, -1, "family").value_or("");
  effect.sentence = string_field(L, -1, "sentence").value_or("");
  effect.special_case_of = strings_field(L, -1, "special_case_of");
  effect.channels = strings_field(L, -1, "channels");
  effect.absolute = strings_field(L, -1, "absolute");
  effect.any_motion = boolean_field(L, -1, "any_motion", false);
  with_field(L, -1, "own_of_record", [&] {
    for_each(L, -1, [&](lua_Integer) {
      effect.separate.push_back(
          {string_field(L, -1, "parameter").value_or(""), string_field(L, -1, "unless").value_or("")});
    });
  });
  effect.repeats = boolean_field(L, -1, "repeats", false);
  effect.parameters = read_rows(L);
  effect.variants = read_variants(L);
  with_field(L, -1, "margins",
             [&] { for_each(L, -1, [&](lua_Integer) { effect.margins.push_back(check_value(L, -1).expr); }); });
  with_field(L, -1, "state_values", [&] {
    for_each(L, -1, [&](lua_Integer) {
      for (const DeclaredState& row : check_value(L, -1).declared->states) effect.states.push_back(row.state);
    });
  });
  with_field(L, -1, "guess", [&] {
    lua_pushvalue(L, -1);
    const auto function = std::make_shared<const Reference>(L);
    effect.guess = [function, name = effect.name](const RecordScales& scales, int variant) {
      return call_entry(*function, name, "guess", scales, variant, read_guesses);
    };
  });
  with_field(L, -1, "range", [&] {
    lua_pushvalue(L, -1);
    const auto function = std::make_shared<const Reference>(L);
    effect.range = [function, name = effect.name](const RecordScales& scales, int variant) {
      return call_entry(*function, name, "range", scales, variant, read_ranges);
    };
  });
  return effect;
}

}  // namespace

std::vector<Effect> read_catalogue(lua_State* L, int index) {
  std::vector<Effect> catalogue;
  check_table(L, index);
  for_each(L, index, [&](lua_Integer) { catalogue.push_back(read_effect(L)); });
  return catalogue;
}

std::vector<Record> read_records(lua_State* L, int index) {
  std::vector<Record> records;
  check_table(L, index);
  for_each(L, index, [&](lua_Integer) { records.push_back(check<Record>(L, -1)); });
  return records;
}

DiscoverOptions read_discover_options(lua_State* L, int index) {
  DiscoverOptions options;
  options.alpha = number_field(L, index, "alpha").value_or(options.alpha);
  options.minimum_gain = number_field(L, index, "minimum_gain").value_or(options.minimum_gain);
  options.first = static_cast<int>(number_field(L, index, "first").value_or(options.first));
  options.max_effects = static_cast<int>(number_field(L, index, "max_effects").value_or(options.max_effects));
  options.blocks = static_cast<int>(number_field(L, index, "blocks").value_or(options.blocks));
  options.holdout = number_field(L, index, "holdout").value_or(options.holdout);
  options.seed = runtime(L).seed;
  options.threads = model_threads(L);
  options.cancelled = &runtime(L).cancelled();
  if (on_terminal()) options.progress = show_with_time_left();
  return options;
}

void set_rows(lua_State* L, const char* field, const Eigen::MatrixXd& values) {
  lua_newtable(L);
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    push_column(L, values.col(j));
    lua_rawseti(L, -2, j + 1);
  }
  lua_setfield(L, -2, field);
}

namespace {

/// `function({ name =, gap =, model = })` at `index`: whether a set may be named.
std::function<bool(const FittedSet&)> read_criterion(lua_State* L, int index) {
  if (lua_getfield(L, index, "criterion") == LUA_TNIL) {
    lua_pop(L, 1);
    return {};
  }
  return [function = std::make_shared<const Reference>(L)](const FittedSet& set) {
    lua_State* state = function->state();
    const StackTop restore(state);
    function->push();
    lua_newtable(state);
    set_text(state, "name", set.name);
    set_number(state, "gap", set.gap);
    push<Model>(state, set.model);
    lua_setfield(state, -2, "model");
    const std::string where = "discover: criterion: of " + set.name + ": ";
    call(state, 1, where);
    if (!lua_isnil(state, -1) && !lua_isboolean(state, -1))
      throw InputError(where + "expected the function to return true or false, got " + describe(state, -1));
    return lua_isnil(state, -1) || lua_toboolean(state, -1) != 0;
  };
}

/// discover(model, {effects}, {train records}, {test records}, options)
int run_discovery(lua_State* L) {
  const Model& model = check<Model>(L, 1);
  const std::vector<Effect> catalogue = read_catalogue(L, 2);
  const std::vector<Record> train = read_records(L, 3), test = read_records(L, 4);
  check_table(L, 5);
  DiscoverOptions options = read_discover_options(L, 5);
  options.criterion = read_criterion(L, 5);
  const ProgressLine line;
  push<Discovery>(L, discover(model, catalogue, train, test, options));
  return 1;
}

/// before_discovery(model, {train records}, {test records}, options) -> the baseline in words, { note }
int run_before(lua_State* L) {
  const Model& model = check<Model>(L, 1);
  const std::vector<Record> train = read_records(L, 2), test = read_records(L, 3);
  check_table(L, 4);
  const Outset outset = before_discovery(model, train, test, read_discover_options(L, 4));
  push_text(L, outset.baseline);
  push_texts(L, outset.notes);
  return 2;
}

void push_comparisons(lua_State* L, const std::vector<Comparison>& comparisons) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Comparison& c : comparisons) {
    lua_newtable(L);
    push_text(L, c.record);
    lua_setfield(L, -2, "record");
    push_text(L, c.role);
    lua_setfield(L, -2, "role");
    set_text(L, "output", c.output);
    set_column(L, "t", c.t);
    set_column(L, "measured", c.measured);
    set_column(L, "baseline", c.baseline);
    set_column(L, "final", c.final);
    set_column(L, "y", c.y);
    set_column(L, "v", c.v);
    set_column(L, "residual_before", c.residual_before);
    set_column(L, "residual_after", c.residual_after);
    set_column(L, "named_force", c.named_force);
    lua_rawseti(L, -2, ++i);
  }
}

/// { { name =, t =, y =, v =, named =, left = } }: with several coordinates the force of each named effect at its
/// place.
void push_forces(lua_State* L, const std::vector<PlacedForce>& forces) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const PlacedForce& force : forces) {
    lua_newtable(L);
    set_text(L, "name", force.name);
    set_column(L, "t", force.t);
    set_column(L, "y", force.y);
    set_column(L, "v", force.v);
    set_column(L, "named", force.named);
    set_column(L, "left", force.left);
    lua_rawseti(L, -2, ++i);
  }
}

void push_map(lua_State* L, const ResidualMap& map, const std::string& place) {
  lua_newtable(L);
  set_text(L, "place", place);
  set_column(L, "y", map.y);
  set_column(L, "v", map.v);
  set_rows(L, "before", map.before);
  set_rows(L, "after", map.after);
  set_rows(L, "count", map.count);
}

/// { { name =, gap =, remark =, model = } }: sets of effects that were not named, as they were fitted.
void push_rivals(lua_State* L, const Discovery& found) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Rival& rival : found.rivals) {
    lua_newtable(L);
    set_text(L, "name", rival.name);
    set_number(L, "gap", rival.gap);
    set_text(L, "remark", rival.remark);
    push<Model>(L, rival.model);
    lua_setfield(L, -2, "model");
    lua_rawseti(L, -2, ++i);
  }
}

/// { y = "m", v = "m/s", a = "m/s^2", F = "N" }
void push_units(lua_State* L, const Units& units) {
  lua_newtable(L);
  for (const char* channel : {"y", "v", "a", "F"}) set_text(L, channel, units.of(channel));
}

/// What lunid.design_experiment takes where a study says nothing else.
void push_options(lua_State* L, const ExperimentOptions& o) {
  lua_newtable(L);
  set_number(L, "force", o.limits.force);
  set_number(L, "displacement", o.limits.displacement);
  set_number(L, "from", o.limits.from);
  set_number(L, "to", o.limits.to);
  set_number(L, "duration", o.duration);
  set_number(L, "rate", o.rate);
  set_number(L, "noise", o.noise);
  set_text(L, "measured", o.measured);
  push_units(L, o.units);
  lua_setfield(L, -2, "units");
}

/// discovery.json, without the time that it took: the same run gives the same bits.
nlohmann::json data_of(const Discovery& found) {
  auto data = to_json(found);
  data.erase("seconds");
  return data;
}

/// The model with forces without a name; nil where there is none.
void push_closure(lua_State* L, const Discovery& found) {
  if (found.unknown && found.unknown->closure)
    push<Model>(L, found.unknown->closure->model);
  else
    lua_pushnil(L);
}

/// { y =, v =, force = { a column for each v } }, NaN where there is no data; nil where something else was found.
void push_unknown_force(lua_State* L, const Discovery& found) {
  if (!found.unknown) return lua_pushnil(L);
  lua_newtable(L);
  set_column(L, "y", found.unknown->y);
  set_column(L, "v", found.unknown->v);
  set_rows(L, "force", found.unknown->force);
}

/// { before =, after = } as lunid.locate has its maps; a model's are nil where its force is not finite.
void push_residual_maps(lua_State* L, const Discovery& found) {
  lua_newtable(L);
  for (const auto& [field, maps] : {std::pair{"before", &found.maps_before}, std::pair{"after", &found.maps_after}}) {
    if (!*maps) continue;
    push_maps(L, **maps);
    lua_setfield(L, -2, field);
  }
}

/// Fields verdict, sentence, model, baseline, closure, unknown_force, data (discovery.json as a table), json (its
/// text), units, comparisons, map, maps.
int get(lua_State* L) {
  const Discovery& found = check<Discovery>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "verdict")
    push_text(L, to_string(found.verdict));
  else if (key == "sentence")
    push_text(L, found.sentence);
  else if (key == "model")
    push<Model>(L, found.final);
  else if (key == "baseline")
    push<Model>(L, found.baseline);
  else if (key == "closure")
    push_closure(L, found);
  else if (key == "unknown_force")
    push_unknown_force(L, found);
  else if (key == "data")
    push_json(L, data_of(found));
  else if (key == "json")
    push_text(L, data_of(found).dump(1) + "\n");
  else if (key == "units")
    push_units(L, found.units);
  else if (key == "output")
    push_text(L, found.output);
  else if (key == "seconds")
    lua_pushnumber(L, found.seconds);
  else if (key == "comparisons")
    push_comparisons(L, found.comparisons);
  else if (key == "map")
    push_map(L, found.map, found.map_place);
  else if (key == "maps")
    push_residual_maps(L, found);
  else if (key == "forces")
    push_forces(L, found.forces);
  else if (key == "rivals")
    push_rivals(L, found);
  else if (key == "designed") {
    if (found.experiment.empty())
      lua_pushnil(L);
    else
      push_design(L, found.experiment);
  } else if (key == "same_experiment")
    push_options(L, found.same_experiment);
  else if (key == "effects" || key == "warnings") {
    const auto data = to_json(found);
    push_json(L, data.value(key, nlohmann::json::array()));
  } else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1)) {
      throw InputError(
          "a discovery has no '" + key +
          "' (fields: verdict sentence model baseline closure unknown_force effects rivals warnings "
          "same_experiment data json units output seconds comparisons map maps forces; methods: save next_experiment)");
    }
  }
  return 1;
}

int to_string(lua_State* L) {
  std::string text = to_terminal(check<Discovery>(L, 1));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  push_text(L, text);
  return 1;
}

}  // namespace

void open_discoveries(lua_State* L) {
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<Discovery>(L, {}, meta);
  static constexpr Entry functions[] = {{"discover", guarded<run_discovery>},
                                        {"before_discovery", guarded<run_before>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
