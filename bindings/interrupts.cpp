#include <csignal>
#include <string_view>

#include "runtime.hpp"

namespace lunid::lua {

namespace {

// A signal handler has no argument to reach its Runtime by: this is the one variable of file scope.
std::atomic<Runtime*> listening{nullptr};

/// Stops the user's code only: the standard library's own calls look at the flag themselves, and must be able to put
/// away what was done.
void stop_lua(lua_State* L, lua_Debug* frame) {
  lua_getinfo(L, "S", frame);
  if (*frame->what != 'C' && !std::string_view(frame->source).starts_with(library_prefix)) {
    luaL_error(L, "interrupted");
  }
}

void on_signal(int) {
  Runtime* runtime = listening.load();
  if (!runtime) return;
  runtime->cancelled() = true;
  lua_sethook(runtime->state(), stop_lua, LUA_MASKCALL | LUA_MASKRET | LUA_MASKCOUNT, 100);
}

void listen(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second one ends the process
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

Interrupts::Interrupts(Runtime& runtime) {
  listening = &runtime;
  listen(on_signal);
}

Interrupts::~Interrupts() {
  listen(SIG_DFL);
  listening = nullptr;
}

void throw_if_cancelled(Runtime& runtime) {
  if (runtime.cancelled()) throw InputError("interrupted", {}, Fault::interrupted);
}

}  // namespace lunid::lua
