// The tape against a direct walk over the nodes, columns against points, frozen modes, and very large expressions.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "expr/frozen.hpp"
#include "expr/tape.hpp"

#include "expr/sine.hpp"
#include "expr_random.hpp"

namespace lunid {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The same double, or both NaN (whose payload is of no account).
::testing::AssertionResult same_bits(double a, double b) {
  if (std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b)))
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << a << " is not " << b;
}

std::vector<double> run(const Tape& tape, const std::vector<double>& in) {
  std::vector<double> out(static_cast<std::size_t>(tape.outputs())),
      scratch(static_cast<std::size_t>(tape.registers()));
  tape.run_point(in.data(), out.data(), scratch.data());
  return out;
}

struct Frozen {
  std::vector<double> out, g;
};
Frozen run_frozen(const Tape& tape, const std::vector<double>& in, const std::vector<std::int8_t>& mode) {
  Frozen result{std::vector<double>(static_cast<std::size_t>(tape.outputs())),
                std::vector<double>(static_cast<std::size_t>(tape.switches()))};
  std::vector<double> scratch(static_cast<std::size_t>(tape.registers()));
  tape.run_frozen(in.data(), mode.data(), result.out.data(), result.g.data(), scratch.data());
  return result;
}

std::vector<double> run_switches(const Tape& tape, const std::vector<double>& in) {
  std::vector<double> g(static_cast<std::size_t>(tape.switches())), scratch(static_cast<std::size_t>(tape.registers()));
  tape.run_switches(in.data(), g.data(), scratch.data());
  return g;
}

class TapeTest : public ::testing::Test {
 protected:
  Tape tape(const std::vector<std::string>& texts) {
    std::vector<Expr> outputs;
    for (const std::string& text : texts) outputs.push_back(parse(pool, text));
    return Tape(outputs, inputs);
  }
  std::vector<std::string> switches(const Tape& tape) {
    std::vector<std::string> texts;
    for (const Expr& g : tape.switching_functions()) texts.push_back(to_text(g));
    return texts;
  }
  Pool pool;
  std::vector<Expr> inputs{pool.channel("y"), pool.channel("v"), pool.parameter("k"), pool.parameter("c")};
};

const std::vector<std::vector<double>> points = {{0.7, -0.3, 2, 0.5},
                                                 {-1.5, 2.5, 0.25, 3},
                                                 {0, 0, 0, 0},
                                                 {1, 1, 1, 1},
                                                 {-0.0, 1e-310, 1e200, -1e200},
                                                 {infinity, 1, -infinity, 0},
                                                 {std::nan(""), 1, 2, 3},
                                                 {1, std::nan(""), -2, 0.5}};

TEST_F(TapeTest, agrees_with_the_direct_walk_to_the_last_bit) {
  testing::RandomExpressions random(pool, 1);
  for (int i = 0; i < 3000; ++i) {
    const std::vector<Expr> outputs{random.next(3), random.next(5), random.next(1 + i % 6)};
    const Tape tape(outputs, inputs);
    for (const std::vector<double>& point : points) {
      const std::vector<double> out = run(tape, point);
      for (std::size_t j = 0; j < outputs.size(); ++j)
        ASSERT_TRUE(same_bits(out[j], testing::direct_value(outputs[j], inputs, point))) << to_text(outputs[j]);
    }
  }
}

