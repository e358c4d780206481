#pragma once
// Lists of words in messages: "y, v, a".
#include <functional>
#include <string>
#include <string_view>

namespace lunid {

/// Adds a word to such a list.
inline void append_item(std::string& list, std::string_view word) {
  if (!list.empty()) list += ", ";
  list += word;
}

/// The list of what `word` gives of each item: the item itself, a member, a function of it.
template <class Items, class Word = std::identity>
std::string joined(const Items& items, Word word = {}) {
  std::string list;
  for (const auto& item : items) append_item(list, std::invoke(word, item));
  return list;
}

}  // namespace lunid
