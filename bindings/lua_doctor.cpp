// What this executable was built with, for `lunid doctor`.
#include <sundials/sundials_config.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <thread>

#include "types.hpp"

namespace lunid::lua {

namespace {

std::string dotted(int a, int b, int c) {
  return std::to_string(a) + "." + std::to_string(b) + "." + std::to_string(c);
}

/// List of {name=, version=}.
int versions(lua_State* L) {
  nlohmann::json list = nlohmann::json::array();
  const auto add = [&](const char* name, const std::string& version) {
    list.push_back({{"name", name}, {"version", version}});
  };
  add("lua", LUA_RELEASE);
  add("eigen", dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION));
  add("sundials", SUNDIALS_VERSION);
  add("threads", std::to_string(std::thread::hardware_concurrency()));
  push_json(L, list);
  return 1;
}

}  // namespace

void open_doctor(lua_State* L) {
  static constexpr Entry functions[] = {{"versions", guarded<versions>}};
  set_functions(L, functions);
}

}  // namespace lunid::lua
