#include "simulate/inertia.hpp"

#include <unordered_map>

#include "expr/walk.hpp"

namespace lunid {
namespace {

/// A node as slope * a + rest; an empty part stands for zero, so that no 0*x is ever built.
struct Affine {
  Expr slope, rest;
};

Expr sum(Expr a, Expr b) { return !a.valid() ? b : !b.valid() ? a : a + b; }
Expr negated(Expr a) { return a.valid() ? -a : a; }
Expr scaled(Expr a, Expr factor) { return a.valid() ? a * factor : a; }
Expr divided(Expr a, Expr divisor) { return a.valid() ? a / divisor : a; }

[[noreturn]] void refuse(Expr node) {
  throw InputError("model: restoring: terms in a must be a times something without a, got " + to_text(node));
}

Expr choose(Pool& pool, Expr condition, Expr yes, Expr no) {
  if (!yes.valid() && !no.valid()) return {};
  const Expr zero = pool.constant(0);
  return pool.apply(Op::where, {condition, yes.valid() ? yes : zero, no.valid() ? no : zero});
}

Affine combine(Expr node, std::span<const Affine> parts) {
  switch (node.op()) {
    case Op::add: return {sum(parts[0].slope, parts[1].slope), sum(parts[0].rest, parts[1].rest)};
    case Op::sub: return {sum(parts[0].slope, negated(parts[1].slope)), sum(parts[0].rest, negated(parts[1].rest))};
    case Op::neg: return {negated(parts[0].slope), negated(parts[0].rest)};
    case Op::mul:
      if (!parts[1].slope.valid()) return {scaled(parts[0].slope, parts[1].rest), scaled(parts[0].rest, parts[1].rest)};
      if (!parts[0].slope.valid()) return {scaled(parts[1].slope, parts[0].rest), scaled(parts[1].rest, parts[0].rest)};
      refuse(node);
    case Op::div:
      if (parts[1].slope.valid()) refuse(node);
      return {divided(parts[0].slope, parts[1].rest), divided(parts[0].rest, parts[1].rest)};
    case Op::where:
      if (parts[0].slope.valid()) refuse(node);
      return {choose(node.pool(), parts[0].rest, parts[1].slope, parts[2].slope),
              choose(node.pool(), parts[0].rest, parts[1].rest, parts[2].rest)};
    default: refuse(node);
  }
}

}  // namespace

InertiaSplit split_inertia(Expr restoring, Expr a) {
  std::unordered_map<std::uint32_t, Affine> image;
  for (const Expr& node : post_order(restoring)) {
    if (node == a) {
      image[node.id()] = {node.pool().constant(1), {}};
      continue;
    }
    Affine parts[3];
    bool depends = false;
    const auto arguments = node.arguments();
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      parts[i] = image.at(arguments[i].id());
      depends |= parts[i].slope.valid();
    }
    image[node.id()] = depends ? combine(node, parts) : Affine{{}, node};
  }
  const Affine whole = image.at(restoring.id());
  return {whole.slope, whole.rest.valid() ? whole.rest : restoring.pool().constant(0)};
}

std::vector<Expr> summands(Expr f) {
  std::vector<Expr> terms;
  std::vector<std::pair<Expr, bool>> stack{{f, false}};  // a node, and whether it is subtracted
  while (!stack.empty()) {
    const auto [node, minus] = stack.back();
    stack.pop_back();
    const auto arguments = node.arguments();
    if (node.op() == Op::add || node.op() == Op::sub) {
      stack.emplace_back(arguments[1], minus != (node.op() == Op::sub));
      stack.emplace_back(arguments[0], minus);
    } else if (node.op() == Op::neg) {
      stack.emplace_back(arguments[0], !minus);
    } else {
      terms.push_back(minus ? -node : node);
    }
  }
  return terms;
}

}  // namespace lunid
