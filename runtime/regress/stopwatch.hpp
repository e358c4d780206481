#pragma once
#include <chrono>

namespace lunid::detail {

/// Seconds since it was made, for summaries.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace lunid::detail
