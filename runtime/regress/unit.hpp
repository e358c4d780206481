#pragma once
// Inside regress: units of expressions, from those of channels and parameters.
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "expr/expr.hpp"

namespace lunid::detail {

/// Powers of the words of a unit: "N s/m" is {N: 1, s: 1, m: -1}.
using Unit = std::map<std::string, double>;
/// nullopt for what cannot be read.
std::optional<Unit> read_unit(const std::string& text);
/// "N s/m", "N/m^3"; "" for none.
std::string to_text(const Unit& unit);
Unit quotient(const Unit& above, const Unit& below);

/// The unit of an expression; nullopt where a symbol's is unknown, or where unlike ones are added. Constants that are
/// added take the unit of the rest, constant factors have none. `numbers`: expressions without a unit, such as a
/// normalised variable (y - 0.1)/0.5, whose constants have units of their own.
std::optional<Unit> unit_of(Expr expression, const std::function<std::optional<Unit>(Expr symbol)>& of_symbol,
                            std::span<const Expr> numbers = {});

}  // namespace lunid::detail
