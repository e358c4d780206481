#pragma once
// A file without a disk, for exporters that write only to a name.
#include <string>

namespace lunid::figure {

class MemoryFile {
 public:
  /// Throws std::runtime_error when there is none to be had.
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  /// The name under which this process can open it.
  std::string name() const;
  /// All that was written.
  std::string content() const;

 private:
  int descriptor_;
};

}  // namespace lunid::figure
