#include "regress/curve_extended.hpp"

#include <algorithm>
#include <cmath>

namespace lunid::detail {
namespace {

using Real = long double;

Real sign_of(Real x) { return std::isnan(x) ? x : static_cast<Real>((x > 0) - (x < 0)); }

Real apply(Op op, Real a, Real b, Real c) {
  switch (op) {
    case Op::add: return a + b;
    case Op::sub: return a - b;
    case Op::mul: return a * b;
    case Op::div: return a / b;
    case Op::pow: return std::pow(a, b);
    case Op::neg: return -a;
    case Op::sin: return std::sin(a);
    case Op::cos: return std::cos(a);
    case Op::tan: return std::tan(a);
    case Op::asin: return std::asin(a);
    case Op::acos: return std::acos(a);
    case Op::atan: return std::atan(a);
    case Op::sinh: return std::sinh(a);
    case Op::cosh: return std::cosh(a);
    case Op::tanh: return std::tanh(a);
    case Op::exp: return std::exp(a);
    case Op::log: return std::log(a);
    case Op::sqrt: return std::sqrt(a);
    case Op::abs: return std::abs(a);
    case Op::sign: return sign_of(a);
    case Op::min: return a < b ? a : b;
    case Op::max: return a > b ? a : b;
    case Op::greater: return a > b;
    case Op::less: return a < b;
    case Op::greater_equal: return a >= b;
    case Op::less_equal: return a <= b;
    case Op::where: return a > 0 ? b : c;
    default: return std::nanl("");  // an operation without an extended form: the caller stays with double
  }
}

}  // namespace

Extended::Extended(Expr f, std::span<const Expr> inputs) { add(f, inputs); }

int Extended::add(Expr f, std::span<const Expr> inputs) {
  const auto known = std::find(seen_.begin(), seen_.end(), f);
  if (known != seen_.end()) return static_cast<int>(known - seen_.begin());
  Node node{f.op()};
  if (f.is_constant()) {
    node.value = f.value();
  } else if (f.is_symbol()) {
    node.argument[0] = static_cast<int>(std::find(inputs.begin(), inputs.end(), f) - inputs.begin());
  } else {
    int i = 0;
    for (const Expr& part : f.arguments()) {
      const int place = add(part, inputs);
      if (i < 3) node.argument[i++] = place;
    }
  }
  seen_.push_back(f);
  nodes_.push_back(node);
  return static_cast<int>(nodes_.size()) - 1;
}

long double Extended::run(std::span<const double> in) {
  const auto at = [&](int place) { return place < 0 ? Real(0) : nodes_[static_cast<std::size_t>(place)].value; };
  for (Node& node : nodes_) {
    if (node.op == Op::constant) continue;
    node.value = node.op == Op::symbol
                     ? Real(in[static_cast<std::size_t>(node.argument[0])])
                     : apply(node.op, at(node.argument[0]), at(node.argument[1]), at(node.argument[2]));
  }
  return nodes_.back().value;
}

}  // namespace lunid::detail
