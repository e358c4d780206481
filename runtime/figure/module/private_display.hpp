#pragma once
// An X server of our own, without a screen.
#include <memory>
#include <string>

namespace lunid::figure {

/// An Xvfb that nobody else uses, on a display number of its own. It ends with this object; and also when
/// this process ends in any other way (exit, crash, SIGKILL, Ctrl-C), because a watcher process holds the
/// other end of a pipe that only this process keeps open.
class PrivateDisplay {
 public:
  /// Starts one and waits until it answers. Throws std::runtime_error that says what is missing.
  PrivateDisplay();
  ~PrivateDisplay();
  PrivateDisplay(const PrivateDisplay&) = delete;
  PrivateDisplay& operator=(const PrivateDisplay&) = delete;

  /// Such as ":7".
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  int lifeline_ = -1;  ///< closed at the end: the watcher then ends Xvfb
  int watcher_ = -1;
};

}  // namespace lunid::figure
