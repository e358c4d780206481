// Measured records.
#include <cmath>

#include "record/spectra.hpp"
#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

/// read(path, {columns = {"y=disp [mm]", ...}, resample = bool})
int read(lua_State* L) {
  const std::string path = check_string(L, 1);
  check_table(L, 2);
  ReadOptions options;
  options.resample = boolean_field(L, 2, "resample", false);
  for (const std::string& column : strings_field(L, 2, "columns")) {
    const auto map = parse_columns(column);
    options.columns.insert(options.columns.end(), map.begin(), map.end());
  }
  Record record = read_csv(path, options);
  runtime(L).note_input(path);
  push<Record>(L, std::move(record));
  return 1;
}

/// columns("t=time,y=disp [mm]") -> {"t=time", "y=disp [mm]"}, checked.
int split_columns(lua_State* L) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const ColumnMap& map : parse_columns(check_string(L, 1))) {
    push_text(L, map.channel + "=" + map.header + (map.unit.empty() ? "" : " [" + map.unit + "]"));
    lua_rawseti(L, -2, ++i);
  }
  return 1;
}

int window(lua_State* L) {
  push<Record>(L, check<Record>(L, 1).window(check_number(L, 2), check_number(L, 3)));
  return 1;
}

/// record:column "y", or "t"
int column(lua_State* L) {
  const Record& record = check<Record>(L, 1);
  const std::string name = check_string(L, 2);
  if (name == "t") {
    push_column(L, Eigen::VectorXd::NullaryExpr(record.rows(), [&](Eigen::Index i) { return record.time(i); }));
  } else {
    const auto values = record[name];
    push_column(L, Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  }
  return 1;
}

int write(lua_State* L) {
  write_csv(check<Record>(L, 1), check_string(L, 2));
  return 0;
}

void push_channels(lua_State* L, const Record& record) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Channel& channel : record.channels()) {
    lua_newtable(L);
    push_text(L, channel.name);
    lua_setfield(L, -2, "name");
    push_text(L, channel.unit);
    lua_setfield(L, -2, "unit");
    push_text(L, channel.source);
    lua_setfield(L, -2, "source");
    lua_pushnumber(L, channel.noise);
    lua_setfield(L, -2, "noise");
    lua_pushboolean(L, channel.derived);
    lua_setfield(L, -2, "derived");
    push_text(L, channel.derivation);
    lua_setfield(L, -2, "derivation");
    push_text(L, to_string(channel.between));
    lua_setfield(L, -2, "between");
    if (channel.formula.valid()) {
      push<Value>(L, {channel.formula, nullptr});
      lua_setfield(L, -2, "formula");
    }
    lua_pushvalue(L, -1);
    lua_setfield(L, -3, channel.name.c_str());
    lua_rawseti(L, -2, ++i);
  }
}

void push_texts(lua_State* L, const std::vector<std::string>& texts) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const std::string& text : texts) {
    push_text(L, text);
    lua_rawseti(L, -2, ++i);
  }
}

/// Fields name, rows, dt, start, duration, channels, warnings, history; or a method.
int get(lua_State* L) {
  const Record& record = check<Record>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "name")
    push_text(L, record.name());
  else if (key == "rows")
    lua_pushinteger(L, record.rows());
  else if (key == "dt")
    lua_pushnumber(L, record.dt());
  else if (key == "start")
    lua_pushnumber(L, record.start());
  else if (key == "duration")
    lua_pushnumber(L, record.duration());
  else if (key == "channels")
    push_channels(L, record);
  else if (key == "warnings") {
    push_texts(L, record.warnings());
  } else if (key == "history") {
    push_texts(L, record.history());
  } else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1)) {
      throw InputError(
          "a record has no '" + key +
          "' (fields: name rows dt start duration channels warnings history; methods: window column save with_noise "
          "derive filter detrend decimate resample align integrate spectrum transfer spectrogram envelope cycles noise "
          "summary)");
    }
  }
  return 1;
}

int to_string(lua_State* L) {
  push_text(L, describe(check<Record>(L, 1)));
  return 1;
}

}  // namespace

void open_records(lua_State* L) {
  static constexpr Entry methods[] = {{"window", guarded<window>}, {"column", guarded<column>}};
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<Record>(L, methods, meta);
  static constexpr Entry functions[] = {
      {"read", guarded<read>}, {"split_columns", guarded<split_columns>}, {"write_record", guarded<write>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
