// Frequency responses and backbone curves of a model.
#include "simulate/response.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

/// A cosine of this amplitude on a force, or of the base's displacement (with its velocity and acceleration).
std::vector<HarmonicInput> cosine_on(const System& system, const std::string& input, double amplitude) {
  const std::vector<std::string>& inputs = system.inputs();
  std::vector<HarmonicInput> list;
  const auto add = [&](const std::string& name, int derivative) {
    const auto at = std::find(inputs.begin(), inputs.end(), name);
    if (at != inputs.end()) list.push_back({static_cast<int>(at - inputs.begin()), 1, amplitude, derivative});
  };
  if (input == "base") {
    add("yb", 0);
    add("vb", 1);
    add("ab", 2);
  } else if (input.empty()) {
    if (!inputs.empty()) add(inputs.front(), 0);
  } else if (input[0] == 'F') {
    add(input, 0);
  }
  if (list.empty())
    throw InputError("frequency_response: input: expected 'base' or one of the model's forces, got '" + input +
                     "' (the model is driven by " + listed(inputs) + ")");
  return list;
}

template <class Options>
void common_options(lua_State* L, Options& options) {
  options.from = number_field(L, 2, "from").value_or(0);
  options.to = number_field(L, 2, "to").value_or(0);
  options.harmonics = static_cast<int>(number_field(L, 2, "harmonics").value_or(0));
  options.accuracy = number_field(L, 2, "accuracy").value_or(options.accuracy);
  options.max_step = number_field(L, 2, "max_step").value_or(options.max_step);
  options.max_points = static_cast<int>(number_field(L, 2, "max_points").value_or(options.max_points));
  options.cancelled = &runtime(L).cancelled();
}

/// frequency_response(model, {amplitude=, input=, from=, to=, method=, ...}) -> curve
int frequency_response_of(lua_State* L) {
  const System system(check<Model>(L, 1));
  check_table(L, 2);
  ResponseOptions options;
  common_options(L, options);
  options.method = response_method_from(string_field(L, 2, "method").value_or("auto"));
  options.stability = boolean_field(L, 2, "stability", true);
  options.points = static_cast<int>(number_field(L, 2, "points").value_or(options.points));
  options.max_periods = static_cast<long>(number_field(L, 2, "max_periods").value_or(options.max_periods));
  options.rate = number_field(L, 2, "rate").value_or(0);
  if (system.model().imposed_motion)
    throw InputError("frequency_response: the motion of this model is imposed: nothing is free to answer a force");
  const auto inputs =
      cosine_on(system, string_field(L, 2, "input").value_or(""), number_field(L, 2, "amplitude").value_or(1));
  push<ResponseCurve>(L, frequency_response(system, system.model().values(), inputs, options));
  return 1;
}

/// backbone(model, {from=, to=, mode=, ...}) -> curve
int backbone_of(lua_State* L) {
  const System system(check<Model>(L, 1));
  check_table(L, 2);
  BackboneOptions options;
  common_options(L, options);
  options.mode = static_cast<int>(number_field(L, 2, "mode").value_or(1));
  push<Backbone>(L, backbone(system, system.model().values(), options));
  return 1;
}

// ---- columns ----

/// Values of one number along a curve.
template <class Point>
Eigen::VectorXd values_of(const std::vector<Point>& points, const std::function<double(const Point&)>& value) {
  Eigen::VectorXd column(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) column[static_cast<Eigen::Index>(i)] = value(points[i]);
  return column;
}

/// "amplitude_3" with this stem: 3; -1 otherwise.
int order_of(const std::string& name, const std::string& stem) {
  if (name.size() <= stem.size() + 1 || name.compare(0, stem.size() + 1, stem + "_") != 0) return -1;
  const std::string digits = name.substr(stem.size() + 1);
  if (digits.size() > 4 || !std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; }))
    return -1;
  return std::stoi(digits);
}

/// No jumps of more than half a turn from one value to the next, but where `apart` says that a branch begins.
void unwrap(Eigen::VectorXd& phase, const std::function<bool(std::size_t)>& apart) {
  for (Eigen::Index i = 1; i < phase.size(); ++i)
    if (!apart(static_cast<std::size_t>(i)) && std::isfinite(phase[i]) && std::isfinite(phase[i - 1]))
      phase[i] -= 2 * std::numbers::pi * std::round((phase[i] - phase[i - 1]) / (2 * std::numbers::pi));
}

