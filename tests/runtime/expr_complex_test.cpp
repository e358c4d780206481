// Derivatives by complex step: f'(x) = Im f(x + i h) / h is exact to rounding for every operation that continues into
// the complex plane (Squire & Trapp 1998, SIAM Rev. 40, 110); those by switches follow the real part.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <map>

#include "expr/expr.hpp"
#include "expr/op.hpp"
#include "expr_random.hpp"

namespace lunid {
namespace {

using Complex = std::complex<double>;
using Continuation = std::function<Complex(Complex, Complex, Complex)>;

template <class Value>
Continuation unary(Value value) {
  return [value](Complex a, Complex, Complex) { return value(a); };
}

const std::map<Op, Continuation>& continuations() {
  const auto real = [](bool yes) { return Complex(yes ? 1 : 0); };
  static const std::map<Op, Continuation> all = {
      {Op::add, [](Complex a, Complex b, Complex) { return a + b; }},
      {Op::sub, [](Complex a, Complex b, Complex) { return a - b; }},
      {Op::mul, [](Complex a, Complex b, Complex) { return a * b; }},
      {Op::div, [](Complex a, Complex b, Complex) { return a / b; }},
      {Op::pow, [](Complex a, Complex b, Complex) { return std::exp(b * std::log(a)); }},
      {Op::neg, unary([](Complex a) { return -a; })},
      {Op::sin, unary([](Complex a) { return std::sin(a); })},
      {Op::cos, unary([](Complex a) { return std::cos(a); })},
      {Op::tan, unary([](Complex a) { return std::tan(a); })},
      {Op::asin, unary([](Complex a) { return std::asin(a); })},
      {Op::acos, unary([](Complex a) { return std::acos(a); })},
      {Op::atan, unary([](Complex a) { return std::atan(a); })},
      {Op::sinh, unary([](Complex a) { return std::sinh(a); })},
      {Op::cosh, unary([](Complex a) { return std::cosh(a); })},
      {Op::tanh, unary([](Complex a) { return std::tanh(a); })},
      {Op::exp, unary([](Complex a) { return std::exp(a); })},
      {Op::log, unary([](Complex a) { return std::log(a); })},
      {Op::sqrt, unary([](Complex a) { return std::sqrt(a); })},
      {Op::abs, unary([](Complex a) { return a.real() < 0 ? -a : a; })},
      {Op::sign, unary([](Complex a) { return Complex(a.real() > 0   ? 1
                                                      : a.real() < 0 ? -1
                                                                     : 0); })},
      {Op::min, [](Complex a, Complex b, Complex) { return a.real() < b.real() ? a : b; }},
      {Op::max, [](Complex a, Complex b, Complex) { return a.real() > b.real() ? a : b; }},
      {Op::greater, [real](Complex a, Complex b, Complex) { return real(a.real() > b.real()); }},
      {Op::less, [real](Complex a, Complex b, Complex) { return real(a.real() < b.real()); }},
      {Op::greater_equal, [real](Complex a, Complex b, Complex) { return real(a.real() >= b.real()); }},
      {Op::less_equal, [real](Complex a, Complex b, Complex) { return real(a.real() <= b.real()); }},
      {Op::where, [](Complex c, Complex a, Complex b) { return c.real() != 0 ? a : b; }},
  };
  return all;
}

TEST(ComplexStep, agrees_with_the_derivative_of_every_operation) {
  Pool pool;
  const Expr x[] = {pool.channel("y"), pool.channel("v"), pool.parameter("k")};
  const std::vector<Expr> symbols(x, x + 3);
  constexpr double h = 1e-30;
  int seen = 0;
  for (const OpRow& row : all_rows()) {
    if (row.arity == 0) continue;
    const auto found = continuations().find(row.op);
    ASSERT_NE(found, continuations().end()) << "no continuation of '" << row.name << "' is written here";
    ++seen;
    const Expr f = pool.apply(row.op, {x, static_cast<std::size_t>(row.arity)});
    for (const std::vector<double>& at :
         {std::vector{0.6, 0.4, 0.3}, std::vector{0.2, 0.7, 1.3}, std::vector{0.9, 0.1, 2.0}})
      for (int i = 0; i < row.arity; ++i) {
        Complex z[3] = {at[0], at[1], at[2]};
        z[i] += Complex(0, h);
        const double expected = found->second(z[0], z[1], z[2]).imag() / h;
        const double got = testing::direct_value(derivative(f, x[i]), symbols, at);
        EXPECT_NEAR(got, expected, 1e-14 * (1 + std::abs(expected))) << row.name << " by argument " << i + 1;
      }
  }
  EXPECT_GE(seen, 20);
}

}  // namespace
}  // namespace lunid
