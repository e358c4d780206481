// Whatever is typed as an expression is an expression or an error that says where; what is printed reads back.
#include <gtest/gtest.h>

#include "expr/expr.hpp"
#include "mutate.hpp"

namespace lunid::test {
namespace {

TEST(Fuzz, expressions_are_read_or_refused) {
  Mutator texts(
      {"k*y + c*v", "k3*y^3 + Fc*sign(v)", "where(y >= g, k*max(y - g, 0), 0)", "tanh(p*(y - y0))/2e-3",
       "-(a + 1.5e3*t)^-2*abs(v)^0.5", "sin(2*pi*f*t + phi) - exp(-(v/vs)^2)"},
      {"(", ")", "^", "1e", "e308", "-", "..", "where(", "sign", "\xc3\xa4", "y1", "nan", "inf", "0x1p", "/0"}, 7);
  int read = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string text = texts.next();
    Pool pool;
    try {
      const Expr e = parse(pool, text);
      ++read;
      EXPECT_EQ(parse(pool, to_text(e)), e) << text;
    } catch (const InputError& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()), "") << text;
    }
  }
  EXPECT_GT(read, 1000);  // else nothing but errors is tried
  EXPECT_GT(refused, 1000);
}

TEST(Fuzz, brackets_without_end_are_refused) {
  for (const char* piece : {"(", "-", "sin(", "y^", "2*(", "where(y > 0, "}) {
    std::string text;
    for (int i = 0; i < 200000; ++i) text += piece;
    Pool pool;
    EXPECT_THROW(parse(pool, text), InputError) << piece;
  }
}

}  // namespace
}  // namespace lunid::test
