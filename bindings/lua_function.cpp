// External functions in Lua: a user's own Lua function, and tables of values. Calling one with expressions gives an
// expression, with numbers a number.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "expr/external.hpp"
#include "runtime.hpp"
#include "surface/lookup.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

/// "study.lua:7: message" taken apart.
InputError located(const std::string& message, const std::string& words, const std::string& otherwise) {
  const auto split = message.find(": ");
  const auto colon = split == std::string::npos ? split : message.rfind(':', split - 1);
  const bool has_place = colon != std::string::npos && std::atoi(message.c_str() + colon + 1) > 0;
  const std::string place = has_place ? message.substr(0, split) : otherwise;
  const auto end = place.rfind(':');
  const SourceSpan where =
      end == std::string::npos ? SourceSpan{} : SourceSpan{place.substr(0, end), std::atoi(place.c_str() + end + 1), 0};
  return InputError(words + ": " + (has_place ? message.substr(split + 2) : message), where);
}

std::string arguments_text(const double* x, int count) {
  std::ostringstream text;
  text.precision(6);
  for (int i = 0; i < count; ++i) text << (i ? ", " : "(") << x[i];
  return text.str() + ")";
}

/// A function of the user's. Its references stay in the registry as long as the Lua state: the pool, which keeps the
/// function, lives longer.
class LuaFunction final : public ExternalFunction {
 public:
  LuaFunction(lua_State* L, const std::string& name, int arity, std::string place)
      : ExternalFunction(name, arity), L_(L), place_(std::move(place)), thread_(std::this_thread::get_id()) {}

  /// Takes the function on top of the stack as the value, or as the gradient.
  void take_value(lua_State* L) { value_ = luaL_ref(L, LUA_REGISTRYINDEX); }
  void take_gradient(lua_State* L) { gradient_ = luaL_ref(L, LUA_REGISTRYINDEX); }
  void set_scales(std::vector<double> scales) { scales_ = std::move(scales); }

  std::string words() const override { return "Lua function '" + name() + "'"; }
  bool thread_safe() const override { return false; }
  bool has_gradient() const override { return gradient_ != LUA_NOREF; }
  long calls() const override { return calls_; }

 protected:
  double value(const double* x) const override {
    double result = 0;
    call(value_, "call", x, &result, 1);
    return result;
  }
  void gradient(const double* x, double* slopes) const override { call(gradient_, "gradient", x, slopes, arity()); }
  double scale(int i) const override {
    return scales_.empty() ? ExternalFunction::scale(i) : scales_[static_cast<std::size_t>(i)];
  }

 private:
  [[noreturn]] void refuse(const char* field, const double* x, const std::string& got, int expected) const {
    throw located(std::string(field) + ": expected " +
                      (expected == 1 ? "a number" : std::to_string(expected) + " numbers") + ", got " + got + " at " +
                      arguments_text(x, arity()),
                  words(), place_);
  }

  void call(int reference, const char* field, const double* x, double* results, int expected) const {
    if (std::this_thread::get_id() != thread_)
      throw located("was called by another thread than that of the study, which alone may run Lua", words(), place_);
    Runtime& owner = runtime(L_);
    if (owner.cancelled()) throw InputError("interrupted", {}, Fault::interrupted);
    const StackTop restore(L_);
    if (!lua_checkstack(L_, arity() + 4)) throw located("too many calls inside one another", words(), place_);
    lua_rawgeti(L_, LUA_REGISTRYINDEX, reference);
    for (int i = 0; i < arity(); ++i) lua_pushnumber(L_, x[i]);
    const int status = lua_pcall(L_, arity(), LUA_MULTRET, 0);
    ++calls_;
    if (status != LUA_OK) {
      if (owner.cancelled()) throw InputError("interrupted", {}, Fault::interrupted);
      throw located(lua_type(L_, -1) == LUA_TSTRING ? lua_tostring(L_, -1) : describe(L_, -1), words(), place_);
    }
    const int count = lua_gettop(L_) - restore.top();
    if (count != expected)
      refuse(field, x, count == 0 ? "nothing" : std::to_string(count) + (count == 1 ? " value" : " values"), expected);
    for (int i = 0; i < expected; ++i) {
      const int at = restore.top() + 1 + i;
      if (lua_type(L_, at) != LUA_TNUMBER) refuse(field, x, describe(L_, at), expected);
      results[i] = lua_tonumber(L_, at);
      if (std::isnan(results[i])) refuse(field, x, "what is not a number (nan)", expected);
    }
  }

