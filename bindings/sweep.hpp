#pragma once
// An ensemble as Lua sees it: what was varied, what came out, and the file that keeps what is done of a long one.
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "simulate/ensemble.hpp"
#include "types.hpp"

namespace lunid::lua {

/// A quantity that differs between the members: a parameter of the model or of the excitation, a first state.
struct Varied {
  std::string name;
  Eigen::VectorXd values;  ///< of each member
};

struct Sweep {
  std::vector<Varied> varied;
  EnsembleResult result;
  Eigen::Index rows = 0;
  double seconds = 0;
  std::vector<std::string> notes;     ///< on external functions: what they cost
  Eigen::Index kept_from_before = 0;  ///< members read from the file of an earlier start

  Eigen::Index members() const { return static_cast<Eigen::Index>(result.done.size()); }
};

template <>
struct Bound<Sweep> {
  static constexpr const char* key = "lunid.sweep";
  static constexpr const char* words = "a sweep";
};

/// Finished members of a long ensemble, appended while it runs: a restart with the same inputs continues from them. One
/// line a member, numbers as hexadecimal floats; a line that was not finished is left out.
class PartialFile {
 public:
  /// `path`: of this process; `key`: what the members depend on, in 64 digits. Nothing is written before the first
  /// flush.
  PartialFile(std::string path, std::string key) : path_(std::move(path)), key_(std::move(key)) {}
  /// Reads what `path` keeps for this key into the result; members that are done stay.
  static void read(const std::string& path, const std::string& key, EnsembleResult& result);
  void add(const EnsembleResult& result, std::span<const Eigen::Index> members);
  void flush();
  /// True when members were added after the last flush.
  bool pending() const { return !lines_.empty(); }

 private:
  std::string path_, key_, lines_;
  std::ofstream out_;
};

}  // namespace lunid::lua
