// Reading text: what the words mean, and every error in full.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "expr/expr.hpp"

namespace lunid {
namespace {

TEST(Parse, knows_channels_and_takes_the_rest_as_parameters) {
  Pool pool;
  for (const char* name : {"y", "v", "a", "t", "F", "yb", "vb", "ab", "y1", "v12", "a3", "F2"})
    EXPECT_EQ(parse(pool, name).kind(), SymbolKind::channel) << name;
  for (const char* name : {"k", "F0", "y0", "Fc", "v_0", "yb1", "tt", "_x", "v1b"})
    EXPECT_EQ(parse(pool, name).kind(), SymbolKind::parameter) << name;
}

TEST(Parse, a_known_name_keeps_its_kind) {
  Pool pool;
  const Expr z = pool.state("z");
  EXPECT_EQ(parse(pool, "k*z").arguments()[1], z);
}

TEST(Parse, follows_the_grammar) {
  Pool pool;
  const Expr y = pool.channel("y"), v = pool.channel("v"), k = pool.parameter("k");
  EXPECT_EQ(parse(pool, "y-v-k"), (y - v) - k);
  EXPECT_EQ(parse(pool, "y/v*k"), (y / v) * k);
  EXPECT_EQ(parse(pool, "y^v^k"), pow(y, pow(v, k)));
  EXPECT_EQ(parse(pool, "-y^2"), -pow(y, 2));
  EXPECT_EQ(parse(pool, "y^-k"), pow(y, -k));
  EXPECT_EQ(parse(pool, " ( y +\tv )\n* k "), (y + v) * k);
  EXPECT_EQ(parse(pool, ".5*y + 1e3*v + 2.*k"), 0.5 * y + 1e3 * v + 2.0 * k);
  EXPECT_EQ(parse(pool, "where(y >= v, 1, 2)"),
            pool.apply(Op::where, {pool.apply(Op::greater_equal, {y, v}), pool.constant(1), pool.constant(2)}));
  EXPECT_EQ(parse(pool, "pi").value(), std::numbers::pi);
}

struct Row {
  std::string text, error;
};

TEST(Parse, errors_in_full) {
  const Row table[] = {
      {"", "1:1: expected an expression, got nothing"},
      {"   ", "1:4: expected an expression, got nothing"},
      {"k*y + sine(y)", "1:7: unknown function 'sine', did you mean 'sin'?"},
      {"fabs(y)", "1:1: unknown function 'fabs', did you mean 'abs'?"},
      {"ln(y)", "1:1: unknown function 'ln', did you mean 'log'?"},
      {"Sin(y)", "1:1: unknown function 'Sin', did you mean 'sin'?"},
      {"pow(y, 2)", "1:1: unknown function 'pow', write a^b for a power"},
      {"k(y + 1)", "1:1: unknown function 'k', write 'k*(...)' for a product"},
      {"y(1)", "1:1: unknown function 'y', write 'y*(...)' for a product"},
      {"sin(y, v)", "1:1: sin: takes 1 argument, got 2"},
      {"k*max(y)", "1:3: max: takes 2 arguments, got 1"},
      {"where(y > 1, 2)", "1:1: where: takes 3 arguments, got 2"},
      {"sin()", "1:1: sin: takes 1 argument, got 0"},
      {"sin(1,5)", "1:1: sin: takes 1 argument, got 2 (a decimal number takes a point, not a comma)"},
      {"sin y", "1:1: function 'sin' needs its arguments in parentheses, sin(...)"},
      {"(y + v", "1:7: expected ')' to close the '(' in column 1, got the end"},
      {"sin(y", "1:6: expected ')' to close the '(' in column 4, got the end"},
      {"y + v)", "1:6: unexpected ')', no '(' is open"},
      {"1,5*y", "1:2: unexpected ',', a decimal number takes a point: write 1.5"},
      {"y, v", "1:2: unexpected ','"},
      {"k*", "1:3: expected a number, a name or '(', got the end"},
      {"*y", "1:1: expected a number, a name or '(', got '*'"},
      {"k*y +* v", "1:6: expected a number, a name or '(', got '*'"},
      {"max(y,)", "1:7: expected a number, a name or '(', got ')'"},
      {"()", "1:2: expected a number, a name or '(', got ')'"},
      {"k y", "1:3: expected an operator before 'y', write '*' for a product"},
      {"(k)(y)", "1:4: expected an operator before '(', write '*' for a product"},
      {"y 2", "1:3: expected an operator before '2', write '*' for a product"},
      {"2y", "1:1: malformed number '2y', write '2*y' for a product"},
      {"1.2.3", "1:1: malformed number '1.2.3'"},
      {"0x10", "1:1: malformed number '0x10'"},
      {"1e", "1:1: malformed number '1e'"},
      {"1e999", "1:1: number '1e999' is beyond the range of a double"},
      {"y**2", "1:2: unexpected '**', write '^' for a power"},
      {"y > 1", "1:3: unexpected '>', a comparison may stand only in the first argument of where(condition, a, b)"},
      {"max(y > 1, 2)",
       "1:7: unexpected '>', a comparison may stand only in the first argument of where(condition, a, b)"},
      {"where(y, v >= 1, 2)",
       "1:12: unexpected '>=', a comparison may stand only in the first argument of where(condition, a, b)"},
      {"where(1 < y < 2, 1, 2)",
       "1:13: unexpected '<', a comparison may stand only in the first argument of where(condition, a, b)"},
      {"where((y > 1), 2, 3)",
       "1:10: unexpected '>', a comparison may stand only in the first argument of where(condition, a, b)"},
      {"y = 3", "1:3: unexpected '=': give one side of an equation alone; comparisons are > < >= <="},
      {"c*|v|*v", "1:3: unexpected '|', write abs(v) for the size of v"},
      {"c*y'", "1:4: unexpected \"'\": the derivative of y is v, that of v is a"},
      {"if(y, 1, 0)", "1:1: unknown function 'if', write where(condition, a, b)"},
      {"where(y == 3, 1, 2)", "1:9: unexpected '==', comparisons are > < >= <="},
      {"y != 3", "1:3: unexpected '!=', comparisons are > < >= <="},
      {"k*y + $", "1:7: unexpected character '$'"},
      {"y\xC2\xB2 + 1", "1:2: unexpected character '\xC2\xB2'"},
      {"k*y +\n  c*[v]", "2:5: unexpected character '['"},
      {std::string(300, '(') + "y" + std::string(300, ')'), "1:201: nested deeper than 200 levels"},
      {std::string(300, '-') + "y", "1:201: nested deeper than 200 levels"},
  };
  for (const Row& row : table) {
    Pool pool;
    try {
      const Expr f = parse(pool, row.text, "--restoring");
      ADD_FAILURE() << row.text << " was read as " << to_text(f);
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), "--restoring:" + row.error);
    }
  }
}

