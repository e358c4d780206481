#pragma once
// Simplification that is safe for NaN and infinity: every rule gives the same double as the operation (a zero may
// lose its sign, no more).
#include "expr/expr.hpp"

namespace lunid {

/// The simpler form of op(arguments), or an empty Expr when there is none.
Expr simplify(Pool& pool, Op op, std::span<const Expr> arguments);

}  // namespace lunid
