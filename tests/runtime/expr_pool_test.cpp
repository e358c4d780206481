// Nodes: equal expressions are one node, simplification is safe for NaN and infinity.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "expr/expr.hpp"
#include "expr/op.hpp"

namespace lunid {
namespace {

class PoolTest : public ::testing::Test {
 protected:
  std::string simplified(const std::string& text) { return to_text(parse(pool, text)); }
  template <class F>
  std::string message(F f) {
    try {
      f();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  Pool pool;
  Expr y = pool.channel("y"), v = pool.channel("v"), k = pool.parameter("k");
};

TEST_F(PoolTest, equal_expressions_are_one_node) {
  EXPECT_EQ(k * y + 2.0 * v, k * y + 2.0 * v);
  EXPECT_EQ(pow(y, 3), pow(y, pool.constant(3)));
  EXPECT_NE(k * y, y * k) << "the order is kept as typed";
  EXPECT_NE(pool.constant(0.0), pool.constant(-0.0));
  EXPECT_EQ(pool.constant(std::nan("1")), pool.constant(-std::nan("2")));
  EXPECT_EQ(pool.channel("y"), y);
}

TEST_F(PoolTest, handles_stay_valid_while_the_pool_grows) {
  const Expr f = k * y;
  const std::span<const Expr> arguments = f.arguments();
  for (int i = 0; i < 100000; ++i) pool.constant(i);
  EXPECT_EQ(arguments[0], k);
  EXPECT_EQ(arguments[1], y);
  EXPECT_EQ(k.name(), "k");
}

TEST_F(PoolTest, an_empty_handle_is_not_valid) {
  EXPECT_FALSE(Expr().valid());
  EXPECT_FALSE(pool.find("nothing").valid());
  EXPECT_EQ(pool.find("k"), k);
}

TEST_F(PoolTest, accessors_of_the_wrong_kind_of_node_throw) {
  EXPECT_THROW(y.value(), std::logic_error);
  EXPECT_THROW((k * y).name(), std::logic_error);
  EXPECT_THROW(pool.constant(1).kind(), std::logic_error);
  Pool other;
  EXPECT_THROW(y * other.channel("y"), std::logic_error);
}

TEST_F(PoolTest, simplifies_what_is_safe) {
  const std::pair<const char*, const char*> table[] = {
      {"y + 0", "y"},
      {"0 + y", "y"},
      {"y - 0", "y"},
      {"y*1", "y"},
      {"1*y", "y"},
      {"y/1", "y"},
      {"y^1", "y"},
      {"y^0", "1"},
      {"--y", "y"},
      {"-1*y", "-y"},
      {"y*(-1)", "-y"},
      {"y/(-1)", "-y"},
      {"2 + 3*4", "14"},
      {"2^-2", "0.25"},
      {"-(k*y)", "-k*y"},
      {"-(2*y)", "-2*y"},
      {"-(-k*y/3)", "k*y/3"},
      {"y + -k*v", "y - k*v"},
      {"y - -k*v", "y + k*v"},
      {"y + -3", "y - 3"},
      {"y - (-3)", "y + 3"},
      {"abs(-y)", "abs(y)"},
      {"abs(abs(y))", "abs(y)"},
      {"max(y, y)", "y"},
      {"min(y, y)", "y"},
      {"where(2 > 1, y, v)", "y"},
      {"where(-1, y, v)", "v"},
      {"sin(0)", "0"},
      {"0 - y", "0 - y"},
      {"-y^2", "-y^2"},
  };
  for (const auto& [typed, simple] : table) EXPECT_EQ(simplified(typed), simple) << typed;
}

TEST_F(PoolTest, keeps_what_is_not_safe_for_nan_and_infinity) {
  for (const char* text :
       {"y/y", "0*y", "y*0", "y - y", "0/y", "where(y > 0, v, v)", "(y^2)^0.5", "0^y", "1^y", "y*k/k"})
    EXPECT_EQ(simplified(text), text);
}

TEST_F(PoolTest, a_comparison_stands_only_in_where) {
  const Expr holds = pool.apply(Op::greater, {y, v});
  EXPECT_EQ(message([&] { holds + y; }),
            "+: a comparison may stand only in the first argument of where(condition, a, b)");
  EXPECT_EQ(message([&] {
              pool.apply(Op::where, {y, holds, v});
            }),
            "where: a comparison may stand only in the first argument of where(condition, a, b)");
  EXPECT_TRUE(pool.apply(Op::where, {holds, y, v}).valid());
}

TEST_F(PoolTest, wrong_numbers_of_arguments) {
  EXPECT_EQ(message([&] { pool.apply(Op::sin, {y, v}); }), "sin: takes 1 argument, got 2");
  EXPECT_EQ(message([&] { pool.apply(Op::where, {y, v}); }), "where: takes 3 arguments, got 2");
  EXPECT_EQ(message([&] { pool.apply(Op::sin, {Expr()}); }), "sin: an argument is empty");
}

TEST_F(PoolTest, names) {
  EXPECT_EQ(message([&] { pool.parameter("y"); }), "name 'y': is a channel already, not a parameter");
  EXPECT_EQ(message([&] { pool.state("k"); }), "name 'k': is a parameter already, not a state");
  EXPECT_EQ(message([&] { pool.parameter("F2"); }), "name 'F2': is a channel, not a parameter; choose another name");
  EXPECT_EQ(message([&] { pool.parameter("sin"); }), "name 'sin': is a word of the language, choose another");
  EXPECT_EQ(message([&] { pool.parameter("pi"); }), "name 'pi': is a word of the language, choose another");
  EXPECT_EQ(message([&] { pool.parameter("k 1"); }), "name 'k 1': expected a letter or _, then letters, digits or _");
  EXPECT_EQ(message([&] { pool.parameter(""); }), "name '': expected a letter or _, then letters, digits or _");
  EXPECT_EQ(pool.parameter("F0").kind(), SymbolKind::parameter) << "degrees of freedom count from 1";
}

TEST_F(PoolTest, symbols_come_in_order_of_first_appearance) {
  const Expr f = parse(pool, "c*v + k*(y + v) + c*t");
  std::string names;
  for (const Expr& s : symbols(f)) names += s.name() + " ";
  EXPECT_EQ(names, "c v k y t ");
  names.clear();
  for (const Expr& s : symbols(f, SymbolKind::parameter)) names += s.name() + " ";
  EXPECT_EQ(names, "c k ");
  EXPECT_TRUE(depends_on(f, v));
  EXPECT_FALSE(depends_on(f, pool.channel("F")));
}

TEST_F(PoolTest, substitutes_all_at_once) {
  const std::pair<Expr, Expr> swap[] = {{y, v}, {v, y}};
  EXPECT_EQ(substitute(k * y + v, swap), k * v + y);
  const std::pair<Expr, Expr> node[] = {{k * y, v}};
  EXPECT_EQ(to_text(substitute(pow(k * y, 2) + k, node)), "v^2 + k");
  const std::pair<Expr, Expr> zero[] = {{k, pool.constant(1)}};
  EXPECT_EQ(substitute(k * y, zero), y) << "the result is simplified";
  EXPECT_EQ(substitute(k * y, {}), k * y);
}

TEST_F(PoolTest, the_rows_are_in_the_order_of_their_operations) {
  for (std::size_t i = 0; i < all_rows().size(); ++i) EXPECT_EQ(static_cast<std::size_t>(all_rows()[i].op), i);
  EXPECT_EQ(all_rows().size(), static_cast<std::size_t>(Op::external) + 1);
}

TEST_F(PoolTest, function_names_are_those_that_parse_knows) {
  Op op;
  int arity = 0;
  for (const std::string& name : function_names()) EXPECT_TRUE(find_function(name, op, arity)) << name;
  EXPECT_EQ(function_names().size(), 17u)
      << "sin cos tan asin acos atan sinh cosh tanh exp log sqrt abs sign min max where";
  EXPECT_TRUE(find_function("where", op, arity));
  EXPECT_EQ(op, Op::where);
  EXPECT_EQ(arity, 3);
  EXPECT_FALSE(find_function("greater", op, arity)) << "written > in text";
}

TEST_F(PoolTest, powers_of_integers_are_products) {
  EXPECT_EQ(power(3, 4), 81);
  EXPECT_EQ(power(-2, 3), -8);
  EXPECT_EQ(power(2, -3), 0.125);
  EXPECT_EQ(power(1.1, 5), ((1.1 * 1.1) * (1.1 * 1.1)) * 1.1);
  EXPECT_EQ(power(2, 0.5), std::sqrt(2.0));
  EXPECT_EQ(power(1.1, 17), std::pow(1.1, 17));
  EXPECT_TRUE(std::isnan(power(std::nan(""), 3)));
}

TEST(NearestWord, is_near_or_nothing) {
  const std::vector<std::string> words = function_names();
  EXPECT_EQ(nearest_word("sine", words), "sin");
  EXPECT_EQ(nearest_word("fabs", words), "abs");
  EXPECT_EQ(nearest_word("signum", words), "sign");
  EXPECT_EQ(nearest_word("sgn", words), "sign") << "a letter left out, not one in place of another";
  EXPECT_EQ(nearest_word("sqtr", words), "sqrt") << "a swap is one slip";
  EXPECT_EQ(nearest_word("TANH", words), "tanh");
  EXPECT_EQ(nearest_word("derivative", words), "");
  EXPECT_EQ(nearest_word("q", words), "") << "no letter in common";
  EXPECT_EQ(nearest_word("help", {"exp"}), "") << "two slips in a short word";
  EXPECT_EQ(nearest_word("feature", {"record", "features", "window"}), "features");
  EXPECT_EQ(nearest_word("feature", {}), "");
}

TEST(InputErrorTest, says_where) {
  EXPECT_STREQ(InputError("lost", {"study.lua", 14}).what(), "study.lua:14: lost");
  EXPECT_STREQ(InputError("lost", {"--mass", 1, 7}).what(), "--mass:1:7: lost");
  EXPECT_STREQ(InputError("lost", {"run.csv"}).what(), "run.csv: lost");
  EXPECT_STREQ(InputError("lost").what(), "lost");
  EXPECT_EQ(InputError("lost", {}, Fault::data).fault(), Fault::data);
  EXPECT_EQ(InputError("lost", {"a", 1}).message(), "lost");
}

}  // namespace
}  // namespace lunid
