// JSON <-> Lua tables, for everything that a result holds.
#include <cmath>
#include <nlohmann/json.hpp>

#include "support.hpp"

namespace lunid::lua {

namespace {

constexpr const char* list_key = "lunid.list";

void push_list(lua_State* L, const nlohmann::json& list) {
  lua_createtable(L, static_cast<int>(list.size()), 0);
  lua_Integer i = 0;
  for (const auto& entry : list) {
    push_json(L, entry);
    lua_rawseti(L, -2, ++i);
  }
  luaL_newmetatable(L, list_key);
  lua_setmetatable(L, -2);
}

bool is_list(lua_State* L, int index) {
  if (lua_rawlen(L, index) > 0) return true;
  if (!lua_getmetatable(L, index)) return false;
  luaL_getmetatable(L, list_key);
  const bool marked = lua_rawequal(L, -1, -2);
  lua_pop(L, 2);
  return marked;
}

nlohmann::json table_to_json(lua_State* L, int index) {
  if (is_list(L, index)) {
    auto list = nlohmann::json::array();
    for_each(L, index, [&](lua_Integer) { list.push_back(to_json(L, -1)); });
    return list;
  }
  auto object = nlohmann::json::object();  // sorted by key: the order of pairs() does not reach the file
  lua_pushnil(L);
  while (lua_next(L, index)) {
    if (lua_type(L, -2) != LUA_TSTRING) throw InputError("JSON: expected a string as key, got " + describe(L, -2));
    object[lua_tostring(L, -2)] = to_json(L, -1);
    lua_pop(L, 1);
  }
  return object;
}

}  // namespace

void push_json(lua_State* L, const nlohmann::json& value) {
  luaL_checkstack(L, 4, "JSON is nested too deeply");
  switch (value.type()) {
    case nlohmann::json::value_t::boolean: lua_pushboolean(L, value.get<bool>()); break;
    case nlohmann::json::value_t::number_integer:
    case nlohmann::json::value_t::number_unsigned: lua_pushinteger(L, value.get<lua_Integer>()); break;
    case nlohmann::json::value_t::number_float: lua_pushnumber(L, value.get<double>()); break;
    case nlohmann::json::value_t::string: push_text(L, value.get_ref<const std::string&>()); break;
    case nlohmann::json::value_t::array: push_list(L, value); break;
    case nlohmann::json::value_t::object:
      lua_createtable(L, 0, static_cast<int>(value.size()));
      for (const auto& [key, entry] : value.items()) {
        push_json(L, entry);
        lua_setfield(L, -2, key.c_str());
      }
      break;
    default: lua_pushnil(L);
  }
}

nlohmann::json to_json(lua_State* L, int index) {
  luaL_checkstack(L, 4, "table is nested too deeply");
  index = lua_absindex(L, index);
  switch (lua_type(L, index)) {
    case LUA_TNIL: return nullptr;
    case LUA_TBOOLEAN: return static_cast<bool>(lua_toboolean(L, index));
    case LUA_TNUMBER:
      if (lua_isinteger(L, index)) return lua_tointeger(L, index);
      return std::isfinite(lua_tonumber(L, index)) ? nlohmann::json(lua_tonumber(L, index)) : nlohmann::json();
    case LUA_TSTRING: {
      std::size_t size = 0;
      const char* text = lua_tolstring(L, index, &size);
      return std::string(text, size);
    }
    case LUA_TTABLE: return table_to_json(L, index);
    default: throw InputError("JSON: expected a plain value, got " + describe(L, index));
  }
}

}  // namespace lunid::lua
