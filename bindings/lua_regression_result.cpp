// What a regression gives: its fields, and its text.
#include <cmath>
#include <cstdio>

#include "fields.hpp"
#include "regression.hpp"

namespace lunid::lua {

namespace {

/// List of {feature=, name=, value=, unit=, std=, block_std=, lower=, upper=, vif=, inclusion=, contribution=, place=},
/// each also under its feature's text.
void push_terms(lua_State* L, const SolvedRegression& solved) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Term& term : solved.result.terms) {
    const std::string name = to_text(term.feature);
    lua_newtable(L);
    push<Value>(L, {term.feature, solved.declared});
    lua_setfield(L, -2, "feature");
    push_text(L, name);
    lua_setfield(L, -2, "name");
    set_number(L, "value", term.coefficient);
    set_number(L, "std", term.std);
    set_number(L, "block_std", term.block_std);
    set_number(L, "contribution", term.contribution);
    set_number(L, "lower", term.lower);
    set_number(L, "upper", term.upper);
    set_number(L, "vif", term.vif);
    set_number(L, "inclusion", term.inclusion);
    push_text(L, term.unit);
    lua_setfield(L, -2, "unit");
    push_text(L, to_text(term.where));
    lua_setfield(L, -2, "place");
    lua_pushvalue(L, -1);
    lua_setfield(L, -3, name.c_str());
    lua_rawseti(L, -2, ++i);
  }
}

void push_implicit(lua_State* L, const Regression& result) {
  lua_newtable(L);
  for (const ImplicitParameter& parameter : result.implicit) {
    lua_newtable(L);
    set_number(L, "value", parameter.value);
    set_number(L, "std", parameter.std);
    lua_setfield(L, -2, parameter.name.c_str());
  }
}

/// {count=, largest = {{record=, row=, time=, size=}, ...}}
void push_outliers(lua_State* L, const Outliers& outliers) {
  lua_newtable(L);
  set_number(L, "count", static_cast<double>(outliers.count));
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Outlier& o : outliers.largest) {
    lua_newtable(L);
    set_number(L, "record", static_cast<double>(o.record + 1));
    set_number(L, "row", static_cast<double>(o.row + 1));
    set_number(L, "time", o.time);
    set_number(L, "size", o.size);
    lua_rawseti(L, -2, ++i);
  }
  lua_setfield(L, -2, "largest");
}

/// List of {features = {names}, feature=, added=, error_reduction=, rmse=, criterion=}.
void push_steps(lua_State* L, const Fit& fit) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const SelectionStep& step : fit.steps) {
    lua_newtable(L);
    lua_newtable(L);
    lua_Integer k = 0;
    for (const int j : step.features) {
      push_text(L, fit.features[static_cast<std::size_t>(j)]);
      lua_rawseti(L, -2, ++k);
    }
    lua_setfield(L, -2, "features");
    if (step.feature >= 0) {
      push_text(L, fit.features[static_cast<std::size_t>(step.feature)]);
      lua_setfield(L, -2, "feature");
    }
    lua_pushboolean(L, step.added);
    lua_setfield(L, -2, "added");
    set_number(L, "error_reduction", step.error_reduction);
    set_number(L, "rmse", step.rmse);
    set_number(L, "criterion", step.criterion);
    lua_rawseti(L, -2, ++i);
  }
}

/// List of {lambda=, coefficients = column, rmse=, cv_rmse=, cv_std=}: the path of a lasso.
void push_path(lua_State* L, const std::vector<PathPoint>& path) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const PathPoint& point : path) {
    lua_newtable(L);
    set_number(L, "lambda", point.lambda);
    push_column(L, point.coefficients);
    lua_setfield(L, -2, "coefficients");
    set_number(L, "rmse", point.rmse);
    set_number(L, "cv_rmse", point.cv_rmse);
    set_number(L, "cv_std", point.cv_std);
    lua_rawseti(L, -2, ++i);
  }
}

void push_covariance(lua_State* L, const Fit& fit) {
  lua_newtable(L);
  for (Eigen::Index i = 0; i < fit.covariance.rows(); ++i) {
    lua_newtable(L);
    for (Eigen::Index j = 0; j < fit.covariance.cols(); ++j) {
      lua_pushnumber(L, fit.covariance(i, j));
      lua_rawseti(L, -2, static_cast<lua_Integer>(j + 1));
    }
    lua_rawseti(L, -2, static_cast<lua_Integer>(i + 1));
  }
}

/// {least_power=, y=, v=, imposed=}, or nil.
void push_passivity(lua_State* L, const std::optional<Passivity>& passivity) {
  if (!passivity) return lua_pushnil(L);
  lua_newtable(L);
  set_number(L, "least_power", passivity->least_power);
  set_number(L, "y", passivity->y);
  set_number(L, "v", passivity->v);
  lua_pushboolean(L, passivity->imposed);
  lua_setfield(L, -2, "imposed");
}

