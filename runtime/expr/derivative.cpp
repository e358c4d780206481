#include "expr/derivative.hpp"

#include <unordered_map>

#include "expr/op.hpp"
#include "expr/walk.hpp"

namespace lunid {
namespace slope {
namespace {

/// Splits the constant in front off a product: 3*k*y is 3 and k*y, -k*y is -1 and k*y. Looks at a few factors only, so
/// that a product of 10^5 factors does not cost its length at every use.
double take_coefficient(Expr& a) {
  constexpr int few = 16;
  std::vector<Expr> others;  // the factors behind the first
  Expr first = a;
  for (; first.op() == Op::mul && others.size() < few; first = first.arguments()[0])
    others.push_back(first.arguments()[1]);
  double coefficient = -1;
  if (first.op() == Op::neg) {
    others.push_back(first.arguments()[0]);
  } else if (first.is_constant() && !others.empty()) {
    coefficient = first.value();
  } else {
    return 1;
  }
  a = others.back();
  for (others.pop_back(); !others.empty(); others.pop_back()) a = a * others.back();
  return coefficient;
}

}  // namespace

bool zero(Expr a) { return a.is_constant(0); }

Expr plus(Expr a, Expr b) {
  if (zero(a)) return b;
  if (zero(b)) return a;
  return a == b ? times(a.pool().constant(2), a) : a + b;
}

Expr minus(Expr a, Expr b) {
  if (zero(b)) return a;
  return zero(a) ? negative(b) : a - b;
}

Expr times(Expr a, Expr b) {
  if (zero(a) || zero(b)) return a.pool().constant(0);
  if (a.is_constant(1)) return b;
  if (b.is_constant(1)) return a;
  if (b.is_constant()) return a.is_constant() ? a * b : times(b, a);
  if (b.op() == Op::div) return over(times(a, b.arguments()[0]), b.arguments()[1]);
  if (a.is_constant()) {
    const double coefficient = a.value() * take_coefficient(b);
    return coefficient * b;
  }
  const double coefficient = take_coefficient(a) * take_coefficient(b);
  return (coefficient * a) * b;
}

Expr over(Expr a, Expr b) { return zero(a) ? a : a / b; }
Expr negative(Expr a) { return zero(a) ? a : -a; }

Expr choose(Expr condition, Expr a, Expr b) {
  if (a.is_constant() && a == b) return a;
  return a.pool().apply(Op::where, {condition, a, b});
}

}  // namespace slope

Expr derivative(Expr f, Expr symbol) {
  if (!symbol.is_symbol()) throw InputError("derivative: expected a symbol, got '" + to_text(symbol) + "'");
  std::unordered_map<std::uint32_t, Expr> slopes;
  const Expr none = f.pool().constant(0), one = f.pool().constant(1);
  for (const Expr& node : post_order(f)) {
    const auto arguments = node.arguments();
    Expr d[Expr::most_arguments];
    bool moves = false;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      d[i] = slopes.at(arguments[i].id());
      moves |= !slope::zero(d[i]);
    }
    slopes.emplace(node.id(), node == symbol ? one : moves ? row_of(node.op()).derivative(node, d) : none);
  }
  return slopes.at(f.id());
}

}  // namespace lunid