TEST_F(TapeTest, columns_have_the_bits_of_points) {
  testing::RandomExpressions random(pool, 2);
  std::mt19937 noise(3);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (int i = 0; i < 300; ++i) {
    const std::vector<Expr> outputs{random.next(4), random.next(5), inputs[0], pool.constant(3)};
    const Tape tape(outputs, inputs);
    const std::size_t rows = std::vector<std::size_t>{1, 255, 256, 257, 700}[static_cast<std::size_t>(i) % 5];
    std::vector<double> y(rows), v(3 * rows), k{uniform(noise)}, c(rows);
    for (auto* column : {&y, &v, &c})
      for (double& x : *column) x = uniform(noise);
    y[rows / 2] = std::nan("");
    c[rows - 1] = 0;
    const double* in[] = {y.data(), v.data(), k.data(), c.data()};
    const int stride[] = {1, 3, 0, 1};
    std::vector<std::vector<double>> out(outputs.size(), std::vector<double>(rows + 1, 17));
    std::vector<double*> to;
    for (auto& column : out) to.push_back(column.data());
    tape.run_columns(in, stride, rows, to);
    for (std::size_t r = 0; r < rows; ++r) {
      const std::vector<double> point = run(tape, {y[r], v[3 * r], k[0], c[r]});
      for (std::size_t j = 0; j < outputs.size(); ++j)
        ASSERT_TRUE(same_bits(out[j][r], point[j])) << to_text(outputs[j]) << " in row " << r;
    }
    for (const auto& column : out) ASSERT_EQ(column[rows], 17) << "wrote behind the end";
  }
}

/// Registers of lanes, side by side or `rows`: 72 apart, for the machine code of temporaries that stand in rows.
struct LanePlaces {
  std::vector<double> memory;
  std::vector<double*> place;
  LanePlaces(const Tape& tape, int lanes, bool rows) {
    const auto registers = static_cast<std::size_t>(tape.registers());
    const std::size_t apart = rows ? 72 : static_cast<std::size_t>(lanes);
    memory.resize(registers * apart);
    for (std::size_t r = 0; r < registers; ++r) place.push_back(memory.data() + r * apart);
  }
};

TEST_F(TapeTest, frozen_runs_in_place_have_the_bits_of_frozen_runs) {
  testing::RandomExpressions random(pool, 11);
  std::mt19937 noise(12);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (int i = 0; i < 400; ++i) {
    const std::vector<Expr> outputs{random.next(4), random.next(5), inputs[3], inputs[3] * inputs[2]};
    const std::size_t fixed = static_cast<std::size_t>(i) % (inputs.size() + 1);
    const Tape tape(outputs, inputs, fixed);
    std::vector<double> in(inputs.size()), out(outputs.size());
    const auto registers = static_cast<std::size_t>(tape.registers()) + 1;
    std::vector<double> own(registers), scratch(registers), g(static_cast<std::size_t>(tape.switches()));
    std::vector<std::int8_t> mode(g.size());
    for (double& x : in) x = uniform(noise);
    std::copy(in.begin(), in.end(), own.begin());
    tape.prepare_frozen(own.data());
    for (int run = 0; run < 3; ++run) {
      for (std::size_t k = 0; k + fixed < in.size(); ++k) own[k] = in[k] = uniform(noise);
      for (auto& m : mode) m = static_cast<std::int8_t>(static_cast<int>(noise() % 3) - 1);
      tape.run_prepared_frozen(mode.data(), own.data());
      tape.run_frozen(in.data(), mode.data(), out.data(), g.data(), scratch.data());
      for (std::size_t j = 0; j < out.size(); ++j)
        ASSERT_TRUE(same_bits(own[static_cast<std::size_t>(tape.output_place()) + j], out[j])) << to_text(outputs[j]);
      for (std::size_t j = 0; j < g.size(); ++j)
        ASSERT_TRUE(same_bits(own[static_cast<std::size_t>(tape.switch_place()) + j], g[j]));
    }
  }
}

