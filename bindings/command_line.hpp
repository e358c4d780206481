#pragma once
// The command line: what was asked for, as plain data.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace lunid::lua {

class Runtime;

/// A command of stdlib/commands.lua and its options; or an exit code when there is nothing more to do.
struct Command {
  std::string name;
  nlohmann::json options = nlohmann::json::object();
  std::optional<int> exit_code;
};
/// Prints help, the version or what is wrong (exit code 2) itself.
Command parse_command_line(int argc, char** argv);

std::filesystem::path executable_path();

/// Reads lines, runs them, prints values; ends with the input. libreadline is opened when the input is a terminal.
int repl(Runtime& runtime, const nlohmann::json& options);

}  // namespace lunid::lua
