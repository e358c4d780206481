// The stages of discovery one by one, and the design of the experiment that would tell rivals apart: tables of numbers,
// columns, models and records.
#include <nlohmann/json.hpp>

#include "discover/stages.hpp"
#include "discovery.hpp"
#include "model_threads.hpp"
#include "runtime.hpp"

namespace lunid::lua {

namespace {

template <class Body>
void push_list(lua_State* L, std::size_t count, Body body) {
  lua_newtable(L);
  for (std::size_t i = 0; i < count; ++i) {
    lua_newtable(L);
    body(i);
    lua_rawseti(L, -2, static_cast<lua_Integer>(i) + 1);
  }
}

void set_boolean(lua_State* L, const char* field, bool value) {
  lua_pushboolean(L, value);
  lua_setfield(L, -2, field);
}

void set_texts(lua_State* L, const char* field, const std::vector<std::string>& texts) {
  lua_newtable(L);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    push_text(L, texts[i]);
    lua_rawseti(L, -2, static_cast<lua_Integer>(i) + 1);
  }
  lua_setfield(L, -2, field);
}

void set_model(lua_State* L, const char* field, const Model& model) {
  push<Model>(L, model);
  lua_setfield(L, -2, field);
}

// ---- design_experiment ----

void push_candidate(lua_State* L, const ExperimentDesign& design, const ExperimentCandidate& c) {
  set_text(L, "name", c.name);
  set_text(L, "what", c.words);
  set_number(L, "level", c.level);
  set_number(L, "motion", c.peak);
  set_number(L, "separation", c.separation);
  set_number(L, "expected_z", c.expected_z);
  set_boolean(L, "decides", c.decides());
  if (!c.remark.empty()) set_text(L, "reason", c.remark);
  push<Record>(L, c.excitation);
  lua_setfield(L, -2, "excitation");
  push_list(L, c.pairs.size(), [&](std::size_t i) {
    set_text(L, "a", design.rivals[static_cast<std::size_t>(c.pairs[i].a)]);
    set_text(L, "b", design.rivals[static_cast<std::size_t>(c.pairs[i].b)]);
    set_number(L, "separation", c.pairs[i].separation);
  });
  lua_setfield(L, -2, "pairs");
}

/// { y = "m", v = "m/s", a = "m/s^2", F = "N" }, where the field is there.
Units read_units(lua_State* L, int index) {
  Units units;
  if (lua_getfield(L, index, "units") == LUA_TTABLE) {
    const int table = lua_gettop(L);
    units.y = string_field(L, table, "y").value_or(units.y);
    units.v = string_field(L, table, "v").value_or(units.v);
    units.a = string_field(L, table, "a").value_or(units.a);
    units.force = string_field(L, table, "F").value_or(units.force);
  }
  lua_pop(L, 1);
  return units;
}

ExperimentOptions read_experiment(lua_State* L, int index) {
  ExperimentOptions o;
  o.limits.force = number_field(L, index, "force").value_or(0);
  o.limits.displacement = number_field(L, index, "displacement").value_or(o.limits.displacement);
  o.limits.from = number_field(L, index, "from").value_or(0);
  o.limits.to = number_field(L, index, "to").value_or(0);
  o.duration = number_field(L, index, "duration").value_or(0);
  o.rate = number_field(L, index, "rate").value_or(0);
  o.noise = number_field(L, index, "noise").value_or(0);
  o.measured = string_field(L, index, "measured").value_or("y");
  o.units = read_units(L, index);
  o.seed = runtime(L).seed;
  o.threads = model_threads(L);
  o.cancelled = &runtime(L).cancelled();
  return o;
}

/// design_experiment({models}, {names}, {force=, displacement=, from=, to=, duration=, rate=, noise=})
int design(lua_State* L) {
  std::vector<Model> models;
  std::vector<std::string> names;
  check_table(L, 1);
  for_each(L, 1, [&](lua_Integer) { models.push_back(check<Model>(L, -1)); });
  for_each(L, 2, [&](lua_Integer) { names.push_back(check_string(L, lua_gettop(L))); });
  push_design(L, design_experiment(models, names, read_experiment(L, 3)));
  return 1;
}

// ---- locate, propose, rank ----

void push_map(lua_State* L, const BinnedMap& map) {
  lua_newtable(L);
  set_text(L, "over", map.over);
  set_text(L, "unit", map.unit);
  set_text(L, "value_is", map.value_is);
  set_column(L, "x", map.x);
  set_column(L, "value", map.value);
  set_column(L, "level", map.level);
  set_column(L, "rows", map.rows);
  set_number(L, "share", map.share);
  set_boolean(L, "above", map.any_above());
  set_text(L, "sentence", map.sentence);
}

void push_slow(lua_State* L, const SlowTime& slow) {
  lua_newtable(L);
  set_column(L, "time", slow.time);
  set_text(L, "sentence", slow.sentence);
  for (int j = 0; j < 3; ++j) {
    lua_newtable(L);
    set_column(L, "value", slow.value.col(j));
    set_column(L, "std", slow.std.col(j));
    set_boolean(L, "changes", slow.changes[j]);
    lua_setfield(L, -2, SlowTime::names[j]);
  }
}

/// What a stage does with its records; what is wrong with these is told of the stage, not of a discovery.
template <class Work>
auto as_stage(const std::string& stage, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    constexpr std::string_view whole = "discover: ";
    if (!error.message().starts_with(whole)) throw;
    throw InputError(stage + ": " + error.message().substr(whole.size()), error.where(), error.fault());
  }
}

