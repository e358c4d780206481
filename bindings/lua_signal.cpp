// Signals that are made: excitations, random numbers, and what sensors do to a record.
#include <cmath>

#include "expr/number.hpp"
#include "expr/tape.hpp"
#include "record/random_signal.hpp"
#include "record/sensor.hpp"
#include "runtime.hpp"
#include "simulate/simulate.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::uint64_t seed_field(lua_State* L, int index) {
  std::uint64_t seed = runtime(L).seed;
  with_field(L, index, "seed", [&] { seed = static_cast<std::uint64_t>(check_integer(L, -1)); });
  return seed;
}

Index rows_field(lua_State* L, int index) { return static_cast<Index>(number_field(L, index, "rows").value_or(0)); }

/// An expression of the time alone at t0 + i*dt.
VectorXd sampled(Expr formula, double t0, double dt, Index rows) {
  const Expr inputs[] = {formula.pool().channel("t")};
  const Tape tape(std::span<const Expr>(&formula, 1), inputs);
  const VectorXd time = VectorXd::NullaryExpr(rows, [&](Index i) { return t0 + dt * static_cast<double>(i); });
  VectorXd values(rows);
  const double* in[] = {time.data()};
  const int stride[] = {1};
  double* out[] = {values.data()};
  tape.run_columns(in, stride, static_cast<std::size_t>(rows), out);
  return values;
}

Record record_of_force(std::string name, double t0, double dt, Channel force) {
  force.name = "F";
  force.unit = "N";
  for (Index i = 0; i < force.values.size(); ++i) {
    if (!std::isfinite(force.values[i]))
      throw InputError(name + ": the force at t = " +
                       write_number(t0 + dt * static_cast<double>(i), Format::plain).text + " s is not finite");
  }
  return Record(std::move(name), t0, dt, {std::move(force)});
}

/// excitation{name=, source=, start=, dt=, rows=, formula=, values=, between=}: the force formula(t) + values as a
/// record with the channel F.
int make_excitation(lua_State* L) {
  check_table(L, 1);
  const double t0 = number_field(L, 1, "start").value_or(0), dt = number_field(L, 1, "dt").value_or(1);
  const Index rows = rows_field(L, 1);
  Channel force;
  force.source = string_field(L, 1, "source").value_or("");
  force.between = interpolation_named(string_field(L, 1, "between").value_or("linear"));
  force.formula = field_value(L, 1, "formula").expr;
  force.values = force.formula.valid() ? sampled(force.formula, t0, dt, rows) : VectorXd::Zero(rows);
  with_field(L, 1, "values", [&] {
    const VectorXd values = check_column(L, -1);
    if (values.size() != rows)
      throw InputError("values: expected " + std::to_string(rows) + " rows, got " + std::to_string(values.size()));
    force.values += values;
  });
  push<Record>(L, record_of_force(string_field(L, 1, "name").value_or("excitation"), t0, dt, std::move(force)));
  return 1;
}

/// sum_excitations({records...}, name, between): the forces on one time base added, formulas as well.
int sum_excitations(lua_State* L) {
  check_table(L, 1);
  Channel total;
  std::optional<Record> first;
  for_each(L, 1, [&](lua_Integer) {
    const Record& part = check<Record>(L, -1);
    const Channel& force = part.channel("F");
    const auto values = part["F"];
    if (!first) {
      first = part;
      total.values = VectorXd::Zero(part.rows());
    }
    total.values += Eigen::Map<const VectorXd>(values.data(), part.rows());
    if (force.formula.valid()) total.formula = total.formula.valid() ? total.formula + force.formula : force.formula;
    total.source += (total.source.empty() ? "" : " + ") + force.source;
  });
  total.between = interpolation_named(check_string(L, 3));
  push<Record>(L, record_of_force(check_string(L, 2), first->start(), first->dt(), std::move(total)));
  return 1;
}

/// random_signal{kind=, rows=, dt=, seed=, stream=, exponent=, from=, to=} -> column of rms 1 (uniform: -1 to 1)
int random_signal(lua_State* L) {
  check_table(L, 1);
  const std::string kind = string_field(L, 1, "kind").value_or("");
  const Index rows = rows_field(L, 1);
  Philox random(seed_field(L, 1), stream_of(string_field(L, 1, "stream").value_or(kind)));
  if (kind == "uniform") {
    push_column(L, uniform_noise(rows, random));
  } else if (kind == "white") {
    push_column(L, white_noise(rows, random));
  } else if (kind == "coloured") {
    push_column(L, coloured_noise(rows, number_field(L, 1, "exponent").value_or(0), random));
  } else if (kind == "band_limited") {
    push_column(L,
                band_limited_noise(rows, number_field(L, 1, "dt").value_or(1), number_field(L, 1, "from").value_or(0),
                                   number_field(L, 1, "to").value_or(0), random));
  } else {
    throw InputError("random_signal: no kind '" + kind + "'");
  }
  return 1;
}

SensorFault::Kind kind_from(const std::string& name) {
  using Kind = SensorFault::Kind;
  for (const auto& [word, kind] : {std::pair{"gaussian", Kind::gaussian},
                                   {"uniform", Kind::uniform},
                                   {"coloured", Kind::coloured},
                                   {"multiplicative", Kind::multiplicative},
                                   {"poisson", Kind::poisson},
                                   {"outliers", Kind::outliers},
                                   {"dropped", Kind::dropped},
                                   {"quantised", Kind::quantised},
                                   {"clipped", Kind::clipped}}) {
    if (name == word) return kind;
  }
  throw InputError("noise: no kind '" + name + "'");
}