  lua_State* L_;
  std::string place_;
  std::thread::id thread_;
  int value_ = LUA_NOREF, gradient_ = LUA_NOREF;
  std::vector<double> scales_;
  mutable long calls_ = 0;  // changed by its one thread
};

/// Number of arguments that the Lua function on top of the stack names; throws for `...`.
int arity_of(lua_State* L, const char* field) {
  lua_Debug info;
  lua_pushvalue(L, -1);
  lua_getinfo(L, ">u", &info);
  if (info.isvararg || info.nparams < 1 || info.nparams > Expr::most_arguments)
    throw InputError(std::string("lua_function: ") + field + ": expected a function of 1 to " +
                     std::to_string(Expr::most_arguments) + " named arguments, got one of " +
                     (info.isvararg ? "'...'" : std::to_string(info.nparams)));
  return info.nparams;
}

/// lua_function{name=, call=, gradient=, scale=, place=}
int make_lua_function(lua_State* L) {
  check_table(L, 1);
  Pool& pool = *runtime(L).pool();
  lua_getfield(L, 1, "call");
  const int arity = arity_of(L, "call");
  const auto function = std::make_shared<LuaFunction>(runtime(L).state(), pool.free_name(*string_field(L, 1, "name")),
                                                      arity, string_field(L, 1, "place").value_or(""));
  function->take_value(L);
  with_field(L, 1, "gradient", [&] {
    if (arity_of(L, "gradient") != arity)
      throw InputError("lua_function: gradient: expected a function of as many arguments as call, " +
                       std::to_string(arity) + ", got one of " + std::to_string(arity_of(L, "gradient")));
    lua_pushvalue(L, -1);
    function->take_gradient(L);
  });
  with_field(L, 1, "scale", [&] {
    const Eigen::VectorXd scales = check_column(L, -1);
    if (scales.size() != arity)
      throw InputError("lua_function: scale: expected " + std::to_string(arity) + " numbers, got " +
                       std::to_string(scales.size()));
    function->set_scales({scales.begin(), scales.end()});
  });
  pool.add(function);
  push<FunctionPtr>(L, function);
  return 1;
}

bool same_table(const Lookup& table, const std::vector<Eigen::VectorXd>& axes, const Eigen::MatrixXd& values,
                Between between) {
  const auto same = [](const auto& a, const auto& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() && (a.array() == b.array()).all();
  };
  return std::equal(table.axes().begin(), table.axes().end(), axes.begin(), axes.end(), same) &&
         same(table.values(), values) && table.between() == between;
}