// A mode that lasts becomes machine code: branches decided, what they leave out not run.
TEST_F(TapeTest, code_of_a_mode_has_the_bits_of_frozen_runs) {
  testing::RandomExpressions random(pool, 21);
  std::mt19937 noise(22);
  std::uniform_real_distribution<double> uniform(-2, 2);
  int compiled = 0;
  for (int i = 0; i < 300; ++i) {
    const std::vector<Expr> outputs{random.next(4), random.next(5), inputs[3],
                                    pool.apply(Op::where, {pool.apply(Op::greater, {inputs[0], inputs[1]}),
                                                           pool.apply(Op::abs, {inputs[2]}), random.next(3)})};
    const std::size_t fixed = static_cast<std::size_t>(i) % (inputs.size() + 1);
    const Tape tape(outputs, inputs, fixed);
    const auto registers = static_cast<std::size_t>(tape.registers()) + 1;
    std::vector<double> own(registers), expected(registers);
    for (std::size_t k = 0; k < inputs.size(); ++k) own[k] = expected[k] = uniform(noise);
    tape.prepare_frozen(own.data());
    tape.prepare_frozen(expected.data());
    FrozenRun run(tape);
    std::vector<std::vector<std::int8_t>> modes(3);
    for (auto& mode : modes)
      for (int s = 0; s < tape.switches(); ++s) mode.push_back(noise() % 2 ? 1 : -1);
    for (int repeat = 0; repeat < 100; ++repeat) {
      const auto& mode = modes[noise() % modes.size()];
      for (std::size_t k = 0; k + fixed < inputs.size(); ++k) own[k] = expected[k] = uniform(noise);
      run(mode, own.data());
      tape.run_prepared_frozen(mode.data(), expected.data());
      for (std::size_t j = static_cast<std::size_t>(tape.output_place());
           j < static_cast<std::size_t>(tape.switch_place() + tape.switches()); ++j)
        ASSERT_TRUE(same_bits(own[j], expected[j])) << i << " " << repeat;
    }
    compiled += tape.frozen_code(modes[0], false) != nullptr;
  }
#if defined(__x86_64__)
  EXPECT_GT(compiled, 200);
#endif
}

TEST_F(TapeTest, frozen_runs_in_place_leave_out_what_fixed_inputs_make) {
  const Expr v = inputs[1], k = inputs[2], c = inputs[3];
  const std::vector<Expr> outputs{pool.apply(Op::pow, {k, c}) * pool.apply(Op::abs, {v}) +
                                  pool.apply(Op::exp, {k / c})};
  EXPECT_EQ(Tape(outputs, inputs, 0).frozen_instructions() - Tape(outputs, inputs, 2).frozen_instructions(), 3);
}

TEST_F(TapeTest, lanes_have_the_bits_of_points) {
  testing::RandomExpressions random(pool, 7);
  std::mt19937 noise(8);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (int i = 0; i < 400; ++i) {
    const std::vector<Expr> outputs{random.next(4), random.next(5), inputs[0], pool.constant(3)};
    const Tape tape(outputs, inputs);
    const int lanes = Tape::lane_group * (1 + i % 3);
    LanePlaces memory(tape, lanes, i % 2);
    std::vector<double*>& place = memory.place;
    for (std::size_t k = 0; k < inputs.size(); ++k)
      for (int l = 0; l < lanes; ++l) place[k][l] = uniform(noise);
    place[0][3] = std::nan("");
    place[1][lanes - 1] = 0;
    tape.prepare_lanes(place.data(), lanes);
    for (int repeat = 0; repeat < 2; ++repeat) {  // a second run reads nothing that the first one wrote
      tape.run_lanes(place.data(), lanes);
      for (int l = 0; l < lanes; ++l) {
        const std::vector<double> point = run(tape, {place[0][l], place[1][l], place[2][l], place[3][l]});
        for (std::size_t j = 0; j < outputs.size(); ++j)
          ASSERT_TRUE(same_bits(place[static_cast<std::size_t>(tape.output_place()) + j][l], point[j]))
              << to_text(outputs[j]) << " in lane " << l;
      }
    }
  }
}

