// Measures of columns: how alike, how dependent, how white.
#include "statistics/statistics.hpp"

#include <algorithm>
#include <cmath>

#include "fields.hpp"
#include "runtime.hpp"
#include "statistics/checks.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::uint64_t seed_at(lua_State* L, int index) {
  return lua_isnoneornil(L, index) ? runtime(L).seed : static_cast<std::uint64_t>(check_integer(L, index));
}

/// A list of columns of one length as a matrix.
MatrixXd check_columns_at(lua_State* L, int index, const char* who) {
  std::vector<VectorXd> columns;
  check_table(L, index);
  for_each(L, index, [&](lua_Integer) { columns.push_back(check_column(L, -1)); });
  if (columns.empty()) return {};
  MatrixXd matrix(columns[0].size(), static_cast<Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].size() != matrix.rows())
      throw InputError(std::string(who) + ": columns 1 and " + std::to_string(c + 1) + " have " +
                           std::to_string(matrix.rows()) + " and " + std::to_string(columns[c].size()) +
                           " rows: cut them to one window",
                       {}, Fault::data);
    matrix.col(static_cast<Index>(c)) = columns[c];
  }
  return matrix;
}

// ---- two columns, one number ----

/// measure(a, b) -> number
template <double (*Measure)(std::span<const double>, std::span<const double>)>
int measure_of(lua_State* L, const char* who, bool varies) {
  const VectorXd measured = check_column(L, 1), model = check_column(L, 2);
  check_columns(who, {span_of(measured), span_of(model)}, {.may_be_constant = true});
  if (varies) check_columns(who, {span_of(measured)});
  lua_pushnumber(L, Measure(span_of(measured), span_of(model)));
  return 1;
}

int root_mean_square_error(lua_State* L) { return measure_of<rmse>(L, "rmse", false); }
int normalised_error(lua_State* L) { return measure_of<nrmse>(L, "nrmse", true); }
int determination(lua_State* L) { return measure_of<r_squared>(L, "r2", true); }
int fit(lua_State* L) { return measure_of<fit_percent>(L, "fit", true); }

int push_correlation(lua_State* L, const Correlation& found) {
  lua_pushnumber(L, found.coefficient);
  lua_pushnumber(L, found.p_value);
  return 2;
}

/// -> rho, p
int spearman_of(lua_State* L) {
  const VectorXd a = check_column(L, 1), b = check_column(L, 2);
  return push_correlation(L, spearman(span_of(a), span_of(b)));
}

/// -> tau, p
int kendall_of(lua_State* L) {
  const VectorXd a = check_column(L, 1), b = check_column(L, 2);
  return push_correlation(L, kendall(span_of(a), span_of(b)));
}

/// correlation(a, b, seed or nil) -> r, p
int correlation_of(lua_State* L) {
  const VectorXd a = check_column(L, 1), b = check_column(L, 2);
  check_columns("correlation", {span_of(a), span_of(b)}, {.rows = 3});
  return push_correlation(L, correlation(span_of(a), span_of(b), 0, seed_at(L, 3)));
}

// ---- information ----

void push_numbers(lua_State* L, const VectorXd& values) {
  lua_createtable(L, static_cast<int>(values.size()), 0);
  for (Index i = 0; i < values.size(); ++i) {
    lua_pushnumber(L, values[i]);
    lua_rawseti(L, -2, i + 1);
  }
}

/// mutual_information({columns}, target, {given}, neighbours) -> {nat}
int information(lua_State* L) {
  const MatrixXd columns = check_columns_at(L, 1, "mutual_information"),
                 given = check_columns_at(L, 3, "conditional_mutual_information");
  const VectorXd target = check_column(L, 2);
  const NeighbourOptions options{static_cast<int>(check_integer(L, 4)), runtime(L).threads};
  push_numbers(L, conditional_mutual_information(columns, span_of(target), given, options));
  return 1;
}

/// significance_index(information, coefficient, feature) -> number
int significance(lua_State* L) {
  const VectorXd feature = check_column(L, 3);
  lua_pushnumber(L, significance_index(check_number(L, 1), check_number(L, 2), span_of(feature)));
  return 1;
}

// ---- shapes and distributions ----

/// dtw({columns of a}, {columns of b}, band or nil) -> number
int time_warping(lua_State* L) {
  const MatrixXd a = check_columns_at(L, 1, "dtw"), b = check_columns_at(L, 2, "dtw");
  lua_pushnumber(L, dtw(a, b, lua_isnoneornil(L, 3) ? -1 : check_integer(L, 3)));
  return 1;
}

