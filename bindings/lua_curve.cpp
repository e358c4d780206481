// Nonlinear regressions of a formula of channels.
#include <algorithm>
#include <cmath>

#include "fields.hpp"
#include "regress/curve.hpp"
#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {
namespace {

/// The records at `index`, or one made of a table { names = {"x", ...}, x = column, ... }.
std::vector<Record> data_of(lua_State* L, int index) {
  std::vector<Record> records;
  const std::vector<std::string> names = strings_field(L, index, "names");
  if (names.empty()) {
    for_each(L, index, [&](lua_Integer) { records.push_back(check<Record>(L, -1)); });
    return records;
  }
  std::vector<Channel> channels;
  for (const std::string& name : names) {
    Channel channel;
    channel.name = name;
    with_field(L, index, name.c_str(), [&] { channel.values = check_column(L, -1); });
    channels.push_back(std::move(channel));
  }
  records.emplace_back("data", 0.0, 1.0, std::move(channels));
  return records;
}

/// A fixed parameter has a value, another a first guess: its own, or the middle between finite bounds.
void read_parameters(const DeclarationsPtr& declared, CurveOptions& options) {
  for (const Expr& symbol : symbols(options.formula, SymbolKind::parameter)) {
    const Parameter* row = find_declared(declared, symbol.name());
    const Parameter parameter = row ? *row : Parameter{};
    if (parameter.fixed) {
      options.values[symbol.name()] = parameter.value;
      continue;
    }
    CurveParameter fitted;
    fitted.name = symbol.name();
    fitted.min = parameter.min;
    fitted.max = parameter.max;
    fitted.value = parameter.value;
    if (std::isnan(fitted.value)) fitted.value = 0.5 * (parameter.min + parameter.max);
    if (!std::isfinite(fitted.value))
      throw InputError("fit_curve: parameter '" + fitted.name + "' has no first guess; give it one, or min and max");
    options.parameters.push_back(std::move(fitted));
  }
}

void push_parameters(lua_State* L, const CurveFit& fit) {
  lua_newtable(L);
  lua_Integer i = 0;
  for (const CurveParameter& p : fit.parameters) {
    lua_newtable(L);
    push_text(L, p.name);
    lua_setfield(L, -2, "name");
    set_number(L, "value", p.value);
    if (std::isfinite(p.std)) set_number(L, "std", p.std);
    lua_pushboolean(L, p.at_bound);
    lua_setfield(L, -2, "at_bound");
    lua_pushboolean(L, p.unexcited);
    lua_setfield(L, -2, "unexcited");
    lua_pushvalue(L, -1);
    lua_setfield(L, -3, p.name.c_str());
    lua_rawseti(L, -2, ++i);
  }
}

void push_correlation(lua_State* L, const Eigen::MatrixXd& covariance) {
  lua_newtable(L);
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    lua_newtable(L);
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
      lua_pushnumber(L, scale > 0 ? covariance(i, j) / scale : 0);
      lua_rawseti(L, -2, j + 1);
    }
    lua_rawseti(L, -2, i + 1);
  }
}

/// fit_curve({records...} or {names=, ...}, {formula=, response=, weight=, max_iterations=})
int run(lua_State* L) {
  check_table(L, 1);
  check_table(L, 2);
  const std::vector<Record> records = data_of(L, 1);
  CurveOptions options;
  const Value formula = field_value(L, 2, "formula");
  options.formula = formula.expr;
  options.response = field_value(L, 2, "response").expr;
  options.weight = field_value(L, 2, "weight").expr;
  options.max_iterations = static_cast<int>(number_field(L, 2, "max_iterations").value_or(options.max_iterations));
  read_parameters(formula.declared, options);
  const CurveFit fit = fit_curve(records, options);
  lua_newtable(L);
  push_parameters(L, fit);
  lua_setfield(L, -2, "parameters");
  push_correlation(L, fit.covariance);
  lua_setfield(L, -2, "correlation");
  push<Value>(L, {fit.formula, nullptr});
  lua_setfield(L, -2, "formula");
  for (const auto& [field, value] :
       {std::pair{"rss", fit.rss}, std::pair{"rmse", fit.rmse}, std::pair{"residual_std", fit.residual_std},
        std::pair{"r2", fit.r2}, std::pair{"condition", fit.condition}, std::pair{"seconds", fit.seconds}})
    set_number(L, field, value);
  for (const auto& [field, value] :
       {std::pair{"rows", static_cast<lua_Integer>(fit.rows)}, std::pair{"iterations", lua_Integer{fit.iterations}},
        std::pair{"evaluations", lua_Integer{fit.evaluations}}}) {
    lua_pushinteger(L, value);
    lua_setfield(L, -2, field);
  }
  lua_pushboolean(L, fit.converged);
  lua_setfield(L, -2, "converged");
  push_text(L, fit.stopped);
  lua_setfield(L, -2, "stopped");
  return 1;
}

}  // namespace

void open_curves(lua_State* L) {
  static constexpr Entry functions[] = {{"fit_curve", guarded<run>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