// More of them than the processor has registers to point to them with; all arithmetic, so that it is machine code.
TEST_F(TapeTest, lanes_of_many_inputs_have_the_bits_of_points) {
  std::vector<Expr> many;
  for (int i = 0; i < 24; ++i) many.push_back(pool.parameter("p" + std::to_string(i)));
  std::mt19937 noise(31);
  std::uniform_real_distribution<double> uniform(-2, 2);
  const auto any = [&] { return many[noise() % many.size()]; };
  for (int i = 0; i < 60; ++i) {
    std::vector<Expr> outputs;
    for (int o = 0; o < 3; ++o) {
      Expr f = any();
      for (int term = 0; term < 12; ++term) {
        const Expr part = any() * any() - 0.75 * any();
        switch (noise() % 4) {
          case 0: f = 3.5 * f + part * any(); break;
          case 1: f = part - (f * any() + 1.25); break;
          case 2: f = -f / (part * part + 2); break;
          default: f = pool.apply(Op::sqrt, {part * part + 0.5}) - f; break;
        }
      }
      outputs.push_back(f);
    }
    const Tape tape(outputs, many);
    const int lanes = Tape::lane_group * (1 + i % 3);
    LanePlaces memory(tape, lanes, i % 2);
    std::vector<double*>& place = memory.place;
    for (std::size_t k = 0; k < many.size(); ++k)
      for (int l = 0; l < lanes; ++l) place[k][l] = uniform(noise);
    tape.prepare_lanes(place.data(), lanes);
    tape.run_lanes(place.data(), lanes);
    for (int l = 0; l < lanes; ++l) {
      std::vector<double> at;
      for (std::size_t k = 0; k < many.size(); ++k) at.push_back(place[k][l]);
      const std::vector<double> point = run(tape, at);
      for (std::size_t j = 0; j < outputs.size(); ++j)
        ASSERT_TRUE(same_bits(place[static_cast<std::size_t>(tape.output_place()) + j][l], point[j]))
            << to_text(outputs[j]) << " in lane " << l;
    }
  }
}

