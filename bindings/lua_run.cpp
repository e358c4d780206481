// Free runs of a model, and fits on the trajectory.
#include <algorithm>
#include <cmath>
#include <map>

#include "expr/joined.hpp"
#include "runtime.hpp"
#include "simulate/acceleration.hpp"
#include "simulate/dense.hpp"
#include "simulate/fit.hpp"
#include "simulate/regularise.hpp"
#include "types.hpp"

namespace lunid::lua {

std::optional<Interpolation> interpolation_field(lua_State* L, int index) {
  const auto name = string_field(L, index, "interpolation");
  return name ? std::optional(interpolation_named(*name)) : std::nullopt;
}

namespace {

/// An input as an expression of the time alone, evaluated exactly between samples. Lua is not called.
Excitation of_expression(Expr f, double dt, double duration) {
  return Excitation(0, dt, static_cast<Eigen::Index>(std::llround(duration / dt)) + 1, function_of_time(f));
}

const char* unit_of(char quantity) {
  return quantity == 'F' ? "N" : quantity == 'y' ? "m" : quantity == 'v' ? "m/s" : "m/s^2";
}

/// An input as the channel of the run's record: what it does between the samples, and its formula, are those of the
/// record that drove, unless an interpolation was forced. An expression leaves samples that are cubic between.
Channel channel_of_input(const std::string& name, const Excitation& signal, const Record* record,
                         const std::string& source, std::optional<Interpolation> forced) {
  Channel channel;
  channel.name = channel.source = name;
  channel.unit = unit_of(name[0]);
  channel.values = signal.samples();
  channel.between = signal.interpolation();
  if (record && record->has(source) && !forced) {
    channel.between = record->channel(source).between;
    channel.formula = record->channel(source).formula;
  }
  return channel;
}

/// {F = expression, yb = expression...}: a velocity or acceleration of the base that is not given follows from the
/// rest.
Excitations of_expressions(lua_State* L, int index, const System& system, double dt, double duration) {
  const Expr t = runtime(L).pool()->channel("t");
  Excitations excitation;
  std::map<std::string, Expr> given;
  lua_pushnil(L);
  while (lua_next(L, index)) {
    const std::string channel = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : describe(L, -2);
    given[channel] = check_value(L, -1).expr;
    lua_pop(L, 1);
  }
  for (const auto& [channel, rate] : {std::pair{"yb", "vb"}, std::pair{"vb", "ab"}}) {
    const bool needed = std::find(system.inputs().begin(), system.inputs().end(), "ab") != system.inputs().end() ||
                        std::find(system.inputs().begin(), system.inputs().end(), rate) != system.inputs().end();
    if (needed && given.contains(channel) && !given.contains(rate)) given[rate] = derivative(given[channel], t);
  }
  if (given.contains("vb") && std::find(system.inputs().begin(), system.inputs().end(), "vb") == system.inputs().end())
    given.erase("vb");
  for (const auto& [channel, f] : given) excitation.add(channel, of_expression(f, dt, duration));
  return excitation;
}

constexpr double giga = 1e9;

/// "regularised over 0.001, as asked: sign(v), abs(v)"
std::string regularised_note(const Regularised& smooth, double width) {
  const std::string branches = joined(smooth.replaced);
  char text[64];
  std::snprintf(text, sizeof text, "regularised over %g, as asked: ", width);
  return text + (branches.empty() ? "there was no branch" : branches);
}

/// What drives a run that wants more rows than its record has.
Excitations on_rows(Excitations excitation, const System& system, double record_dt, double dt, double max_memory) {
  const double parts = std::round(record_dt / dt);
  constexpr double rounding = 1e-6;
  if (parts < 1 || std::abs(record_dt / dt - parts) > rounding * parts) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "simulate: dt: expected the sample time of the record, %.9g s, or a whole part of it, got %.9g s",
                  record_dt, dt);
    throw InputError(text);
  }
  if (parts == 1) return excitation;
  check_memory("simulate", static_cast<double>(excitation.rows() - 1) * parts + 1, run_values(system), max_memory);
  return finer(excitation.ordered(system), static_cast<int>(parts));
}

