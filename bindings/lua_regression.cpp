// Regressions of the restoring force on features.
#include "regress/regress.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {

/// A regression with what its features' symbols were declared as, and the model that it gives.
struct SolvedRegression {
  Regression result;
  DeclarationsPtr declared;
  Model model;
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

/// The constraint on top of the stack, as stdlib/constraints.lua made it.
TermConstraint read_constraint(lua_State* L) {
  const std::string kind = string_field(L, -1, "kind").value_or("");
  const Expr feature = field_value(L, -1, "feature").expr;
  TermConstraint constraint;
  if (kind == "fixed") {
    constraint = fixed(feature, number_field(L, -1, "value").value_or(0));
  } else if (kind == "between") {
    constraint = between(feature, number_field(L, -1, "lower").value_or(0), number_field(L, -1, "upper").value_or(0));
  } else {
    const Expr bound = field_value(L, -1, "bound").expr;
    if (bound.is_constant()) {
      constraint = kind == "at_most" ? at_most(feature, bound.value()) : at_least(feature, bound.value());
    } else {
      constraint = kind == "at_most" ? at_most(feature, bound) : at_most(bound, feature);
    }
  }
  constraint.where = span_of(string_field(L, -1, "place").value_or(""));
  return constraint;
}

/// The solver on top of the stack, as stdlib/regression.lua made it.
RegressionSolver read_solver(lua_State* L) {
  const std::string kind = string_field(L, -1, "kind").value_or("least_squares");
  if (kind == "ridge") {
    RidgeOptions options;
    options.lambda = number_field(L, -1, "lambda").value_or(options.lambda);
    return options;
  }
  if (kind == "stlsq") {
    StlsqOptions options;
    options.threshold = number_field(L, -1, "threshold").value_or(options.threshold);
    options.ridge = number_field(L, -1, "ridge").value_or(options.ridge);
    options.max_passes = static_cast<int>(number_field(L, -1, "max_passes").value_or(options.max_passes));
    return options;
  }
  if (kind == "lasso") {
    LassoOptions options;
    options.lambda = number_field(L, -1, "lambda_value");
    options.path = static_cast<int>(number_field(L, -1, "path").value_or(options.path));
    options.refit = boolean_field(L, -1, "refit", options.refit);
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

/// Parameters in the features: fixed ones have a value, the others are searched for within finite bounds.
void read_parameters(const Expr expr, const DeclarationsPtr& declared, RegressOptions& options) {
  for (const Expr symbol : symbols(expr, SymbolKind::parameter)) {
    const Parameter* row = find_declared(declared, symbol.name());
    const Parameter parameter = row ? *row : Parameter{};
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

/// regress({records}, {features=, mass=, known=, constraints=, solver=, blocks=})
int run(lua_State* L) {
  std::vector<Record> records;
  check_table(L, 1);
  for_each(L, 1, [&](lua_Integer) { records.push_back(check<Record>(L, -1)); });
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
  with_field(L, 2, "solver", [&] { options.solver = read_solver(L); });
  with_field(L, 2, "objective", [&] { options.objective.mean_force = number_field(L, -1, "mean_force").value_or(0); });
  with_field(L, 2, "search", [&] { options.search = read_search(L, runtime(L).seed); });
  Regression result = regress(records, options);
  Model model = model_of(L, result, options.mass, options, declared);
  push<SolvedRegression>(L, {std::move(result), declared, std::move(model)});
  return 1;
}

void set_number(lua_State* L, const char* field, double value) {
  if (!std::isfinite(value)) return;
  lua_pushnumber(L, value);
  lua_setfield(L, -2, field);
}

/// List of {feature=, name=, value=, std=, block_std=, contribution=}, each also under its feature's text.
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

template <class Item, class Text>
void push_texts(lua_State* L, const std::vector<Item>& items, Text text) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Item& item : items) {
    push_text(L, text(item));
    lua_rawseti(L, -2, ++i);
  }
}

/// Fields model, terms, implicit, r2, rmse, solver, stopped, converged, condition, active, unexcited, warnings,
/// windows.
int get(lua_State* L) {
  const SolvedRegression& solved = check<SolvedRegression>(L, 1);
  const Regression& result = solved.result;
  const std::string key = check_string(L, 2);
  const auto itself = [](const std::string& text) { return text; };
  const auto text = [](const auto& item) { return item.text; };
  if (key == "model")
    push<Model>(L, solved.model);
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
  else if (key == "solver")
    push_text(L, result.fit.summary.solver);
  else if (key == "stopped")
    push_text(L, result.fit.summary.stopped);
  else if (key == "mode")
    push_text(L, result.mode);
  else if (key == "converged")
    lua_pushboolean(L, result.fit.summary.converged);
  else if (key == "restoring")
    push<Value>(L, {solved.model.restoring, declarations_of(solved.model)});
  else if (key == "active")
    push_texts(L, result.fit.active, text);
  else if (key == "unexcited")
    push_texts(L, result.fit.unexcited, text);
  else if (key == "warnings")
    push_texts(L, result.warnings, itself);
  else if (key == "windows")
    push_texts(L, result.windows, itself);
  else {
    throw InputError("a regression has no '" + key +
                     "' (fields: model restoring terms implicit r2 rmse mode condition solver stopped converged active "
                     "unexcited warnings windows)");
  }
  return 1;
}

std::string line(const std::string& name, double value, double std) {
  char text[96];
  std::snprintf(text, sizeof text, std > 0 ? " = %.6g +- %.2g" : " = %.6g", value, std);
  return "\n  " + name + text;
}

int to_string(lua_State* L) {
  const Regression& result = check<SolvedRegression>(L, 1).result;
  char head[128];
  std::snprintf(head, sizeof head, ": R2 %.5g, RMSE %.4g (", result.r2, result.rmse);
  std::string text = result.fit.summary.solver + head + result.mode + ")";
  for (const Term& term : result.terms) {
    if (term.coefficient != 0) text += line(to_text(term.feature), term.coefficient, term.block_std);
  }
  for (const ImplicitParameter& found : result.implicit) text += line(found.name, found.value, found.std);
  for (const ActiveBound& bound : result.fit.active) text += "\n  held by " + bound.text;
  for (const Unexcited& unexcited : result.fit.unexcited) text += "\n  " + unexcited.text;
  for (const std::string& warning : result.warnings) text += "\n  note: " + warning;
  push_text(L, text);
  return 1;
}

}  // namespace

void open_regressions(lua_State* L) {
  static constexpr Entry meta[] = {{"__index", guarded<get>}, {"__tostring", guarded<to_string>}};
  make_type<SolvedRegression>(L, {}, meta);
  static constexpr Entry functions[] = {{"regress", guarded<run>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
