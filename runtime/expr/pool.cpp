#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <stdexcept>
#include <unordered_map>

#include "expr/expr.hpp"
#include "expr/external.hpp"
#include "expr/op.hpp"
#include "expr/simplify.hpp"
#include "expr/words.hpp"

namespace lunid {

struct Pool::Impl {
  struct Node {
    Op op;
    SymbolKind kind = SymbolKind::channel;
    std::uint8_t count = 0;
    double value = 0;
    const std::string* name = nullptr;
    std::uint32_t function = 0;  // of Op::external, an index into functions
    std::uint8_t part = 0;
    Expr arguments[Expr::most_arguments] = {};

    /// Of operations: the same operation, and for an external function the same part of it.
    bool same_operation(const Node& other) const {
      return op == other.op && function == other.function && part == other.part;
    }
  };
  std::deque<Node> nodes;  // a deque: nodes stay where they are while the pool grows
  std::unordered_multimap<std::size_t, std::uint32_t> operations;
  std::unordered_map<std::uint64_t, std::uint32_t> constants;
  std::map<std::string, std::uint32_t, std::less<>> symbols;
  std::vector<std::shared_ptr<const ExternalFunction>> functions;

  std::uint32_t append(const Node& node) {
    nodes.push_back(node);
    return static_cast<std::uint32_t>(nodes.size() - 1);
  }
  /// The node `kind` with these arguments, an old one where there is one.
  std::uint32_t intern(const Node& kind, std::span<const Expr> arguments);
  bool has_function(std::string_view name) const {
    return std::any_of(functions.begin(), functions.end(), [&](const auto& f) { return f->name() == name; });
  }
};

namespace {

std::size_t hash_of(std::uint64_t operation, std::span<const Expr> arguments) {
  std::uint64_t h = operation + 1;
  for (const Expr& a : arguments) h = (h ^ a.id()) * 0x9E3779B97F4A7C15ull + (h >> 29);
  return static_cast<std::size_t>(h);
}

const char* word_of(SymbolKind kind) {
  return kind == SymbolKind::channel ? "channel" : kind == SymbolKind::parameter ? "parameter" : "state";
}

void check_name(std::string_view name, SymbolKind kind) {
  const std::string quoted = "'" + std::string(name) + "'";
  if (!is_identifier(name)) throw InputError("name " + quoted + ": expected a letter or _, then letters, digits or _");
  if (is_reserved(name)) throw InputError("name " + quoted + ": is a word of the language, choose another");
  if (kind != SymbolKind::channel && is_channel_name(name))
    throw InputError("name " + quoted + ": is a channel, not a " + word_of(kind) + "; choose another name");
}

void check_each(const Pool& pool, const std::string& name, std::span<const Expr> arguments, bool has_condition) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (!arguments[i].valid()) throw InputError(name + ": an argument is empty");
    if (&arguments[i].pool() != &pool) throw std::logic_error("expressions of two pools in one operation");
    if (row_of(arguments[i].op()).kind == OpClass::comparison && !(has_condition && i == 0))
      throw InputError(name + ": a comparison may stand only in the first argument of where(condition, a, b)");
  }
}

void check_arguments(const Pool& pool, Op op, std::span<const Expr> arguments) {
  const OpRow& row = row_of(op);
  if (static_cast<int>(arguments.size()) != row.arity || row.arity == 0)
    throw InputError(arity_message(row.name, row.arity, static_cast<int>(arguments.size())));
  check_each(pool, row.name, arguments, op == Op::where);
}

}  // namespace

std::uint32_t Pool::Impl::intern(const Node& kind, std::span<const Expr> arguments) {
  const std::size_t hash =
      hash_of(static_cast<std::uint64_t>(kind.op) + 256 * (kind.part + 256 * std::uint64_t{kind.function}), arguments);
  for (auto [at, end] = operations.equal_range(hash); at != end; ++at) {
    const Node& node = nodes[at->second];
    if (node.same_operation(kind) && std::equal(arguments.begin(), arguments.end(), node.arguments)) return at->second;
  }
  if (nodes.size() >= std::numeric_limits<std::uint32_t>::max()) throw std::length_error("expression pool is full");
  Node node = kind;
  node.count = static_cast<std::uint8_t>(arguments.size());
  std::copy(arguments.begin(), arguments.end(), node.arguments);
  const std::uint32_t id = append(node);
  operations.emplace(hash, id);
  return id;
}

Pool::Pool() : impl_(new Impl) {}
Pool::~Pool() { delete impl_; }

Expr Pool::constant(double value) {
  if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();  // one NaN, one node
  const auto [at, fresh] = impl_->constants.try_emplace(std::bit_cast<std::uint64_t>(value), 0);
  if (fresh) {
    Impl::Node node{Op::constant};
    node.value = value;
    at->second = impl_->append(node);
  }
  return {this, at->second};
}

Expr Pool::symbol(std::string_view name, SymbolKind kind) {
  if (const Expr known = find(name); known.valid()) {
    if (known.kind() == kind) return known;
    throw InputError("name '" + std::string(name) + "': is a " + word_of(known.kind()) + " already, not a " +
                     word_of(kind));
  }
  check_name(name, kind);
  if (impl_->has_function(name))
    throw InputError("name '" + std::string(name) + "': is a function already, not a " + word_of(kind));
  const auto at = impl_->symbols.emplace(std::string(name), 0).first;
  Impl::Node node{Op::symbol, kind};
  node.name = &at->first;
  at->second = impl_->append(node);
  return {this, at->second};
}

