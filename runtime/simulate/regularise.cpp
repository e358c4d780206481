#include "simulate/regularise.hpp"

#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "expr/walk.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

/// Replaces the branches of the expressions that it is given.
class Smoother {
 public:
  Smoother(Pool& pool, double width) : pool_(pool), width_(width) {}

  Expr operator()(Expr f) {
    if (!f.valid()) return f;
    for (const Expr& node : post_order(f)) {
      if (known(node)) continue;
      const Expr smooth = smoothed(node);
      if (!smooth.valid()) continue;
      replacements_.emplace_back(node, smooth);
      replaced.push_back(to_text(node));
    }
    return substitute(f, replacements_);
  }
  std::vector<std::string> replaced;

 private:
  bool known(Expr node) const {
    return std::any_of(replacements_.begin(), replacements_.end(), [&](const auto& r) { return r.first == node; });
  }
  static bool compares(Expr node) {
    return node.op() == Op::greater || node.op() == Op::less || node.op() == Op::greater_equal ||
           node.op() == Op::less_equal;
  }
  Expr side(Expr g) { return pool_.apply(Op::tanh, {g / width_}); }
  Expr step(Expr g) { return (1 + side(g)) / 2; }

  /// Empty for a node without branches.
  Expr smoothed(Expr node) {
    std::vector<Expr> x;
    for (const Expr& argument : node.arguments()) x.push_back(substitute(argument, replacements_));
    switch (node.op()) {
      case Op::sign: return side(x[0]);
      case Op::abs: return x[0] * side(x[0]);
      case Op::max: return (x[0] + x[1] + (x[0] - x[1]) * side(x[0] - x[1])) / 2;
      case Op::min: return (x[0] + x[1] - (x[0] - x[1]) * side(x[0] - x[1])) / 2;
      case Op::greater:
      case Op::greater_equal: return step(x[0] - x[1]);
      case Op::less:
      case Op::less_equal: return step(x[1] - x[0]);
      case Op::where: return x[2] + (compares(node.arguments()[0]) ? x[0] : step(x[0])) * (x[1] - x[2]);
      default: return {};
    }
  }

  Pool& pool_;
  const double width_;
  std::vector<std::pair<Expr, Expr>> replacements_;
};

}  // namespace

Regularised regularised(const Model& model, double width) {
  if (!(width > 0) || std::isinf(width)) throw InputError("regularise: expected a width > 0, got " + number(width));
  Regularised out{model, {}};
  Smoother smooth(*model.pool, width);
  out.model.mass = smooth(model.mass);
  out.model.restoring = smooth(model.restoring);
  for (Coordinate& coordinate : out.model.further) coordinate = {smooth(coordinate.mass), smooth(coordinate.restoring)};
  for (InternalState& state : out.model.states) state.rate = smooth(state.rate);
  out.replaced = std::move(smooth.replaced);
  return out;
}

}  // namespace lunid