/// locate(model, {records}, {place=})
int run_locate(lua_State* L) {
  const Model& model = check<Model>(L, 1);
  const std::vector<Record> records = read_records(L, 2);
  const ProgressLine line;
  const DiscoverOptions options = read_discover_options(L, 3);
  const std::string place = string_field(L, 3, "place").value_or("");
  const Located found = as_stage("locate", [&] { return locate(model, records, options, place); });
  lua_newtable(L);
  set_model(L, "model", found.baseline);
  set_number(L, "gap", found.gap);
  if (!found.place.empty()) set_text(L, "place", found.place);
  set_text(L, "sentence", found.maps.sentence);
  set_text(L, "no_data", found.maps.no_data);
  set_number(L, "rms", found.maps.rms);
  set_number(L, "noise", found.maps.noise);
  set_boolean(L, "above_noise", found.maps.above_noise);
  set_boolean(L, "loop", found.maps.loop);
  set_number(L, "loop_share", found.maps.loop_share);
  set_texts(L, "warnings", found.warnings);
  set_column(L, "t", found.rows.t);
  set_column(L, "y", found.rows.y);
  set_column(L, "v", found.rows.v);
  set_column(L, "force", found.rows.force);
  push_maps(L, found.maps);
  lua_setfield(L, -2, "maps");
  return 1;
}

/// propose(model, {effects}, {records}, options)
int run_propose(lua_State* L) {
  const Model& model = check<Model>(L, 1);
  const std::vector<Effect> catalogue = read_catalogue(L, 2);
  const std::vector<Record> records = read_records(L, 3);
  const ProgressLine line;
  const DiscoverOptions options = read_discover_options(L, 4);
  const Proposed found = as_stage("propose", [&] { return propose(model, catalogue, records, options); });
  lua_newtable(L);
  set_model(L, "model", found.baseline);
  set_number(L, "gap", found.gap);
  set_texts(L, "warnings", found.warnings);
  push_list(L, found.proposals.size(), [&](std::size_t i) {
    const Proposal& p = found.proposals[i];
    set_text(L, "name", p.name);
    lua_pushinteger(L, p.variant + 1);
    lua_setfield(L, -2, "variant");
    set_number(L, "gain", p.gain);
    set_number(L, "force_gain", p.force_gain);
    set_number(L, "p_value", p.p_value);
    if (!p.remark.empty()) set_text(L, "remark", p.remark);
    push_parameters(L, p.parameters);
    lua_setfield(L, -2, "parameters");
  });
  lua_setfield(L, -2, "proposals");
  return 1;
}

/// rank_sets(model, {effects}, {{names}}, {records}, options)
int run_rank(lua_State* L) {
  const Model& model = check<Model>(L, 1);
  const std::vector<Effect> catalogue = read_catalogue(L, 2);
  std::vector<std::vector<std::string>> sets;
  for_each(L, 3, [&](lua_Integer) {
    sets.emplace_back();
    for_each(L, -1, [&](lua_Integer) { sets.back().push_back(check_string(L, lua_gettop(L))); });
  });
  const std::vector<Record> records = read_records(L, 4);
  const ProgressLine line;
  const DiscoverOptions options = read_discover_options(L, 5);
  const std::vector<Ranked> found =
      as_stage("rank", [&] { return rank_sets(model, catalogue, sets, records, options); });
  push_list(L, found.size(), [&](std::size_t i) {
    const Ranked& r = found[i];
    set_text(L, "name", r.name);
    set_number(L, "gap", r.gap);
    set_number(L, "left_out_gap", r.left_out_gap);
    set_number(L, "log_likelihood", r.log_likelihood);
    set_number(L, "bic", r.bic);
    set_number(L, "p_value", r.p_value);
    set_number(L, "z", r.z);
    if (!r.remark.empty()) set_text(L, "remark", r.remark);
    if (std::isfinite(r.bic)) set_model(L, "model", r.model);
  });
  return 1;
}

}  // namespace

void push_maps(lua_State* L, const ResidualMaps& maps) {
  lua_newtable(L);
  for (const BinnedMap& map : maps.maps) {
    push_map(L, map);
    lua_setfield(L, -2, map.over.c_str());
  }
  push_slow(L, maps.slow);
  lua_setfield(L, -2, "slow");
  lua_newtable(L);
  set_column(L, "y", maps.plane.y);
  set_column(L, "v", maps.plane.v);
  set_rows(L, "value", maps.plane.before);
  set_rows(L, "level", maps.plane_level);
  set_rows(L, "rows", maps.plane.count);
  set_text(L, "sentence", maps.plane_sentence);
  lua_setfield(L, -2, "plane");
}

void push_design(lua_State* L, const ExperimentDesign& design) {
  lua_newtable(L);
  set_texts(L, "rivals", design.rivals);
  set_text(L, "sentence", sentence_of(design));
  std::string text = to_terminal(design);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  set_text(L, "text", text);
  set_text(L, "json", to_json(design).dump(1) + "\n");
  set_boolean(L, "decides", design.best().decides());
  set_number(L, "separation", design.best().separation);
  set_number(L, "noise", design.options.noise);
  push_list(L, design.candidates.size(), [&](std::size_t i) { push_candidate(L, design, design.candidates[i]); });
  lua_setfield(L, -2, "candidates");
}

void open_stages(lua_State* L) {
  static constexpr Entry functions[] = {{"design_experiment", guarded<design>},
                                        {"locate", guarded<run_locate>},
                                        {"propose", guarded<run_propose>},
                                        {"rank_sets", guarded<run_rank>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
