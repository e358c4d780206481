#pragma once
// The small header between C++ and Lua: check arguments, push values, one metatable per bound type, one guard that
// turns C++ exceptions into Lua errors. Lua is linked as C++, so a Lua error unwinds C++ frames and runs destructors;
// nothing here catches it (`catch (...)` around a Lua call is forbidden).
#include <lua.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "expr/error.hpp"

namespace lunid::lua {

class Runtime;
/// The Runtime that owns this state.
Runtime& runtime(lua_State* L);

/// Sets the stack back to its height of now, whatever comes.
class StackTop {
 public:
  explicit StackTop(lua_State* L) : L_(L), top_(lua_gettop(L)) {}
  ~StackTop() { lua_settop(L_, top_); }
  StackTop(const StackTop&) = delete;
  StackTop& operator=(const StackTop&) = delete;
  int top() const { return top_; }

 private:
  lua_State* L_;
  int top_;
};

/// How a bound type is called: `key` is its metatable's name in the registry, `words` what messages say ("a record").
/// Specialised beside each type in types.hpp.
template <class T>
struct Bound;

/// "study.lua:14: " of the innermost frame that is the user's (not the standard library, not C); "" when there is none.
std::string user_position(lua_State* L);
/// "a number", "a string", "a record", "nothing" ...
std::string describe(lua_State* L, int index);
/// Throws InputError `argument N: expected <words>, got ...`.
[[noreturn]] void bad_argument(lua_State* L, int index, std::string_view expected);

/// Turns an exception into the message that a person reads, with the user's file and line, and pushes it.
void push_error(lua_State* L, const std::exception& error);

/// Calls `function`. An error that an external function raised meanwhile is the one to tell (expr/external.hpp).
int run_watched(lua_State* L, lua_CFunction function);

/// The guard: every C++ function that Lua may call is registered as guarded<function>.
template <int (*Function)(lua_State*)>
int guarded(lua_State* L) {
  try {
    return run_watched(L, Function);
  } catch (const std::exception& error) {
    push_error(L, error);
  }
  return lua_error(L);
}

/// One entry of a module or of a metatable's methods.
struct Entry {
  const char* name;
  lua_CFunction function;
};
/// Sets the entries as fields of the table on top of the stack.
void set_functions(lua_State* L, std::span<const Entry> entries);
/// Makes the metatable `key`: methods under __methods, and under __index when no metamethod is given; metamethods; a
/// lock.
void make_metatable(lua_State* L, const char* key, const char* words, std::span<const Entry> methods,
                    std::span<const Entry> meta);

namespace detail {
void* test(lua_State* L, int index, const char* key);
void set_metatable(lua_State* L, const char* key);
}  // namespace detail

/// The value at `index`, or null when it is of another type.
template <class T>
T* test(lua_State* L, int index) {
  return static_cast<T*>(detail::test(L, index, Bound<T>::key));
}
/// The value at `index`; throws InputError otherwise.
template <class T>
T& check(lua_State* L, int index) {
  if (T* value = test<T>(L, index)) return *value;
  bad_argument(L, index, Bound<T>::words);
}
/// Pushes a value as a userdata of its type. Memory is taken first, then the value is moved in: nothing leaks.
template <class T>
T& push(lua_State* L, T value) {
  void* memory = lua_newuserdatauv(L, sizeof(T), 0);
  T* object = new (memory) T(std::move(value));
  detail::set_metatable(L, Bound<T>::key);
  return *object;
}
template <class T>
int collect(lua_State* L) {
  if (T* object = test<T>(L, 1)) object->~T();
  return 0;
}
template <class T>
void make_type(lua_State* L, std::span<const Entry> methods, std::span<const Entry> meta) {
  std::vector<Entry> all(meta.begin(), meta.end());
  all.push_back({"__gc", collect<T>});
  make_metatable(L, Bound<T>::key, Bound<T>::words, methods, all);
}

double check_number(lua_State* L, int index);
long long check_integer(lua_State* L, int index);
std::string check_string(lua_State* L, int index);
bool check_boolean(lua_State* L, int index);
void check_table(lua_State* L, int index);
inline void push_text(lua_State* L, std::string_view text) { lua_pushlstring(L, text.data(), text.size()); }

/// Fields of the table at `index`; nullopt when absent. A wrong type throws InputError `field: expected ..., got ...`.
std::optional<double> number_field(lua_State* L, int index, const char* field);
std::optional<std::string> string_field(lua_State* L, int index, const char* field);
bool boolean_field(lua_State* L, int index, const char* field, bool otherwise);
std::vector<std::string> strings_field(lua_State* L, int index, const char* field);

/// Runs `body` for each entry of the list at `index`, in order, with the entry on top of the stack.
template <class Body>
void for_each(lua_State* L, int index, Body body) {
  index = lua_absindex(L, index);
  const auto count = static_cast<lua_Integer>(lua_rawlen(L, index));
  for (lua_Integer i = 1; i <= count; ++i) {
    lua_rawgeti(L, index, i);
    body(i);
    lua_pop(L, 1);
  }
}
/// Runs `body` with the table's field on top of the stack when it is there (not nil).
template <class Body>
void with_field(lua_State* L, int index, const char* field, Body body) {
  if (lua_getfield(L, index, field) != LUA_TNIL) body();
  lua_pop(L, 1);
}

/// JSON <-> Lua. Objects and lists become tables, null is nil; lists are marked, so that an empty one stays a list.
void push_json(lua_State* L, const nlohmann::json& value);
/// Numbers that are not finite become null; functions and userdata throw InputError.
nlohmann::json to_json(lua_State* L, int index);

}  // namespace lunid::lua
