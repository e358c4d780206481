#pragma once
// The line of progress on a terminal.
#include <unistd.h>

#include <cstdio>
#include <string>

namespace lunid::lua {

inline bool on_terminal() { return isatty(STDERR_FILENO); }

/// Writes " 43 %  regress" over the line, on a terminal only.
inline void show_progress(const std::string& stage, double fraction) {
  if (on_terminal()) std::fprintf(stderr, "\r\033[K%3.0f %%  %s", 100 * fraction, stage.c_str());
}

/// Wipes the line when the work ends, also by an exception.
struct ProgressLine {
  ~ProgressLine() {
    if (on_terminal()) std::fputs("\r\033[K", stderr);
  }
};

}  // namespace lunid::lua
