// Expressions: Lua's own operators and the functions of the language build the runtime's nodes.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "expr/tape.hpp"
#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {

Value check_value(lua_State* L, int index) {
  if (const Value* value = test<Value>(L, index)) return *value;
  if (lua_type(L, index) == LUA_TNUMBER) return {runtime(L).pool()->constant(lua_tonumber(L, index)), nullptr};
  bad_argument(L, index, "a number or an expression");
}

Value field_value(lua_State* L, int index, const char* field) {
  Value value;
  with_field(L, index, field, [&] {
    if (const Value* found = test<Value>(L, -1)) {
      value = *found;
    } else if (lua_type(L, -1) == LUA_TNUMBER) {
      value.expr = runtime(L).pool()->constant(lua_tonumber(L, -1));
    } else {
      throw InputError(std::string(field) + ": expected a number or an expression, got " + describe(L, -1));
    }
  });
  return value;
}

namespace {

/// Applies an operation to the arguments 1..arity. Numbers alone give a number.
int apply(lua_State* L, Op op, int arity) {
  Expr arguments[3];
  DeclarationsPtr declared;
  bool numbers = true;
  for (int i = 1; i <= arity; ++i) {
    const Value value = check_value(L, i);
    numbers = numbers && lua_type(L, i) == LUA_TNUMBER;
    arguments[i - 1] = value.expr;
    declared = join(declared, value.declared);
  }
  const Expr result = runtime(L).pool()->apply(op, std::span<const Expr>(arguments, static_cast<std::size_t>(arity)));
  if (numbers && result.is_constant()) {
    lua_pushnumber(L, result.value());
  } else {
    push<Value>(L, {result, declared});
  }
  return 1;
}

int negate(lua_State* L) { return apply(L, Op::neg, 1); }

const char* sign_of(Op op) {
  switch (op) {
    case Op::add: return "+";
    case Op::sub: return "-";
    case Op::mul: return "*";
    case Op::div: return "/";
    default: return "^";
  }
}

/// An operator between two values, one of which may be neither number nor expression.
template <Op op>
int between(lua_State* L) {
  for (const int side : {1, 2}) {
    if (test<Value>(L, side) || lua_type(L, side) == LUA_TNUMBER) continue;
    const std::string where = std::string("'") + sign_of(op) + "': the " + (side == 1 ? "left" : "right") + " side";
    if (lua_isnoneornil(L, side))
      throw InputError(where + " is nothing: a name or a field that has no value (" + (side == 1 ? "nil " : "... ") +
                       sign_of(op) + (side == 1 ? " ...)" : " nil)"));
    throw InputError(where + ": expected a number or an expression, got " + describe(L, side));
  }
  return apply(L, op, 2);
}

int refuse_remainder(lua_State*) {
  throw InputError("'%': an expression has no remainder; of a periodic one write lunid.sin or lunid.cos");
}

int refuse_whole_division(lua_State*) { throw InputError("'//': an expression has no whole division; write '/'"); }

int refuse_call(lua_State*) {
  throw InputError("an expression is no function: write '*' for a product, and k:at { y = 1 } for its value");
}

/// A function of the language by its name; the operation and its arity are upvalues.
int call_function(lua_State* L) {
  const auto op = static_cast<Op>(lua_tointeger(L, lua_upvalueindex(1)));
  const int arity = static_cast<int>(lua_tointeger(L, lua_upvalueindex(2)));
  const std::string name = lua_tostring(L, lua_upvalueindex(3));
  const bool folds = op == Op::min || op == Op::max;  // min(a, b, c) = min(min(a, b), c)
  const int given = lua_gettop(L);
  if (folds ? given < arity : given != arity) {
    throw InputError(name + ": expected " + std::to_string(arity) + (arity == 1 ? " argument" : " arguments") +
                     ", got " + std::to_string(given));
  }
  try {
    while (folds && lua_gettop(L) > 2) {
      const int count = lua_gettop(L);
      apply(L, op, 2);
      lua_replace(L, 2);
      lua_remove(L, 1);
      lua_settop(L, count - 1);
    }
    return apply(L, op, arity);
  } catch (const InputError& error) {
    throw InputError(name + ": " + error.message(), error.where(), error.fault());
  }
}

int refuse_comparison(lua_State* L) {
  throw InputError(
      "an expression cannot be compared by < <= > >=, because Lua makes a boolean of it: write lunid.at_most(a, b), "
      "lunid.at_least(a, b) for a constraint, or lunid.less(a, b), lunid.greater(a, b) for the condition of "
      "lunid.where");
}

int equal(lua_State* L) {
  const Value *a = test<Value>(L, 1), *b = test<Value>(L, 2);
  lua_pushboolean(L, a && b && a->expr == b->expr);
  return 1;
}

int to_string(lua_State* L) {
  push_text(L, to_text(check<Value>(L, 1).expr));
  return 1;
}

int concat(lua_State* L) {
  luaL_tolstring(L, 1, nullptr);
  luaL_tolstring(L, 2, nullptr);
  lua_concat(L, 2);
  return 1;
}

/// expr:text("plain" | "latex" | "c" | "lua")
int text(lua_State* L) {
  const Value& value = check<Value>(L, 1);
  const std::string format = lua_isnoneornil(L, 2) ? "plain" : check_string(L, 2);
  for (const auto& [name, is] : {std::pair{"plain", Format::plain}, std::pair{"latex", Format::latex},
                                 std::pair{"c", Format::c}, std::pair{"lua", Format::lua}}) {
    if (format == name) {
      push_text(L, to_text(value.expr, is));
      return 1;
    }
  }
  throw InputError("text: expected 'plain', 'latex', 'c' or 'lua', got '" + format + "'");
}

Expr check_symbol(lua_State* L, int index) {
  const Value value = check_value(L, index);
  if (!value.expr.is_symbol()) bad_argument(L, index, "a symbol, such as lunid.displacement or a parameter");
  return value.expr;
}

/// expr:derivative(symbol)
int derive(lua_State* L) {
  const Value& value = check<Value>(L, 1);
  push<Value>(L, {derivative(value.expr, check_symbol(L, 2)), value.declared});
  return 1;
}

/// What an expression is a product of, whole powers as such: y^2*v is {y, 2}, {v, 1}.
void append_factors(Expr expr, std::vector<std::pair<Expr, double>>& factors) {
  const auto arguments = expr.arguments();
  if (expr.op() == Op::mul) {
    for (const Expr& argument : arguments) append_factors(argument, factors);
    return;
  }
  const bool power = expr.op() == Op::pow && arguments[1].is_constant() && arguments[1].value() >= 1 &&
                     arguments[1].value() == std::floor(arguments[1].value());
  factors.emplace_back(power ? arguments[0] : expr, power ? arguments[1].value() : 1);
}

/// product(a, b): a*b, with powers of one expression as one power: y*v times y^2 is y^3*v.
int make_product(lua_State* L) {
  const Value a = check_value(L, 1), b = check_value(L, 2);
  std::vector<std::pair<Expr, double>> factors, more;
  append_factors(a.expr, factors);
  append_factors(b.expr, more);
  bool merged = false;
  for (const auto& [base, power] : more) {
    const auto same = std::find_if(factors.begin(), factors.end(), [&](const auto& f) { return f.first == base; });
    if (same != factors.end() && !base.is_constant()) {
      same->second += power;
      merged = true;
    } else {
      factors.emplace_back(base, power);
    }
  }
  Expr product = a.expr * b.expr;
  if (merged) {
    product = {};
    for (const auto& [base, power] : factors) {
      const Expr factor = power == 1 ? base : pow(base, power);
      product = product.valid() ? product * factor : factor;
    }
  }
  push<Value>(L, {product, join(a.declared, b.declared)});
  return 1;
}

/// The names and kinds of the symbols, in order: {{name=, kind=}, ...}.
int list_symbols(lua_State* L) {
  const Expr expr = check_value(L, 1).expr;
  lua_newtable(L);
  lua_Integer i = 0;
  for (const Expr symbol : symbols(expr)) {
    lua_newtable(L);
    push_text(L, symbol.name());
    lua_setfield(L, -2, "name");
    push_text(L, symbol.kind() == SymbolKind::channel     ? "channel"
                 : symbol.kind() == SymbolKind::parameter ? "parameter"
                                                          : "state");
    lua_setfield(L, -2, "kind");
    lua_rawseti(L, -2, ++i);
  }
  return 1;
}

/// expr:at{ y = 1, k = 2 } -> number. Parameters that are not given take their declared value.
int evaluate(lua_State* L) {
  const Value value = check_value(L, 1);
  check_table(L, 2);
  const std::vector<Expr> inputs = symbols(value.expr);
  std::vector<double> in;
  for (const Expr symbol : inputs) {
    auto given = number_field(L, 2, symbol.name().c_str());
    const Parameter* row = find_declared(value.declared, symbol.name());
    if (!given && row && std::isnan(row->value))
      throw InputError("at: parameter '" + symbol.name() + "' has no value: give it here too, at { " + symbol.name() +
                       " = ... }");
    if (!given && row) given = row->value;
    if (!given) throw InputError("at: no value for '" + symbol.name() + "'");
    in.push_back(*given);
  }
  const Tape tape(std::span<const Expr>(&value.expr, 1), inputs);
  std::vector<double> scratch(static_cast<std::size_t>(tape.registers()));
  double out = 0;
  tape.run_point(in.data(), &out, scratch.data());
  lua_pushnumber(L, out);
  return 1;
}

/// channel(name): a signal of the language.
int make_channel(lua_State* L) {
  push<Value>(L, {runtime(L).pool()->channel(check_string(L, 1)), nullptr});
  return 1;
}

/// parameter{name=, value=, min=, max=, unit=, fixed=, std=, place=}
int make_parameter(lua_State* L) {
  check_table(L, 1);
  DeclaredParameter row;
  row.parameter.name = string_field(L, 1, "name").value_or("");
  row.parameter.value = number_field(L, 1, "value").value_or(row.parameter.value);
  row.parameter.min = number_field(L, 1, "min").value_or(row.parameter.min);
  row.parameter.max = number_field(L, 1, "max").value_or(row.parameter.max);
  row.parameter.unit = string_field(L, 1, "unit").value_or("");
  row.parameter.fixed = boolean_field(L, 1, "fixed", false);
  row.parameter.std = number_field(L, 1, "std").value_or(row.parameter.std);
  row.place = string_field(L, 1, "place").value_or("");
  const Expr symbol = runtime(L).pool()->parameter(row.parameter.name);
  Declarations all;
  all.parameters.push_back(std::move(row));
  push<Value>(L, {symbol, std::make_shared<const Declarations>(std::move(all))});
  return 1;
}

/// state_symbol(name): the bare symbol, for the rate that refers to it.
int make_state_symbol(lua_State* L) {
  push<Value>(L, {runtime(L).pool()->state(check_string(L, 1)), nullptr});
  return 1;
}

/// state{name=, rate=, initial=, min=, max=, anchored=, place=}
int make_state(lua_State* L) {
  check_table(L, 1);
  DeclaredState row;
  row.state.symbol = runtime(L).pool()->state(string_field(L, 1, "name").value_or(""));
  row.state.initial = number_field(L, 1, "initial").value_or(0);
  row.state.anchored = boolean_field(L, 1, "anchored", false);
  row.place = string_field(L, 1, "place").value_or("");
  DeclarationsPtr declared;
  for (const auto& [field, target] :
       {std::pair{"rate", &row.state.rate}, std::pair{"min", &row.state.min}, std::pair{"max", &row.state.max}}) {
    const Value value = field_value(L, 1, field);
    *target = value.expr;
    declared = join(declared, value.declared);
  }
  const Expr symbol = row.state.symbol;
  Declarations all;
  all.states.push_back(std::move(row));
  push<Value>(L, {symbol, join(std::make_shared<const Declarations>(std::move(all)), declared)});
  return 1;
}

/// parse(text, source): the language from text; unknown identifiers become parameters.
int parse_text(lua_State* L) {
  push<Value>(L, {parse(*runtime(L).pool(), check_string(L, 1), check_string(L, 2)), nullptr});
  return 1;
}

/// Digits of a number that read back to the same double, as Lua writes it.
int number_text(lua_State* L) {
  push_text(L, to_text(runtime(L).pool()->constant(check_number(L, 1)), Format::lua));
  return 1;
}

/// substitute(expr, {name = expression or number, ...}, {more...}) -> the expression with these in place of its
/// symbols. What they and the further expressions were declared with comes along; what the old symbols were declared
/// with does not.
int substitute_symbols(lua_State* L) {
  const Expr expr = check_value(L, 1).expr;
  check_table(L, 2);
  std::vector<std::pair<Expr, Expr>> replacements;
  DeclarationsPtr declared;
  for (const Expr symbol : symbols(expr)) {
    with_field(L, 2, symbol.name().c_str(), [&] {
      const Value by = check_value(L, -1);
      replacements.emplace_back(symbol, by.expr);
      declared = join(declared, by.declared);
    });
  }
  if (!lua_isnoneornil(L, 3)) {
    check_table(L, 3);
    for_each(L, 3, [&](lua_Integer) { declared = join(declared, check_value(L, -1).declared); });
  }
  push<Value>(L, {substitute(expr, replacements), declared});
  return 1;
}

/// A method; what has no such name is told of it, and not that nothing can be called.
int get(lua_State* L) {
  luaL_getmetafield(L, 1, "__methods");
  lua_pushvalue(L, 2);
  lua_gettable(L, -2);
  if (lua_isnil(L, -1) && lua_type(L, 2) == LUA_TNUMBER)
    throw InputError("an expression is no list and has no [" + std::string(luaL_tolstring(L, 2, nullptr)) +
                     "]; several come as several values: local y1, y2 = lunid.displacements(2)");
  if (!lua_isnil(L, -1) || lua_type(L, 2) != LUA_TSTRING) return 1;
  std::vector<std::string> names;
  std::string all;
  for (lua_pushnil(L); lua_next(L, -3); lua_pop(L, 1)) names.emplace_back(lua_tostring(L, -2));
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) all += " " + name;
  throw InputError("an expression has no '" + check_string(L, 2) + "' (methods:" + all + ")");
}

