#include "record/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "expr/error.hpp"

namespace lunid {
namespace {

[[noreturn]] void fail(const std::string& path, int reason) {
  throw InputError("cannot write: " + std::string(std::strerror(reason)), {path}, Fault::data);
}

/// An open file that is closed, and when `temporary` is set removed, unless it is released.
class Output {
 public:
  Output(int descriptor, std::string temporary) : descriptor_(descriptor), temporary_(std::move(temporary)) {}
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  ~Output() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
  }
  int descriptor() const { return descriptor_; }
  int close() {
    const int result = ::close(descriptor_);
    descriptor_ = -1;
    return result;
  }
  void keep() { temporary_.clear(); }

 private:
  int descriptor_;
  std::string temporary_;
};

void write_all(int descriptor, std::string_view content, const std::string& path) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      fail(path, errno);
    }
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

bool is_special(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

void write_directly(const std::string& path, std::string_view content) {
  Output output(::open(path.c_str(), O_WRONLY | O_CLOEXEC), "");
  if (output.descriptor() < 0) fail(path, errno);
  write_all(output.descriptor(), content, path);
}

}  // namespace

void write_file_atomically(const std::string& path, std::string_view content) {
  if (is_special(path)) return write_directly(path, content);
  std::string temporary = path + ".XXXXXX";
  const int descriptor = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (descriptor < 0) fail(path, errno);
  Output output(descriptor, temporary);
  // mkostemp makes the file private; give it the mode of the file that it replaces, or the usual one.
  struct stat earlier {};
  const mode_t mask = ::umask(0);
  ::umask(mask);
  const mode_t mode = ::stat(path.c_str(), &earlier) == 0 ? earlier.st_mode & 07777 : 0666 & ~mask;
  if (::fchmod(descriptor, mode) != 0) fail(path, errno);
  write_all(descriptor, content, path);
  if (::fsync(descriptor) != 0) fail(path, errno);
  if (output.close() != 0) fail(path, errno);
  if (::rename(temporary.c_str(), path.c_str()) != 0) fail(path, errno);
  output.keep();
}

}  // namespace lunid
