#include "simulate/inertia.hpp"

#include <unordered_map>

#include "expr/walk.hpp"
#include "simulate/model.hpp"

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
    Affine parts[Expr::most_arguments];
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

std::vector<InertiaRow> inertia_rows(const Model& model) {
  Pool& pool = *model.pool;
  std::vector<InertiaRow> rows;
  for (int i = 0; i < model.degrees(); ++i) {
    const auto [mass, restoring] = model.coordinate(i);
    InertiaRow row{{{i, mass}}, restoring};
    for (int j = 0; j < model.degrees(); ++j) {
      const Expr a = pool.find(model.channel('a', j));
      if (!a.valid() || !depends_on(row.force, a)) continue;
      const auto [slope, rest] = split_inertia(row.force, a);
      row.force = rest;
      if (slope.valid()) row.mass[j] = row.mass.contains(j) ? row.mass[j] + slope : slope;
    }
    for (const auto& [column, entry] : row.mass)  // a1*a2 is affine in each, but not in both
      for (const Expr& symbol : symbols(entry, SymbolKind::channel))
        if (symbol.name()[0] == 'a' && symbol.name() != "ab") refuse(entry * pool.channel(model.channel('a', column)));
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<Expr> solve_accelerations(std::vector<InertiaRow> rows, std::vector<Expr> right) {
  const int n = static_cast<int>(rows.size());
  std::vector<std::vector<int>> below(n);  // rows below the diagonal with an entry in this column
  for (int i = 0; i < n; ++i)
    for (const auto& [column, entry] : rows[i].mass)
      if (column < i) below[column].push_back(i);
  for (int k = 0; k < n; ++k)
    for (const int i : below[k]) {
      const Expr factor = rows[i].mass.at(k) / rows[k].mass.at(k);
      rows[i].mass.erase(k);
      for (const auto& [column, entry] : rows[k].mass) {
        if (column <= k) continue;
        const auto at = rows[i].mass.find(column);
        if (at == rows[i].mass.end() && column < i) below[column].push_back(i);
        rows[i].mass[column] = at == rows[i].mass.end() ? -(factor * entry) : at->second - factor * entry;
      }
      right[i] = right[i] - factor * right[k];
    }
  for (int k = n - 1; k >= 0; --k) {
    for (const auto& [column, entry] : rows[k].mass)
      if (column > k) right[k] = right[k] - entry * right[column];
    right[k] = right[k] / rows[k].mass.at(k);
  }
  return right;
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
