// The read-evaluate-print loop. Lines are read here; stdlib/repl.lua runs them and prints their values.
#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>

#include "command_line.hpp"
#include "runtime.hpp"

namespace lunid::lua {

namespace {

/// Reads lines with editing and history by libreadline, opened only here; by getline when it is absent or the input is
/// no terminal.
class LineReader {
 public:
  LineReader() {
    if (!isatty(STDIN_FILENO)) return;
    void* library = dlopen("libreadline.so.8", RTLD_LAZY | RTLD_LOCAL);
    if (!library) return;
    read_ = reinterpret_cast<char* (*)(const char*)>(dlsym(library, "readline"));
    remember_ = reinterpret_cast<void (*)(const char*)>(dlsym(library, "add_history"));
  }

  bool next(const char* prompt, std::string& line) {
    if (!read_) {
      if (isatty(STDIN_FILENO)) std::cout << prompt << std::flush;
      return static_cast<bool>(std::getline(std::cin, line));
    }
    char* text = read_(prompt);
    if (!text) return false;
    line = text;
    if (*text && remember_) remember_(text);
    std::free(text);
    return true;
  }

 private:
  char* (*read_)(const char*) = nullptr;
  void (*remember_)(const char*) = nullptr;
};

}  // namespace

int repl(Runtime& runtime, const nlohmann::json& options) {
  Failure failure;
  runtime.call("lunid.repl", "start", options, failure);
  if (!failure.message.empty()) throw InputError(failure.message, {}, failure.fault);
  LineReader reader;
  std::string chunk, line;
  while (reader.next(chunk.empty() ? "> " : ">> ", line)) {
    chunk += chunk.empty() ? line : "\n" + line;
    Failure wrong;
    const Interrupts interrupts(runtime);
    const bool incomplete = runtime.call("lunid.repl", "evaluate", chunk, wrong) == 1 && wrong.message.empty();
    if (incomplete && !line.empty()) continue;
    if (!wrong.message.empty()) std::cerr << wrong.message << "\n";
    if (incomplete) std::cerr << "the input above is not complete\n";
    chunk.clear();
  }
  return 0;
}

}  // namespace lunid::lua
