#pragma once
// The table of operations: one row per operation with its name, arity, value, derivative and printing.
// Adding an operation is adding its word to Op (expr.hpp) and its row here; only operations that deserve an
// instruction of their own (arithmetic, switches) are known to the tape by name.
#include "expr/expr.hpp"

namespace lunid {

enum class OpClass : std::uint8_t { leaf, operation, function, comparison, external };

/// How strongly a text binds: a child weaker than its place demands is put in parentheses.
namespace bind {
enum Level : int { anything, comparison, sum, product, unary, power, atom };
}

/// How an operation is written. In `pattern`, `$iL` stands for argument i, in a place that demands level L; null
/// means a function call, `name(a, b)`.
struct Notation {
  int level = bind::atom;
  const char* pattern = nullptr;
};

struct OpRow {
  Op op;
  const char* name;
  int arity;
  OpClass kind;
  /// The value. NaN propagates.
  double (*value)(double a, double b, double c);
  /// The derivative of the node f, given the derivatives d of its arguments (constant 0 where there is none).
  Expr (*derivative)(Expr f, const Expr* d);
  Notation plain, latex, c, lua;
};

const OpRow& row_of(Op op);
/// All rows, in the order of Op.
std::span<const OpRow> all_rows();

/// a^b as all of the language computes it: by multiplications for integers |b| <= 16 and std::sqrt for b = 0.5,
/// else std::pow.
double power(double a, double b);
/// The integer n with b == n and |n| <= 16; false when there is none.
bool small_integer(double b, int& n);
/// Multiplications of x by binary powering, n >= 1: the one order of products, shared with the tape.
template <class T, class Multiply>
T integer_power(T x, int n, Multiply multiply) {
  if (n == 1) return x;
  const T half = integer_power(x, n / 2, multiply);
  const T square = multiply(half, half);
  return n % 2 ? multiply(square, x) : square;
}

}  // namespace lunid