/// lookup{name=, axes = {column...}, values = {column over the second axis...}, between=}
int make_lookup(lua_State* L) {
  check_table(L, 1);
  Pool& pool = *runtime(L).pool();
  std::vector<Eigen::VectorXd> axes, rows;
  for (const auto& [field, list] : {std::pair{"axes", &axes}, std::pair{"values", &rows}})
    with_field(L, 1, field,
               [&, list = list] { for_each(L, -1, [&](lua_Integer) { list->push_back(check_column(L, -1)); }); });
  Eigen::MatrixXd values(static_cast<Eigen::Index>(rows.size()), rows.empty() ? 0 : rows[0].size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() != values.cols())
      throw InputError("lookup: values: row " + std::to_string(i + 1) + ": expected " + std::to_string(values.cols()) +
                       " numbers, got " + std::to_string(rows[i].size()));
    values.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  }
  const std::string name = *string_field(L, 1, "name");
  const Between between = between_from(string_field(L, 1, "between").value_or("linear"));
  for (const FunctionPtr& known : pool.functions()) {  // a saved model that is loaded again
    const auto* table = dynamic_cast<const Lookup*>(known.get());
    if (!table || known->name() != name || !same_table(*table, axes, values, between)) continue;
    push<FunctionPtr>(L, known);
    return 1;
  }
  const auto function = std::make_shared<const Lookup>(pool.free_name(name), axes, values, between);
  pool.add(function);
  push<FunctionPtr>(L, function);
  return 1;
}

int call_bound(lua_State* L) { return call_external(L, check<FunctionPtr>(L, 1), 2); }

int to_string(lua_State* L) {
  push_text(L, check<FunctionPtr>(L, 1)->words());
  return 1;
}

/// A table of values as {axes = {...}, values = {rows}, between =}.
void push_lookup(lua_State* L, const Lookup& lookup) {
  lua_newtable(L);
  lua_newtable(L);
  for (std::size_t i = 0; i < lookup.axes().size(); ++i) {
    push_column(L, lookup.axes()[i]);
    lua_rawseti(L, -2, static_cast<lua_Integer>(i) + 1);
  }
  lua_setfield(L, -2, "axes");
  lua_newtable(L);
  for (Eigen::Index i = 0; i < lookup.values().rows(); ++i) {
    push_column(L, lookup.values().row(i).transpose());
    lua_rawseti(L, -2, i + 1);
  }
  lua_setfield(L, -2, "values");
  push_text(L, to_string(lookup.between()));
  lua_setfield(L, -2, "between");
}

/// functions_of{expressions...} -> {{name=, words=, table = {axes=, values=, between=} or nil}, ...}, each once
int list_functions(lua_State* L) {
  check_table(L, 1);
  std::vector<Expr> parts;
  for_each(L, 1, [&](lua_Integer) { parts.push_back(check_value(L, -1).expr); });
  lua_newtable(L);
  lua_Integer i = 0;
  for (const auto& function : external_functions(parts)) {
    lua_newtable(L);
    push_text(L, function->name());
    lua_setfield(L, -2, "name");
    push_text(L, function->words());
    lua_setfield(L, -2, "words");
    if (const auto* lookup = dynamic_cast<const Lookup*>(function.get())) {
      push_lookup(L, *lookup);
      lua_setfield(L, -2, "table");
    }
    lua_rawseti(L, -2, ++i);
  }
  return 1;
}

}  // namespace

int call_external(lua_State* L, const FunctionPtr& function, int first) {
  std::vector<Expr> arguments;
  std::vector<double> numbers;
  DeclarationsPtr declared;
  for (int i = first; i <= lua_gettop(L); ++i) {
    const Value value = check_value(L, i);
    if (value.expr.is_constant()) numbers.push_back(value.expr.value());
    arguments.push_back(value.expr);
    declared = join(declared, value.declared);
  }
  const Expr result = runtime(L).pool()->call(function, arguments);
  if (numbers.size() == arguments.size()) {
    lua_pushnumber(L, function->call(ExternalPart(), numbers.data()));
    function->rethrow();
  } else {
    push<Value>(L, {result, declared});
  }
  return 1;
}

void open_lua_functions(lua_State* L) {
  static constexpr Entry meta[] = {{"__call", guarded<call_bound>}, {"__tostring", guarded<to_string>}};
  make_type<FunctionPtr>(L, {}, meta);
  static constexpr Entry functions[] = {{"lua_function", guarded<make_lua_function>},
                                        {"lookup", guarded<make_lookup>},
                                        {"functions_of", guarded<list_functions>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
