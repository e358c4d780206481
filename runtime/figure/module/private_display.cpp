#include "figure/module/private_display.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lunid::figure {
namespace {

/// A descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  void set(int number) {
    close();
    number_ = number;
  }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

void make_pipe(Descriptor& read_end, Descriptor& write_end) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw std::runtime_error(std::string("cannot make a pipe: ") + strerror(errno));
  read_end.set(ends[0]);
  write_end.set(ends[1]);
}

std::string find_xvfb() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string program = folder + "/Xvfb";
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  throw std::runtime_error("there is no display, and Xvfb is not installed (apt-get install xvfb)");
}

// From here to the end of watch(): the children of a process that may have threads. They call nothing but
// async-signal-safe functions, and everything that they need was made before the fork.

struct Plan {
  const char* program;
  char* const* arguments;
  int lifeline;  ///< the watcher's end of the pipe
  int number;    ///< where Xvfb writes its display's number
  int log;       ///< where Xvfb complains
};

void default_signals() {
  struct sigaction plain {};
  plain.sa_handler = SIG_DFL;
  for (int signal = 1; signal < 32; ++signal) ::sigaction(signal, &plain, nullptr);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// Descriptor 3 becomes the number pipe; nothing else of the parent stays open.
[[noreturn]] void become_xvfb(const Plan& plan, pid_t watcher) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != watcher) ::_exit(1);
  const int nothing = ::open("/dev/null", O_RDWR);
  ::dup2(nothing, 0);
  ::dup2(nothing, 1);
  ::dup2(plan.log, 2);
  // First above all that may be in the way, then to its place.
  const int number = ::fcntl(plan.number, F_DUPFD, 10);
  ::dup2(number, 3);
  ::close_range(4, ~0U, 0);
  ::execv(plan.program, plan.arguments);
  ::_exit(127);
}

void end_server(pid_t server) {
  ::kill(server, SIGTERM);
  for (int wait = 0; wait < 200; ++wait) {
    if (::waitpid(server, nullptr, WNOHANG) != 0) return;
    ::poll(nullptr, 0, 10);
  }
  ::kill(server, SIGKILL);
  ::waitpid(server, nullptr, 0);
}

/// The watcher: starts Xvfb, sleeps until the lifeline breaks, ends Xvfb.
[[noreturn]] void watch(const Plan& plan) {
  ::setsid();  // Ctrl-C in the terminal is not for us
  default_signals();
  const pid_t self = ::getpid();
  const pid_t server = ::fork();
  if (server == 0) become_xvfb(plan, self);
  if (server < 0) ::_exit(1);
  // Hold nothing but the lifeline: an inherited pipe kept open would keep its reader waiting.
  ::dup2(plan.lifeline, 0);
  ::close_range(1, ~0U, 0);
  char byte;
  while (::read(0, &byte, 1) < 0 && errno == EINTR) {
  }
  end_server(server);
  ::_exit(0);
}

/// Reads the number and the line break after it, for ten seconds at most; "" when the server ended or kept
/// silent.
std::string read_number(int descriptor) {
  std::string text;
  constexpr int patience = 10000;
  for (;;) {
    pollfd waiting{descriptor, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, patience);
    if (ready < 0 && errno == EINTR) continue;
    char byte;
    if (ready <= 0) return "";
    const ssize_t got = ::read(descriptor, &byte, 1);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return "";
    if (byte == '\n') return text;
    text += byte;
  }
}

std::string last_line(int log) {
  std::array<char, 2000> buffer{};
  const off_t end = ::lseek(log, 0, SEEK_END);
  const off_t start = std::max<off_t>(0, end - static_cast<off_t>(buffer.size()));
  const ssize_t got = ::pread(log, buffer.data(), buffer.size(), start);
  std::istringstream lines(std::string(buffer.data(), got > 0 ? static_cast<std::size_t>(got) : 0));
  std::string last;
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) last = line;
  return last;
}

}  // namespace

PrivateDisplay::PrivateDisplay() {
  const std::string program = find_xvfb();
  const char* arguments[] = {program.c_str(), "-displayfd", "3",        "-screen",    "0",   "64x64x24",
                             "-nolisten",     "tcp",        "-noreset", "+extension", "GLX", nullptr};
  Descriptor watched, lifeline, number_read, number_write;
  make_pipe(watched, lifeline);
  make_pipe(number_read, number_write);
  const Descriptor log(::memfd_create("xvfb", MFD_CLOEXEC));
  const Plan plan{program.c_str(), const_cast<char* const*>(arguments), watched.number(), number_write.number(),
                  log.number()};
  watcher_ = ::fork();
  if (watcher_ == 0) watch(plan);
  if (watcher_ < 0) throw std::runtime_error(std::string("cannot start Xvfb: ") + strerror(errno));
  number_write.close();
  const std::string number = read_number(number_read.number());
  if (number.empty()) {
    lifeline.close();
    ::waitpid(watcher_, nullptr, 0);
    const std::string reason = last_line(log.number());
    throw std::runtime_error("Xvfb did not start" + (reason.empty() ? std::string() : ": " + reason));
  }
  name_ = ":" + number;
  lifeline_ = lifeline.release();
}

PrivateDisplay::~PrivateDisplay() {
  ::close(lifeline_);
  while (::waitpid(watcher_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace lunid::figure
