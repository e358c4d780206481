#pragma once
// Which words mean what in the language.
#include <string>
#include <string_view>

namespace lunid {

/// A letter or _, then letters, digits or _.
bool is_identifier(std::string_view name);
/// y v a t F, y1 v1 a1 F1 ... (numbered from 1), and yb vb ab.
bool is_channel_name(std::string_view name);
/// A function's name, or pi.
bool is_reserved(std::string_view name);
/// Its ASCII letters as small ones.
std::string lower_case(std::string_view text);
/// `where: takes 3 arguments, got 2`.
std::string arity_message(const std::string& name, int arity, int got);

}  // namespace lunid