/// What a state does along a curve: amplitude min max mean amplitude_<k> phase_<k>; empty for another name.
template <class Point>
Eigen::VectorXd motion_column(const std::vector<Point>& points, const std::string& name, std::size_t state,
                              const std::function<bool(std::size_t)>& apart) {
  const auto of = [&](auto value) {
    return values_of<Point>(points, [&](const Point& p) { return value(p.motion[state]); });
  };
  const double none = std::nan("");
  if (name == "amplitude") return of([](const Motion& m) { return m.amplitude(); });
  if (name == "min") return of([](const Motion& m) { return m.min; });
  if (name == "max") return of([](const Motion& m) { return m.max; });
  if (name == "mean") return of([&](const Motion& m) { return m.harmonics.empty() ? none : m.harmonics[0].real(); });
  if (const int k = order_of(name, "amplitude"); k >= 1)
    return of([&](const Motion& m) {
      const auto order = static_cast<std::size_t>(k);
      return m.harmonics.empty() ? none : order < m.harmonics.size() ? std::abs(m.harmonics[order]) : 0;
    });
  if (const int k = order_of(name, "phase"); k >= 1) {
    Eigen::VectorXd phase = of([&](const Motion& m) {
      const auto order = static_cast<std::size_t>(k);
      return order < m.harmonics.size() ? std::arg(m.harmonics[order]) : none;
    });
    unwrap(phase, apart);
    return phase;
  }
  return {};
}

std::size_t state_of(lua_State* L, const char* what, const std::vector<std::string>& states, std::size_t otherwise) {
  if (lua_isnoneornil(L, 3)) return otherwise;
  const std::string name = check_string(L, 3);
  const auto at = std::find(states.begin(), states.end(), name);
  if (at == states.end())
    throw InputError(std::string(what) + " has no state '" + name + "'; it has " + listed(states));
  return static_cast<std::size_t>(at - states.begin());
}

/// curve:column(name[, state])
int response_column(lua_State* L) {
  const ResponseCurve& curve = check<ResponseCurve>(L, 1);
  const std::string name = check_string(L, 2);
  const std::size_t state = state_of(L, "a response", curve.states, 0);
  const std::pair<const char*, std::function<double(const ResponsePoint&)>> plain[] = {
      {"frequency", [](const auto& p) { return p.frequency; }},
      {"stable", [](const auto& p) { return p.stable ? 1.0 : 0.0; }},
      {"branch", [](const auto& p) { return static_cast<double>(p.branch); }},
      {"harmonics", [](const auto& p) { return static_cast<double>(p.harmonics); }},
      {"periods", [](const auto& p) { return static_cast<double>(p.periods); }},
      {"multiplier", [](const auto& p) { return p.multipliers.empty() ? std::nan("") : std::abs(p.multipliers[0]); }},
  };
  for (const auto& [known, value] : plain) {
    if (name != known) continue;
    push_column(L, values_of<ResponsePoint>(curve.points, value));
    return 1;
  }
  const auto apart = [&](std::size_t i) { return curve.points[i].branch != curve.points[i - 1].branch; };
  const Eigen::VectorXd column = motion_column(curve.points, name, state, apart);
  if (column.size() == 0 && !curve.points.empty())
    throw InputError("a response has no column '" + name +
                     "'; it has frequency stable branch harmonics periods multiplier amplitude min max mean "
                     "amplitude_1 phase_1 amplitude_2 ...");
  push_column(L, column);
  return 1;
}

int backbone_column(lua_State* L) {
  const Backbone& curve = check<Backbone>(L, 1);
  const std::string name = check_string(L, 2);
  const std::size_t state = state_of(L, "a backbone", curve.states, static_cast<std::size_t>(curve.state));
  Eigen::VectorXd column;
  if (name == "frequency")
    column = values_of<BackbonePoint>(curve.points, [](const auto& p) { return p.frequency; });
  else if (name == "damping")
    column = values_of<BackbonePoint>(curve.points, [](const auto& p) { return p.damping; });
  else
    column = motion_column(curve.points, name, state, [](std::size_t) { return false; });
  if (column.size() == 0 && !curve.points.empty())
    throw InputError("a backbone has no column '" + name +
                     "'; it has frequency damping amplitude min max mean amplitude_1 phase_1 amplitude_2 ...");
  push_column(L, column);
  return 1;
}

