#pragma once
// Files that are either whole or not there.
#include <functional>
#include <string>
#include <string_view>

namespace lunid {

/// Writes `content` to a temporary file beside `path`, syncs it and renames it over `path`: a reader sees the
/// old file or the new one, never a part. A target that is a device (/dev/null, /dev/full) or a pipe is
/// written directly. Throws InputError (Fault::data) that names the path and the reason (disk full, no such
/// directory, no permission); an earlier file is left as it was and the temporary file is removed.
void write_file_atomically(const std::string& path, std::string_view content);

/// The same of a file that a library makes: `make(name)` writes it under that name.
void make_file_atomically(const std::string& path, const std::function<void(const std::string& name)>& make);

}  // namespace lunid