// The library's functions in extended precision are the witness.
TEST_F(TapeTest, sine_and_cosine_are_within_a_unit_in_the_last_place) {
  std::mt19937 noise(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto units = [](double value, long double exact) {
    const double ulp =
        std::nextafter(std::abs(static_cast<double>(exact)), INFINITY) - std::abs(static_cast<double>(exact));
    return static_cast<double>(std::abs(static_cast<long double>(value) - exact)) / ulp;
  };
  for (const double reach : {0.7, 4.0, 100.0, 1e5})
    for (int i = 0; i < 100000; ++i) {
      const double x = reach * uniform(noise);
      ASSERT_LT(units(wave::sin(x), std::sin(static_cast<long double>(x))), 0.95) << x;
      ASSERT_LT(units(wave::cos(x), std::cos(static_cast<long double>(x))), 0.95) << x;
    }
  EXPECT_EQ(wave::cos(0.0), 1);
  EXPECT_EQ(wave::sin(0.0), 0);
  EXPECT_EQ(wave::sin(1e300), std::sin(1e300));
  EXPECT_TRUE(std::isnan(wave::sin(INFINITY)));
  EXPECT_TRUE(std::isnan(wave::cos(std::nan(""))));
}

TEST_F(TapeTest, sines_of_lanes_have_the_bits_of_points_also_out_of_reach) {
  const Expr outputs[] = {pool.apply(Op::sin, {inputs[0]}), pool.apply(Op::cos, {inputs[0]})};
  const Tape tape(outputs, std::span(inputs).first(1));
  constexpr int lanes = Tape::lane_group;
  std::vector<double> memory(lanes * 8);
  std::vector<double*> place;
  for (int r = 0; r < tape.registers(); ++r) place.push_back(memory.data() + lanes * r);
  const double values[lanes] = {-0.0, 1e-310, 3.0, -700.5, 4.9e6, -5.1e6, 1e22, std::nan("")};
  for (int turn = 0; turn < lanes; ++turn) {
    for (int l = 0; l < lanes; ++l) place[0][l] = values[(l * (turn + 1)) % lanes];
    tape.prepare_lanes(place.data(), lanes);
    tape.run_lanes(place.data(), lanes);
    for (int l = 0; l < lanes; ++l) {
      const double expected[] = {wave::sin(place[0][l]), wave::cos(place[0][l])};
      for (int j = 0; j < 2; ++j)
        EXPECT_TRUE(same_bits(place[static_cast<std::size_t>(tape.output_place() + j)][l], expected[j]));
    }
  }
}

TEST_F(TapeTest, outputs_that_are_inputs_may_be_left_out) {
  const Expr outputs[] = {inputs[1], inputs[0] + inputs[1], inputs[3]};
  const Tape tape(outputs, inputs);
  EXPECT_EQ(tape.copy_of(0), 1);
  EXPECT_EQ(tape.copy_of(1), -1);
  EXPECT_EQ(tape.copy_of(2), 3);
  constexpr int lanes = Tape::lane_group;
  std::vector<double> memory(static_cast<std::size_t>(lanes * tape.registers()), 17);
  std::vector<double*> place;
  for (int r = 0; r < tape.registers(); ++r) place.push_back(memory.data() + lanes * r);
  tape.prepare_lanes(place.data(), lanes);
  tape.run_lanes_without_copies(place.data(), lanes);
  place[1][2] = 18;
  for (const int output : {0, 2}) EXPECT_EQ(place[static_cast<std::size_t>(tape.output_place() + output)][2], 17);
  EXPECT_EQ(place[static_cast<std::size_t>(tape.output_place() + 1)][2], 34);
}

TEST_F(TapeTest, knows_which_inputs_it_reads) {
  const Expr output[] = {inputs[0] * 2.0 + inputs[3]};
  const Tape tape(output, inputs);
  EXPECT_TRUE(tape.reads(0));
  EXPECT_FALSE(tape.reads(1));
  EXPECT_FALSE(tape.reads(2));
  EXPECT_TRUE(tape.reads(3));
}

TEST_F(TapeTest, in_place_runs_agree_and_leave_the_inputs) {
  testing::RandomExpressions random(pool, 4);
  for (int i = 0; i < 500; ++i) {
    const std::vector<Expr> outputs{random.next(5), inputs[1], pool.constant(2), random.next(4), random.next(0)};
    const Tape tape(outputs, inputs);
    std::vector<double> scratch(static_cast<std::size_t>(tape.registers()));
    tape.prepare(scratch.data());
    const std::vector<std::int8_t> mode(static_cast<std::size_t>(tape.switches()), 0);
    for (const std::vector<double>& point : points) {
      std::copy(point.begin(), point.end(), scratch.begin());
      const std::vector<double> expected = run(tape, point), g = run_switches(tape, point);
      const auto check = [&] {
        for (std::size_t j = 0; j < expected.size(); ++j)
          ASSERT_TRUE(same_bits(scratch[static_cast<std::size_t>(tape.output_place()) + j], expected[j]));
        for (std::size_t j = 0; j < point.size(); ++j) ASSERT_TRUE(same_bits(scratch[j], point[j]));
      };
      tape.run_prepared(scratch.data());
      check();
      tape.run_prepared_frozen(mode.data(), scratch.data());
      check();
      for (std::size_t j = 0; j < g.size(); ++j)
        ASSERT_TRUE(same_bits(scratch[static_cast<std::size_t>(tape.switch_place()) + j], g[j]));
    }
  }
}

// Arithmetic alone is what becomes machine code: more values alive than there are vector registers, so that some go
// through memory, and with functions in between.
TEST_F(TapeTest, machine_code_has_the_bits_of_the_interpreter) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-2, 2);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  for (int i = 0; i < 300; ++i) {
    std::vector<Expr> known(inputs.begin(), inputs.end());
    known.push_back(pool.constant(0.7));
    constexpr Op two[] = {Op::add, Op::sub, Op::mul, Op::div}, one[] = {Op::neg, Op::sqrt};
    for (int k = 0; k < 90; ++k) {
      const Expr a = known[below(known.size())], b = known[below(known.size())];
      if (i % 3 == 0 && k % 30 == 29)
        known.push_back(pool.apply(Op::tanh, {a}));
      else
        known.push_back(below(8) == 0 ? pool.apply(one[below(2)], {a}) : pool.apply(two[below(4)], {a, b}));
    }
    const std::vector<Expr> outputs(known.end() - 25, known.end());
    const Tape tape(outputs, inputs);
    const auto registers = static_cast<std::size_t>(tape.registers());
    std::vector<double> scratch(registers), memory(registers * Tape::lane_group);
    std::vector<double*> place(registers);
    for (std::size_t r = 0; r < registers; ++r) place[r] = memory.data() + r * Tape::lane_group;
    tape.prepare(scratch.data());
    tape.prepare_lanes(place.data(), Tape::lane_group);
    for (std::size_t k = 0; k < inputs.size(); ++k)
      for (int l = 0; l < Tape::lane_group; ++l) place[k][l] = uniform(random);
    tape.run_lanes(place.data(), Tape::lane_group);
    for (int l = 0; l < Tape::lane_group; ++l) {
      for (std::size_t k = 0; k < inputs.size(); ++k) scratch[k] = place[k][l];
      const std::vector<double> expected = run(tape, {scratch[0], scratch[1], scratch[2], scratch[3]});
      tape.run_prepared(scratch.data());
      for (std::size_t j = 0; j < outputs.size(); ++j) {
        const std::size_t at = static_cast<std::size_t>(tape.output_place()) + j;
        ASSERT_TRUE(same_bits(scratch[at], expected[j])) << to_text(outputs[j]);
        ASSERT_TRUE(same_bits(place[at][l], expected[j])) << to_text(outputs[j]) << " in lane " << l;
      }
#if defined(__x86_64__) && defined(__linux__)
      if (!__builtin_cpu_supports("avx")) continue;
      ASSERT_NE(tape.point_code(), nullptr);
      if (tape.last_written() < 0) continue;
      ASSERT_TRUE(
          same_bits(tape.point_code()(scratch.data()), expected[static_cast<std::size_t>(tape.last_written())]));
#endif
    }
  }
}

