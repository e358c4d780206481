// History models: ARX, ARMAX, NARX, NARMAX.
#include <cmath>

#include "fields.hpp"
#include "regress/history.hpp"
#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {

template <>
struct Bound<HistoryModel> {
  static constexpr const char* key = "lunid.history_model";
  static constexpr const char* words = "a history model";
};

namespace {

HistoryOptions options_of(lua_State* L, int index) {
  HistoryOptions options;
  const auto count = [&](const char* field, int& value) {
    value = static_cast<int>(number_field(L, index, field).value_or(value));
  };
  options.output = string_field(L, index, "output").value_or(options.output);
  options.input = string_field(L, index, "input").value_or(options.input);
  count("outputs", options.output_lags);
  count("inputs", options.input_lags);
  count("delay", options.input_delay);
  count("noise", options.noise_lags);
  count("degree", options.degree);
  count("max_passes", options.max_passes);
  options.constant = boolean_field(L, index, "constant", false);
  with_field(L, index, "features",
             [&] { for_each(L, -1, [&](lua_Integer) { options.features.push_back(check_value(L, -1).expr); }); });
  return options;
}

std::vector<Record> records_of(lua_State* L, int index) {
  std::vector<Record> records;
  check_table(L, index);
  for_each(L, index, [&](lua_Integer) { records.push_back(check<Record>(L, -1)); });
  return records;
}

/// fit_history({records}, {output=, input=, outputs=, inputs=, delay=, noise=, degree=, constant=, features=})
int fit(lua_State* L) {
  const std::vector<Record> records = records_of(L, 1);
  push<HistoryModel>(L, fit_history(*runtime(L).pool(), records, options_of(L, 2)));
  return 1;
}

/// history_orders({records}, options) -> list of {outputs=, inputs=, residual_std=, aic=, bic=}, the least BIC first
int orders(lua_State* L) {
  const std::vector<Record> records = records_of(L, 1);
  lua_newtable(L);
  lua_Integer i = 0;
  for (const HistoryOrder& order : history_orders(*runtime(L).pool(), records, options_of(L, 2))) {
    lua_newtable(L);
    lua_pushinteger(L, order.output_lags);
    lua_setfield(L, -2, "outputs");
    lua_pushinteger(L, order.input_lags);
    lua_setfield(L, -2, "inputs");
    set_number(L, "residual_std", order.residual_std);
    set_number(L, "aic", order.aic);
    set_number(L, "bic", order.bic);
    lua_rawseti(L, -2, ++i);
  }
  return 1;
}

/// stored_history({output=, input=, dt=, between=, residual_std=, terms = {{feature, value, std}, ...}})
int stored(lua_State* L) {
  HistoryModel model;
  model.options = options_of(L, 1);
  model.dt = number_field(L, 1, "dt").value_or(0);
  model.between = interpolation_named(string_field(L, 1, "between").value_or("linear"));
  model.residual_std = number_field(L, 1, "residual_std").value_or(std::nan(""));
  model.stopped = "stored";
  with_field(L, 1, "terms", [&] {
    for_each(L, -1, [&](lua_Integer) {
      HistoryTerm term;
      term.feature = field_value(L, -1, "feature").expr;
      term.coefficient = number_field(L, -1, "value").value_or(0);
      term.std = number_field(L, -1, "std").value_or(std::nan(""));
      model.terms.push_back(term);
    });
  });
  const auto count = static_cast<Eigen::Index>(model.terms.size());
  model.covariance = Eigen::MatrixXd::Constant(count, count, std::nan(""));
  push<HistoryModel>(L, std::move(model));
  return 1;
}

/// model:predict_rows(record, steps) -> {values=, first=, rmse=, fit=, ended=}, rows counted from 1; steps 0: a free
/// run
int predict_rows(lua_State* L) {
  const HistoryModel& model = check<HistoryModel>(L, 1);
  const Record& record = check<Record>(L, 2);
  const Prediction p = predict(model, record, static_cast<int>(check_integer(L, 3)));
  lua_newtable(L);
  push_column(L, p.values);
  lua_setfield(L, -2, "values");
  lua_pushinteger(L, p.first + 1);
  lua_setfield(L, -2, "first");
  set_number(L, "rmse", p.rmse);
  set_number(L, "fit", p.fit);
  if (p.ended >= 0) set_number(L, "stopped_at", record.time(p.ended));
  return 1;
}

/// model:residual_tests(record, lags = 25) -> list of {name=, first_lag=, correlation=, bound=, outside=, passed=}
int tests(lua_State* L) {
  const HistoryModel& model = check<HistoryModel>(L, 1);
  const int lags = lua_isnoneornil(L, 3) ? 25 : static_cast<int>(check_integer(L, 3));
  lua_newtable(L);
  lua_Integer i = 0;
  for (const ResidualTest& test : residual_tests(model, check<Record>(L, 2), lags)) {
    lua_newtable(L);
    set_text(L, "name", test.name);
    lua_pushinteger(L, test.first_lag);
    lua_setfield(L, -2, "first_lag");
    push_column(L, test.correlation);
    lua_setfield(L, -2, "correlation");
    set_number(L, "bound", test.bound);
    lua_pushinteger(L, test.outside);
    lua_setfield(L, -2, "outside");
    lua_pushboolean(L, test.passed);
    lua_setfield(L, -2, "passed");
    lua_rawseti(L, -2, ++i);
  }
  return 1;
}

/// model:equation() -> {mass=, damping=, stiffness=, mass_std= ..., mismatch=}
int equation(lua_State* L) {
  const ContinuousModel found = to_continuous(check<HistoryModel>(L, 1));
  lua_newtable(L);
  set_number(L, "mass", found.mass);
  set_number(L, "damping", found.damping);
  set_number(L, "stiffness", found.stiffness);
  set_number(L, "mass_std", found.mass_std);
  set_number(L, "damping_std", found.damping_std);
  set_number(L, "stiffness_std", found.stiffness_std);
  set_number(L, "mismatch", found.mismatch);
  return 1;
}

/// model:poles() -> list of {real=, imaginary=} [rad/s]
int poles(lua_State* L) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const auto& [real, imaginary] : history_poles(check<HistoryModel>(L, 1))) {
    lua_newtable(L);
    set_number(L, "real", real);
    set_number(L, "imaginary", imaginary);
    lua_rawseti(L, -2, ++i);
  }
  return 1;
}

