// The private display: it comes when needed and goes with its process, however that ends.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "expr/error.hpp"
#include "figure_samples.hpp"

#ifdef __SANITIZE_ADDRESS__
// The OpenGL driver keeps some hundred bytes for each context, and VTK's PDF exporter a renderer for each
// file.
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }
#endif

namespace {

using namespace samples;

/// Sets or unsets a variable for a while.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    had_ = std::getenv(name) != nullptr;
    if (value)
      setenv(name, value, 1);
    else
      unsetenv(name);
  }
  ~Environment() {
    if (had_)
      setenv(name_, before_.c_str(), 1);
    else
      unsetenv(name_);
  }

 private:
  const char* name_;
  std::string before_;
  bool had_;
};

constexpr const char* mark_name = "LUNID_TEST_MARK";
constexpr const char* role_name = "LUNID_TEST_ROLE";

/// X servers that inherited this mark.
int servers(const std::string& mark) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    if (content(entry.path() / "comm") != "Xvfb\n") continue;
    const std::string environment = content(entry.path() / "environ");
    count += environment.find(std::string(mark_name) + "=" + mark + '\0') != std::string::npos;
  }
  return count;
}

/// Waits until there are none; the limit only ends a failed test.
bool all_gone(const std::string& mark) {
  for (int i = 0; i < 1000; ++i) {
    if (servers(mark) == 0) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// A process of its own that plays one of the roles below, in a process group as a shell would make it.
class Child {
 public:
  Child(const std::string& role, const std::string& mark, const std::string& argument = "") {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw std::runtime_error("pipe");
    pid_ = fork();
    if (pid_ == 0) {
      setpgid(0, 0);
      setenv(mark_name, mark.c_str(), 1);
      setenv(role_name, role.c_str(), 1);
      setenv("LUNID_TEST_ARGUMENT", argument.c_str(), 1);
      unsetenv("DISPLAY");
      dup2(ends[1], 1);
      execl("/proc/self/exe", "child", nullptr);
      _exit(127);
    }
    close(ends[1]);
    output_ = ends[0];
  }
  ~Child() { close(output_); }

  /// Blocks until the child has printed this.
  bool says(const std::string& word) {
    std::string text;
    char byte;
    while (text.find(word) == std::string::npos && read(output_, &byte, 1) == 1) text += byte;
    return text.find(word) != std::string::npos;
  }
  void send(int signal) const { kill(-pid_, signal); }
  int wait() const {
    int status = 0;
    waitpid(pid_, &status, 0);
    return status;
  }

 private:
  pid_t pid_ = -1;
  int output_ = -1;
};

std::string fresh_mark(const char* name) { return std::string(name) + std::to_string(getpid()); }

void say_drawn() {
  if (write(1, "drawn\n", 6) != 6) _exit(1);
}

/// What a child does, before any test could start: a role never returns.
void play(const std::string& role) {
  FigureModule module(module_file());
  if (role == "draws a file") {
    module.render(rivals(), std::getenv("LUNID_TEST_ARGUMENT"));
    std::exit(0);
  }
  {
    Folder folder;
    module.render(rivals(), folder / "a.png");
  }
  say_drawn();
  if (role == "draws and exits") _exit(0);  // no destructor runs
  for (;;) pause();
}

const bool is_child = [] {
  const char* role = std::getenv(role_name);
  if (role) play(role);
  return role != nullptr;
}();

TEST(FigureDisplay, no_server_is_left_after_a_normal_end) {
  ASSERT_FALSE(is_child);
  const std::string mark = fresh_mark("normal");
  const Environment marked(mark_name, mark.c_str()), none("DISPLAY", nullptr);
  {
    FigureModule module(module_file());
    EXPECT_EQ(servers(mark), 0);  // not before the first drawing
    EXPECT_NE(module.check().find("private display"), std::string::npos);
    EXPECT_EQ(servers(mark), 1);
  }
  EXPECT_EQ(servers(mark), 0);  // at once
}

TEST(FigureDisplay, no_server_is_left_after_an_exit_without_clean_up) {
  const std::string mark = fresh_mark("exit");
  Child child("draws and exits", mark);
  EXPECT_TRUE(child.says("drawn"));
  EXPECT_EQ(child.wait(), 0);
  EXPECT_TRUE(all_gone(mark));
}

TEST(FigureDisplay, no_server_is_left_after_a_kill) {
  for (const int signal : {SIGKILL, SIGINT, SIGTERM, SIGSEGV}) {
    const std::string mark = fresh_mark("kill") + "_" + std::to_string(signal);
    Child child("draws and waits", mark);
    ASSERT_TRUE(child.says("drawn"));
    EXPECT_EQ(servers(mark), 1);
    child.send(signal);
    const int status = child.wait();
    EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    EXPECT_TRUE(all_gone(mark)) << "signal " << signal;
  }
}

TEST(FigureDisplay, parallel_runs_do_not_collide) {
  Folder folder;
  const std::string mark = fresh_mark("parallel");
  std::vector<std::unique_ptr<Child>> children;
  for (int i = 0; i < 4; ++i)
    children.push_back(std::make_unique<Child>("draws a file", mark, folder / (std::to_string(i) + ".png")));
  for (const auto& child : children) {
    child->says("never");  // reads to the end
    EXPECT_EQ(child->wait(), 0);
  }
  const std::string first = content(folder / "0.png");
  EXPECT_GT(first.size(), 5000u);
  for (int i = 1; i < 4; ++i) EXPECT_EQ(content(folder / (std::to_string(i) + ".png")), first);
  EXPECT_TRUE(all_gone(mark));
}

TEST(FigureDisplay, a_display_that_does_not_answer_is_passed_over) {
  for (const char* dead : {":9753", "nowhere.invalid:0", "nonsense", ""}) {
    const Environment display("DISPLAY", dead);
    FigureModule module(module_file());
    EXPECT_NE(module.check().find("private display"), std::string::npos) << dead;
  }
}

TEST(FigureDisplay, without_xvfb_the_error_names_the_package) {
  const Environment display("DISPLAY", nullptr), path("PATH", "/nonexistent");
  Folder folder;
  FigureModule module(module_file());
  std::string message;
  try {
    module.render(rivals(), folder / "a.png");
  } catch (const lunid::InputError& e) {
    message = e.message();
  }
  EXPECT_EQ(message, "cannot draw: there is no display, and Xvfb is not installed (apt-get install xvfb)");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
  // The numbers of a surface need no display.
  module.export_surface(surface(), folder / "s.vts");
  EXPECT_GT(content(folder / "s.vts").size(), 1000u);
}

}  // namespace