TEST_F(TapeTest, frozen_by_the_signs_of_g_is_the_unfrozen_run) {
  testing::RandomExpressions random(pool, 5);
  std::mt19937 noise(6);
  std::uniform_real_distribution<double> uniform(-2, 2);
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::vector<Expr> outputs{random.next(5)};
    const Tape tape(outputs, inputs);
    const std::vector<double> point{uniform(noise), uniform(noise), uniform(noise), uniform(noise)};
    const std::vector<double> g = run_switches(tape, point);
    std::vector<std::int8_t> mode;
    for (const double x : g) mode.push_back(x > 0 ? 1 : x < 0 ? -1 : 0);
    const Frozen frozen = run_frozen(tape, point, mode);
    const double unfrozen = run(tape, point)[0];
    // A frozen sign does not pass on NaN, and an overflowing a - b has no sign: compare where all is finite.
    bool finite = std::isfinite(unfrozen);
    for (const double x : g) finite &= std::isfinite(x);
    if (!finite) continue;
    ++compared;
    ASSERT_TRUE(same_bits(frozen.out[0], unfrozen)) << to_text(outputs[0]);
    for (std::size_t s = 0; s < g.size(); ++s) ASSERT_TRUE(same_bits(frozen.g[s], g[s]));
  }
  EXPECT_GT(compared, 500);
}

TEST_F(TapeTest, switches_and_their_branches) {
  struct Row {
    const char *text, *g;
    double in_plus, in_minus;  // at y = 0.75, v = 0.5, frozen in +1 and in -1
  };
  const Row table[] = {
      {"sign(y)", "y", 1, -1},
      {"abs(y)", "y", 0.75, -0.75},
      {"max(y, v)", "y - v", 0.75, 0.5},
      {"min(y, v)", "y - v", 0.5, 0.75},
      {"where(y > v, 10, 20)", "y - v", 10, 20},
      {"where(y >= v, 10, 20)", "y - v", 10, 20},
      {"where(y < v, 10, 20)", "v - y", 10, 20},
      {"where(y <= v, 10, 20)", "v - y", 10, 20},
      {"where(y*v, 10, 20)", "y*v", 10, 20},
      {"max(y - 1, 0)", "y - 1", -0.25, 0},
  };
  for (const Row& row : table) {
    const Tape t = tape({row.text});
    ASSERT_EQ(switches(t), std::vector<std::string>{row.g}) << row.text;
    const std::vector<double> in{0.75, 0.5, 0, 0};
    EXPECT_EQ(run_frozen(t, in, {1}).out[0], row.in_plus) << row.text;
    EXPECT_EQ(run_frozen(t, in, {-1}).out[0], row.in_minus) << row.text;
    EXPECT_EQ(run_frozen(t, in, {0}).out[0], run(t, in)[0]) << row.text;
    EXPECT_EQ(run_frozen(t, in, {1}).g[0], run_switches(t, in)[0]) << row.text;
  }
}

