#pragma once
// Fields of the table on top of the stack: what results are made of.
#include <string>

#include "types.hpp"

namespace lunid::lua {

/// Left out when it is not finite.
void set_number(lua_State* L, const char* field, double value);
void set_text(lua_State* L, const char* field, const std::string& text);
void set_column(lua_State* L, const char* field, const Eigen::VectorXd& values);

}  // namespace lunid::lua