void push_terms(lua_State* L, const HistoryModel& model) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const HistoryTerm& term : model.terms) {
    const std::string name = to_text(term.feature);
    lua_newtable(L);
    set_text(L, "name", name);
    set_number(L, "value", term.coefficient);
    set_number(L, "std", term.std);
    lua_pushvalue(L, -1);
    lua_setfield(L, -3, name.c_str());
    lua_rawseti(L, -2, ++i);
  }
}

int get(lua_State* L) {
  const HistoryModel& model = check<HistoryModel>(L, 1);
  const std::string key = check_string(L, 2);
  if (key == "terms")
    push_terms(L, model);
  else if (key == "output")
    push_text(L, model.options.output);
  else if (key == "input")
    push_text(L, model.options.input);
  else if (key == "dt")
    lua_pushnumber(L, model.dt);
  else if (key == "rows")
    lua_pushinteger(L, model.rows);
  else if (key == "residual_std")
    lua_pushnumber(L, model.residual_std);
  else if (key == "aic")
    lua_pushnumber(L, model.aic);
  else if (key == "bic")
    lua_pushnumber(L, model.bic);
  else if (key == "converged")
    lua_pushboolean(L, model.converged);
  else if (key == "stopped")
    push_text(L, model.stopped);
  else if (key == "passes")
    lua_pushinteger(L, model.passes);
  else if (key == "between")
    push_text(L, to_string(model.between));
  else {
    luaL_getmetafield(L, 1, "__methods");
    lua_getfield(L, -1, key.c_str());
    if (lua_isnil(L, -1))
      throw InputError("a history model has no '" + key +
                       "' (fields: terms output input dt between rows residual_std aic bic converged stopped passes; "
                       "methods: predict free_run residual_tests equation poles save)");
  }
  return 1;
}

int to_string(lua_State* L) {
  const HistoryModel& model = check<HistoryModel>(L, 1);
  char text[128];
  std::string all = "history model of " + model.options.output + " from " + model.options.input;
  std::snprintf(text, sizeof text, ", %.6g s between samples: one-step residual std %.4g, %s", model.dt,
                model.residual_std, model.stopped.c_str());
  all += text;
  for (const HistoryTerm& term : model.terms) {
    std::snprintf(text, sizeof text, term.std > 0 ? " = %.8g +- %.2g" : " = %.8g", term.coefficient, term.std);
    all += "\n  " + to_text(term.feature) + text;
  }
  push_text(L, all);
  return 1;
}

}  // namespace

void open_histories(lua_State* L) {
  static constexpr Entry methods[] = {{"predict_rows", guarded<predict_rows>},
                                      {"residual_tests", guarded<tests>},
                                      {"equation", guarded<equation>},
                                      {"poles", guarded<poles>}};
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<HistoryModel>(L, methods, meta);
  static constexpr Entry functions[] = {
      {"fit_history", guarded<fit>}, {"history_orders", guarded<orders>}, {"stored_history", guarded<stored>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
