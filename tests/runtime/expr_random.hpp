#pragma once
// Random expressions with a fixed seed, and a direct recursion to check the tape against.
#include <random>
#include <unordered_map>

#include "expr/expr.hpp"
#include "expr/op.hpp"
#include "expr/walk.hpp"

namespace lunid::testing {

/// Makes expressions of all operations over y, v, k and c.
class RandomExpressions {
 public:
  explicit RandomExpressions(Pool& pool, unsigned seed) : pool_(pool), random_(seed) {
    leaves_ = {pool.channel("y"), pool.channel("v"), pool.parameter("k"), pool.parameter("c")};
  }

  const std::vector<Expr>& leaves() const { return leaves_; }

  Expr next(int depth) {
    if (depth == 0 || below(8) == 0) return leaf();
    const std::span<const OpRow> rows = all_rows().first(static_cast<std::size_t>(Op::external));
    const OpRow& row = rows[2 + below(rows.size() - 2)];
    if (row.kind == OpClass::comparison) return next(depth);  // only within where
    Expr arguments[3];
    for (int i = 0; i < row.arity; ++i) arguments[i] = next(depth - 1);
    if (row.op == Op::where && below(4) != 0) arguments[0] = comparison(depth - 1);
    if (row.op == Op::pow && below(2) == 0) arguments[1] = pool_.constant(static_cast<double>(below(21)) - 10);
    return pool_.apply(row.op, {arguments, static_cast<std::size_t>(row.arity)});
  }

 private:
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }

  Expr leaf() {
    if (below(3) != 0) return leaves_[below(leaves_.size())];
    constexpr double interesting[] = {0, 1, -1, 2, 0.5, -3.25, 1e-5, 1e22, 0.1, -2e-300, 123456789, 1.0 / 3};
    return pool_.constant(interesting[below(std::size(interesting))]);
  }

  Expr comparison(int depth) {
    constexpr Op ops[] = {Op::greater, Op::less, Op::greater_equal, Op::less_equal};
    return pool_.apply(ops[below(4)], {next(depth), next(depth)});
  }

  Pool& pool_;
  std::mt19937 random_;
  std::vector<Expr> leaves_;
};

/// The value by walking the nodes: no tape, no fusion, no registers.
inline double direct_value(Expr f, const std::vector<Expr>& symbols, const std::vector<double>& values) {
  std::unordered_map<std::uint32_t, double> known;
  for (std::size_t i = 0; i < symbols.size(); ++i) known.emplace(symbols[i].id(), values[i]);
  for (const Expr& node : post_order(f)) {
    if (known.contains(node.id())) continue;
    double x[3] = {};
    const auto arguments = node.arguments();
    for (std::size_t i = 0; i < arguments.size(); ++i) x[i] = known.at(arguments[i].id());
    known.emplace(node.id(), node.is_constant() ? node.value() : row_of(node.op()).value(x[0], x[1], x[2]));
  }
  return known.at(f.id());
}

}  // namespace lunid::testing
