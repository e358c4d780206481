#include "figure/module/memory_file.hpp"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <stdexcept>

namespace lunid::figure {

MemoryFile::MemoryFile() : descriptor_(::memfd_create("figure", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::runtime_error("cannot make a file in memory");
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

std::string MemoryFile::name() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

std::string MemoryFile::content() const {
  struct stat info {};
  if (::fstat(descriptor_, &info) != 0) return "";
  std::string bytes(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t got = 0;
  while (got < bytes.size()) {
    const ssize_t n = ::pread(descriptor_, bytes.data() + got, bytes.size() - got, static_cast<off_t>(got));
    if (n <= 0) throw std::runtime_error("cannot read back a file in memory");
    got += static_cast<std::size_t>(n);
  }
  return bytes;
}

}  // namespace lunid::figure