TEST_F(TapeTest, nodes_with_the_same_g_share_one_switch) {
  EXPECT_EQ(switches(tape({"sign(v)*abs(v)"})), std::vector<std::string>{"v"});
  EXPECT_EQ(switches(tape({"max(y, v) + where(y > v, 1, 2)"})), std::vector<std::string>{"y - v"});
  EXPECT_EQ(switches(tape({"sign(v) + max(y, v)", "abs(v)*min(y, v)"})), (std::vector<std::string>{"v", "y - v"}));
}

TEST_F(TapeTest, a_g_and_its_negative_are_one_switch) {
  const Tape t = tape({"where(y > v, 1, 2)", "where(y < v, 10, 20)", "sign(-y + v)", "sign(-y)", "abs(y)"});
  EXPECT_EQ(switches(t), (std::vector<std::string>{"y - v", "-y + v", "-y"}));
  const Frozen frozen = run_frozen(t, {5, 3, 0, 0}, {-1, 1, 1});
  EXPECT_EQ(frozen.out[0], 2) << "y > v fails";
  EXPECT_EQ(frozen.out[1], 10) << "y < v holds";
  EXPECT_EQ(frozen.out[3], 1);
  EXPECT_EQ(frozen.out[4], -5) << "-y > 0, so abs(y) = -y";
}

TEST_F(TapeTest, more_outputs_keep_the_first_switches) {
  const Expr f = parse(pool, "k*y + c*sign(v) + max(y - k, 0)");
  const std::vector<Expr> few{f}, many{f, derivative(f, inputs[0]), derivative(f, inputs[1]), parse(pool, "abs(y)")};
  const Tape small(few, inputs), large(many, inputs);
  ASSERT_GT(large.switching_functions().size(), small.switching_functions().size());
  for (std::size_t i = 0; i < small.switching_functions().size(); ++i)
    EXPECT_EQ(small.switching_functions()[i], large.switching_functions()[i]);
}

TEST_F(TapeTest, a_constant_g_is_no_switch) {
  EXPECT_EQ(tape({"abs(-3)*y", "max(2, 1)", "where(1 > 0, y, v)"}).switches(), 0);
}

TEST_F(TapeTest, values_on_the_switch) {
  const Tape t = tape({"sign(y)", "abs(y)", "max(y, v)", "where(y > v, 1, 2)", "where(y >= v, 1, 2)",
                       "where(y < v, 1, 2)", "where(y <= v, 1, 2)", "where(y, 1, 2)"});
  EXPECT_EQ(run(t, {0, 0, 0, 0}), (std::vector<double>{0, 0, 0, 2, 1, 2, 1, 2}));
}

TEST_F(TapeTest, nan_goes_through_the_switches) {
  for (const char* text : {"sign(y)", "abs(y)", "max(y, v)", "max(v, y)", "min(y, v)", "min(v, y)",
                           "where(y > v, 1, 2)", "where(v <= y, 1, 2)", "where(y, 1, 2)"})
    EXPECT_TRUE(std::isnan(run(tape({text}), {std::nan(""), 1, 0, 0})[0])) << text;
}

TEST_F(TapeTest, a_branch_that_is_not_taken_does_not_count) {
  EXPECT_EQ(run(tape({"where(y > 0, sqrt(y), 0)"}), {-1, 0, 0, 0})[0], 0);
}

