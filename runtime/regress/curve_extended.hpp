#pragma once
// Inside regress: an expression in extended precision, row by row. Slow; for residuals that are rounding in double.
#include <span>
#include <vector>

#include "expr/expr.hpp"

namespace lunid::detail {

class Extended {
 public:
  /// `inputs`: the symbols that `f` may hold, in the order of the values given to run.
  Extended(Expr f, std::span<const Expr> inputs);
  long double run(std::span<const double> in);

 private:
  struct Node {
    Op op;
    int argument[3] = {-1, -1, -1};  // places of nodes; of a symbol: its input
    long double value = 0;
  };
  int add(Expr f, std::span<const Expr> inputs);

  std::vector<Expr> seen_;
  std::vector<Node> nodes_;
};

}  // namespace lunid::detail
