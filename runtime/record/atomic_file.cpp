#include "record/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

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

/// A new file beside `path`, with the usual mode (mkstemp's would be private), and its name.
std::pair<int, std::string> open_beside(const std::string& path) {
  constexpr int attempts = 1000;  // another thread or a killed run may hold a name
  for (int i = 0; i < attempts; ++i) {
    const std::string name = path + ".part" + std::to_string(::getpid()) + "_" + std::to_string(i);
    const int descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) return {descriptor, name};
    if (errno != EEXIST) break;
  }
  fail(path, errno);
}

/// A file beside `path` with the mode of what is there, filled by `fill(descriptor, name)`, becomes that.
template <class Fill>
void replace(const std::string& path, Fill fill) {
  auto [descriptor, temporary] = open_beside(path);
  Output output(descriptor, temporary);
  struct stat earlier {};
  if (::stat(path.c_str(), &earlier) == 0 && ::fchmod(descriptor, earlier.st_mode & 07777) != 0) fail(path, errno);
  fill(descriptor, temporary);
  if (::fsync(descriptor) != 0) fail(path, errno);
  if (output.close() != 0) fail(path, errno);
  if (::rename(temporary.c_str(), path.c_str()) != 0) fail(path, errno);
  output.keep();
}

}  // namespace

void write_file_atomically(const std::string& path, std::string_view content) {
  if (is_special(path)) return write_directly(path, content);
  replace(path, [&](int descriptor, const std::string&) { write_all(descriptor, content, path); });
}

void make_file_atomically(const std::string& path, const std::function<void(const std::string& name)>& make) {
  replace(path, [&](int, const std::string& name) { make(name); });
}

}  // namespace lunid
