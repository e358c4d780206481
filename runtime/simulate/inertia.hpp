#pragma once
// Terms of the restoring force that are affine in the acceleration belong to the mass.
#include "expr/expr.hpp"

namespace lunid {

/// restoring = inertia * a + force, with neither part depending on a. An empty `inertia` stands for zero.
struct InertiaSplit {
  Expr inertia;
  Expr force;
};

/// Splits an expression that is affine in `a`. Throws InputError naming the part that is not.
InertiaSplit split_inertia(Expr restoring, Expr a);

/// An expression as a list of summands: sums and differences taken apart, signs kept.
std::vector<Expr> summands(Expr f);

}  // namespace lunid
