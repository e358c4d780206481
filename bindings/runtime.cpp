#include "runtime.hpp"

#include "figure/module.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sha256.hpp"
#include "types.hpp"

namespace lunid::lua {

namespace {

namespace fs = std::filesystem;

fs::path find_library(const fs::path& executable) {
  const fs::path folder = executable.parent_path();
  for (const fs::path& candidate :
       {folder / "../share/lunid/stdlib", folder / "../stdlib", fs::path(LUNID_SOURCE_STDLIB)}) {
    std::error_code none;
    if (fs::exists(candidate / "lunid.lua", none)) return fs::weakly_canonical(candidate, none);
  }
  throw InputError("the standard library is missing: expected share/lunid/stdlib/lunid.lua beside bin/, from " +
                   folder.string());
}

/// require "lunid" and "lunid.NAME": files of the standard library, under chunk names that errors are not blamed on.
int search_library(lua_State* L) {
  const std::string name = check_string(L, 1);
  const bool whole = name == "lunid";
  if (!whole && name.rfind("lunid.", 0) != 0) return 0;
  std::string file = whole ? name : name.substr(6);
  std::replace(file.begin(), file.end(), '.', '/');
  const fs::path path = runtime(L).library() / (file + ".lua");
  std::ifstream in(path, std::ios::binary);
  if (!in) return 0;
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (luaL_loadbuffer(L, text.data(), text.size(), (library_prefix + file + ".lua").c_str()) != LUA_OK) lua_error(L);
  return 1;
}

int open_core(lua_State* L) {
  lua_newtable(L);
  for (const Opener open : openers()) open(L);
  return 1;
}

/// Messages pass unchanged; a fault of the standard library itself gets its traceback.
int handle_message(lua_State* L) {
  const char* text = lua_tostring(L, 1);
  if (!text) text = luaL_tolstring(L, 1, nullptr);
  if (std::string_view(text).substr(0, 6) == std::string_view(library_prefix).substr(1)) {
    luaL_traceback(L, L, text, 1);
  } else {
    lua_pushstring(L, text);
  }
  return 1;
}

}  // namespace

Runtime::Runtime(const fs::path& executable)
    : executable_(executable), library_(find_library(executable)), figures_(std::make_unique<figure::FigureModule>()) {
  L_ = luaL_newstate();
  if (!L_) throw std::bad_alloc();
  *static_cast<Runtime**>(lua_getextraspace(L_)) = this;
  open_lua();
}

Runtime::~Runtime() { lua_close(L_); }

void Runtime::open_lua() {
  luaL_openlibs(L_);
  luaL_getsubtable(L_, LUA_REGISTRYINDEX, LUA_PRELOAD_TABLE);
  lua_pushcfunction(L_, open_core);
  lua_setfield(L_, -2, "lunid.core");
  lua_getglobal(L_, "package");
  lua_getfield(L_, -1, "searchers");
  lua_pushcfunction(L_, guarded<search_library>);
  lua_rawseti(L_, -2, 2);  // in place of package.path; the user's own modules are found by stdlib/strict.lua
  for (int i = 3; i <= 4; ++i) {
    lua_pushnil(L_);
    lua_rawseti(L_, -2, i);
  }
  lua_settop(L_, 0);
}

Fault Runtime::fault_of(const std::string& message) const {
  if (cancelled_) return Fault::interrupted;
  return !last_.message.empty() && message.find(last_.message) != std::string::npos ? last_.fault : Fault::study;
}

int Runtime::call(const std::string& module, const std::string& function, const nlohmann::json& argument,
                  Failure& failure) {
  lua_settop(L_, 0);
  lua_pushcfunction(L_, handle_message);
  lua_getglobal(L_, "require");
  push_text(L_, module);
  int status = lua_pcall(L_, 1, 1, 1);
  if (status == LUA_OK) {
    lua_getfield(L_, -1, function.c_str());
    push_json(L_, argument);
    status = lua_pcall(L_, 1, 1, 1);
  }
  if (status == LUA_OK) return lua_isinteger(L_, -1) ? static_cast<int>(lua_tointeger(L_, -1)) : 0;
  failure.message = lua_tostring(L_, -1);
  failure.fault = fault_of(failure.message);
  return static_cast<int>(failure.fault);
}

void Runtime::note_input(const std::string& path) {
  const auto same = [&](const InputFile& input) { return input.path == path; };
  if (std::none_of(inputs_.begin(), inputs_.end(), same)) inputs_.push_back({path, sha256_of_file(path)});
}

}  // namespace lunid::lua
