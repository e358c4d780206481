// A model beside a measurement: the columns to compare, and all measures of them.
#include <cmath>

#include "expr/number.hpp"
#include "expr/tape.hpp"
#include "fields.hpp"
#include "runtime.hpp"
#include "simulate/one_step.hpp"
#include "statistics/agreement.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

// ---- expressions along a record ----

/// Where the values of an expression's symbols are: channels of the record, the time, parameters as declared.
struct Columns {
  std::vector<Expr> symbols;
  std::vector<VectorXd> own;  ///< the time, values of parameters
  std::vector<const double*> in;
  std::vector<int> stride;
};

Columns columns_of(const Value& value, const Record& record, const std::string& who) {
  Columns columns;
  columns.own.reserve(symbols(value.expr).size());
  for (const Expr symbol : symbols(value.expr)) {
    columns.symbols.push_back(symbol);
    const Parameter* row = find_declared(value.declared, symbol.name());
    if (symbol.kind() == SymbolKind::state)
      throw InputError(who + ": the state '" + symbol.name() + "' is not measured: take mode = \"free_run\"");
    if (symbol.kind() == SymbolKind::parameter) {
      if (!row || !std::isfinite(row->value))
        throw InputError(who + ": the parameter '" + symbol.name() + "' has no value");
      columns.own.push_back(VectorXd::Constant(1, row->value));
    } else if (symbol.name() == "t" && !record.has("t")) {
      columns.own.push_back(VectorXd::NullaryExpr(record.rows(), [&](Index i) { return record.time(i); }));
    } else {
      columns.in.push_back(record[symbol.name()].data());
      columns.stride.push_back(1);
      continue;
    }
    columns.in.push_back(columns.own.back().data());
    columns.stride.push_back(symbol.kind() == SymbolKind::parameter ? 0 : 1);
  }
  return columns;
}

/// evaluate(record, expression, who) -> column: the expression at each row of the record.
int evaluate(lua_State* L) {
  const Record& record = check<Record>(L, 1);
  const Value value = check_value(L, 2);
  const Columns columns = columns_of(value, record, check_string(L, 3));
  const Tape tape(std::span<const Expr>(&value.expr, 1), columns.symbols);
  VectorXd result(record.rows());
  double* out[] = {result.data()};
  tape.run_columns(columns.in, columns.stride, static_cast<std::size_t>(record.rows()), out);
  for (Index i = 0; i < result.size(); ++i)
    if (!std::isfinite(result[i]))
      throw InputError(check_string(L, 3) + ": '" + to_text(value.expr) + "' is not finite at t = " +
                           write_number(record.time(i), Format::plain).text + " s: leave such rows out of the window",
                       {}, Fault::data);
  push_column(L, result);
  return 1;
}

/// predict_one_step(model, record) -> column y, column v of lunid::predict_one_step, without the first row.
int predict_one_step(lua_State* L) {
  const System system(check<Model>(L, 1));
  const Record& record = check<Record>(L, 2);
  if (!system.model().states.empty())
    throw InputError("compare: mode 'one_step': the state '" + system.model().states[0].symbol.name() +
                     "' is not measured: take mode = \"free_run\"");
  const std::vector<double> theta = system.model().values();
  const Excitations excitation = excitations_of(system, record);
  const OneStep next = predict_one_step(system, theta, record, excitation, &runtime(L).cancelled());
  push_column(L, next.y.tail(record.rows() - 1));
  push_column(L, next.v.tail(record.rows() - 1));
  return 2;
}

// ---- all measures ----

std::optional<VectorXd> column_field(lua_State* L, const char* field) {
  std::optional<VectorXd> values;
  with_field(L, 1, field, [&] { values = check_column(L, -1); });
  return values;
}

std::span<const double> span_of(const std::optional<VectorXd>& x) {
  return x ? std::span<const double>(x->data(), static_cast<std::size_t>(x->size())) : std::span<const double>();
}

void set_lag_test(lua_State* L, const char* field, const std::optional<LagTest>& test) {
  if (!test) return;
  lua_newtable(L);
  push_column(L, test->coefficients);
  lua_setfield(L, -2, "coefficients");
  set_number(L, "bound", test->bound);
  set_number(L, "p_value", test->p_value);
  for (const auto& [name, value] :
       {std::pair{"beyond", test->beyond}, std::pair{"count", static_cast<int>(test->lags.size())}}) {
    lua_pushinteger(L, value);
    lua_setfield(L, -2, name);
  }
  lua_setfield(L, -2, field);
}

void set_intervals(lua_State* L, const Agreement& found) {
  lua_newtable(L);
  for (const auto& [name, interval] : found.intervals) {
    lua_newtable(L);
    set_number(L, "low", interval.low);
    set_number(L, "high", interval.high);
    set_number(L, "std", interval.std);
    lua_setfield(L, -2, name.c_str());
  }
  lua_setfield(L, -2, "intervals");
  lua_pushinteger(L, found.block_length);
  lua_setfield(L, -2, "block");
}

/// compare{measured=, model=, measured_rate=, model_rate=, input=, neighbours=, lags=, band=, level=, draws=, seed=}
int compare_columns(lua_State* L) {
  check_table(L, 1);
  const auto measured = column_field(L, "measured"), model = column_field(L, "model"),
             measured_rate = column_field(L, "measured_rate"), model_rate = column_field(L, "model_rate"),
             input = column_field(L, "input");
  AgreementOptions options;
  options.neighbours = static_cast<int>(number_field(L, 1, "neighbours").value_or(options.neighbours));
  options.lags = static_cast<int>(number_field(L, 1, "lags").value_or(options.lags));
  options.band = static_cast<Index>(number_field(L, 1, "band").value_or(-1));
  options.level = number_field(L, 1, "level").value_or(0);
  options.draws = static_cast<int>(number_field(L, 1, "draws").value_or(options.draws));
  options.seed = static_cast<std::uint64_t>(number_field(L, 1, "seed").value_or(static_cast<double>(runtime(L).seed)));
  options.threads = runtime(L).threads;
  const Agreement found = agreement(
      {span_of(measured), span_of(model), span_of(measured_rate), span_of(model_rate), span_of(input)}, options);
  lua_newtable(L);
  lua_pushinteger(L, found.rows);
  lua_setfield(L, -2, "rows");
  for (const auto& [field, value] : {std::pair<const char*, std::optional<double>>{"rmse", found.rmse},
                                     {"nrmse", found.nrmse},
                                     {"r2", found.r2},
                                     {"fit", found.fit},
                                     {"qqcc", found.qqcc},
                                     {"dtw", found.dtw},
                                     {"mutual_information", found.mutual_information}})
    if (value) set_number(L, field, *value);
  if (found.spearman) set_number(L, "spearman", found.spearman->coefficient);
  if (found.kendall) set_number(L, "kendall", found.kendall->coefficient);
  if (found.runs) set_number(L, "runs_p_value", found.runs->p_value);
  if (found.band >= 0) set_number(L, "dtw_band", static_cast<double>(found.band));
  set_lag_test(L, "white", found.white);
  set_lag_test(L, "follows", found.follows);
  set_intervals(L, found);
  return 1;
}

}  // namespace

void open_comparisons(lua_State* L) {
  static constexpr Entry functions[] = {{"evaluate", guarded<evaluate>},
                                        {"predict_one_step", guarded<predict_one_step>},
                                        {"compare", guarded<compare_columns>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