// ---- fields ----

void push_special(lua_State* L, const ResponseCurve& curve) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const SpecialPoint& special : curve.special) {
    const ResponsePoint& point = curve.points[special.point];
    lua_newtable(L);
    push_text(L, special.kind);
    lua_setfield(L, -2, "kind");
    lua_pushnumber(L, point.frequency);
    lua_setfield(L, -2, "frequency");
    lua_pushnumber(L, point.motion.front().amplitude());
    lua_setfield(L, -2, "amplitude");
    lua_pushinteger(L, static_cast<lua_Integer>(special.point) + 1);
    lua_setfield(L, -2, "row");
    lua_rawseti(L, -2, ++i);
  }
}

/// A method by name, or an error that lists what there is.
void push_method(lua_State* L, const std::string& key, const char* words) {
  luaL_getmetafield(L, 1, "__methods");
  lua_getfield(L, -1, key.c_str());
  if (lua_isnil(L, -1)) throw InputError("no '" + key + "' (" + words + ")");
}

int get_response(lua_State* L) {
  const ResponseCurve& curve = check<ResponseCurve>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "rows")
    lua_pushinteger(L, static_cast<lua_Integer>(curve.points.size()));
  else if (key == "method")
    push_text(L, curve.method);
  else if (key == "complete")
    lua_pushboolean(L, curve.complete);
  else if (key == "truncated")
    lua_pushboolean(L, curve.truncated);
  else if (key == "corrections")
    lua_pushinteger(L, curve.corrections);
  else if (key == "seconds")
    lua_pushnumber(L, curve.seconds);
  else if (key == "special")
    push_special(L, curve);
  else if (key == "states" || key == "stopped") {
    lua_newtable(L);
    lua_Integer i = 0;
    for (const std::string& text : key == "states" ? curve.states : curve.stopped) {
      push_text(L, text);
      lua_rawseti(L, -2, ++i);
    }
  } else {
    push_method(L, key,
                "fields: rows method special stopped states complete truncated corrections seconds; methods: column");
  }
  return 1;
}

int get_backbone(lua_State* L) {
  const Backbone& curve = check<Backbone>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "rows")
    lua_pushinteger(L, static_cast<lua_Integer>(curve.points.size()));
  else if (key == "stopped")
    push_text(L, curve.stopped);
  else if (key == "complete")
    lua_pushboolean(L, curve.complete);
  else if (key == "truncated")
    lua_pushboolean(L, curve.truncated);
  else if (key == "seconds")
    lua_pushnumber(L, curve.seconds);
  else if (key == "state")
    push_text(L, curve.states[static_cast<std::size_t>(curve.state)]);
  else
    push_method(L, key, "fields: rows stopped complete truncated state seconds; methods: column save");
  return 1;
}

int backbone_text(lua_State* L) {
  const Backbone& curve = check<Backbone>(L, 1);
  std::string text = "backbone of " + std::to_string(curve.points.size()) + " points: " + curve.stopped;
  char line[160];
  const auto state = static_cast<std::size_t>(curve.state);
  for (const auto* point : {curve.points.empty() ? nullptr : &curve.points.front(),
                            curve.points.size() < 2 ? nullptr : &curve.points.back()}) {
    if (!point) continue;
    std::snprintf(line, sizeof line, "\n  amplitude %-10.4g %.6g Hz, damping ratio %.3g",
                  point->motion[state].amplitude(), point->frequency,
                  std::abs(point->damping) < 1e-9 ? 0.0 : point->damping);
    text += line;
  }
  if (curve.truncated) text += "\n  the harmonics did not suffice everywhere for the accuracy";
  push_text(L, text);
  return 1;
}

}  // namespace

void open_responses(lua_State* L) {
  static constexpr Entry response_methods[] = {{"column", guarded<response_column>}};
  static constexpr Entry response_meta[] = {{"__index", guarded<get_response>}};
  make_type<ResponseCurve>(L, response_methods, response_meta);
  static constexpr Entry backbone_methods[] = {{"column", guarded<backbone_column>}};
  static constexpr Entry backbone_meta[] = {{"__index", guarded<get_backbone>}, {"__tostring", guarded<backbone_text>}};
  make_type<Backbone>(L, backbone_methods, backbone_meta);
  static constexpr Entry functions[] = {{"frequency_response", guarded<frequency_response_of>},
                                        {"backbone", guarded<backbone_of>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