TEST_F(TapeTest, common_subexpressions_and_powers_are_computed_once) {
  EXPECT_EQ(tape({"y*v", "y*v + 1", "y*v - k"}).instructions(), 3);
  EXPECT_EQ(tape({"y", "y^2", "y^3", "y^4", "y^5"}).instructions(), 5) << "a copy and one product each";
  EXPECT_EQ(tape({"k*y + c*v + 3*y^3"}).instructions(), 3) << "two products and their sum, a cube, a product added";
  EXPECT_EQ(tape({"y^16"}).instructions(), 4);
}

TEST_F(TapeTest, registers_are_used_again) {
  Expr f = inputs[0];
  for (int i = 0; i < 1000; ++i) f = pool.apply(Op::sin, {f}) + inputs[1];
  const std::vector<Expr> outputs{f};
  EXPECT_LT(Tape(outputs, inputs).registers(), 10);
}

TEST_F(TapeTest, an_unknown_symbol_is_named) {
  try {
    tape({"k*y + Fc*sign(v)"});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "tape: 'Fc' is not among the inputs (y, v, k, c)");
  }
}

TEST_F(TapeTest, wrong_inputs_and_outputs) {
  const std::vector<Expr> outputs{inputs[0]};
  const auto message = [&](std::vector<Expr> out, std::vector<Expr> in) -> std::string {
    try {
      Tape tape(out, in);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message(outputs, {inputs[0], inputs[0]}), "tape: the input 'y' is given twice");
  EXPECT_EQ(message(outputs, {inputs[0], 2.0 * inputs[0]}), "tape: an input is not a symbol");
  EXPECT_EQ(message({Expr()}, inputs), "tape: an output is empty");
  const double* in[] = {nullptr};
  const int stride[] = {1};
  try {
    Tape(outputs, inputs).run_columns(in, stride, 5, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "tape: expected 4 columns in and 1 out, got 1 and 0");
  }
}

TEST_F(TapeTest, empty_tapes) {
  EXPECT_EQ(Tape().outputs(), 0);
  EXPECT_TRUE(Tape().switching_functions().empty());
  const std::vector<Expr> none;
  const Tape nothing(none, none);
  nothing.run_point(nullptr, nullptr, nullptr);
  nothing.run_columns({}, {}, 300, {});
  const std::vector<Expr> outputs{pool.constant(2)};
  const Tape constant(outputs, {});
  EXPECT_EQ(run(constant, {})[0], 2);
  std::vector<double> column(300);
  double* out[] = {column.data()};
  constant.run_columns({}, {}, 300, out);
  EXPECT_EQ(column[0] + column[299], 4);
  double x = 0;
  out[0] = &x;
  constant.run_columns({}, {}, 0, out);
  EXPECT_EQ(x, 0);
}

/// 10^5 nodes deep: everything but the nesting of a typed text must cope.
TEST_F(TapeTest, very_deep_expressions) {
  constexpr int depth = 100000;
  const Expr y = inputs[0], v = inputs[1];
  Expr f = y;
  for (int i = 0; i < depth; ++i) f = i % 2 ? f + v : pool.apply(Op::tanh, {f});
  EXPECT_EQ(symbols(f).size(), 2u);
  const std::vector<Expr> outputs{f, derivative(f, y)};
  const Tape tape(outputs, inputs);
  EXPECT_TRUE(std::isfinite(run(tape, {0.1, 0.2, 0, 0})[0]));
  const std::pair<Expr, Expr> swap[] = {{y, v}};
  EXPECT_FALSE(depends_on(substitute(f, swap), y));
  EXPECT_GT(to_text(f).size(), 5u * depth);
}

TEST_F(TapeTest, very_long_typed_sums_and_products) {
  std::string sum = "y", product = "y";
  for (int i = 0; i < 50000; ++i) sum += i % 2 ? " + y" : " - v", product += "*v";
  for (const std::string& text : {sum, product}) {
    const Expr f = parse(pool, text);
    EXPECT_EQ(to_text(f), text);
    const std::vector<Expr> outputs{f, -f};
    const std::vector<double> out = run(Tape(outputs, inputs), {1, 1, 0, 0});
    EXPECT_EQ(out[0], 1);
    EXPECT_EQ(out[1], -1);
  }
}

}  // namespace
}  // namespace lunid
