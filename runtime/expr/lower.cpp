#include <unordered_map>

#include "expr/joined.hpp"
#include "expr/op.hpp"
#include "expr/program.hpp"
#include "expr/walk.hpp"

namespace lunid {
namespace {

struct ValueHash {
  std::size_t operator()(const Value& v) const {
    std::uint64_t h = static_cast<std::uint64_t>(v.code);
    for (const std::uint32_t x : {v.a, v.b, v.c, v.d, v.function}) h = (h ^ x) * 0x9E3779B97F4A7C15ull + (h >> 29);
    return static_cast<std::size_t>(h);
  }
};

class Lowering {
 public:
  explicit Lowering(std::span<const Expr> inputs) {
    for (std::uint32_t i = 0; i < inputs.size(); ++i) {
      if (!inputs[i].valid() || !inputs[i].is_symbol()) throw InputError("tape: an input is not a symbol");
      if (!known_.emplace(inputs[i].id(), emit({Code::input, i})).second)
        throw InputError("tape: the input '" + inputs[i].name() + "' is given twice");
    }
  }

  Values lower(std::span<const Expr> outputs, std::span<const Expr> inputs) {
    for (const Expr& output : outputs)
      if (!output.valid()) throw InputError("tape: an output is empty");
    collect_switches(outputs);
    std::vector<Expr> roots(outputs.begin(), outputs.end());
    roots.insert(roots.end(), values_.switching_functions.begin(), values_.switching_functions.end());
    for (const Expr& node : post_order(roots)) {
      if (node.is_constant() || known_.contains(node.id())) continue;  // constants are made where they are used
      if (node.is_symbol()) missing(node, inputs);
      known_.emplace(node.id(), translate(node));
    }
    for (const Expr& output : outputs) values_.outputs.push_back(value(output));
    for (const Expr& g : values_.switching_functions) values_.switch_values.push_back(value(g));
    return std::move(values_);
  }

 private:
  struct Switch {
    std::uint32_t index;
    bool reversed;
  };

  [[noreturn]] static void missing(Expr symbol, std::span<const Expr> inputs) {
    const std::string names = joined(inputs, &Expr::name);
    throw InputError("tape: '" + symbol.name() + "' is not among the inputs (" + names + ")");
  }

  /// The switching function of a node, or an empty Expr.
  static Expr switching_function(Expr node) {
    const auto x = node.arguments();
    switch (node.op()) {
      case Op::sign:
      case Op::abs: return x[0];
      case Op::min:
      case Op::max:
      case Op::greater:
      case Op::greater_equal: return x[0] - x[1];
      case Op::less:
      case Op::less_equal: return x[1] - x[0];
      case Op::where: return row_of(x[0].op()).kind == OpClass::comparison ? Expr() : x[0];
      default: return {};
    }
  }

  static Expr opposite(Expr g) { return g.op() == Op::sub ? g.arguments()[1] - g.arguments()[0] : -g; }

  /// Switches in order of first appearance, so that a tape with more outputs starts with the switches of a tape
  /// with fewer. A g and its negative are one switch: they cross zero together.
  void collect_switches(std::span<const Expr> outputs) {
    for (const Expr& node : post_order(outputs)) {
      const Expr g = switching_function(node);
      if (!g.valid() || g.is_constant()) continue;
      const auto known = switch_of_.find(g.id());
      const auto reversed = switch_of_.find(opposite(g).id());
      Switch at{static_cast<std::uint32_t>(values_.switching_functions.size()), false};
      if (known != switch_of_.end())
        at = known->second;
      else if (reversed != switch_of_.end())
        at = {reversed->second.index, !reversed->second.reversed};
      else
        values_.switching_functions.push_back(g);
      switch_of_.emplace(g.id(), at);
      node_switch_.emplace(node.id(), at);
    }
  }

  std::uint32_t emit(const Value& value) {
    const auto [at, fresh] = numbers_.try_emplace(value, static_cast<std::uint32_t>(values_.list.size()));
    if (fresh) values_.list.push_back(value);
    return at->second;
  }

  std::uint32_t constant(Expr node) {
    const auto [at, fresh] = known_.try_emplace(node.id(), 0);
    if (fresh) {
      values_.constants.push_back(node.value());
      at->second = emit({Code::constant, static_cast<std::uint32_t>(values_.constants.size() - 1)});
    }
    return at->second;
  }

  std::uint32_t value(Expr node) { return node.is_constant() ? constant(node) : known_.at(node.id()); }