/// dtw_pairing({columns of a}, {columns of b}, band or nil) -> rows of a, rows of b (counted from 1), distance
int pairing(lua_State* L) {
  const MatrixXd a = check_columns_at(L, 1, "dtw"), b = check_columns_at(L, 2, "dtw");
  const Pairing found = dtw_pairing(a, b, lua_isnoneornil(L, 3) ? -1 : check_integer(L, 3));
  push_column(L, (found.a.array() + 1).cast<double>());
  push_column(L, (found.b.array() + 1).cast<double>());
  lua_pushnumber(L, found.distance);
  return 3;
}

/// quantiles(x) against a normal distribution, or quantiles(expected, found) -> expected, found, QQCC
int quantiles(lua_State* L) {
  const VectorXd x = check_column(L, 1);
  const Quantiles points =
      lua_isnoneornil(L, 2) ? normal_quantiles(span_of(x)) : paired_quantiles(span_of(x), span_of(check_column(L, 2)));
  push_column(L, points.expected);
  push_column(L, points.found);
  lua_pushnumber(L, quantile_correlation(points));
  return 3;
}

int push_test(lua_State* L, const TestResult& result) {
  lua_pushnumber(L, result.statistic);
  lua_pushnumber(L, result.p_value);
  return 2;
}

/// kolmogorov_smirnov(x, {other =} or {mean =, std =} or {seed =}) -> D, p
int kolmogorov_smirnov(lua_State* L) {
  const VectorXd x = check_column(L, 1);
  check_table(L, 2);
  std::optional<VectorXd> other;
  with_field(L, 2, "other", [&] { other = check_column(L, -1); });
  if (other) return push_test(L, kolmogorov_two(span_of(x), span_of(*other)));
  const auto deviation = number_field(L, 2, "std");
  if (deviation) return push_test(L, kolmogorov_normal(span_of(x), number_field(L, 2, "mean").value_or(0), *deviation));
  return push_test(L, lilliefors(span_of(x), runtime(L).seed));
}

// ---- residuals ----

int ljung_box_of(lua_State* L) {
  const VectorXd x = check_column(L, 1);
  check_columns("ljung_box", {span_of(x)}, {.rows = 5});
  return push_test(L,
                   ljung_box(span_of(x), static_cast<int>(check_integer(L, 2)), static_cast<int>(check_integer(L, 3))));
}

int runs_test_of(lua_State* L) {
  const VectorXd x = check_column(L, 1);
  check_columns("runs_test", {span_of(x)}, {.rows = 5});
  return push_test(L, runs_test(span_of(x)));
}

void push_lag_test(lua_State* L, const LagTest& test) {
  lua_newtable(L);
  set_column(L, "lags", VectorXd::NullaryExpr(test.coefficients.size(), [&](Index i) {
               return static_cast<double>(test.lags[static_cast<std::size_t>(i)]);
             }));
  set_column(L, "coefficients", test.coefficients);
  set_number(L, "bound", test.bound);
  lua_pushinteger(L, test.beyond);
  lua_setfield(L, -2, "beyond");
  set_number(L, "statistic", test.statistic);
  set_number(L, "p_value", test.p_value);
}

/// whiteness(x, lags, fitted) -> {lags =, coefficients =, bound =, beyond =, statistic =, p_value =}
int whiteness_of(lua_State* L) {
  const VectorXd x = check_column(L, 1);
  push_lag_test(L, whiteness(span_of(x), static_cast<int>(check_integer(L, 2)), static_cast<int>(check_integer(L, 3))));
  return 1;
}

/// cross_correlation(residual, input, lags) -> the same
int cross_correlation_of(lua_State* L) {
  const VectorXd residual = check_column(L, 1), input = check_column(L, 2);
  push_lag_test(L, cross_correlation(span_of(residual), span_of(input), static_cast<int>(check_integer(L, 3))));
  return 1;
}

void set_columns(lua_State* L, const char* field, const MatrixXd& matrix) {
  lua_newtable(L);
  for (Index c = 0; c < matrix.cols(); ++c) {
    push_column(L, matrix.col(c));
    lua_rawseti(L, -2, c + 1);
  }
  lua_setfield(L, -2, field);
}

