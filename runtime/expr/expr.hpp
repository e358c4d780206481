#pragma once
// The one expression type: a feature, a restoring force, a mass, a rate of an internal state, a catalogue entry.
// Nodes are hash-consed in a Pool; an Expr is a small value (pool, id). Equal expressions have equal ids.
//
// Grammar of the plain form, which parse() reads and to_text() writes (re-reading gives the same node):
//   comparison: sum (('>' | '<' | '>=' | '<=') sum)?         only as the first argument of where()
//   sum: product (('+' | '-') product)*       product: unary (('*' | '/') unary)*
//   unary: '-' unary | power                   power: atom ('^' unary)?      (right associative)
//   atom: number | 'pi' | name | function '(' args ')' | '(' sum ')'
// An external function (external.hpp) is written like any other, but parse() knows no such names.
// A comparison may stand in the first argument of where() and nowhere else; any other condition means `> 0`.
//
// NaN and infinity: simplification is only what is safe for them (constant folding, x+0, x*1, x/1, x^1, -(-x), signs
// moved to the front: x + -k*y is x - k*y, -(k*y) is -k*y, k*-y is -k*y); never x/x -> 1 nor 0*x -> 0, except in the
// derivative pass, which drops structural zeros. x^n with an integer |n| <= 16 is a product by binary powering,
// everywhere.
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "expr/error.hpp"

namespace lunid {

/// One row per operation in op.cpp: name, arity, value, derivative, printing.
enum class Op : std::uint8_t {
  constant,
  symbol,
  add,
  sub,
  mul,
  div,
  pow,
  neg,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  sinh,
  cosh,
  tanh,
  exp,
  log,
  sqrt,
  abs,
  sign,
  min,
  max,
  greater,
  less,
  greater_equal,
  less_equal,
  where,
  external,  // of an ExternalFunction: built by Pool::call
};

/// What a symbol stands for. A node holds identity only (kind and name): values, bounds and units live in the
/// model's table.
///   channel: a measured or simulated signal (y v a t F; y1 v1 a1 F1 ... for n degrees of freedom; yb vb ab)
///   parameter: an unknown to fit          state: an internal state z with a rate of its own
enum class SymbolKind : std::uint8_t { channel, parameter, state };

class ExternalFunction;
class Pool;

/// A handle to a node. Cheap to copy; valid as long as its pool lives. Default-constructed: empty (valid() false).
class Expr {
 public:
  static constexpr int most_arguments = 4;

  Expr() = default;
  bool valid() const { return pool_ != nullptr; }
  Pool& pool() const { return *pool_; }
  std::uint32_t id() const { return id_; }
  friend bool operator==(const Expr&, const Expr&) = default;

  Op op() const;
  std::span<const Expr> arguments() const;
  bool is_constant() const { return op() == Op::constant; }
  bool is_constant(double value) const;  ///< a constant of exactly this value
  bool is_symbol() const { return op() == Op::symbol; }
  double value() const;             ///< of a constant; otherwise throws std::logic_error
  const std::string& name() const;  ///< of a symbol; otherwise throws std::logic_error
  SymbolKind kind() const;          ///< of a symbol; otherwise throws std::logic_error
  /// Of Op::external, otherwise throws std::logic_error: the function, and what of it the node is (ExternalPart).
  const std::shared_ptr<const ExternalFunction>& function() const;
  std::uint8_t part() const;

