// The lunid executable: reads the command line and hands the command to stdlib/commands.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <thread>

#include "command_line.hpp"
#include "runtime.hpp"

namespace {

/// A rank that fails ends all of them, which would wait for it. A fault of the study is that of every rank: the first
/// one says it; another only where the first one goes on.
[[noreturn]] void end_ranks(const lunid::lua::Ranks& ranks, const std::string& message, int code) {
  if (ranks.rank() > 0) std::this_thread::sleep_for(std::chrono::seconds(2));
  if (ranks.rank() > 0) std::cerr << "rank " << ranks.rank() << ": ";
  if (!message.empty()) std::cerr << message << "\n";
  std::fflush(stdout);
  ranks.abort(code);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace lunid;
  std::signal(SIGPIPE, SIG_IGN);  // a reader that goes away (`| head`) does not cost the results
  const lua::Command command = lua::parse_command_line(argc, argv);
  if (command.exit_code) return *command.exit_code;
  try {
    lua::Runtime runtime(lua::executable_path());
    if (command.name == "repl") return lua::repl(runtime, command.options);
    const lua::Interrupts interrupts(runtime);
    lua::Failure failure;
    const int code = runtime.call("lunid.commands", command.name, command.options, failure);
    if (runtime.ranks().size() > 1 && code != 0) end_ranks(runtime.ranks(), failure.message, code);
    if (!failure.message.empty()) std::cerr << failure.message << "\n";
    runtime.ranks().finish();
    return code;
  } catch (const InputError& error) {
    std::cerr << error.what() << "\n";
    return static_cast<int>(error.fault());
  }
}
