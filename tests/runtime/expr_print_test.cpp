// Printing in four formats; re-reading the plain form gives the same node.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "expr/expr.hpp"
#include "expr_random.hpp"

namespace lunid {
namespace {

struct Row {
  const char *plain, *latex, *c, *lua;
};

TEST(Print, four_formats) {
  const Row table[] = {
      {"k*y + c*v + k3*y^3", "k \\, y + c \\, v + k_{3} \\, y^{3}", "k*y + c*v + k3*pow(y, 3.0)", "k*y + c*v + k3*y^3"},
      {"(y + v)*(y - v)", "\\left(y + v\\right) \\, \\left(y - v\\right)", "(y + v)*(y - v)", "(y + v)*(y - v)"},
      {"y - (v - k)", "y - \\left(v - k\\right)", "y - (v - k)", "y - (v - k)"},
      {"y/(v/k)", "\\frac{y}{\\frac{v}{k}}", "y/(v/k)", "y/(v/k)"},
      {"y/v/k", "\\frac{\\frac{y}{v}}{k}", "y/v/k", "y/v/k"},
      {"(y/v)^2", "\\left(\\frac{y}{v}\\right)^{2}", "pow(y/v, 2.0)", "(y/v)^2"},
      {"y^v^k", "y^{v^{k}}", "pow(y, pow(v, k))", "y^v^k"},
      {"(y^v)^k", "\\left(y^{v}\\right)^{k}", "pow(pow(y, v), k)", "(y^v)^k"},
      {"y^-2", "y^{-2}", "pow(y, -2.0)", "y^-2"},
      {"(-3)^y", "\\left(-3\\right)^{y}", "pow(-3.0, y)", "(-3)^y"},
      {"-y^2", "-y^{2}", "-pow(y, 2.0)", "-y^2"},
      {"-y*v", "-y \\, v", "-y*v", "-y*v"},
      {"sin(y)^2", "\\left(\\sin\\left(y\\right)\\right)^{2}", "pow(sin(y), 2.0)", "lunid.sin(y)^2"},
      {"asin(y) + log(y)", "\\arcsin\\left(y\\right) + \\ln\\left(y\\right)", "asin(y) + log(y)",
       "lunid.asin(y) + lunid.log(y)"},
      {"sqrt(abs(y))*sign(v)", "\\sqrt{\\left|y\\right|} \\, \\operatorname{sign}\\left(v\\right)",
       "sqrt(fabs(y))*(double)((v > 0) - (v < 0))", "lunid.sqrt(lunid.abs(y))*lunid.sign(v)"},
      {"max(y, min(v, 0))", "\\max\\left(y, \\min\\left(v, 0\\right)\\right)", "fmax(y, fmin(v, 0.0))",
       "lunid.max(y, lunid.min(v, 0))"},
      {"where(y > g, k*(y - g), 0)",
       "\\begin{cases} k \\, \\left(y - g\\right) & \\text{if } y > g \\\\ 0 & \\text{otherwise} \\end{cases}",
       "(y > g ? k*(y - g) : 0.0)", "lunid.where(lunid.greater(y, g), k*(y - g), 0)"},
      {"where(y <= v, 1, 2)*k",
       "\\left(\\begin{cases} 1 & \\text{if } y \\le v \\\\ 2 & \\text{otherwise} \\end{cases}\\right) \\, k",
       "(y <= v ? 1.0 : 2.0)*k", "lunid.where(lunid.less_equal(y, v), 1, 2)*k"},
      {"where(y + v, 1, 2)", "\\begin{cases} 1 & \\text{if } y + v > 0 \\\\ 2 & \\text{otherwise} \\end{cases}",
       "(y + v > 0 ? 1.0 : 2.0)", "lunid.where(y + v, 1, 2)"},
      {"alpha_s*clearance_k*c_12*Fc", "\\alpha_{s} \\, \\mathrm{clearance}_{k} \\, c_{12} \\, \\mathrm{Fc}",
       "alpha_s*clearance_k*c_12*Fc", "alpha_s*clearance_k*c_12*Fc"},
      {"1e-5*y + 2.5e22", "10^{-5} \\, y + 2.5 \\times 10^{22}", "1e-5*y + 2.5e22", "1e-5*y + 2.5e22"},
      {"0.1 + y", "0.1 + y", "0.1 + y", "0.1 + y"},
  };
  for (const Row& row : table) {
    Pool pool;
    const Expr f = parse(pool, row.plain);
    EXPECT_EQ(to_text(f), row.plain);
    EXPECT_EQ(to_text(f, Format::latex), row.latex);
    EXPECT_EQ(to_text(f, Format::c), row.c);
    EXPECT_EQ(to_text(f, Format::lua), row.lua);
  }
}

TEST(Print, numbers_in_the_fewest_digits_that_read_back) {
  Pool pool;
  const std::pair<double, const char*> table[] = {{1, "1"},
                                                  {-2, "-2"},
                                                  {0.1, "0.1"},
                                                  {1e-5, "1e-5"},
                                                  {1e22, "1e22"},
                                                  {1.0 / 3, "0.3333333333333333"},
                                                  {1e100, "1e100"},
                                                  {100, "100"},
                                                  {5e-324, "5e-324"},
                                                  {-1.5e-10, "-1.5e-10"},
                                                  {-0.0, "-0"},
                                                  {0, "0"},
                                                  {std::numeric_limits<double>::infinity(), "1/0"},
                                                  {-std::numeric_limits<double>::infinity(), "-1/0"},
                                                  {std::nan(""), "0/0"}};
  for (const auto& [value, text] : table) {
    const Expr number = pool.constant(value);
    EXPECT_EQ(to_text(number), text);
    EXPECT_EQ(parse(pool, text), number) << text;
    const Expr used = pow(number, pool.channel("y")) * number;
    EXPECT_EQ(parse(pool, to_text(used)), used) << to_text(used);
  }
  EXPECT_EQ(to_text(pool.constant(-std::numeric_limits<double>::infinity()), Format::c), "-INFINITY");
  EXPECT_EQ(to_text(pool.constant(std::nan("")), Format::latex), "\\mathrm{NaN}");
}

TEST(Print, rereading_gives_the_same_node) {
  Pool pool;
  testing::RandomExpressions random(pool, 20240501);
  std::size_t longest = 0;
  for (int i = 0; i < 20000; ++i) {
    const Expr f = random.next(1 + i % 5);
    const std::string text = to_text(f);
    ASSERT_EQ(parse(pool, text), f) << text << " became " << to_text(parse(pool, text));
    longest = std::max(longest, text.size());
  }
  EXPECT_GT(longest, 200u) << "the random expressions are too simple to test anything";
}

TEST(Print, rereading_derivatives_gives_the_same_node) {
  Pool pool;
  testing::RandomExpressions random(pool, 7);
  for (int i = 0; i < 3000; ++i) {
    const Expr slope = derivative(random.next(1 + i % 4), random.leaves()[static_cast<std::size_t>(i) % 4]);
    ASSERT_EQ(parse(pool, to_text(slope)), slope) << to_text(slope);
  }
}

TEST(Print, every_format_closes_what_it_opens) {
  Pool pool;
  testing::RandomExpressions random(pool, 99);
  for (int i = 0; i < 500; ++i) {
    const Expr f = random.next(4);
    for (const Format format : {Format::plain, Format::latex, Format::c, Format::lua}) {
      int open = 0;
      for (const char c : to_text(f, format)) open += (c == '(' || c == '{') - (c == ')' || c == '}');
      EXPECT_EQ(open, 0) << to_text(f, format);
    }
  }
}

}  // namespace
}  // namespace lunid
