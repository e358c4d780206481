#include "expr/op.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "expr/derivative.hpp"
#include "expr/external.hpp"
#include "expr/sine.hpp"

namespace lunid {
namespace {

using namespace slope;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Expr call(Op op, Expr a) { return a.pool().apply(op, {a}); }
Expr square(Expr a) { return pow(a, 2); }
Expr one(Expr a) { return a.pool().constant(1); }
Expr none(Expr f) { return f.pool().constant(0); }

double sign(double a) { return a > 0 ? 1 : a < 0 ? -1 : a == 0 ? 0 : nan; }
double truth(bool yes, double a, double b) { return a != a || b != b ? nan : yes ? 1 : 0; }

/// (a/b)' = a'/b - (a/b) b'/b; shares a/b with the value.
Expr quotient(Expr f, const Expr* d) {
  const Expr a = f.arguments()[0], b = f.arguments()[1];
  if (zero(d[1])) return over(d[0], b);
  if (zero(d[0])) return over(negative(times(a, d[1])), square(b));
  return over(minus(d[0], times(f, d[1])), b);
}

/// (a^b)' = b a^(b-1) a' + a^b log(a) b'. The second term's limit at a = 0 is 0 (b > 0), where 0*log(0) would be NaN:
/// the offset, far below the smallest a that matters, leaves every other value as it is.
Expr power_slope(Expr f, const Expr* d) {
  const Expr a = f.arguments()[0], b = f.arguments()[1];
  Expr base = none(f), exponent = none(f);
  if (!zero(d[0])) base = times(times(b, pow(a, b - 1.0)), d[0]);
  if (!zero(d[1])) exponent = times(times(f, call(Op::log, a.is_constant() ? a : a + 1e-300)), d[1]);
  return plus(base, exponent);
}

/// The sum of partial derivatives times d, each partial derivative a call of its own.
Expr external_slope(Expr f, const Expr* d) {
  Expr sum = none(f);
  for (int i = 0; i < f.function()->arity(); ++i)
    if (!zero(d[i])) sum = plus(sum, times(partial_derivative(f, i), d[i]));
  return sum;
}

Expr greater(Expr f) { return f.pool().apply(Op::greater, f.arguments()); }

// clang-format off
// Values and derivatives, short enough for a row: a, b, c are the arguments; f the node, d the derivatives.
#define VALUE(expression) [](double a, double b, double c) -> double { (void)a, (void)b, (void)c; return expression; }
#define SLOPE(expression) \
  [](Expr f, const Expr* d) -> Expr { const auto x = f.arguments(); (void)x, (void)d; return expression; }

constexpr auto F = OpClass::function;
constexpr auto O = OpClass::operation;
constexpr auto C = OpClass::comparison;

constexpr Notation infix_sum(const char* pattern) { return {bind::sum, pattern}; }
constexpr Notation call_only{};
constexpr Notation latex_call{bind::power, nullptr};  // \sin(x)^2 would be read as sin(x^2)

constexpr OpRow function_row(Op op, const char* name, double (*value)(double, double, double),
                             Expr (*derivative)(Expr, const Expr*), Notation latex = latex_call,
                             Notation c = call_only) {
  return {op, name, 1, F, value, derivative, call_only, latex, c, call_only};
}

constexpr OpRow comparison_row(Op op, const char* name, double (*value)(double, double, double),
                               const char* pattern, const char* latex) {
  return {op, name, 2, C, value, SLOPE(none(f)), {bind::comparison, pattern}, {bind::comparison, latex},
          {bind::comparison, pattern}, call_only};
}

const std::array rows = {
  OpRow{Op::constant, "constant", 0, OpClass::leaf, nullptr, nullptr, {}, {}, {}, {}},
  OpRow{Op::symbol, "symbol", 0, OpClass::leaf, nullptr, nullptr, {}, {}, {}, {}},
  OpRow{Op::add, "+", 2, O, VALUE(a + b), SLOPE(plus(d[0], d[1])),
        infix_sum("$02 + $13"), infix_sum("$02 + $13"), infix_sum("$02 + $13"), infix_sum("$02 + $13")},
  OpRow{Op::sub, "-", 2, O, VALUE(a - b), SLOPE(minus(d[0], d[1])),
        infix_sum("$02 - $13"), infix_sum("$02 - $13"), infix_sum("$02 - $13"), infix_sum("$02 - $13")},
  OpRow{Op::mul, "*", 2, O, VALUE(a * b), SLOPE(plus(times(d[0], x[1]), times(x[0], d[1]))),
        {bind::product, "$03*$14"}, {bind::product, "$03 \\, $15"}, {bind::product, "$03*$14"}, {bind::product, "$03*$14"}},
  OpRow{Op::div, "/", 2, O, VALUE(a / b), quotient,
        {bind::product, "$03/$14"}, {bind::power, "\\frac{$00}{$10}"}, {bind::product, "$03/$14"}, {bind::product, "$03/$14"}},
  OpRow{Op::pow, "^", 2, O, VALUE(power(a, b)), power_slope,
        {bind::power, "$06^$14"}, {bind::power, "$06^{$10}"}, {bind::atom, "pow($00, $10)"}, {bind::power, "$06^$14"}},
  OpRow{Op::neg, "-", 1, O, VALUE(-a), SLOPE(negative(d[0])),
        {bind::unary, "-$04"}, {bind::unary, "-$05"}, {bind::unary, "-$04"}, {bind::unary, "-$04"}},
  function_row(Op::sin, "sin", VALUE(wave::sin(a)), SLOPE(times(call(Op::cos, x[0]), d[0]))),
  function_row(Op::cos, "cos", VALUE(wave::cos(a)), SLOPE(times(negative(call(Op::sin, x[0])), d[0]))),
  function_row(Op::tan, "tan", VALUE(std::tan(a)), SLOPE(times(plus(one(f), square(f)), d[0]))),
  function_row(Op::asin, "asin", VALUE(std::asin(a)), SLOPE(over(d[0], call(Op::sqrt, minus(one(f), square(x[0]))))),
               {bind::power, "\\arcsin\\left($00\\right)"}),
  function_row(Op::acos, "acos", VALUE(std::acos(a)), SLOPE(over(negative(d[0]), call(Op::sqrt, minus(one(f), square(x[0]))))),
               {bind::power, "\\arccos\\left($00\\right)"}),
  function_row(Op::atan, "atan", VALUE(std::atan(a)), SLOPE(over(d[0], plus(one(f), square(x[0])))),
               {bind::power, "\\arctan\\left($00\\right)"}),
  function_row(Op::sinh, "sinh", VALUE(std::sinh(a)), SLOPE(times(call(Op::cosh, x[0]), d[0]))),
  function_row(Op::cosh, "cosh", VALUE(std::cosh(a)), SLOPE(times(call(Op::sinh, x[0]), d[0]))),
  function_row(Op::tanh, "tanh", VALUE(std::tanh(a)), SLOPE(times(minus(one(f), square(f)), d[0]))),
  function_row(Op::exp, "exp", VALUE(std::exp(a)), SLOPE(times(f, d[0]))),
  function_row(Op::log, "log", VALUE(std::log(a)), SLOPE(over(d[0], x[0])),
               {bind::power, "\\ln\\left($00\\right)"}),
  function_row(Op::sqrt, "sqrt", VALUE(std::sqrt(a)), SLOPE(over(d[0], times(f.pool().constant(2), f))),
               {bind::atom, "\\sqrt{$00}"}),
  function_row(Op::abs, "abs", VALUE(std::fabs(a)), SLOPE(times(call(Op::sign, x[0]), d[0])),
               {bind::atom, "\\left|$00\\right|"}, {bind::atom, "fabs($00)"}),
  function_row(Op::sign, "sign", VALUE(sign(a)), SLOPE(none(f)),
               {bind::power, "\\operatorname{sign}\\left($00\\right)"}, {bind::atom, "(double)(($00 > 0) - ($00 < 0))"}),
  // d max(a, b) = where(a > b, a', b') and d min(a, b) = where(a > b, b', a'): the switch of the value itself.
  OpRow{Op::min, "min", 2, F, VALUE(a <= b || a != a ? a : b), SLOPE(choose(greater(f), d[1], d[0])),
        call_only, latex_call, {bind::atom, "fmin($00, $10)"}, call_only},
  OpRow{Op::max, "max", 2, F, VALUE(a >= b || a != a ? a : b), SLOPE(choose(greater(f), d[0], d[1])),
        call_only, latex_call, {bind::atom, "fmax($00, $10)"}, call_only},
  comparison_row(Op::greater, "greater", VALUE(truth(a > b, a, b)), "$02 > $12", "$02 > $12"),
  comparison_row(Op::less, "less", VALUE(truth(a < b, a, b)), "$02 < $12", "$02 < $12"),
  comparison_row(Op::greater_equal, "greater_equal", VALUE(truth(a >= b, a, b)), "$02 >= $12", "$02 \\ge $12"),
  comparison_row(Op::less_equal, "less_equal", VALUE(truth(a <= b, a, b)), "$02 <= $12", "$02 \\le $12"),
  OpRow{Op::where, "where", 3, F, VALUE(a > 0 ? b : a <= 0 ? c : nan), SLOPE(choose(x[0], d[1], d[2])),
        call_only, {bind::comparison, "\\begin{cases} $10 & \\text{if } $0? \\\\ $20 & \\text{otherwise} \\end{cases}"},
        {bind::atom, "($0? ? $11 : $21)"}, call_only},
  OpRow{Op::external, "an external function", 0, OpClass::external, nullptr, external_slope,
        call_only, latex_call, call_only, call_only},
};
// clang-format on

}  // namespace

const OpRow& row_of(Op op) { return rows[static_cast<std::size_t>(op)]; }
std::span<const OpRow> all_rows() { return rows; }

bool small_integer(double b, int& n) {
  if (!(b >= -16 && b <= 16) || b != std::floor(b)) return false;
  n = static_cast<int>(b);
  return true;
}

double power(double a, double b) {
  int n = 0;
  if (small_integer(b, n)) {
    if (n == 0) return 1;
    const double p = integer_power(a, n < 0 ? -n : n, [](double x, double y) { return x * y; });
    return n < 0 ? 1 / p : p;
  }
  return b == 0.5 ? std::sqrt(a) : std::pow(a, b);
}

std::vector<std::string> function_names() {
  std::vector<std::string> names;
  for (const OpRow& row : rows)
    if (row.kind == OpClass::function) names.emplace_back(row.name);
  return names;
}

bool find_function(std::string_view name, Op& op, int& arity) {
  for (const OpRow& row : rows) {
    if (row.kind != OpClass::function || name != row.name) continue;
    op = row.op;
    arity = row.arity;
    return true;
  }
  return false;
}

}  // namespace lunid