const Model& model_of(const SolvedRegression& solved) {
  if (!solved.model) throw InputError(solved.why_none);
  return *solved.model;
}

template <class Item, class Text>
void push_texts(lua_State* L, const std::vector<Item>& items, Text text) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Item& item : items) {
    push_text(L, text(item));
    lua_rawseti(L, -2, ++i);
  }
}

}  // namespace

/// The fields that the last message lists.
int regression_field(lua_State* L) {
  const SolvedRegression& solved = check<SolvedRegression>(L, 1);
  const Regression& result = solved.result;
  const std::string key = check_string(L, 2);
  const auto itself = [](const std::string& text) { return text; };
  const auto text = [](const auto& item) { return item.text; };
  if (key == "model")
    push<Model>(L, model_of(solved));
  else if (key == "terms")
    push_terms(L, solved);
  else if (key == "implicit")
    push_implicit(L, result);
  else if (key == "r2")
    lua_pushnumber(L, result.r2);
  else if (key == "rmse")
    lua_pushnumber(L, result.rmse);
  else if (key == "condition")
    lua_pushnumber(L, result.fit.condition);
  else if (key == "kkt")
    lua_pushnumber(L, result.fit.summary.kkt);
  else if (key == "iterations")
    lua_pushinteger(L, result.fit.summary.iterations);
  else if (key == "covariance")
    push_covariance(L, result.fit);
  else if (key == "steps")
    push_steps(L, result.fit);
  else if (key == "path")
    push_path(L, result.path);
  else if (key == "outliers")
    push_outliers(L, result.outliers);
  else if (key == "passivity")
    push_passivity(L, result.passivity);
  else if (key == "interval")
    push_text(L, result.interval);
  else if (key == "form")
    push_text(L, result.form);
  else if (key == "solver")
    push_text(L, result.fit.summary.solver);
  else if (key == "stopped")
    push_text(L, result.fit.summary.stopped);
  else if (key == "mode")
    push_text(L, result.mode);
  else if (key == "converged")
    lua_pushboolean(L, result.fit.summary.converged);
  else if (key == "restoring")
    push<Value>(L, {model_of(solved).restoring, declarations_of(model_of(solved))});
  else if (key == "active")
    push_texts(L, result.fit.active, text);
  else if (key == "unexcited")
    push_texts(L, result.fit.unexcited, text);
  else if (key == "warnings")
    push_texts(L, result.warnings, itself);
  else if (key == "windows")
    push_texts(L, result.windows, itself);
  else {
    throw InputError(
        "a regression has no '" + key +
        "' (fields: model restoring terms implicit r2 rmse mode form condition covariance interval solver "
        "stopped converged iterations kkt steps path active unexcited outliers passivity warnings windows)");
  }
  return 1;
}

namespace {

std::string line(const std::string& name, double value, double std, const std::string& unit = "") {
  char text[96];
  std::snprintf(text, sizeof text, std > 0 ? " = %.6g +- %.2g" : " = %.6g", value, std);
  return "\n  " + name + text + (unit.empty() ? "" : " " + unit);
}

/// "\n  6 outliers, the largest at t = 0.7 s"
std::string outlier_line(const Outliers& outliers) {
  if (outliers.count == 0) return "";
  char text[96];
  std::snprintf(text, sizeof text, "\n  %lld outliers, the largest at t = %.6g s (%.3g deviations)",
                static_cast<long long>(outliers.count), outliers.largest[0].time, outliers.largest[0].size);
  return text;
}

std::string passivity_line(const std::optional<Passivity>& passivity) {
  if (!passivity) return "";
  char text[128];
  std::snprintf(text, sizeof text, "\n  passivity %s: least dissipated power %.3g W at y = %.3g, v = %.3g",
                passivity->imposed ? "imposed" : "looked at", passivity->least_power, passivity->y, passivity->v);
  return text;
}

}  // namespace

int regression_text(lua_State* L) {
  const Regression& result = check<SolvedRegression>(L, 1).result;
  char head[128];
  std::snprintf(head, sizeof head, ": R2 %.5g, RMSE %.4g (", result.r2, result.rmse);
  std::string text = result.fit.summary.solver + head + result.mode + ")";
  if (!result.form.empty()) text += "\n  " + result.form;
  for (const Term& term : result.terms) {
    if (term.coefficient == 0) continue;
    text += line(to_text(term.feature), term.coefficient, term.block_std > 0 ? term.block_std : term.std, term.unit);
  }
  for (const ImplicitParameter& found : result.implicit) text += line(found.name, found.value, found.std);
  for (const ActiveBound& bound : result.fit.active) text += "\n  held by " + bound.text;
  text += outlier_line(result.outliers) + passivity_line(result.passivity);
  for (const std::string& warning : result.warnings) text += "\n  note: " + warning;
  push_text(L, text);
  return 1;
}

}  // namespace lunid::lua
