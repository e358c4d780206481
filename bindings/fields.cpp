#include "fields.hpp"

#include <cmath>

namespace lunid::lua {

void set_number(lua_State* L, const char* field, double value) {
  if (!std::isfinite(value)) return;
  lua_pushnumber(L, value);
  lua_setfield(L, -2, field);
}

void set_text(lua_State* L, const char* field, const std::string& text) {
  push_text(L, text);
  lua_setfield(L, -2, field);
}

void set_column(lua_State* L, const char* field, const Eigen::VectorXd& values) {
  push_column(L, values);
  lua_setfield(L, -2, field);
}

}  // namespace lunid::lua
