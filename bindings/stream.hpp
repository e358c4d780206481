#pragma once
// Records in files, read block by block, and what they share with records in memory.
#include <vector>

#include "record/stream.hpp"
#include "types.hpp"

namespace lunid::lua {

template <>
struct Bound<Stream> {
  static constexpr const char* key = "lunid.stream";
  static constexpr const char* words = "a stream";
};

/// The list of records and streams at `index`.
std::vector<Stream> check_streams(lua_State* L, int index);
/// {columns =, resample =, rate =, interval =} (lua_record.cpp)
ReadOptions file_options(lua_State* L, int index);
/// The list of channels, each also under its name (lua_record.cpp).
void push_channels(lua_State* L, const std::vector<Channel>& channels);
/// A list of texts (lua_record.cpp).
void push_texts(lua_State* L, const std::vector<std::string>& texts);
/// {kind =, ...} as lunid.derivative.<kind> gives it (lua_derivative.cpp).
DerivativeMethod derivative_method(lua_State* L, int index);

}  // namespace lunid::lua