int is_expression(lua_State* L) {
  lua_pushboolean(L, test<Value>(L, 1) != nullptr);
  return 1;
}

void open_functions(lua_State* L) {
  lua_newtable(L);
  const auto add = [L](const std::string& name, Op op, int arity) {
    lua_pushinteger(L, static_cast<lua_Integer>(op));
    lua_pushinteger(L, arity);
    push_text(L, name);
    lua_pushcclosure(L, guarded<call_function>, 3);
    lua_setfield(L, -2, name.c_str());
  };
  for (const std::string& name : function_names()) {
    Op op;
    int arity = 0;
    if (find_function(name, op, arity)) add(name, op, arity);
  }
  add("greater", Op::greater, 2);
  add("less", Op::less, 2);
  add("greater_equal", Op::greater_equal, 2);
  add("less_equal", Op::less_equal, 2);
  lua_setfield(L, -2, "functions");
}

}  // namespace

void open_expressions(lua_State* L) {
  static constexpr Entry methods[] = {
      {"text", guarded<text>},
      {"derivative", guarded<derive>},
      {"symbols", guarded<list_symbols>},
      {"at", guarded<evaluate>},
  };
  static constexpr Entry meta[] = {
      {"__add", guarded<between<Op::add>>},
      {"__sub", guarded<between<Op::sub>>},
      {"__mul", guarded<between<Op::mul>>},
      {"__div", guarded<between<Op::div>>},
      {"__pow", guarded<between<Op::pow>>},
      {"__unm", guarded<negate>},
      {"__mod", guarded<refuse_remainder>},
      {"__idiv", guarded<refuse_whole_division>},
      {"__call", guarded<refuse_call>},
      {"__index", guarded<get>},
      {"__lt", guarded<refuse_comparison>},
      {"__le", guarded<refuse_comparison>},
      {"__eq", guarded<equal>},
      {"__concat", guarded<concat>},
      {"__tostring", guarded<to_string>},
  };
  make_type<Value>(L, methods, meta);
  static constexpr Entry functions[] = {
      {"channel", guarded<make_channel>},    {"parameter", guarded<make_parameter>},
      {"state", guarded<make_state>},        {"state_symbol", guarded<make_state_symbol>},
      {"parse", guarded<parse_text>},        {"substitute", guarded<substitute_symbols>},
      {"number_text", guarded<number_text>}, {"is_expression", guarded<is_expression>},
      {"product", guarded<make_product>},
  };
  set_functions(L, functions);
  open_functions(L);
}

}  // namespace lunid::lua
