// Derivatives: exact forms by table, and central differences for every operation.
#include <gtest/gtest.h>

#include <cmath>

#include "expr/expr.hpp"
#include "expr_random.hpp"

namespace lunid {
namespace {

struct Row {
  const char* f;
  const char* by;
  const char* slope;
};

TEST(Derivative, table) {
  const Row table[] = {
      {"3", "y", "0"},
      {"k", "y", "0"},
      {"y", "y", "1"},
      {"k*y + c*v", "y", "k"},
      {"k*y + c*v", "v", "c"},
      {"k3*y^3", "y", "3*k3*y^2"},
      {"k3*y^3", "k3", "y^3"},
      {"2*y^2", "y", "4*y"},
      {"y*y", "y", "2*y"},
      {"y - v", "v", "-1"},
      {"-k*y", "y", "-k"},
      {"y/k", "y", "1/k"},
      {"1/y", "y", "-1/y^2"},
      {"y/k", "k", "-y/k^2"},
      {"y/(1 + y)", "y", "(1 - y/(1 + y))/(1 + y)"},
      {"y^-2", "y", "-2*y^-3"},
      {"y^p", "y", "p*y^(p - 1)"},
      {"y^p", "p", "y^p*log(y + 1e-300)"},
      {"2^y", "y", "0.6931471805599453*2^y"},
      {"sin(k*y)", "y", "cos(k*y)*k"},
      {"cos(y)", "y", "-sin(y)"},
      {"tan(y)", "y", "1 + tan(y)^2"},
      {"asin(y)", "y", "1/sqrt(1 - y^2)"},
      {"acos(y)", "y", "-1/sqrt(1 - y^2)"},
      {"atan(y)", "y", "1/(1 + y^2)"},
      {"sinh(y)", "y", "cosh(y)"},
      {"cosh(y)", "y", "sinh(y)"},
      {"tanh(v/v0)", "v", "(1 - tanh(v/v0)^2)/v0"},
      {"exp(-y)", "y", "-exp(-y)"},
      {"log(y)", "y", "1/y"},
      {"sqrt(y)", "y", "1/(2*sqrt(y))"},
      {"abs(y)", "y", "sign(y)"},
      {"c*v*abs(v)", "v", "c*abs(v) + c*v*sign(v)"},
      {"sign(v)", "v", "0"},
      {"max(y - g, 0)", "y", "where(y - g > 0, 1, 0)"},
      {"max(y, v)", "v", "where(y > v, 0, 1)"},
      {"min(y, v)", "y", "where(y > v, 0, 1)"},
      {"where(y > g, k*(y - g), 0)", "y", "where(y > g, k, 0)"},
      {"where(y > g, k*(y - g), 0)", "g", "where(y > g, -k, 0)"},
      {"where(y > g, k*y, k*y)", "y", "where(y > g, k, k)"},
      {"where(y > g, 1, 2)", "y", "0"},
  };
  for (const Row& row : table) {
    Pool pool;
    const Expr f = parse(pool, row.f);
    const Expr by = parse(pool, row.by);
    EXPECT_EQ(to_text(derivative(f, by)), row.slope) << "d(" << row.f << ")/d" << row.by;
  }
}

TEST(Derivative, is_by_a_symbol) {
  Pool pool;
  const Expr y = pool.channel("y");
  try {
    derivative(y, y * y);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "derivative: expected a symbol, got 'y*y'");
  }
}

/// Central differences of every operation at points off its switches. h^2 f''' / 6 with h = 1e-5 and rounding
/// 1e-16 / h both stay below 1e-9 for functions of order one; 1e-7 relative leaves room for the steeper ones.
TEST(Derivative, agrees_with_central_differences_for_every_operation) {
  const char* table[] = {"y + v*y",
                         "v - y*3",
                         "y*v*y",
                         "y/v + v/y",
                         "y^3 - y^-2",
                         "y^v",
                         "(y + 2)^2.5",
                         "-y*v",
                         "sin(y*v)",
                         "cos(y + v)",
                         "tan(y)",
                         "asin(y/2)",
                         "acos(y/2)",
                         "atan(y*v)",
                         "sinh(y)",
                         "cosh(y*v)",
                         "tanh(y - v)",
                         "exp(y*v)",
                         "log(y + v)",
                         "sqrt(y*v)",
                         "abs(y - v)",
                         "abs(v - y)*y",
                         "y*sign(y - v)",
                         "min(y, v)*y",
                         "max(y, v)*v",
                         "min(v, y)",
                         "max(v, y*y)",
                         "where(y > v, y*v, y^2)",
                         "where(y < v, y*v, y^2)",
                         "where(y >= v, y^3, v)",
                         "where(y <= v, y^3, v)",
                         "where(y - v, y^2, sin(y))",
                         "abs(y - v)^v",
                         "y^17",
                         "2^y",
                         "0.5^(y*v)"};
  for (const char* text : table) {
    Pool pool;
    const std::vector<Expr> symbols{pool.channel("y"), pool.channel("v")};
    const Expr f = parse(pool, text);
    for (const std::vector<double>& point : {std::vector{0.6, 0.4}, std::vector{0.3, 0.9}, std::vector{1.1, 1.7}}) {
      for (std::size_t i = 0; i < 2; ++i) {
        constexpr double h = 1e-5;
        std::vector<double> low = point, high = point;
        low[i] -= h, high[i] += h;
        const double difference =
            (testing::direct_value(f, symbols, high) - testing::direct_value(f, symbols, low)) / (2 * h);
        const double exact = testing::direct_value(derivative(f, symbols[i]), symbols, point);
        EXPECT_NEAR(exact, difference, 1e-7 * (1 + std::fabs(exact))) << text << " by " << symbols[i].name();
      }
    }
  }
}

TEST(Derivative, the_table_of_differences_holds_every_operation) {
  // The list above is by hand; this asks the rows whether any function was added without a derivative.
  Pool pool;
  const Expr x[] = {pool.channel("y"), pool.channel("v"), pool.parameter("k")};
  for (const OpRow& row : all_rows()) {
    if (row.arity == 0) continue;
    const Expr f = pool.apply(row.op, {x, static_cast<std::size_t>(row.arity)});
    EXPECT_TRUE(derivative(f, x[0]).valid()) << row.name;
  }
}

TEST(Derivative, of_a_power_by_its_exponent_is_finite_at_rest) {
  Pool pool;
  const std::vector<Expr> symbols{pool.channel("v"), pool.parameter("p")};
  const Expr slope = derivative(parse(pool, "abs(v)^p*sign(v)"), symbols[1]);
  EXPECT_EQ(testing::direct_value(slope, symbols, {0, 1.5}), 0);
  EXPECT_EQ(testing::direct_value(slope, symbols, {2, 1.5}), std::pow(2, 1.5) * std::log(2.0)) << "others untouched";
}

TEST(Derivative, nan_goes_through) {
  Pool pool;
  const std::vector<Expr> symbols{pool.channel("y"), pool.channel("v")};
  const Expr slope = derivative(parse(pool, "v*log(y)"), symbols[0]);
  EXPECT_TRUE(std::isnan(testing::direct_value(slope, symbols, {std::nan(""), 0})));
}

}  // namespace
}  // namespace lunid
