// Expressions of time on even grids: turned waves against the formula itself.
#include "simulate/ensemble.hpp"
#include "simulate_models.hpp"

namespace lunid {
namespace {

using namespace lunid::testing;
using Eigen::Index;

constexpr double pi = std::numbers::pi;

/// A sum of `lines` cosines whose phases are spread.
Expr multisine(Pool& pool, int lines) {
  const Expr t = pool.channel("t");
  Expr sum = pool.constant(0.25);
  for (int k = 1; k <= lines; ++k)
    sum = sum + (1 + 0.01 * k) * pool.apply(Op::cos, {2 * pi * 0.37 * k * t + 1.7 * k * k});
  return sum;
}

// The witness evaluates in extended precision. Angles of up to 630 rad are known to 2e-13 in any evaluation: over 40
// lines that is 5e-12 at worst.
TEST(TimeTape, AMultisineIsExactToRoundingOfItsAngles) {
  Pool pool;
  constexpr int lines = 40, rows = 5003;
  const Expr formula = multisine(pool, lines), inputs[] = {pool.channel("t")};
  const TimeTape tape(std::span(&formula, 1), inputs);
  EXPECT_EQ(tape.waves(), lines);
  std::vector<double> out(rows);
  double* const to[] = {out.data()};
  for (const double place : {0.0, 0.3}) {
    tape.fill(0.5, 0.00125, place, {}, rows, to);
    for (int row = 0; row < rows; ++row) {
      const long double t = 0.5L + 0.00125L * (row + static_cast<long double>(place));
      long double exact = 0.25L;
      for (int k = 1; k <= lines; ++k)
        exact += (1 + 0.01L * k) * std::cos(static_cast<long double>(2 * pi * 0.37 * k) * t + 1.7L * k * k);
      ASSERT_NEAR(out[static_cast<std::size_t>(row)], static_cast<double>(exact), 5e-12) << row;
    }
  }
}

TEST(TimeTape, TurnsOnlyWhatIsAffineInTime) {
  Pool pool;
  const Expr t = pool.channel("t"), w = pool.parameter("w"), b = pool.parameter("b");
  const auto sine = [&](Expr angle) { return pool.apply(Op::sin, {angle}); };
  const Expr outputs[] = {
      sine(w * t - b) * pool.apply(Op::cos, {w * t - b}),         // one wave, both its parts
      sine(t * t) + sine(pool.apply(Op::sign, {t - 1.0}) * 2.0),  // a chirp; a jump, whose slope is zero
      sine(b) + t * w,                                            // no wave
      sine((3.0 - t) / b) * pool.apply(Op::exp, {-t}),            // falling
  };
  const Expr inputs[] = {t, w, b};
  const TimeTape tape(outputs, inputs);
  EXPECT_EQ(tape.waves(), 2);
  EXPECT_EQ(tape.values().size(), 3U);
  constexpr int rows = 333;
  const std::vector<double> q{41, 0.7};
  std::vector<std::vector<double>> out(4, std::vector<double>(rows));
  std::vector<double*> to;
  for (auto& column : out) to.push_back(column.data());
  tape.fill(0.1, 0.01, 0.8, q, rows, to);
  for (int row = 0; row < rows; ++row) {
    const double at = 0.1 + 0.01 * (row + 0.8), a = 41 * at - 0.7;
    const auto r = static_cast<std::size_t>(row);
    EXPECT_NEAR(out[0][r], std::sin(a) * std::cos(a), 1e-13);
    EXPECT_NEAR(out[1][r], std::sin(at * at) + std::sin(at > 1 ? 2.0 : -2.0), 1e-13);
    EXPECT_NEAR(out[2][r], std::sin(0.7) + at * 41, 1e-13);
    EXPECT_NEAR(out[3][r], std::sin((3 - at) / 0.7) * std::exp(-at), 1e-13);
  }
}

TEST(TimeTape, AnExcitationScaledKeepsItsFormula) {
  Pool pool;
  const Expr formula = multisine(pool, 7);
  const Excitation one(0, 0.01, 200, function_of_time(formula)), three = one.scaled(3);
  EXPECT_TRUE(three.analytic());
  const auto a = one.stage_grid(2), b = three.stage_grid(2);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(b[i], 3 * a[i], 1e-14 * 30);
  EXPECT_NEAR(three.at(0.1234), 3 * one.at(0.1234), 1e-13);
}

}  // namespace
}  // namespace lunid