/// The first state: the user's, whose internal states may be left to their own initial values; or the record's.
Eigen::VectorXd first_state(const System& system, const Eigen::VectorXd& from, const Record* record) {
  const Eigen::Index motion = 2 * system.degrees(), states = system.states();
  Eigen::VectorXd x0 = from.size() ? from : measured_state(system, system.model().values(), *record, 0);
  const Eigen::Index given = x0.size();
  const bool rest = x0.isZero(0);  // of any number of coordinates
  if ((given < motion && !rest) || given > states) {
    std::string names;
    for (const std::string& name : system.dynamics().names) names += (names.empty() ? "" : " ") + name;
    throw InputError("simulate: from: expected " + (motion < states ? std::to_string(motion) + " to " : std::string()) +
                     std::to_string(states) + " values (" + names + "), got " + std::to_string(given));
  }
  x0.conservativeResize(states);
  for (Eigen::Index i = given; i < states; ++i)
    x0[i] = i < motion ? 0 : system.model().states[static_cast<std::size_t>(i - motion)].initial;
  return x0;
}

/// simulate(model, {record=, signals=, dt=, duration=, interpolation=, x0=, solver=, rtol=, atol=, substeps=,
/// regularise=}) `record` (its channels drive) or `signals` ({channel = expression of t}). Without x0 the run starts at
/// the record's motion.
int run(lua_State* L) {
  const Model& model = check<Model>(L, 1);
  check_table(L, 2);
  if (model.imposed_motion)
    throw InputError(
        "simulate: the motion of this model is imposed: there is no free run; model:force(record) is its "
        "force along a motion");
  const auto interpolation = interpolation_field(L, 2);
  SimulateOptions options;
  options.solver = solver_from(string_field(L, 2, "solver").value_or("auto"));
  options.rtol = number_field(L, 2, "rtol").value_or(options.rtol);
  options.atol = number_field(L, 2, "atol").value_or(options.atol);
  options.substeps = static_cast<int>(number_field(L, 2, "substeps").value_or(0));
  options.stop_when = field_value(L, 2, "stop_when").expr;
  options.max_memory = number_field(L, 2, "max_memory").value_or(default_memory / giga) * giga;
  const bool sensitivities = boolean_field(L, 2, "sensitivities", false);
  if (sensitivities && options.stop_when.valid())
    throw InputError("simulate: sensitivities: not of a run that stop_when ends, whose end would move with them");
  options.cancelled = &runtime(L).cancelled();

  const auto width = number_field(L, 2, "regularise");
  const Regularised smooth = width ? regularised(model, *width) : Regularised{model, {}};
  const auto shared = std::make_shared<const System>(smooth.model);
  const System& system = *shared;
  Excitations excitation;
  std::optional<Record> record;
  with_field(L, 2, "record", [&] {
    record = check<Record>(L, -1);
    excitation = excitations_of(system, *record, interpolation);
    if (const auto dt = number_field(L, 2, "dt"))
      excitation = on_rows(std::move(excitation), system, record->dt(), *dt, options.max_memory);
  });
  with_field(L, 2, "signals", [&] {
    const double dt = number_field(L, 2, "dt").value_or(1e-3), duration = number_field(L, 2, "duration").value_or(1);
    check_memory("simulate", duration / dt + 1, run_values(system), options.max_memory);
    excitation = of_expressions(L, lua_gettop(L), system, dt, duration);
  });
  Eigen::VectorXd x0;
  with_field(L, 2, "x0", [&] { x0 = check_column(L, -1); });
  x0 = first_state(system, x0, record ? &*record : nullptr);

  FreeRun result;
  result.name = record ? record->name() : "run";
  result.place = user_position(L);
  if (result.place.size() > 2) result.place.resize(result.place.size() - 2);  // ": "
  if (sensitivities) {
    SensitivityRun exact = simulate_sensitivities(system, system.model().values(), excitation, x0, options);
    std::vector<Eigen::MatrixXd> of_a = acceleration_slopes(system, system.model().values(), excitation, exact);
    result.run = std::move(exact.run);
    result.sensitivities = std::move(exact.dx);
    std::move(of_a.begin(), of_a.end(), std::back_inserter(result.sensitivities));
    for (const Parameter& parameter : system.model().parameters) result.parameters.push_back(parameter.name);
  } else {
    result.run = simulate(system, system.model().values(), excitation, x0, options);
  }
  result.up_to = [shared, theta = system.model().values(), excitation, options](const Run& run, double t) {
    return run_up_to(*shared, theta, excitation, options, run, t);
  };
  if (width) result.run.summary.notes.push_back(regularised_note(smooth, *width));
  excitation = excitation.ordered(system);
  for (int k = 0; k < excitation.count(); ++k) {
    const std::string& name = excitation.channel(k);
    const std::string source = k == 0 && record && !record->has(name) ? "F" : name;  // F drives the first coordinate
    result.inputs.push_back(channel_of_input(name, excitation[k], record ? &*record : nullptr, source, interpolation));
  }
  result.states = system.dynamics().names;
  for (int i = 0; i < system.degrees(); ++i) result.accelerations.push_back(system.model().channel('a', i));
  push<FreeRun>(L, std::move(result));
  return 1;
}

