// Regressions of the restoring force on features.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "progress.hpp"
#include "regress/lag.hpp"
#include "regression.hpp"
#include "runtime.hpp"
#include "stream.hpp"

namespace lunid::lua {

namespace {

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
  with_field(L, 2, "numbers",
             [&] { for_each(L, -1, [&](lua_Integer) { options.numbers.push_back(check_value(L, -1).expr); }); });
  options.seed = runtime(L).seed;
  options.bootstrap = static_cast<int>(number_field(L, 2, "bootstrap").value_or(0));
  regress_options(L, 2, options);
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

}  // namespace

void open_regressions(lua_State* L) {
  static constexpr Entry meta[] = {{"__index", guarded<regression_field>}, {"__tostring", guarded<regression_text>}};
  make_type<SolvedRegression>(L, {}, meta);
  static constexpr Entry functions[] = {{"regress", guarded<run>}, {"lag", guarded<make_lag>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
