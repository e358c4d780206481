// Measured records.
#include <cmath>

#include "record/atomic_file.hpp"
#include "record/container.hpp"
#include "record/spectra.hpp"
#include "runtime.hpp"
#include "stream.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

/// The field as a number, or as the name of a variable; without it neither.
void number_or_name(lua_State* L, int index, const char* field, std::optional<double>& number, std::string& name) {
  with_field(L, index, field, [&] {
    if (lua_type(L, -1) == LUA_TNUMBER)
      number = lua_tonumber(L, -1);
    else
      name = check_string(L, -1);
  });
}

}  // namespace

ReadOptions file_options(lua_State* L, int index) {
  ReadOptions options;
  options.resample = boolean_field(L, index, "resample", false);
  for (const std::string& column : strings_field(L, index, "columns")) {
    const auto map = parse_columns(column);
    options.columns.insert(options.columns.end(), map.begin(), map.end());
  }
  std::optional<double> rate, interval;
  number_or_name(L, index, "rate", rate, options.rate_name);
  number_or_name(L, index, "interval", interval, options.interval_name);
  options.interval = rate ? 1 / *rate : interval.value_or(0);
  return options;
}

namespace {

/// read(path, {columns = {"y=disp [mm]", ...}, resample = bool, rate = , interval = })
int read(lua_State* L) {
  const std::string path = check_string(L, 1);
  check_table(L, 2);
  Record record = read_record(path, file_options(L, 2));
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
  const Record& record = check<Record>(L, 1);
  const double from = check_number(L, 2), to = check_number(L, 3);
  push<Record>(L, record.window(from, to));
  return 1;
}

/// record:pieces() -> { record, ... }
int pieces(lua_State* L) {
  std::vector<Record> parts = check<Record>(L, 1).pieces();
  lua_newtable(L);
  lua_Integer i = 0;
  for (Record& part : parts) {
    push<Record>(L, std::move(part));
    lua_rawseti(L, -2, ++i);
  }
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

/// write_record(record, path, version of a MAT file): by the end of the path HDF5, MAT or else CSV.
int write(lua_State* L) {
  const Record& record = check<Record>(L, 1);
  const std::string path = check_string(L, 2);
  if (path.ends_with(".mat"))
    write_mat(record, path, check_string(L, 3) == "7.3" ? MatVersion::v7_3 : MatVersion::v5);
  else if (path.ends_with(".h5") || path.ends_with(".hdf5"))
    write_hdf5(record, path);
  else
    write_csv(record, path);
  return 0;
}

/// write_columns(path, names, {column...}): an HDF5 file.
int write_columns(lua_State* L) {
  std::vector<Eigen::VectorXd> values;
  std::vector<StoredColumn> columns;
  check_table(L, 2);
  check_table(L, 3);
  for_each(L, 3, [&](lua_Integer) { values.push_back(check_column(L, -1)); });
  for_each(L, 2, [&](lua_Integer i) {
    const Eigen::VectorXd& column = values.at(static_cast<std::size_t>(i) - 1);
    columns.push_back({check_string(L, -1), "", column.data(), static_cast<std::size_t>(column.size()), {}, {}});
  });
  std::string error;
  const std::string bytes = container_module().encode_hdf5(columns, error);
  if (!error.empty()) throw InputError(error, {check_string(L, 1)}, Fault::data);
  write_file_atomically(check_string(L, 1), bytes);
  return 0;
}

/// read_columns(path) -> names, {column...}: all vectors of numbers of an HDF5 or MAT file; nil for other files.
int read_columns(lua_State* L) {
  const std::string path = check_string(L, 1);
  if (!is_container(path)) return 0;
  const auto file = open_container(path);
  lua_newtable(L);
  lua_newtable(L);
  lua_Integer i = 0;
  for (std::size_t k = 0; k < file->variables().size(); ++k) {
    const Variable& variable = file->variables()[k];
    if (!variable.is_number() || !variable.is_vector()) continue;
    push_text(L, variable.name);
    lua_rawseti(L, -3, ++i);
    push_column(L, read_choice(*file, path, {k, -1, variable.size()}));
    lua_rawseti(L, -2, i);
  }
  if (i == 0) throw InputError("the file holds no vectors of numbers", {path}, Fault::data);
  return 2;
}

}  // namespace

void push_channels(lua_State* L, const std::vector<Channel>& channels) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Channel& channel : channels) {
    lua_newtable(L);
    push_text(L, channel.name);
    lua_setfield(L, -2, "name");
    push_text(L, channel.unit);
    lua_setfield(L, -2, "unit");
    push_text(L, channel.source);
    lua_setfield(L, -2, "source");
    push_text(L, channel.source_unit);
    lua_setfield(L, -2, "source_unit");
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

namespace {

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
    push_channels(L, record.channels());
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
          "' (fields: name rows dt start duration channels warnings history; methods: window pieces column save "
          "with_noise derive filter detrend decimate resample align integrate spectrum transfer spectrogram envelope "
          "cycles noise summary)");
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
  static constexpr Entry methods[] = {
      {"window", guarded<window>}, {"pieces", guarded<pieces>}, {"column", guarded<column>}};
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<Record>(L, methods, meta);
  static constexpr Entry functions[] = {{"read", guarded<read>},
                                        {"split_columns", guarded<split_columns>},
                                        {"write_record", guarded<write>},
                                        {"write_columns", guarded<write_columns>},
                                        {"read_columns", guarded<read_columns>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