 private:
  friend class Pool;
  Expr(Pool* pool, std::uint32_t id) : pool_(pool), id_(id) {}
  Pool* pool_ = nullptr;
  std::uint32_t id_ = 0;
};

/// Owns the nodes. Changed by one thread only; tapes built from it are immutable and may be shared.
class Pool {
 public:
  Pool();
  ~Pool();
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  Expr constant(double value);
  /// Throws InputError when `name` is no identifier, exists with another kind, is a word of the language (a
  /// function's name, pi), or is a channel's name and `kind` is not channel.
  Expr symbol(std::string_view name, SymbolKind kind);
  Expr channel(std::string_view name) { return symbol(name, SymbolKind::channel); }
  Expr parameter(std::string_view name) { return symbol(name, SymbolKind::parameter); }
  Expr state(std::string_view name) { return symbol(name, SymbolKind::state); }
  /// The symbol of this name, or an empty Expr.
  Expr find(std::string_view name) const;
  /// Applies an operation with safe simplification. Throws InputError on a wrong number of arguments and
  /// on a comparison anywhere but in the first argument of where.
  Expr apply(Op op, std::span<const Expr> arguments);
  Expr apply(Op op, std::initializer_list<Expr> arguments) {
    return apply(op, std::span<const Expr>(arguments.begin(), arguments.size()));
  }
  /// An external function, or the `part` of it (ExternalPart), of these arguments. Throws InputError on a wrong number
  /// of them or on a comparison, and when another function or symbol has its name.
  Expr call(const std::shared_ptr<const ExternalFunction>& function, std::span<const Expr> arguments,
            std::uint8_t part = 0);
  /// The functions that were called or added, in order. A pool keeps them as long as it lives.
  std::span<const std::shared_ptr<const ExternalFunction>> functions() const;
  void add(std::shared_ptr<const ExternalFunction> function);
  /// `wanted`, or with a number behind it when a symbol, a function or the language has that name.
  std::string free_name(std::string_view wanted) const;

 private:
  friend class Expr;
  struct Impl;
  Impl* impl_;
};

Expr operator+(Expr a, Expr b);
Expr operator-(Expr a, Expr b);
Expr operator*(Expr a, Expr b);
Expr operator/(Expr a, Expr b);
Expr operator-(Expr a);
Expr operator+(Expr a, double b);
Expr operator-(Expr a, double b);
Expr operator+(double a, Expr b);
Expr operator-(double a, Expr b);
Expr operator*(double a, Expr b);
Expr operator*(Expr a, double b);
Expr operator/(double a, Expr b);
Expr operator/(Expr a, double b);
Expr pow(Expr a, Expr b);
Expr pow(Expr a, double b);

/// Names of all functions that parse() knows (sin ... where), for messages and for Lua.
std::vector<std::string> function_names();
/// The operation of this function name; false when there is none.
bool find_function(std::string_view name, Op& op, int& arity);

/// Every distinct symbol in `f`, in order of first appearance (depth first, left to right).
std::vector<Expr> symbols(Expr f);
std::vector<Expr> symbols(Expr f, SymbolKind kind);
bool depends_on(Expr f, Expr symbol);
/// `f` with each `first` replaced by its `second` (all at once).
Expr substitute(Expr f, std::span<const std::pair<Expr, Expr>> replacements);

/// Exact partial derivative with respect to a symbol. Switching functions are taken branch by branch:
/// d|x| = sign(x) dx, d sign(x) = 0, d max(a, b) = where(a > b, da, db).
Expr derivative(Expr f, Expr symbol);

enum class Format { plain, latex, c, lua };
/// Text of an expression. plain: re-reading gives the same node. c: a C expression with <math.h>. lua: with the
/// functions as lunid.sin(...). Constants print in the fewest digits that read back to the same double.
std::string to_text(Expr f, Format format = Format::plain);

/// Reads the plain form (nested at most 200 levels). `y v a t F` (and yb vb ab, y1 v1 a1 F1 ...) are channels (degrees
/// of freedom count from 1: F0 is no channel), pi is the number, a name already known to the pool keeps its kind, any
/// other identifier becomes a parameter. Throws InputError with the 1-based column in the text, e.g.
///   `--restoring:1:7: unknown function 'sine', did you mean 'sin'?`  (source = "--restoring").
Expr parse(Pool& pool, std::string_view text, std::string_view source = "expression");

}  // namespace lunid
