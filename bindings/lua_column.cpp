// Columns of numbers: shared, read-only, 1-based.
#include <algorithm>
#include <cmath>

#include "types.hpp"

namespace lunid::lua {

void push_column(lua_State* L, const Eigen::VectorXd& values) {
  push<Column>(L, {std::make_shared<const Eigen::VectorXd>(values)});
  // The collector sees a few bytes of it. Told of the rest, it keeps up with loops that take a column in every row.
  if (const auto kilobytes = values.size() * static_cast<Eigen::Index>(sizeof(double)) / 1024; kilobytes > 0) {
    lua_gc(L, LUA_GCSTEP, static_cast<int>(std::min<Eigen::Index>(kilobytes, 1 << 20)));
  }
}

Eigen::VectorXd check_column(lua_State* L, int index) {
  if (const Column* column = test<Column>(L, index)) return *column->values;
  if (lua_type(L, index) != LUA_TTABLE) bad_argument(L, index, "a column or a list of numbers");
  Eigen::VectorXd values(static_cast<Eigen::Index>(lua_rawlen(L, index)));
  for_each(L, index, [&](lua_Integer i) {
    if (lua_type(L, -1) != LUA_TNUMBER) {
      throw InputError("entry " + std::to_string(i) + ": expected a number, got " + describe(L, -1));
    }
    values[static_cast<Eigen::Index>(i - 1)] = lua_tonumber(L, -1);
  });
  return values;
}

namespace {

/// column[i], or a method by name. The row behind the last is nil: with it ipairs(column) ends.
int get(lua_State* L) {
  const Column& column = check<Column>(L, 1);
  if (lua_type(L, 2) == LUA_TSTRING) {
    luaL_getmetafield(L, 1, "__methods");
    lua_pushvalue(L, 2);
    lua_rawget(L, -2);
    return 1;
  }
  const long long i = check_integer(L, 2);
  if (i == column.values->size() + 1) {
    lua_pushnil(L);
    return 1;
  }
  if (i < 1 || i > column.values->size()) {
    throw InputError("column: row " + std::to_string(i) + " is outside 1 to " + std::to_string(column.values->size()));
  }
  lua_pushnumber(L, (*column.values)[static_cast<Eigen::Index>(i - 1)]);
  return 1;
}

int length(lua_State* L) {
  lua_pushinteger(L, check<Column>(L, 1).values->size());
  return 1;
}

int to_string(lua_State* L) {
  lua_pushfstring(L, "column of %d numbers", static_cast<int>(check<Column>(L, 1).values->size()));
  return 1;
}

/// The finite values; most statistics are over them.
Eigen::VectorXd finite(const Column& column) {
  Eigen::VectorXd values(column.values->size());
  Eigen::Index count = 0;
  for (const double value : *column.values) {
    if (std::isfinite(value)) values[count++] = value;
  }
  return values.head(count);
}

template <class Statistic>
int statistic(lua_State* L, Statistic of) {
  const Eigen::VectorXd values = finite(check<Column>(L, 1));
  lua_pushnumber(L, values.size() ? of(values) : std::nan(""));
  return 1;
}

int minimum(lua_State* L) {
  return statistic(L, [](const auto& x) { return x.minCoeff(); });
}
int maximum(lua_State* L) {
  return statistic(L, [](const auto& x) { return x.maxCoeff(); });
}
int mean(lua_State* L) {
  return statistic(L, [](const auto& x) { return x.mean(); });
}
int root_mean_square(lua_State* L) {
  return statistic(L, [](const auto& x) { return std::sqrt(x.squaredNorm() / static_cast<double>(x.size())); });
}
int deviation(lua_State* L) {
  return statistic(L, [](const auto& x) { return std::sqrt((x.array() - x.mean()).square().mean()); });
}

int to_list(lua_State* L) {
  const Column column = check<Column>(L, 1);
  lua_createtable(L, static_cast<int>(column.values->size()), 0);
  for (Eigen::Index i = 0; i < column.values->size(); ++i) {
    lua_pushnumber(L, (*column.values)[i]);
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

/// column:every(n): rows 1, n + 1, 2n + 1, ...
int every(lua_State* L) {
  const Column column = check<Column>(L, 1);
  const long long step = check_integer(L, 2);
  if (step < 1) throw InputError("column: every: expected >= 1, got " + std::to_string(step));
  const auto count = (column.values->size() + step - 1) / step;
  push_column(L, Eigen::VectorXd::NullaryExpr(count, [&](Eigen::Index i) { return (*column.values)[i * step]; }));
  return 1;
}

/// column(list of numbers)
int make_column(lua_State* L) {
  push_column(L, check_column(L, 1));
  return 1;
}

}  // namespace

void open_columns(lua_State* L) {
  static constexpr Entry methods[] = {
      {"min", guarded<minimum>},   {"max", guarded<maximum>},          {"mean", guarded<mean>},
      {"std", guarded<deviation>}, {"rms", guarded<root_mean_square>}, {"list", guarded<to_list>},
      {"every", guarded<every>},
  };
  static constexpr Entry meta[] = {
      {"__index", guarded<get>}, {"__len", guarded<length>}, {"__tostring", guarded<to_string>}};
  make_type<Column>(L, methods, meta);
  static constexpr Entry functions[] = {{"column", guarded<make_column>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
