// Regressions of the restoring force on features.
#include "regress/lag.hpp"
#include "regress/regress.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "progress.hpp"
#include "runtime.hpp"
#include "stream.hpp"
#include "types.hpp"

namespace lunid::lua {

/// A regression with what its features' symbols were declared as, and the model that it gives.
struct SolvedRegression {
  Regression result;
  DeclarationsPtr declared;
  std::optional<Model> model;  ///< none with lags
  std::string why_none;        ///< why there is no model
};

template <>
struct Bound<SolvedRegression> {
  static constexpr const char* key = "lunid.regression";
  static constexpr const char* words = "a regression";
};

namespace {

/// "study.lua:7" as a span.
SourceSpan span_of(const std::string& place) {
  const auto colon = place.rfind(':');
  if (colon == std::string::npos) return {};
  return {place.substr(0, colon), std::atoi(place.c_str() + colon + 1), 0};
}

/// The constraint on top of the stack, as stdlib/constraints.lua made it: {terms = {{feature =, weight =}, ...}, lower
/// =, upper =, place =}.
TermConstraint read_constraint(lua_State* L) {
  TermConstraint constraint;
  with_field(L, -1, "terms", [&] {
    for_each(L, -1, [&](lua_Integer) {
      constraint.terms.emplace_back(field_value(L, -1, "feature").expr, number_field(L, -1, "weight").value_or(1));
    });
  });
  constraint.lower = number_field(L, -1, "lower").value_or(constraint.lower);
  constraint.upper = number_field(L, -1, "upper").value_or(constraint.upper);
  constraint.where = span_of(string_field(L, -1, "place").value_or(""));
  return constraint;
}

TermGroup read_group(lua_State* L) {
  TermGroup group;
  with_field(L, -1, "features",
             [&] { for_each(L, -1, [&](lua_Integer) { group.features.push_back(check_value(L, -1).expr); }); });
  group.at_most = static_cast<int>(number_field(L, -1, "at_most").value_or(1));
  group.where = span_of(string_field(L, -1, "place").value_or(""));
  return group;
}

/// Sets a field of the table on top of the stack where it is there.
template <class Number>
void read(lua_State* L, const char* field, Number& value) {
  if (const auto given = number_field(L, -1, field)) value = static_cast<Number>(*given);
}

PassiveOptions read_passive(lua_State* L) {
  PassiveOptions options;
  read(L, "points_y", options.points_y);
  read(L, "points_v", options.points_v);
  options.impose = boolean_field(L, -1, "impose", options.impose);
  options.where = span_of(string_field(L, -1, "place").value_or(""));
  return options;
}

WeakForm read_weak(lua_State* L) {
  WeakForm form;
  read(L, "half_width", form.half_width);
  read(L, "order", form.order);
  read(L, "spacing", form.spacing);
  return form;
}

Criterion read_criterion(lua_State* L) {
  return string_field(L, -1, "criterion").value_or("bic") == "bic" ? Criterion::bic : Criterion::aicc;
}

/// A lasso or an elastic net.
LassoOptions read_lasso(lua_State* L) {
  LassoOptions options;
  options.lambda = number_field(L, -1, "lambda_value");
  read(L, "mixture", options.mixture);
  read(L, "path", options.path);
  options.refit = boolean_field(L, -1, "refit", options.refit);
  return options;
}

/// The solver on top of the stack, as stdlib/solvers.lua made it; those that work on statistics.
StatisticSolver read_statistic_solver(lua_State* L, std::uint64_t seed) {
  const std::string kind = string_field(L, -1, "kind").value_or("least_squares");
  if (kind == "lasso" || kind == "elastic_net") return read_lasso(L);
  if (kind == "non_negative") return NonNegativeOptions{};
  if (kind == "ridge") {
    RidgeOptions options;
    read(L, "lambda", options.lambda);
    return options;
  }
  if (kind == "stlsq") {
    StlsqOptions options;
    read(L, "threshold", options.threshold);
    read(L, "ridge", options.ridge);
    read(L, "max_passes", options.max_passes);
    return options;
  }
  if (kind == "sr3") {
    Sr3Options options;
    read(L, "threshold", options.threshold);
    read(L, "relaxation", options.relaxation);
    options.absolute = boolean_field(L, -1, "absolute", options.absolute);
    options.refit = boolean_field(L, -1, "refit", options.refit);
    return options;
  }
  if (kind == "frols") {
    FrolsOptions options;
    read(L, "threshold", options.threshold);
    read(L, "max_terms", options.max_terms);
    return options;
  }
  if (kind == "stepwise") {
    StepwiseOptions options;
    options.criterion = read_criterion(L);
    read(L, "max_terms", options.max_terms);
    return options;
  }
  if (kind == "best_subset") {
    BestSubsetOptions options;
    options.criterion = read_criterion(L);
    read(L, "terms", options.terms);
    return options;
  }
  if (kind == "spike_slab") {
    SpikeSlabOptions options;
    read(L, "prior", options.prior);
    read(L, "cut", options.cut);
    read(L, "sweeps", options.sweeps);
    options.seed = seed;
    return options;
  }
  return LeastSquaresOptions{};
}

/// The search on top of the stack, as stdlib/regression.lua made it.
SearchOptions read_search(lua_State* L, std::uint64_t seed) {
  SearchOptions search;
  search.method = search_method(string_field(L, -1, "method").value_or("slsqp"));
  search.starts = static_cast<int>(number_field(L, -1, "starts").value_or(search.starts));
  search.evaluations = static_cast<int>(number_field(L, -1, "evaluations").value_or(search.evaluations));
  search.seed = static_cast<std::uint64_t>(number_field(L, -1, "seed").value_or(static_cast<double>(seed)));
  return search;
}

RegressionSolver read_solver(lua_State* L, std::uint64_t seed) {
  const std::string kind = string_field(L, -1, "kind").value_or("least_squares");
  if (kind == "huber") {
    HuberOptions options;
    read(L, "threshold", options.threshold);
    read(L, "outlier", options.outlier);
    return options;
  }
  if (kind == "total_least_squares") {
    TotalOptions options;
    with_field(L, -1, "noise", [&] {
      for (lua_pushnil(L); lua_next(L, -2) != 0; lua_pop(L, 1))
        options.noise[check_string(L, -2)] = check_number(L, -1);
    });
    return options;
  }
  if (kind == "ensemble_of") {
    EnsembleOptions options;
    with_field(L, -1, "solver", [&] { options.solver = read_statistic_solver(L, seed); });
    read(L, "members", options.members);
    read(L, "features", options.features);
    read(L, "inclusion", options.inclusion);
    options.seed = seed;
    return options;
  }
  return std::visit([](const auto& solver) { return RegressionSolver(solver); }, read_statistic_solver(L, seed));
}

/// Parameters in the features: fixed ones have a value, the others are searched for within finite bounds.
void read_parameters(const Expr expr, const DeclarationsPtr& declared, RegressOptions& options) {
  for (const Expr symbol : symbols(expr, SymbolKind::parameter)) {
    const Parameter* row = find_declared(declared, symbol.name());
    const Parameter parameter = row ? *row : Parameter{};
    options.units[symbol.name()] = parameter.unit;
    if (options.values.count(symbol.name())) continue;
    const auto known = [&](const ImplicitParameter& p) { return p.name == symbol.name(); };
    if (std::any_of(options.implicit.begin(), options.implicit.end(), known)) continue;
    const bool bounded = std::isfinite(parameter.min) && std::isfinite(parameter.max);
    if (parameter.fixed && std::isfinite(parameter.value)) {
      options.values[symbol.name()] = parameter.value;
    } else if (bounded) {
      const double middle = 0.5 * (parameter.min + parameter.max);
      options.implicit.push_back(
          {symbol.name(), std::isfinite(parameter.value) ? parameter.value : middle, parameter.min, parameter.max});
    } else {
      throw InputError("regress: the parameter '" + symbol.name() +
                       "' stands in a feature or in the mass: give it min and max, to search between them, or fixed = "
                       "true and a value; the coefficients of the features themselves need no parameter");
    }
  }
}

/// "c_y", "c_y3", "c_y_v2": a name for a feature's coefficient.
std::string coefficient_name(const std::string& feature) {
  std::string name = "c_";
  for (const char c : feature) {
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '_')
      name += c;
    else if (c != '^' && c != ' ' && name.back() != '_')
      name += '_';
  }
  while (name.back() == '_' && name.size() > 2) name.pop_back();
  return name;
}

/// mass*a + sum of c*feature = F, each coefficient a parameter with the value found.
Model model_of(lua_State* L, const Regression& result, Expr mass, const RegressOptions& options,
               const DeclarationsPtr& declared) {
  Model model;
  model.pool = runtime(L).pool();
  Pool& pool = *model.pool;
  model.mass = mass.valid() ? mass : pool.constant(0);
  model.imposed_motion = !mass.valid();
  for (const Term& term : result.terms) {
    if (term.coefficient == 0) continue;
    Parameter parameter;
    parameter.name = coefficient_name(to_text(term.feature));
    while (model.find(parameter.name)) parameter.name += "_";
    parameter.value = term.coefficient;
    parameter.std = term.block_std > 0 ? term.block_std : term.std;
    parameter.unit = term.unit;
    parameter.fixed = term.std == 0;
    const Expr part = pool.parameter(parameter.name) * term.feature;
    model.restoring = model.restoring.valid() ? model.restoring + part : part;
    model.parameters.push_back(std::move(parameter));
  }
  if (options.known.valid())
    model.restoring = model.restoring.valid() ? model.restoring + options.known : options.known;
  if (!model.restoring.valid()) model.restoring = pool.constant(0);
  for (const Expr expr : {model.mass, model.restoring}) {
    for (const Expr symbol : symbols(expr, SymbolKind::parameter)) {
      if (model.find(symbol.name())) continue;
      Parameter parameter;
      parameter.name = symbol.name();
      if (const Parameter* row = find_declared(declared, symbol.name())) parameter = *row;
      for (const ImplicitParameter& found : result.implicit) {
        if (found.name == symbol.name()) parameter.value = found.value, parameter.std = found.std;
      }
      model.parameters.push_back(std::move(parameter));
    }
  }
  return complete(std::move(model));
}

/// Why the terms kept make no continuous model; "" where they do.
std::string lag_in(const Regression& result) {
  for (const Term& term : result.terms) {
    if (term.coefficient == 0 || first_lag(term.feature).empty()) continue;
    const std::string place = to_text(term.where);
    return "the regression has no model: its term '" + to_text(term.feature) + "'" +
           (place.empty() ? "" : " (" + place + ")") +
           " is a lag, which holds at the samples of this record only; leave lags out, or use the terms and the "
           "coefficients themselves";
  }
  return "";
}

/// regress({records}, {features=, places=, mass=, known=, constraints=, groups=, passive=, form=, solver=, blocks=,
/// bootstrap=})
int run(lua_State* L) {
  const std::vector<Stream> records = check_streams(L, 1);
  check_table(L, 2);
  RegressOptions options;
  options.threads = runtime(L).threads;
  options.blocks = static_cast<int>(number_field(L, 2, "blocks").value_or(options.blocks));
  const Value mass = field_value(L, 2, "mass"), known = field_value(L, 2, "known");
  DeclarationsPtr declared = join(mass.declared, known.declared);
  options.mass = mass.expr;
  options.known = known.expr;
  with_field(L, 2, "features", [&] {
    for_each(L, -1, [&](lua_Integer) {
      const Value feature = check_value(L, -1);
      declared = join(declared, feature.declared);
      options.features.push_back(feature.expr);
    });
  });
  std::vector<Expr> all = options.features;
  for (const Expr part : {options.mass, options.known}) {
    if (part.valid()) all.push_back(part);
  }
  for (const Expr expr : all) read_parameters(expr, declared, options);
  with_field(L, 2, "constraints",
             [&] { for_each(L, -1, [&](lua_Integer) { options.constraints.push_back(read_constraint(L)); }); });
  with_field(L, 2, "groups", [&] { for_each(L, -1, [&](lua_Integer) { options.groups.push_back(read_group(L)); }); });
  with_field(L, 2, "passive", [&] { options.passive = read_passive(L); });
  with_field(L, 2, "form", [&] { options.weak = read_weak(L); });
  for (const std::string& place : strings_field(L, 2, "places")) options.places.push_back(span_of(place));
  options.seed = runtime(L).seed;
  options.bootstrap = static_cast<int>(number_field(L, 2, "bootstrap").value_or(0));
  with_field(L, 2, "solver", [&] { options.solver = read_solver(L, options.seed); });
  with_field(L, 2, "objective", [&] { options.objective.mean_force = number_field(L, -1, "mean_force").value_or(0); });
  with_field(L, 2, "search", [&] { options.search = read_search(L, options.seed); });
  const ProgressLine line;
  SolvedRegression solved{regress(records, options), declared, {}, {}};
  with_field(L, 2, "notes",
             [&] { for_each(L, -1, [&](lua_Integer) { solved.result.warnings.push_back(check_string(L, -1)); }); });
  solved.why_none = lag_in(solved.result);
  if (solved.why_none.empty()) solved.model = model_of(L, solved.result, options.mass, options, declared);
  push<SolvedRegression>(L, std::move(solved));
  return 1;
}

/// lag(signal, samples)
int make_lag(lua_State* L) {
  push<Value>(L, {lag(check_value(L, 1).expr, static_cast<int>(check_integer(L, 2))), nullptr});
  return 1;
}

void set_number(lua_State* L, const char* field, double value) {
  if (!std::isfinite(value)) return;
  lua_pushnumber(L, value);
  lua_setfield(L, -2, field);
}

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

/// The fields that the last message lists.
int get(lua_State* L) {
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

int to_string(lua_State* L) {
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

}  // namespace

void open_regressions(lua_State* L) {
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<SolvedRegression>(L, {}, meta);
  static constexpr Entry functions[] = {{"regress", guarded<run>}, {"lag", guarded<make_lag>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