Expr Pool::find(std::string_view name) const {
  const auto at = impl_->symbols.find(name);
  return at == impl_->symbols.end() ? Expr() : Expr(const_cast<Pool*>(this), at->second);
}

Expr Pool::apply(Op op, std::span<const Expr> arguments) {
  check_arguments(*this, op, arguments);
  if (const Expr simpler = simplify(*this, op, arguments); simpler.valid()) return simpler;
  return {this, impl_->intern(Impl::Node{op}, arguments)};
}

Expr Pool::call(const std::shared_ptr<const ExternalFunction>& function, std::span<const Expr> arguments,
                std::uint8_t part) {
  if (static_cast<int>(arguments.size()) != function->arity())
    throw InputError(arity_message(function->name(), function->arity(), static_cast<int>(arguments.size())));
  check_each(*this, function->name(), arguments, false);
  if (std::find(impl_->functions.begin(), impl_->functions.end(), function) == impl_->functions.end()) add(function);
  Impl::Node kind{Op::external};
  kind.function = static_cast<std::uint32_t>(std::find(impl_->functions.begin(), impl_->functions.end(), function) -
                                             impl_->functions.begin());
  kind.part = part;
  return {this, impl_->intern(kind, arguments)};
}

std::span<const std::shared_ptr<const ExternalFunction>> Pool::functions() const { return impl_->functions; }

void Pool::add(std::shared_ptr<const ExternalFunction> function) {
  if (is_channel_name(function->name()))
    throw InputError("name '" + function->name() + "': is a channel, not a function; choose another name");
  check_name(function->name(), SymbolKind::parameter);
  if (impl_->has_function(function->name()) || find(function->name()).valid())
    throw InputError("name '" + function->name() + "': is taken already, choose another for the function");
  impl_->functions.push_back(std::move(function));
}

std::string Pool::free_name(std::string_view wanted) const {
  std::string name(wanted);
  if (is_reserved(name) || is_channel_name(name)) return name;  // add() refuses it
  for (int i = 2; impl_->has_function(name) || find(name).valid(); ++i) name = std::string(wanted) + std::to_string(i);
  return name;
}

Op Expr::op() const { return pool_->impl_->nodes[id_].op; }

std::span<const Expr> Expr::arguments() const {
  const Pool::Impl::Node& node = pool_->impl_->nodes[id_];
  return {node.arguments, node.count};
}

bool Expr::is_constant(double value) const {
  const Pool::Impl::Node& node = pool_->impl_->nodes[id_];
  return node.op == Op::constant && node.value == value;
}

double Expr::value() const {
  if (op() != Op::constant) throw std::logic_error("Expr::value of a node that is no constant");
  return pool_->impl_->nodes[id_].value;
}

const std::string& Expr::name() const {
  if (op() != Op::symbol) throw std::logic_error("Expr::name of a node that is no symbol");
  return *pool_->impl_->nodes[id_].name;
}

SymbolKind Expr::kind() const {
  if (op() != Op::symbol) throw std::logic_error("Expr::kind of a node that is no symbol");
  return pool_->impl_->nodes[id_].kind;
}

const std::shared_ptr<const ExternalFunction>& Expr::function() const {
  if (op() != Op::external) throw std::logic_error("Expr::function of a node that calls none");
  return pool_->impl_->functions[pool_->impl_->nodes[id_].function];
}

std::uint8_t Expr::part() const {
  if (op() != Op::external) throw std::logic_error("Expr::part of a node that calls no function");
  return pool_->impl_->nodes[id_].part;
}

Expr operator+(Expr a, Expr b) { return a.pool().apply(Op::add, {a, b}); }
Expr operator-(Expr a, Expr b) { return a.pool().apply(Op::sub, {a, b}); }
Expr operator*(Expr a, Expr b) { return a.pool().apply(Op::mul, {a, b}); }
Expr operator/(Expr a, Expr b) { return a.pool().apply(Op::div, {a, b}); }
Expr operator-(Expr a) { return a.pool().apply(Op::neg, {a}); }
Expr operator+(Expr a, double b) { return a + a.pool().constant(b); }
Expr operator-(Expr a, double b) { return a - a.pool().constant(b); }
Expr operator+(double a, Expr b) { return b.pool().constant(a) + b; }
Expr operator-(double a, Expr b) { return b.pool().constant(a) - b; }
Expr operator*(Expr a, double b) { return a * a.pool().constant(b); }
Expr operator/(double a, Expr b) { return b.pool().constant(a) / b; }
Expr operator*(double a, Expr b) { return b.pool().constant(a) * b; }
Expr operator/(Expr a, double b) { return a / a.pool().constant(b); }
Expr pow(Expr a, Expr b) { return a.pool().apply(Op::pow, {a, b}); }
Expr pow(Expr a, double b) { return pow(a, a.pool().constant(b)); }

}  // namespace lunid
