// The guard between C++ and Lua: destructors run on a Lua error, exceptions become errors with the user's line.
#include <gtest/gtest.h>

#include "runtime.hpp"
#include "types.hpp"

namespace lunid::lua {
namespace {

int alive = 0;  // objects that a guarded function holds

struct Counted {
  Counted() { ++alive; }
  ~Counted() { --alive; }
};

int raise_in_lua(lua_State* L) {
  const Counted object;
  return luaL_error(L, "from Lua");
}
int fail_in_a_callback(lua_State* L) {
  const Counted object;
  lua_call(L, 0, 0);
  return 0;
}
int throw_input_error(lua_State*) {
  const Counted object;
  throw InputError("lambda: expected > 0, got -1");
}
int throw_bad_data(lua_State*) { throw InputError("expected a number", {"run3.csv", 812, 0}, Fault::data); }
int throw_something(lua_State*) { throw std::logic_error("impossible"); }

class Guard : public ::testing::Test {
 protected:
  Guard() : runtime(std::filesystem::path(LUNID_STDLIB) / "../build/lunid"), L(runtime.state()) {}

  /// The message of the error that line 2 of a study raises by calling `function`.
  std::string message_of(lua_CFunction function) {
    lua_pushcfunction(L, function);
    lua_setglobal(L, "f");
    const std::string study = "\nf(function() error('in the callback', 0) end)";
    EXPECT_EQ(luaL_loadbuffer(L, study.data(), study.size(), "@study.lua"), LUA_OK);
    EXPECT_NE(lua_pcall(L, 0, 0, 0), LUA_OK);
    std::string message = lua_tostring(L, -1);
    lua_settop(L, 0);
    return message;
  }

  Runtime runtime;
  lua_State* L;
};

TEST_F(Guard, DestructorsRunOnALuaError) {
  EXPECT_EQ(message_of(guarded<raise_in_lua>), "study.lua:2: from Lua");
  EXPECT_EQ(alive, 0);
}

TEST_F(Guard, DestructorsRunWhenALuaCallbackFails) {
  EXPECT_EQ(message_of(guarded<fail_in_a_callback>), "in the callback");
  EXPECT_EQ(alive, 0);
}

TEST_F(Guard, AnInputErrorCarriesTheUsersLine) {
  EXPECT_EQ(message_of(guarded<throw_input_error>), "study.lua:2: lambda: expected > 0, got -1");
  EXPECT_EQ(alive, 0);
}

TEST_F(Guard, AnErrorInAFileKeepsItsOwnLineAndSaysWhoAsked) {
  const std::string message = message_of(guarded<throw_bad_data>);
  EXPECT_EQ(message, "run3.csv:812: expected a number\n  asked for at study.lua:2");
  EXPECT_EQ(runtime.fault_of("before " + message + " after"), Fault::data);
  EXPECT_EQ(runtime.fault_of("another message"), Fault::study);
}

TEST_F(Guard, OtherExceptionsAreCalledInternal) {
  EXPECT_EQ(message_of(guarded<throw_something>), "study.lua:2: internal fault: impossible");
}

TEST_F(Guard, CollectedObjectsAreDestroyedOnce) {
  const auto values = std::make_shared<const Eigen::VectorXd>(3);
  lua_getglobal(L, "require");
  lua_pushstring(L, "lunid.core");
  ASSERT_EQ(lua_pcall(L, 1, 0, 0), LUA_OK);
  push<Column>(L, {values});
  EXPECT_EQ(values.use_count(), 2);
  lua_settop(L, 0);
  lua_gc(L, LUA_GCCOLLECT);
  EXPECT_EQ(values.use_count(), 1);
}

}  // namespace
}  // namespace lunid::lua
