#include "support.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>

#include "expr/external.hpp"
#include "runtime.hpp"

namespace lunid::lua {

Runtime& runtime(lua_State* L) { return **static_cast<Runtime**>(lua_getextraspace(L)); }

namespace {

bool is_library(const lua_Debug& frame) {
  return std::strncmp(frame.source, library_prefix, std::strlen(library_prefix)) == 0;
}

}  // namespace

std::string user_position(lua_State* L) {
  lua_Debug frame;
  for (int level = 0; lua_getstack(L, level, &frame); ++level) {
    lua_getinfo(L, "Sl", &frame);
    if (*frame.what == 'C' || is_library(frame) || frame.currentline <= 0) continue;
    return std::string(*frame.source == '@' ? frame.source + 1 : frame.short_src) + ":" +
           std::to_string(frame.currentline) + ": ";
  }
  return {};
}

std::string describe(lua_State* L, int index) {
  if (luaL_getmetafield(L, index, "__words") == LUA_TSTRING) {
    std::string words = lua_tostring(L, -1);
    lua_pop(L, 1);
    return words;
  }
  switch (lua_type(L, index)) {
    case LUA_TNONE:
    case LUA_TNIL: return "nothing";
    case LUA_TNUMBER: {
      if (std::isnan(lua_tonumber(L, index))) return "nan";  // of either sign
      char text[32];
      std::snprintf(text, sizeof text, "%.14g", lua_tonumber(L, index));
      return text;
    }
    case LUA_TSTRING: return "the string '" + std::string(lua_tostring(L, index)) + "'";
    case LUA_TBOOLEAN: return lua_toboolean(L, index) ? "true" : "false";
    case LUA_TTABLE: return "a table";
    case LUA_TFUNCTION: return "a function";
    default: return std::string("a ") + luaL_typename(L, index);
  }
}

namespace {

/// Of a method called with a colon the value itself is no argument that was written.
bool is_called_as_method(lua_State* L) {
  lua_Debug frame;
  return lua_getstack(L, 0, &frame) && lua_getinfo(L, "n", &frame) && std::string_view(frame.namewhat) == "method";
}

}  // namespace

void bad_argument(lua_State* L, int index, std::string_view expected) {
  const int written = index > 1 && is_called_as_method(L) ? index - 1 : index;
  throw InputError("argument " + std::to_string(written) + ": expected " + std::string(expected) + ", got " +
                   describe(L, index));
}

namespace {

/// Rethrows what an external function raised; an interruption is told by whoever was interrupted.
void rethrow_external_errors(lua_State* L) {
  for (const auto& function : runtime(L).pool()->functions()) {
    if (runtime(L).cancelled()) function->forget();
    function->rethrow();
  }
}

}  // namespace

int run_watched(lua_State* L, lua_CFunction function) {
  try {
    const int results = function(L);
    rethrow_external_errors(L);
    return results;
  } catch (const std::exception&) {
    rethrow_external_errors(L);
    throw;
  }
}

void push_error(lua_State* L, const std::exception& error) {
  std::string text = error.what();
  if (const auto* input = dynamic_cast<const InputError*>(&error)) {
    const std::string position = user_position(L);
    if (input->where().file.empty()) {
      text = position + text;
    } else if (!position.empty()) {
      text += "\n  asked for at " + position.substr(0, position.size() - 2);
    }
    runtime(L).note_fault(text, input->fault());
  } else if (dynamic_cast<const std::bad_alloc*>(&error)) {
    text = user_position(L) + "out of memory";
  } else {
    text = user_position(L) + "internal fault: " + text;
  }
  push_text(L, text);
}

namespace {

/// Assignment to a field of a bound type that has no assignment of its own.
int refuse_assignment(lua_State* L) {
  const std::string key = lua_type(L, 2) == LUA_TSTRING ? "'" + check_string(L, 2) + "'" : "[" + describe(L, 2) + "]";
  throw InputError(describe(L, 1) + " is read-only: " + key + " cannot be assigned");
}

}  // namespace

void set_functions(lua_State* L, std::span<const Entry> entries) {
  for (const Entry& entry : entries) {
    lua_pushcfunction(L, entry.function);
    lua_setfield(L, -2, entry.name);
  }
}

void make_metatable(lua_State* L, const char* key, const char* words, std::span<const Entry> methods,
                    std::span<const Entry> meta) {
  luaL_newmetatable(L, key);
  set_functions(L, meta);
  lua_newtable(L);
  set_functions(L, methods);
  if (lua_getfield(L, -2, "__index") == LUA_TNIL) {
    lua_pushvalue(L, -2);
    lua_setfield(L, -4, "__index");
  }
  lua_pop(L, 1);
  lua_setfield(L, -2, "__methods");
  if (lua_getfield(L, -1, "__newindex") == LUA_TNIL) {
    lua_pushcfunction(L, guarded<refuse_assignment>);
    lua_setfield(L, -3, "__newindex");
  }
  lua_pop(L, 1);
  push_text(L, words);
  lua_setfield(L, -2, "__words");
  push_text(L, key);
  lua_setfield(L, -2, "__metatable");
  lua_pop(L, 1);
}

namespace detail {

void* test(lua_State* L, int index, const char* key) { return luaL_testudata(L, index, key); }
void set_metatable(lua_State* L, const char* key) { luaL_setmetatable(L, key); }

}  // namespace detail

double check_number(lua_State* L, int index) {
  if (lua_type(L, index) != LUA_TNUMBER) bad_argument(L, index, "a number");
  return lua_tonumber(L, index);
}

long long check_integer(lua_State* L, int index) {
  int exact = 0;
  const auto value = lua_tointegerx(L, index, &exact);
  if (lua_type(L, index) != LUA_TNUMBER || !exact) bad_argument(L, index, "a whole number");
  return value;
}

std::string check_string(lua_State* L, int index) {
  if (lua_type(L, index) != LUA_TSTRING) bad_argument(L, index, "a string");
  std::size_t size = 0;
  const char* text = lua_tolstring(L, index, &size);
  return {text, size};
}

bool check_boolean(lua_State* L, int index) {
  if (lua_type(L, index) != LUA_TBOOLEAN) bad_argument(L, index, "true or false");
  return lua_toboolean(L, index);
}

void check_table(lua_State* L, int index) {
  if (lua_type(L, index) != LUA_TTABLE) bad_argument(L, index, "a table");
}

namespace {

[[noreturn]] void bad_field(lua_State* L, const char* field, const char* expected) {
  throw InputError(std::string(field) + ": expected " + expected + ", got " + describe(L, -1));
}

}  // namespace

std::optional<double> number_field(lua_State* L, int index, const char* field) {
  std::optional<double> result;
  with_field(L, index, field, [&] {
    if (lua_type(L, -1) != LUA_TNUMBER) bad_field(L, field, "a number");
    result = lua_tonumber(L, -1);
  });
  return result;
}

std::optional<std::string> string_field(lua_State* L, int index, const char* field) {
  std::optional<std::string> result;
  with_field(L, index, field, [&] {
    if (lua_type(L, -1) != LUA_TSTRING) bad_field(L, field, "a string");
    std::size_t size = 0;
    const char* text = lua_tolstring(L, -1, &size);
    result.emplace(text, size);
  });
  return result;
}

bool boolean_field(lua_State* L, int index, const char* field, bool otherwise) {
  bool result = otherwise;
  with_field(L, index, field, [&] {
    if (lua_type(L, -1) != LUA_TBOOLEAN) bad_field(L, field, "true or false");
    result = lua_toboolean(L, -1);
  });
  return result;
}

std::vector<std::string> strings_field(lua_State* L, int index, const char* field) {
  std::vector<std::string> result;
  with_field(L, index, field, [&] {
    if (lua_type(L, -1) != LUA_TTABLE) bad_field(L, field, "a list of strings");
    for_each(L, -1, [&](lua_Integer) {
      if (lua_type(L, -1) != LUA_TSTRING) bad_field(L, field, "a list of strings");
      result.emplace_back(lua_tostring(L, -1));
    });
  });
  return result;
}

}  // namespace lunid::lua
