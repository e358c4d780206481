#pragma once
// Walks over the nodes of expressions without recursion: an expression may be a chain of 10^5 nodes.
#include "expr/expr.hpp"

namespace lunid {

/// Every distinct node of `roots`, arguments before the nodes that use them, in order of first appearance (depth
/// first, left to right).
std::vector<Expr> post_order(std::span<const Expr> roots);
std::vector<Expr> post_order(Expr root);

}  // namespace lunid
