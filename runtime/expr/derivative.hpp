#pragma once
// Building blocks of the derivative pass. Unlike Pool::apply they drop structural zeros (0*x -> 0) and gather
// constant factors at the front: k3*(3*y^2) becomes 3*k3*y^2.
#include "expr/expr.hpp"

namespace lunid::slope {

bool zero(Expr a);
Expr plus(Expr a, Expr b);
Expr minus(Expr a, Expr b);
Expr times(Expr a, Expr b);
Expr over(Expr a, Expr b);
Expr negative(Expr a);
Expr choose(Expr condition, Expr a, Expr b);

}  // namespace lunid::slope