/// principal_components({columns}, standardise)
int components(lua_State* L) {
  const PrincipalComponents found =
      principal_components(check_columns_at(L, 1, "principal_components"), check_boolean(L, 2));
  lua_newtable(L);
  for (const auto& [field, values] : {std::pair{"mean", &found.mean}, std::pair{"scale", &found.scale},
                                      std::pair{"variances", &found.variances}, std::pair{"shares", &found.shares}})
    set_column(L, field, *values);
  set_columns(L, "directions", found.directions);
  set_columns(L, "scores", found.scores);
  return 1;
}

// ---- intervals ----

/// The first value that the function at `function` gives for chosen rows of the columns.
double call(lua_State* L, int function, const std::vector<VectorXd>& columns, std::span<const Index> rows) {
  const int top = lua_gettop(L);
  lua_pushvalue(L, function);
  for (const VectorXd& column : columns)
    push_column(L, VectorXd::NullaryExpr(static_cast<Index>(rows.size()),
                                         [&](Index i) { return column[rows[static_cast<std::size_t>(i)]]; }));
  if (lua_pcall(L, static_cast<int>(columns.size()), 1, 0) != LUA_OK) {
    const char* said = lua_tostring(L, -1);
    throw InputError(std::string("interval: of: ") + (said ? said : describe(L, -1)));
  }
  if (lua_type(L, -1) != LUA_TNUMBER)
    throw InputError("interval: of: expected the function to return a number, got " + describe(L, -1));
  const double value = lua_tonumber(L, -1);
  lua_settop(L, top);
  return value;
}

/// interval(function, {columns}, {level =, draws =, block =, method =, seed =}) -> value, low, high, std, block
int interval(lua_State* L) {
  std::vector<VectorXd> columns;
  for_each(L, 2, [&](lua_Integer) { columns.push_back(check_column(L, -1)); });
  ColumnList list;
  for (const VectorXd& column : columns) list.push_back(span_of(column));
  check_columns("interval", list, {.rows = 10, .may_be_constant = true});
  IntervalOptions options;
  options.level = number_field(L, 3, "level").value_or(options.level);
  options.draws = static_cast<int>(number_field(L, 3, "draws").value_or(options.draws));
  options.seed = static_cast<std::uint64_t>(number_field(L, 3, "seed").value_or(static_cast<double>(runtime(L).seed)));
  options.threads = 1;  // Lua has one
  Index longest = 1;
  for (const auto& column : list) longest = std::max(longest, choose_block_length(column));
  options.block_length = static_cast<Index>(number_field(L, 3, "block").value_or(static_cast<double>(longest)));
  const auto statistic = [&](std::span<const Index> rows) {
    throw_if_cancelled(runtime(L));
    VectorXd value(1);
    value[0] = call(L, 1, columns, rows);
    return value;
  };
  std::vector<Index> all(list[0].size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
  const double value = statistic(all)[0];
  const bool jackknife = string_field(L, 3, "method") == "jackknife";
  const auto rows = static_cast<Index>(all.size());
  const Interval found = (jackknife ? jackknife_intervals : bootstrap_intervals)(rows, statistic, options)[0];
  for (const double each : {value, found.low, found.high, found.std}) lua_pushnumber(L, each);
  lua_pushinteger(L, options.block_length);
  return 5;
}

}  // namespace

void open_statistics(lua_State* L) {
  static constexpr Entry functions[] = {
      {"rmse", guarded<root_mean_square_error>},
      {"nrmse", guarded<normalised_error>},
      {"r2", guarded<determination>},
      {"fit", guarded<fit>},
      {"correlation", guarded<correlation_of>},
      {"spearman", guarded<spearman_of>},
      {"kendall", guarded<kendall_of>},
      {"mutual_information", guarded<information>},
      {"significance_index", guarded<significance>},
      {"dtw", guarded<time_warping>},
      {"dtw_pairing", guarded<pairing>},
      {"quantiles", guarded<quantiles>},
      {"kolmogorov_smirnov", guarded<kolmogorov_smirnov>},
      {"ljung_box", guarded<ljung_box_of>},
      {"runs_test", guarded<runs_test_of>},
      {"whiteness", guarded<whiteness_of>},
      {"cross_correlation", guarded<cross_correlation_of>},
      {"principal_components", guarded<components>},
      {"interval", guarded<interval>},
  };
  lua_newtable(L);
  set_functions(L, functions);
  lua_setfield(L, -2, "statistics");
}

}  // namespace lunid::lua
