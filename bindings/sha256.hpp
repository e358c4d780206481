#pragma once
// SHA-256 (FIPS 180-4), to tell whether an input file is the one that a run was made from.
#include <string>
#include <string_view>

namespace lunid::lua {

/// 64 hexadecimal digits.
std::string sha256(std::string_view bytes);
/// Of a file's content; throws InputError (Fault::data) when it cannot be read.
std::string sha256_of_file(const std::string& path);

}  // namespace lunid::lua
