#pragma once
// Frozen runs in place, many in few modes: within one mode every branch is known, so what remains is arithmetic, which
// runs as machine code. Same bits as Tape::run_prepared_frozen.
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "expr/tape.hpp"

namespace lunid {

/// Of one thread and one tape, which it keeps.
class FrozenRun {
 public:
  explicit FrozenRun(const Tape& tape) : tape_(tape) {}

  /// As Tape::run_prepared_frozen. The code of a mode is made when it has run some times; all runs of the tape share
  /// it.
  void operator()(const std::vector<std::int8_t>& mode, double* scratch) noexcept {
    if (!now_ || !same(mode, now_->mode)) now_ = find(mode);
    if (now_ && now_->code)
      now_->code(scratch);
    else
      interpret(mode, scratch);
  }

 private:
  struct Mode {
    std::vector<std::int8_t> mode;
    Tape::PointCode code = nullptr;
    int runs = 0;
  };

  /// A loop of its own: modes are short, and this is asked before every run.
  static bool same(const std::vector<std::int8_t>& a, const std::vector<std::int8_t>& b) {
    std::size_t i = 0;
    while (i < a.size() && a[i] == b[i]) ++i;
    return i == a.size();
  }
  Mode* find(const std::vector<std::int8_t>& mode);
  void interpret(const std::vector<std::int8_t>& mode, double* scratch) noexcept;

  Tape tape_;
  std::deque<Mode> modes_;
  Mode* now_ = nullptr;  ///< the mode of the last run; null: one too many
};

}  // namespace lunid