/// imposed_force(model, record) -> column: the force that the model predicts along the measured motion.
int force_along(lua_State* L) {
  const System system(check<Model>(L, 1));
  const Eigen::VectorXd force = imposed_force(system, system.model().values(), check<Record>(L, 2));
  if (!force.allFinite())
    throw InputError(
        "force: the model has no finite force along this motion: its internal states diverge, or are too fast for the "
        "record's rate; resample the record to a finer step, or check the parameters");
  push_column(L, force);
  return 1;
}

void push_summary(lua_State* L, const RunSummary& summary) {
  lua_newtable(L);
  push_text(L, summary.solver);
  lua_setfield(L, -2, "solver");
  lua_pushboolean(L, summary.completed);
  lua_setfield(L, -2, "completed");
  if (!summary.completed) {
    lua_pushnumber(L, summary.stopped_at);
    lua_setfield(L, -2, "stopped_at");
    push_text(L, summary.cause);
    lua_setfield(L, -2, "cause");
  }
  if (std::isfinite(summary.ended_at)) {
    lua_pushnumber(L, summary.ended_at);
    lua_setfield(L, -2, "ended_at");
    push_column(L, summary.ended_in);
    lua_setfield(L, -2, "ended_in");
  }
  for (const auto& [field, value] : {std::pair{"steps", summary.steps}, std::pair{"evaluations", summary.evaluations},
                                     std::pair{"tried", summary.tried}, std::pair{"events", summary.events},
                                     std::pair{"grazing", summary.grazing}}) {
    lua_pushinteger(L, value);
    lua_setfield(L, -2, field);
  }
  lua_newtable(L);
  for (std::size_t i = 0; i < summary.notes.size(); ++i) {
    push_text(L, summary.notes[i]);
    lua_rawseti(L, -2, static_cast<lua_Integer>(i) + 1);
  }
  lua_setfield(L, -2, "notes");
  lua_pushnumber(L, summary.stuck);
  lua_setfield(L, -2, "stuck");
  lua_pushnumber(L, summary.error);
  lua_setfield(L, -2, "error");
}

Eigen::VectorXd channel_of(const FreeRun& free, const std::string& name) {
  const Run& run = free.run;
  if (name == "t") {
    return Eigen::VectorXd::NullaryExpr(run.x.rows(),
                                        [&](Eigen::Index i) { return run.t0 + run.dt * static_cast<double>(i); });
  }
  std::string known = "t";
  for (const Channel& input : free.inputs) {
    if (name == input.name) return input.values;
    known += " " + input.name;
  }
  for (std::size_t i = 0; i < free.states.size(); ++i) {
    if (name == free.states[i]) return run.x.col(static_cast<Eigen::Index>(i));
    known += " " + free.states[i];
  }
  for (std::size_t i = 0; i < free.accelerations.size(); ++i) {
    if (name == free.accelerations[i]) return run.a.col(static_cast<Eigen::Index>(i));
    known += " " + free.accelerations[i];
  }
  throw InputError("a run has no column '" + name + "'; it has " + known);
}

int column(lua_State* L) {
  push_column(L, channel_of(check<FreeRun>(L, 1), check_string(L, 2)));
  return 1;
}

/// run:at(t) -> { t =, y =, v =, a =, z = ... }: between the rows by a run of the same method from the row before.
int at(lua_State* L) {
  const FreeRun& free = check<FreeRun>(L, 1);
  const double t = check_number(L, 2);
  const Run there = free.up_to(free.run, t);
  const Eigen::Index row = there.x.rows() - 1;
  if (!there.x.row(row).allFinite()) throw InputError("at: the run to this time stopped: " + there.summary.cause);
  lua_newtable(L);
  const auto set = [&](const std::string& name, double value) {
    lua_pushnumber(L, value);
    lua_setfield(L, -2, name.c_str());
  };
  set("t", t);
  for (std::size_t i = 0; i < free.states.size(); ++i) set(free.states[i], there.x(row, static_cast<Eigen::Index>(i)));
  for (std::size_t i = 0; i < free.accelerations.size(); ++i)
    set(free.accelerations[i], there.a(row, static_cast<Eigen::Index>(i)));
  return 1;
}