SensorFault fault_from(lua_State* L, int index) {
  SensorFault fault;
  fault.kind = kind_from(string_field(L, index, "kind").value_or(""));
  fault.size = number_field(L, index, "size").value_or(0);
  fault.relative = boolean_field(L, index, "relative", false);
  fault.exponent = number_field(L, index, "exponent").value_or(0);
  fault.fraction = number_field(L, index, "fraction").value_or(0);
  fault.bits = static_cast<int>(number_field(L, index, "bits").value_or(0));
  with_field(L, index, "ar", [&] {
    const VectorXd ar = check_column(L, -1);
    fault.ar.assign(ar.begin(), ar.end());
  });
  const std::string fill = string_field(L, index, "fill").value_or("hold");
  fault.fill = fill == "gap"      ? SensorFault::Fill::gap
               : fill == "linear" ? SensorFault::Fill::linear
                                  : SensorFault::Fill::hold;
  return fault;
}

/// disturb(record, channel, {faults...}, seed or nil) -> record, {rows hit by each fault}
int disturb(lua_State* L) {
  const Record& record = check<Record>(L, 1);
  const std::string name = check_string(L, 2);
  check_table(L, 3);
  const std::uint64_t seed = lua_isnoneornil(L, 4) ? runtime(L).seed : static_cast<std::uint64_t>(check_integer(L, 4));
  Channel channel = record.channel(name);
  const auto clean = record[name];
  channel.values = Eigen::Map<const VectorXd>(clean.data(), record.rows());
  std::vector<Index> hit;
  for_each(L, 3, [&](lua_Integer i) {
    Philox random(seed, stream_of("noise " + name + " " + std::to_string(i)));
    hit.push_back(apply(fault_from(L, lua_gettop(L)), channel.values, random));
  });
  if (channel.values.allFinite())
    channel.noise = noise_level({channel.values.data(), static_cast<std::size_t>(channel.values.size())});
  push<Record>(L, record.with(std::move(channel)));
  lua_newtable(L);
  for (std::size_t i = 0; i < hit.size(); ++i) {
    lua_pushinteger(L, hit[i]);
    lua_rawseti(L, -2, static_cast<lua_Integer>(i) + 1);
  }
  return 2;
}

/// measured_motion(record, {"F", "y", "v"}, name) -> a record of these channels alone, with their noise levels, and the
/// rest of the motion derived from them as for a file.
int measured_motion(lua_State* L) {
  const Record& record = check<Record>(L, 1);
  check_table(L, 2);
  std::vector<Channel> channels;
  for_each(L, 2, [&](lua_Integer) {
    const std::string name = check_string(L, -1);
    Channel channel = record.channel(name);
    const auto values = record[name];
    channel.values = Eigen::Map<const VectorXd>(values.data(), record.rows());
    channel.noise = noise_level(values);
    channel.formula = {};
    channels.push_back(std::move(channel));
  });
  push<Record>(L, derive_motion(Record(check_string(L, 3), record.start(), record.dt(), std::move(channels))));
  return 1;
}

/// record_of_columns(name, start, dt, {{name=, unit=, values=}...}) -> a record of columns that are there already, with
/// their noise levels, and the rest of the motion derived from them as for a file.
int record_of_columns(lua_State* L) {
  check_table(L, 4);
  std::vector<Channel> channels;
  for_each(L, 4, [&](lua_Integer) {
    Channel channel;
    channel.name = channel.source = string_field(L, -1, "name").value_or("");
    channel.unit = string_field(L, -1, "unit").value_or("");
    with_field(L, -1, "values", [&] { channel.values = check_column(L, -1); });
    channel.noise = noise_level({channel.values.data(), static_cast<std::size_t>(channel.values.size())});
    channels.push_back(std::move(channel));
  });
  const Record record(check_string(L, 1), check_number(L, 2), check_number(L, 3), std::move(channels));
  push<Record>(L, has_motion(record) ? derive_motion(record) : record);
  return 1;
}

/// run_seed() -> the seed of the run (--seed)
int run_seed(lua_State* L) {
  lua_pushinteger(L, static_cast<lua_Integer>(runtime(L).seed));
  return 1;
}

/// warn(record, text) -> a copy with one more warning
int warn(lua_State* L) {
  Record record = check<Record>(L, 1);
  record.warn(check_string(L, 2));
  push<Record>(L, std::move(record));
  return 1;
}

}  // namespace

void open_signals(lua_State* L) {
  static constexpr Entry functions[] = {
      {"make_excitation", guarded<make_excitation>},
      {"sum_excitations", guarded<sum_excitations>},
      {"random_signal", guarded<random_signal>},
      {"disturb", guarded<disturb>},
      {"measured_motion", guarded<measured_motion>},
      {"record_of_columns", guarded<record_of_columns>},
      {"warn_record", guarded<warn>},
      {"run_seed", guarded<run_seed>},
  };
  set_functions(L, functions);
}

}  // namespace lunid::lua
