#pragma once
// Threads for work on models.
#include "expr/external.hpp"
#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {

/// As the user says; one where models may call a function that Lua computes, which only the study's thread may run.
inline int model_threads(lua_State* L) {
  for (const FunctionPtr& function : runtime(L).pool()->functions())
    if (!function->thread_safe()) return 1;
  return runtime(L).threads;
}

}  // namespace lunid::lua
