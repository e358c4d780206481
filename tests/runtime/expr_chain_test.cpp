// Chains of tapes: the bits of the parts run one after another, also in a frozen mode and in lanes.
#include "expr/chain.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "expr_random.hpp"

namespace lunid {
namespace {

bool same_bits(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

class Chain : public ::testing::Test {
 protected:
  std::vector<double> point(const Tape& tape, const std::vector<double>& in) const {
    std::vector<double> out(static_cast<std::size_t>(tape.outputs())),
        scratch(static_cast<std::size_t>(tape.registers()) + 1);
    tape.run_point(in.data(), out.data(), scratch.data());
    return out;
  }
  Pool pool;
  std::vector<Expr> inputs{pool.channel("y"), pool.channel("v"), pool.parameter("k"), pool.parameter("c")};
};

TEST_F(Chain, HasTheBitsOfItsPartsOneAfterAnother) {
  testing::RandomExpressions random(pool, 21);
  std::mt19937 noise(22);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (int i = 0; i < 200; ++i) {
    const std::vector<Expr> first{random.next(4), random.next(3)}, second{random.next(4)};
    const Tape a(first, inputs), b(second, inputs);
    TapeChain chain(4);
    const std::vector<TapeChain::Number> in{0, 1, 2, 3};
    const auto x = chain.run(a, in).outputs;
    const TapeChain::Number moved = chain.sum(x[0], chain.product(chain.constant(0.3), x[1]));
    const TapeChain::Number inner[] = {moved, chain.negative(x[1]), 2, chain.difference(x[0], 3)};
    const TapeChain::Number outputs[] = {chain.run(b, inner).outputs[0], moved};
    const Tape whole = chain.tape(outputs);
    const std::vector<double> at{uniform(noise), uniform(noise), uniform(noise), uniform(noise)};
    const std::vector<double> one = point(a, at);
    const double middle = one[0] + 0.3 * one[1];
    const std::vector<double> two = point(b, {middle, -one[1], at[2], one[0] - at[3]}), both = point(whole, at);
    EXPECT_TRUE(same_bits(both[1], middle)) << to_text(first[0]);
    EXPECT_TRUE(same_bits(both[0], two[0])) << to_text(second[0]);
  }
}

TEST_F(Chain, FreezesSwitchesByModesThatAreValues) {
  testing::RandomExpressions random(pool, 23);
  std::mt19937 noise(24);
  std::uniform_real_distribution<double> uniform(-2, 2);
  int switches = 0;
  for (int i = 0; i < 600; ++i) {
    const std::vector<Expr> outputs{random.next(5)};
    const Tape tape(outputs, inputs);
    const int count = tape.switches();
    if (count == 0) continue;
    switches += count;
    TapeChain chain(4 + count);
    std::vector<TapeChain::Number> modes;
    for (int s = 0; s < count; ++s) modes.push_back(chain.input(4 + s));
    const std::vector<TapeChain::Number> in{0, 1, 2, 3};
    const TapeChain::Run run = chain.run(tape, in, modes);
    std::vector<TapeChain::Number> all = run.outputs;
    all.insert(all.end(), run.switches.begin(), run.switches.end());
    const Tape frozen = chain.tape(all);
    EXPECT_EQ(frozen.switches(), 0);

    constexpr int lanes = Tape::lane_group;
    const auto registers = static_cast<std::size_t>(frozen.registers() + 1);
    std::vector<double> memory(registers * 72);
    std::vector<double*> place(registers);
    for (std::size_t r = 0; r < registers; ++r) place[r] = memory.data() + 72 * r;
    frozen.prepare_lanes(place.data(), lanes);
    for (int l = 0; l < lanes; ++l) {
      for (int k = 0; k < 4; ++k) place[static_cast<std::size_t>(k)][l] = uniform(noise);
      for (int s = 0; s < count; ++s) place[static_cast<std::size_t>(4 + s)][l] = uniform(noise) > 0 ? 1 : -1;
    }
    frozen.run_lanes(place.data(), lanes);
    for (int l = 0; l < lanes; ++l) {
      std::vector<double> at, expected(1), g(static_cast<std::size_t>(count));
      std::vector<double> scratch(static_cast<std::size_t>(tape.registers()) + 1);
      std::vector<std::int8_t> mode;
      for (int k = 0; k < 4; ++k) at.push_back(place[static_cast<std::size_t>(k)][l]);
      for (int s = 0; s < count; ++s)
        mode.push_back(static_cast<std::int8_t>(place[static_cast<std::size_t>(4 + s)][l]));
      tape.run_frozen(at.data(), mode.data(), expected.data(), g.data(), scratch.data());
      const auto out = static_cast<std::size_t>(frozen.output_place());
      ASSERT_TRUE(same_bits(place[out][l], expected[0])) << to_text(outputs[0]) << " in lane " << l;
      for (std::size_t s = 0; s < g.size(); ++s)
        ASSERT_TRUE(same_bits(place[out + 1 + s][l], g[s])) << to_text(outputs[0]) << " switch " << s;
    }
  }
  EXPECT_GT(switches, 300);
}

}  // namespace
}  // namespace lunid
