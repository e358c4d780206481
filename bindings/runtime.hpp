#pragma once
// What one process holds: the Lua state, the pool of expressions, the seed, the log of what was read and written.
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "ranks.hpp"
#include "support.hpp"

namespace lunid::figure {
class FigureModule;
}

namespace lunid::lua {

/// Chunk names of the standard library begin with this, so that an error is blamed on the user's frame.
inline constexpr const char* library_prefix = "@lunid:";

/// A file that was read: its path as found and the hash of its content, for run.json.
struct InputFile {
  std::string path;
  std::string sha256;
};

/// Why a command failed: what a person reads, and the exit code.
struct Failure {
  std::string message;
  Fault fault = Fault::study;
};

class Runtime {
 public:
  /// `executable`: full path of this program; the standard library is ../share/lunid/stdlib or ../stdlib from its
  /// folder. Throws InputError when there is none.
  explicit Runtime(const std::filesystem::path& executable);
  ~Runtime();
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;

  /// Calls `require(module)[function](argument)`; its boolean or integer result is the exit code. Failures carry the
  /// message with the user's file and line.
  int call(const std::string& module, const std::string& function, const nlohmann::json& argument, Failure& failure);

  /// Remembers the kind of fault of a message on its way through Lua.
  void note_fault(const std::string& message, Fault fault) { last_ = {message, fault}; }
  /// The kind of fault of a message that a command ended with.
  Fault fault_of(const std::string& message) const;
  /// Hashes a file that a result depends on; once per path.
  void note_input(const std::string& path);
  const std::vector<InputFile>& inputs() const { return inputs_; }

  lua_State* state() const { return L_; }
  const std::shared_ptr<Pool>& pool() const { return pool_; }
  const std::filesystem::path& library() const { return library_; }
  const std::filesystem::path& executable() const { return executable_; }
  figure::FigureModule& figures() { return *figures_; }
  Ranks& ranks() { return ranks_; }
  std::atomic<bool>& cancelled() { return cancelled_; }

  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all cores

 private:
  void open_lua();

  std::filesystem::path executable_, library_;
  std::shared_ptr<Pool> pool_ = std::make_shared<Pool>();
  std::unique_ptr<figure::FigureModule> figures_;
  Ranks ranks_;
  std::atomic<bool> cancelled_{false};
  std::vector<InputFile> inputs_;
  Failure last_;
  lua_State* L_ = nullptr;
};

/// Ctrl-C and SIGTERM set Runtime::cancelled and stop the Lua code that runs; a second one ends the process at once.
/// Lives as long as the command.
class Interrupts {
 public:
  explicit Interrupts(Runtime& runtime);
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;
};

/// "lunid: interrupted" as an error when Ctrl-C was pressed.
void throw_if_cancelled(Runtime& runtime);

}  // namespace lunid::lua
