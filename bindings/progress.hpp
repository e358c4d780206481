#pragma once
// How far work is: a line on a terminal, and now and then a line in a log.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <mutex>
#include <string>

namespace lunid::lua {

inline bool on_terminal() { return isatty(STDERR_FILENO); }

/// Writes " 43 %  regress" over the line, on a terminal only.
inline void show_progress(const std::string& stage, double fraction) {
  if (on_terminal()) std::fprintf(stderr, "\r\033[K%3.0f %%  %s", 100 * fraction, stage.c_str());
}

/// Where there is no terminal, long work leaves a line in the log at most every so many seconds: " 43 %  regress".
class ProgressLog {
 public:
  explicit ProgressLog(double seconds = 10, std::FILE* log = stderr) : every_(seconds), log_(log) {}

  /// On a terminal as show_progress(). Several threads may call it.
  void show(const std::string& stage, double fraction) {
    const std::lock_guard lock(guard_);
    if (log_ == stderr && on_terminal()) return show_progress(stage, fraction);
    const auto now = Clock::now();
    if (now - called_ > every_) written_ = now;  // work begins
    called_ = now;
    if (now - written_ < every_) return;
    written_ = now;
    std::fprintf(log_, "%3.0f %%  %s\n", 100 * fraction, stage.c_str());
    std::fflush(log_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  const std::chrono::duration<double> every_;
  std::FILE* const log_;
  std::mutex guard_;
  Clock::time_point called_ = {}, written_ = {};
};

/// ", about 20 s left" after so many seconds for this part of the work; "" where that says nothing yet.
inline std::string time_left(double seconds, double fraction) {
  if (!(fraction >= 0.1 && fraction < 1)) return "";
  const double left = seconds / fraction * (1 - fraction);
  char text[40];
  if (left < 90)
    std::snprintf(text, sizeof text, ", about %.0f s left", std::ceil(left));
  else
    std::snprintf(text, sizeof text, ", about %.0f min left", left / 60);
  return text;
}

/// show_progress() of work that begins now, with the time left.
inline std::function<void(const std::string&, double)> show_with_time_left() {
  return [begin = std::chrono::steady_clock::now()](const std::string& stage, double fraction) {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    show_progress(stage + time_left(passed.count(), fraction), fraction);
  };
}

/// Wipes the line when the work ends, also by an exception.
struct ProgressLine {
  ~ProgressLine() {
    if (on_terminal()) std::fputs("\r\033[K", stderr);
  }
};

}  // namespace lunid::lua