TEST(Parse, columns_count_characters) {
  Pool pool;
  try {
    parse(pool, "y*\xC2\xB5", "expression");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.where().column, 3);
    EXPECT_EQ(error.where().line, 1);
  }
  try {
    parse(pool, "k + \xCE\xB1 + y y");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.where().column, 5);
  }
}

TEST(Parse, nested_up_to_the_limit_is_read) {
  Pool pool;
  EXPECT_EQ(parse(pool, std::string(199, '(') + "y" + std::string(199, ')')), pool.channel("y"));
}

/// Any sequence of words is either read, and then reads back to the same node, or refused by an InputError within it.
TEST(Parse, random_words_are_read_or_refused) {
  const char* words[] = {"y", "v", "k", "sin", "where", "max", "(",   "(", ")",  ")", "+", "-",        "*",    "/",
                         "^", ",", ">", "<=",  "1",     "2.5", "1e3", " ", "**", "=", ".", "\xC2\xB2", "\xFF", "pi"};
  std::mt19937 random(11);
  std::uniform_int_distribution<std::size_t> word(0, std::size(words) - 1), length(1, 9);
  int read = 0;
  for (int i = 0; i < 200000; ++i) {
    std::string text;
    for (std::size_t n = length(random); n > 0; --n) text += words[word(random)];
    Pool pool;
    try {
      const Expr f = parse(pool, text);
      ++read;
      ASSERT_EQ(parse(pool, to_text(f)), f) << text;
    } catch (const InputError& error) {
      ASSERT_EQ(error.where().line, 1) << text << ": " << error.what();
      ASSERT_GE(error.where().column, 1);
      ASSERT_LE(error.where().column, static_cast<int>(text.size()) + 1) << text;
    }
  }
  EXPECT_GT(read, 2000);
}

}  // namespace
}  // namespace lunid
