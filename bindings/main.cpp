// The lunid executable: reads the command line and hands the command to stdlib/commands.
#include <cstdio>
#include <iostream>

#include "command_line.hpp"
#include "runtime.hpp"

int main(int argc, char** argv) {
  using namespace lunid;
  const lua::Command command = lua::parse_command_line(argc, argv);
  if (command.exit_code) return *command.exit_code;
  try {
    lua::Runtime runtime(lua::executable_path());
    if (command.name == "repl") return lua::repl(runtime, command.options);
    const lua::Interrupts interrupts(runtime);
    lua::Failure failure;
    const int code = runtime.call("lunid.commands", command.name, command.options, failure);
    if (!failure.message.empty()) std::cerr << failure.message << "\n";
    return code;
  } catch (const InputError& error) {
    std::cerr << error.what() << "\n";
    return static_cast<int>(error.fault());
  }
}
