// The read-evaluate-print loop. Lines are read here; stdlib/repl.lua runs them and prints their values.
#include <dlfcn.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <string>

#include "command_line.hpp"
#include "runtime.hpp"

namespace lunid::lua {

namespace {

/// What is used of libreadline, which is opened only here. Its callback and a signal handler have no argument
/// to reach a reader by: these are the variables of file scope.
struct Readline {
  void (*begin)(const char*, void (*)(char*)) = nullptr;
  void (*read_character)() = nullptr;
  void (*end)() = nullptr;
  void (*drop_line)() = nullptr;
  void (*remember)(const char*) = nullptr;
  int* catch_signals = nullptr;
} library;
std::optional<std::string> typed;
bool ended = false;
volatile std::sig_atomic_t interrupted = 0;

template <class Symbol>
void take(void* handle, const char* name, Symbol& symbol) {
  symbol = reinterpret_cast<Symbol>(dlsym(handle, name));
}

bool open_library() {
  void* handle = isatty(STDIN_FILENO) ? dlopen("libreadline.so.8", RTLD_LAZY | RTLD_LOCAL) : nullptr;
  if (!handle) return false;
  take(handle, "rl_callback_handler_install", library.begin);
  take(handle, "rl_callback_read_char", library.read_character);
  take(handle, "rl_callback_handler_remove", library.end);
  take(handle, "rl_free_line_state", library.drop_line);
  take(handle, "add_history", library.remember);
  take(handle, "rl_catch_signals", library.catch_signals);
  return library.begin && library.read_character && library.end && library.drop_line && library.remember &&
         library.catch_signals;
}

void on_line(char* text) {
  library.end();
  ended = !text;
  typed = text ? text : "";
  std::free(text);
}

/// SIGINT is let in only while the loop waits: none is missed, none comes in the middle of a character.
class Ctrl_C {
 public:
  Ctrl_C() {
    interrupted = 0;
    sigset_t held;
    sigemptyset(&held);
    sigaddset(&held, SIGINT);
    sigprocmask(SIG_BLOCK, &held, &outside_);
    before_ = std::signal(SIGINT, [](int) { interrupted = 1; });
  }
  ~Ctrl_C() {
    std::signal(SIGINT, before_);
    sigprocmask(SIG_SETMASK, &outside_, nullptr);
  }
  /// True when a character can be read; false when Ctrl-C came instead.
  bool wait() const {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    while (ppoll(&input, 1, nullptr, &outside_) <= 0)
      if (interrupted) return false;
    return true;
  }

 private:
  sigset_t outside_;
  void (*before_)(int);
};

enum class Answer { line, given_up, end };

/// Reads lines with editing and history by libreadline; by getline when it is absent or the input is no
/// terminal.
class LineReader {
 public:
  Answer next(const char* prompt, std::string& line) {
    if (editing_) return edited(prompt, line);
    if (isatty(STDIN_FILENO)) std::cout << prompt << std::flush;
    return std::getline(std::cin, line) ? Answer::line : Answer::end;
  }

 private:
  static Answer edited(const char* prompt, std::string& line) {
    const Ctrl_C ctrl_c;
    *library.catch_signals = 0;
    typed.reset();
    library.begin(prompt, on_line);
    while (!typed) {
      if (ctrl_c.wait()) {
        library.read_character();
        continue;
      }
      library.drop_line();
      library.end();
      std::cout << "^C" << std::endl;
      return Answer::given_up;
    }
    if (ended) {
      std::cout << std::endl;  // the prompt is still on its line
      return Answer::end;
    }
    line = *typed;
    if (!line.empty()) library.remember(line.c_str());
    return Answer::line;
  }

  bool editing_ = open_library();
};

}  // namespace

int repl(Runtime& runtime, const nlohmann::json& options) {
  Failure failure;
  runtime.call("lunid.repl", "start", options, failure);
  if (!failure.message.empty()) throw InputError(failure.message, {}, failure.fault);
  LineReader reader;
  const bool typing = isatty(STDIN_FILENO);
  int code = 0;  // of the first fault; who types has seen it and gone on
  const auto fault = [&](const std::string& message, Fault kind) {
    std::cerr << message << "\n";
    if (code == 0 && !typing) code = static_cast<int>(kind);
  };
  std::string chunk, line;
  for (;;) {
    const Answer answered = reader.next(chunk.empty() ? "> " : ">> ", line);
    if (answered == Answer::end) break;
    if (answered == Answer::given_up) {
      chunk.clear();
      continue;
    }
    chunk += chunk.empty() ? line : "\n" + line;
    Failure wrong;
    const Interrupts interrupts(runtime);
    const int answer = runtime.call("lunid.repl", "evaluate", chunk, wrong);
    const bool failed = !wrong.message.empty();
    if (answer == 2 && !failed) return code;
    const bool incomplete = answer == 1 && !failed;
    if (incomplete && !line.empty()) continue;
    if (failed) fault(wrong.message, wrong.fault);
    if (incomplete) fault("the input above is not complete", Fault::study);
    chunk.clear();
  }
  if (!chunk.empty())
    fault("the input ends before this is complete: " + chunk.substr(0, chunk.find('\n')), Fault::study);
  return code;
}

}  // namespace lunid::lua
