#include "expr/simplify.hpp"

#include "expr/op.hpp"

namespace lunid {
namespace {

bool all_constant(std::span<const Expr> arguments) {
  for (const Expr& a : arguments)
    if (!a.is_constant()) return false;
  return true;
}

double value_at(std::span<const Expr> arguments, std::size_t i) {
  return i < arguments.size() ? arguments[i].value() : 0;
}

bool is_product(Expr a) { return a.op() == Op::mul || a.op() == Op::div; }

/// The first factor of a product or quotient: a of a*b/c.
Expr first_factor(Expr a) {
  while (is_product(a)) a = a.arguments()[0];
  return a;
}

/// A text that starts with a minus.
bool starts_negative(Expr a) {
  const Expr first = first_factor(a);
  return first.op() == Op::neg || (first.is_constant() && first.value() < 0);
}

/// -(a*b/c) as (-a)*b/c, exact in floating point: the sign is carried by the first factor.
Expr negate(Pool& pool, Expr a) {
  std::vector<Expr> spine;
  for (; is_product(a); a = a.arguments()[0]) spine.push_back(a);
  Expr result = a.is_constant() ? pool.constant(-a.value()) : a.op() == Op::neg ? a.arguments()[0] : -a;
  for (auto at = spine.rbegin(); at != spine.rend(); ++at) result = pool.apply(at->op(), {result, at->arguments()[1]});
  return result;
}

Expr simplify_sum(Pool& pool, Op op, Expr a, Expr b) {
  if (b.is_constant(0)) return a;
  if (op == Op::add && a.is_constant(0)) return b;
  if (starts_negative(b)) return pool.apply(op == Op::add ? Op::sub : Op::add, {a, negate(pool, b)});
  return {};
}

Expr simplify_product(Pool& pool, Op op, Expr a, Expr b) {
  if (b.is_constant(1)) return a;
  if (b.is_constant(-1)) return -a;
  if (op == Op::mul && a.is_constant(1)) return b;
  if (op == Op::mul && a.is_constant(-1)) return -b;
  if (b.op() == Op::neg) return pool.apply(op, {negate(pool, a), b.arguments()[0]});  // a*-b is -a*b, to the last bit
  return {};
}

Expr simplify_power(Pool& pool, Expr a, Expr b) {
  if (b.is_constant(1)) return a;
  if (b.is_constant(0)) return pool.constant(1);  // IEEE 754: also for NaN
  return {};
}

Expr simplify_abs(Pool& pool, Expr a) {
  if (a.op() == Op::abs) return a;
  if (a.op() == Op::neg) return pool.apply(Op::abs, {a.arguments()[0]});
  return {};
}

}  // namespace

Expr simplify(Pool& pool, Op op, std::span<const Expr> x) {
  if (all_constant(x)) return pool.constant(row_of(op).value(value_at(x, 0), value_at(x, 1), value_at(x, 2)));
  switch (op) {
    case Op::add:
    case Op::sub: return simplify_sum(pool, op, x[0], x[1]);
    case Op::mul:
    case Op::div: return simplify_product(pool, op, x[0], x[1]);
    case Op::pow: return simplify_power(pool, x[0], x[1]);
    case Op::neg: return x[0].op() == Op::neg || is_product(x[0]) ? negate(pool, x[0]) : Expr();
    case Op::abs: return simplify_abs(pool, x[0]);
    case Op::min:
    case Op::max: return x[0] == x[1] ? x[0] : Expr();
    case Op::where:
      if (!x[0].is_constant()) return {};
      return x[0].value() > 0 ? x[1] : x[0].value() <= 0 ? x[2] : x[0];
    default: return {};
  }
}

}  // namespace lunid