/// The place of `name` in a list of words, which `what` says in the message.
std::size_t place_of(const std::vector<std::string>& words, const std::string& name, const std::string& what) {
  const auto at = std::find(words.begin(), words.end(), name);
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  throw InputError("sensitivity: " + what + ": expected one of " + all + ", got '" + name + "'");
}

/// run:sensitivity("y", "k") -> column: dy/dk; to first states by "y(0)".
int sensitivity(lua_State* L) {
  const FreeRun& free = check<FreeRun>(L, 1);
  if (free.sensitivities.empty()) throw InputError("sensitivity: the run has none; simulate with sensitivities = true");
  std::vector<std::string> columns = free.parameters;
  for (const std::string& state : free.states) columns.push_back(state + "(0)");
  std::vector<std::string> rows = free.states;
  rows.insert(rows.end(), free.accelerations.begin(), free.accelerations.end());
  const std::size_t of = place_of(rows, check_string(L, 2), "of"), to = place_of(columns, check_string(L, 3), "to");
  push_column(L, free.sensitivities[of].col(static_cast<Eigen::Index>(to)));
  return 1;
}

/// run:record() -> the rows up to where the run stopped, as a record.
int as_record(lua_State* L) {
  const FreeRun& free = check<FreeRun>(L, 1);
  Eigen::Index rows = 0;
  while (rows < free.run.x.rows() && free.run.x.row(rows).allFinite()) ++rows;
  if (rows == 0) throw InputError("run: there is no row to keep: " + free.run.summary.cause);
  std::vector<Channel> channels;
  const auto add = [&](const std::string& name, const std::string& unit) {
    Channel channel;
    channel.name = channel.source = name;
    channel.unit = unit;
    channel.values = channel_of(free, name).head(rows);
    channels.push_back(std::move(channel));
  };
  const auto motion = 2 * free.accelerations.size();
  for (Channel input : free.inputs) {
    input.values.conservativeResize(rows);
    channels.push_back(std::move(input));
  }
  for (std::size_t i = 0; i < motion; ++i) add(free.states[i], unit_of(free.states[i][0]));
  for (const std::string& name : free.accelerations) add(name, "m/s^2");
  for (std::size_t i = motion; i < free.states.size(); ++i) add(free.states[i], "");
  push<Record>(L, Record(free.name, free.run.t0, free.run.dt, std::move(channels)));
  return 1;
}

/// Fields summary, rows, dt; or a method.
int get(lua_State* L) {
  const FreeRun& free = check<FreeRun>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "summary")
    push_summary(L, free.run.summary);
  else if (key == "rows")
    lua_pushinteger(L, free.run.x.rows());
  else if (key == "dt")
    lua_pushnumber(L, free.run.dt);
  else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1)) {
      throw InputError("a run has no '" + key +
                       "' (fields: summary rows dt; methods: at column record save sensitivity)");
    }
  }
  return 1;
}

int to_string(lua_State* L) {
  const FreeRun& free = check<FreeRun>(L, 1);
  const RunSummary& summary = free.run.summary;
  char text[256];
  std::snprintf(text, sizeof text, "run of %lld rows at %.6g Hz%s%s: ", static_cast<long long>(free.run.x.rows()),
                1 / free.run.dt, summary.solver.empty() ? "" : " by ", summary.solver.c_str());
  std::string result = text;
  if (std::isfinite(summary.ended_at)) {
    std::snprintf(text, sizeof text, "ended by stop_when at t = %.9g s", summary.ended_at);
    result += text;
  } else if (summary.completed) {
    result += "completed";
  } else {
    std::snprintf(text, sizeof text, "stopped at t = %.4g s: ", summary.stopped_at);
    result += text + summary.cause + (free.place.empty() ? "" : "\n  asked for at " + free.place);
  }
  for (const std::string& note : summary.notes) result += "\n  note: " + note;
  push_text(L, result);
  return 1;
}

}  // namespace

void open_runs(lua_State* L) {
  static constexpr Entry methods[] = {{"at", guarded<at>},
                                      {"column", guarded<column>},
                                      {"record", guarded<as_record>},
                                      {"sensitivity", guarded<sensitivity>}};
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<FreeRun>(L, methods, meta);
  static constexpr Entry functions[] = {{"simulate", guarded<run>}, {"imposed_force", guarded<force_along>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