  std::uint32_t translate(Expr node) {
    const auto x = node.arguments();
    if (node.op() == Op::pow && x[1].is_constant()) {
      int n = 0;
      if (small_integer(x[1].value(), n)) return integer_power_of(node, n);
      if (x[1].is_constant(0.5)) return emit({Code::sqrt, value(x[0])});
    }
    if (node.op() == Op::external) return external(node);
    Value v{code_of(node)};
    std::uint32_t* operand[] = {&v.a, &v.b, &v.c};
    for (std::size_t i = 0; i < x.size(); ++i) *operand[i] = value(x[i]);
    if (v.code == Code::call) v.d = static_cast<std::uint32_t>(node.op());
    if (is_switching(v.code)) v.d = switch_operand_of(node);
    return emit(v);
  }

  /// Operands that the function lacks are its first again, so that all four of them can be read.
  std::uint32_t external(Expr node) {
    const ExternalCall call{node.function(), node.part()};
    std::size_t at = 0;
    while (at < values_.externals.size() && !(values_.externals[at] == call)) ++at;
    if (at == values_.externals.size()) values_.externals.push_back(call);
    if (at > 0xFFFF) throw InputError("tape: more than 65536 external functions");
    const std::uint32_t first = value(node.arguments()[0]);
    Value v{Code::external, first, first, first, first, static_cast<std::uint32_t>(at)};
    std::uint32_t* operand[] = {&v.a, &v.b, &v.c, &v.d};
    for (std::size_t i = 1; i < node.arguments().size(); ++i) *operand[i] = value(node.arguments()[i]);
    return emit(v);
  }

  std::uint32_t integer_power_of(Expr node, int n) {
    const std::uint32_t base = value(node.arguments()[0]);
    const std::uint32_t product = integer_power(base, n < 0 ? -n : n, [this](std::uint32_t a, std::uint32_t b) {
      return emit({Code::mul, a, b});
    });
    return n < 0 ? emit({Code::div, constant(node.pool().constant(1)), product}) : product;
  }

  /// A switching node whose g is constant has no switch: it takes its branch by value, also in a frozen run.
  std::uint32_t switch_operand_of(Expr node) const {
    const auto at = node_switch_.find(node.id());
    return at == node_switch_.end() ? no_switch : switch_operand(at->second.index, at->second.reversed);
  }

  static Code code_of(Expr node) {
    switch (node.op()) {
      case Op::add: return Code::add;
      case Op::sub: return Code::sub;
      case Op::mul: return Code::mul;
      case Op::div: return Code::div;
      case Op::neg: return Code::neg;
      case Op::sqrt: return Code::sqrt;
      case Op::sign: return Code::sign;
      case Op::abs: return Code::abs;
      case Op::min: return Code::min;
      case Op::max: return Code::max;
      case Op::greater: return Code::greater;
      case Op::less: return Code::less;
      case Op::greater_equal: return Code::greater_equal;
      case Op::less_equal: return Code::less_equal;
      case Op::where: return row_of(node.arguments()[0].op()).kind == OpClass::comparison ? Code::select : Code::where;
      default: return Code::call;
    }
  }

  Values values_;
  std::unordered_map<Value, std::uint32_t, ValueHash> numbers_;
  std::unordered_map<std::uint32_t, std::uint32_t> known_;  // node -> value
  std::unordered_map<std::uint32_t, Switch> switch_of_;     // g -> switch
  std::unordered_map<std::uint32_t, Switch> node_switch_;
};

}  // namespace

bool is_switching(Code code) { return code >= Code::sign && code <= Code::where; }

int operand_count(const Value& value) {
  switch (value.code) {
    case Code::input:
    case Code::constant:
    case Code::done: return 0;
    case Code::copy:
    case Code::neg:
    case Code::sqrt:
    case Code::sign:
    case Code::abs: return 1;
    case Code::mul3:
    case Code::mul_add:
    case Code::mul_sub:
    case Code::sub_mul:
    case Code::select:
    case Code::choose:
    case Code::where: return 3;
    case Code::mul_add_mul:
    case Code::mul_sub_mul:
    case Code::sub_sum:
    case Code::external: return 4;
    case Code::call: return row_of(static_cast<Op>(value.d)).arity;
    default: return 2;
  }
}

Values lower(std::span<const Expr> outputs, std::span<const Expr> inputs) {
  return Lowering(inputs).lower(outputs, inputs);
}

}  // namespace lunid
