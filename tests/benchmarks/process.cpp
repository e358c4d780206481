// Whole processes, as a user starts them.
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "benchmarks/work.hpp"

extern char** environ;

namespace bench {
namespace {

/// Runs a command to its end, its output thrown away; a failure ends the benchmark.
void spawn(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  int status = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (status == 0) waitpid(child, &status, 0);
  if (status == 0) return;
  std::fprintf(stderr, "failed: %s\n", command[0].c_str());
  std::exit(1);
}

}  // namespace

std::vector<Work> process_works(const std::string& lunid) {
  const std::string dir = std::filesystem::temp_directory_path() / ("lunid-bench-" + std::to_string(getpid()));
  std::filesystem::create_directories(dir);
  std::ofstream(dir + "/study.lua") << "local lunid = require \"lunid\"\n"
                                       "local y, v = lunid.displacement, lunid.velocity\n"
                                       "local k = lunid.parameter { \"k\", 2e4, unit = \"N/m\" }\n"
                                       "print(lunid.model { mass = 49, restoring = k*y + 10*v })\n";
  std::ofstream(dir + "/figure.lua")
      << "local figure = require \"lunid\".figure\n"
         "figure.lines { series = { figure.series { { 1, 2, 3 }, { 1, 4, 9 } } } }:save \"a.png\"\n";
  const std::string data = std::string(LUNID_TEST_DATA);
  const auto nothing = [] { spawn({"true"}); };
  return {
      {"start-version", 1,
       [=] {
         spawn({lunid, "--version"});
       },
       nothing, 10e-3, 15},
      {"start-study", 1,
       [=] {
         spawn({lunid, "run", dir + "/study.lua", "--out", dir + "/study"});
       },
       nothing, 30e-3, 15},
      {"figure-first", 1,
       [=] {
         spawn({lunid, "run", dir + "/figure.lua", "--out", dir + "/figure"});
       },
       nothing, 1.5, 5},
      {"discovery-8s-800Hz",
       1,
       [=] {
         spawn({lunid, "discover", data + "/spring_multisine.csv", "--test", data + "/spring_sweep.csv", "--mass", "49",
                "--restoring", "k*y + c*v", "--out", dir + "/discovery"});
       },
       {},
       20,
       1},
  };
}

}  // namespace bench
