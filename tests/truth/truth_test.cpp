// The generator itself against closed forms: only then may it judge anything else.
#include "truth/truth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "truth/chain.hpp"
#include "truth/faults.hpp"
#include "truth/noise.hpp"

namespace truth {
namespace {

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(Oscillator, linear_free_decay_follows_the_closed_form) {
  Physics physics;
  physics.zeta = 0.05;
  const Motion motion = integrate(physics, none(), 0, {1, 0, 0}, 2000, 0.05, 8);
  const double damped = std::sqrt(1 - 0.05 * 0.05);
  for (int i = 0; i < 2000; ++i) {
    const double tau = 0.05 * i;
    const double exact = std::exp(-0.05 * tau) * (std::cos(damped * tau) + 0.05 / damped * std::sin(damped * tau));
    ASSERT_NEAR(motion.x[i], exact, 1e-9) << "tau " << tau;  // RK4 at h = 0.006: h^4 tau / 120 is 1e-9
  }
}

TEST(Oscillator, coulomb_decay_loses_twice_the_dead_band_per_half_cycle_and_stops) {
  // Lorenz 1924: without viscous damping, peaks fall by 2 mu per half cycle; at rest within |x| <= mu it
  // stays.
  Physics physics;
  physics.zeta = 0;
  physics.coulomb = 0.3;
  const Motion motion = integrate(physics, none(), 0, {2, 0, 0}, 401, M_PI / 40, 16);
  for (int half = 0; half <= 3; ++half) {
    const double peak = (half % 2 ? -1 : 1) * (2 - 0.6 * half);
    EXPECT_NEAR(motion.x[40 * half], peak, 1e-9) << "half cycle " << half;
  }
  EXPECT_NEAR(motion.x.back(), -0.2, 1e-9);  // 2 - 3 * 0.6 = 0.2 < 0.3: held
  EXPECT_EQ(motion.v.back(), 0);
  EXPECT_NEAR(motion.stuck, M_PI / 40 * 400 - 3 * M_PI, 1e-6);
}

TEST(Oscillator, friction_holds_until_the_force_exceeds_it) {
  Physics physics;
  physics.coulomb = 0.5;
  const Signal ramp = [](double tau) { return 0.1 * tau; };
  const Motion motion = integrate(physics, ramp, 1, {}, 101, 0.1, 8);
  for (int i = 0; i <= 50; ++i) ASSERT_EQ(motion.x[i], 0) << "row " << i;
  EXPECT_GT(motion.x[60], 0);
  EXPECT_NEAR(motion.stuck, 5, 1e-9);  // slips at 0.1 tau = 0.5
}

TEST(Oscillator, stops_keep_the_energy) {
  Physics physics;
  physics.zeta = 0;
  physics.stop_k = 2, physics.stop_gap = 0.4;
  physics.clearance_k = 3, physics.clearance_gap = 0.6;
  const Motion motion = integrate(physics, none(), 0, {1, 0, 0}, 2000, 0.1, 40);
  const auto energy = [](double x, double v) {
    const double stop = std::max(x - 0.4, 0.0), gap = std::max(std::abs(x) - 0.6, 0.0);
    return 0.5 * (v * v + x * x + 2 * stop * stop + 3 * gap * gap);
  };
  for (int i = 0; i < 2000; ++i) {
    ASSERT_NEAR(energy(motion.x[i], motion.v[i]), energy(1, 0), 1e-7) << "row " << i;  // RK4 drift at h = 0.0025
  }
}

TEST(Oscillator, bouc_wen_saturates_at_its_limit) {
  Physics physics;
  physics.bouc_k = 0.5, physics.bouc_beta = 0.7, physics.bouc_gamma = 0.3;
  const Motion motion = integrate(
      physics, [](double tau) { return std::sin(0.3 * tau); }, 8, {}, 4000, 0.05, 8);
  const auto [low, high] = std::minmax_element(motion.hidden.begin(), motion.hidden.end());
  EXPECT_NEAR(*high, 0.5, 1e-3);  // k / (beta + gamma), approached as exp(-x), x > 7 here
  EXPECT_NEAR(*low, -0.5, 1e-3);
}

TEST(Cases, halving_the_step_changes_nothing_that_noise_could_hide) {
  const Signal signal = multisine(0.15, 2.2, 40, 3);
  for (const Case& each : cases()) {
    if (each.kind == Kind::null || each.physics.law) continue;
    const Motion coarse = integrate(each.physics, signal, 0.05, {}, 800, 2 * M_PI / 40, 24);
    const Motion fine = integrate(each.physics, signal, 0.05, {}, 800, 2 * M_PI / 40, 48);
    EXPECT_LT(largest_difference(coarse.x, fine.x), 1e-6) << each.name;  // 40 dB of noise is 1e-2 of the motion
  }
}

/// A law steps over its kinks: its error is that of the step in which one falls, and more where its force jumps.
TEST(Cases, halving_the_step_of_a_law_changes_less_than_the_noise) {
  const Signal signal = multisine(0.15, 2.2, 40, 3);
  for (const Case& each : cases()) {
    if (!each.physics.law) continue;
    const Motion coarse = integrate(each.physics, signal, 0.05, {}, 300, 2 * M_PI / 40, 12);
    const Motion fine = integrate(each.physics, signal, 0.05, {}, 300, 2 * M_PI / 40, 24);
    EXPECT_LT(largest_difference(coarse.x, fine.x), each.physics.law->jump ? 5e-3 : 5e-4) << each.name;
  }
}

/// Laws against closed forms in slow, prescribed motion x = 2 sin(tau): what they are there for.
/// Work of one period of x = centre + 2 sin(tau), the last of so many; the states then.
struct Loop {
  double work = 0, largest = 0;  ///< force
  std::vector<double> states;
};
Loop loop_of(const Law& law, double centre = 0, int periods = 2) {
  std::vector<double> z(std::max(1, law.states), 0.0), rate(z.size());
  std::copy(law.start.begin(), law.start.end(), z.begin());
  const int steps = 40000;
  const double h = 2 * M_PI / steps;
  Loop out;
  for (int i = 0; i < periods * steps; ++i) {
    const double tau = i * h, x = centre + 2 * std::sin(tau), v = 2 * std::cos(tau);
    if (i >= (periods - 1) * steps) {
      const double force = law.force(tau, x, v, z.data());
      out.work += force * v * h;
      out.largest = std::max(out.largest, force);
    }
    if (!law.rate) continue;
    law.rate(tau, x, v, z.data(), rate.data());
    if (law.shaken) law.shaken(-2 * std::sin(tau), rate.data());
    for (int k = 0; k < law.states; ++k) z[k] += h * rate[k];
    if (law.settle) law.settle(centre + 2 * std::sin(tau + h), 2 * std::cos(tau + h), z.data());
  }
  out.states = z;
  return out;
}

TEST(Laws, dissipate_what_their_loops_enclose) {
  const auto loop = [](const Law& law) { return loop_of(law).work; };
  // Elastic slip between -2 and 2: 4 Fs (2 - Fs/k).
  EXPECT_NEAR(loop(laws::slip(1, [](double, double, double) { return 0.35; })), 4 * 0.35 * (2 - 0.35), 1e-3);
  EXPECT_NEAR(loop(laws::quake(0.3, [](double z, double, double) { return 0.25 * z; })), 4 * 0.25 * (2 - 0.3), 1e-3);
  // Maxwell: pi A^2 k w tau / (1 + (w tau)^2).
  EXPECT_NEAR(loop(laws::maxwell(0.5, 1)), M_PI * 4 * 0.5 / 2, 2e-2);  // the first period's transient is nearly gone
  // c D^p x: pi A^2 c w^p sin(pi p / 2), in steady state.
  EXPECT_NEAR(loop(laws::fractional(0.25, 0.5)), M_PI * 4 * 0.25 * std::sin(M_PI / 4), 0.08);
  // Masing: 8 times the area under the backbone less 4 times its triangle (Masing 1926).
  const auto backbone = [](double x) { return x / (1 + std::abs(x) / 0.5); };
  const double under = 0.5 * (2 - 0.5 * std::log(1 + 2 / 0.5)), triangle = 0.5 * 2 * backbone(2);
  EXPECT_NEAR(loop(laws::masing(backbone, 60)), 8 * (under - triangle), 0.02);
}

TEST(Laws, of_slip_have_the_limit_that_depth_and_shaking_give_them) {
  const auto slipped = [](double limit) { return 4 * limit * (2 - limit / 2); };  // k = 2
  // The slow part of the motion is its centre; what it ripples by, a fortieth of it, is taken from one half of the
  // loop and given to the other.
  EXPECT_NEAR(loop_of(laws::depth(2, 0.35, 0.5, 40), 0.6, 60).work, slipped(0.35 + 0.5 * 0.6), 2e-2);
  EXPECT_NEAR(loop_of(laws::depth(2, 0.35, 0.5, 40), -0.8, 60).work, 0, 2e-2);  // nothing holds it there
  // An acceleration of amplitude 2; its mean square ripples by a part in 80.
  EXPECT_NEAR(loop_of(laws::liquefaction(2, 0.9, 0.1, 1.6, 40), 0, 60).work, slipped(0.1 + 0.8 * std::exp(-2 / 1.6)),
              1e-2);
}

TEST(Laws, of_pinching_are_bouc_wen_when_new_and_weaker_softer_and_pinched_when_worn) {
  // beta = gamma, n = 1: unloads along a straight line, then z = -zy (1 - exp(-s/zy)) over the path s.
  const double zy = 0.6, most = zy * (1 - std::exp(-(4 - zy) / zy));
  EXPECT_NEAR(loop_of(laws::pinching({1, zy, 0.5, 1})).work, 2 * (zy * (4 - most - most) - most * most / 2), 1e-3);
  laws::Wear wear{1, zy, 0.5, 1};
  wear.weaker = 0.01;
  const Loop weak = loop_of(laws::pinching(wear), 0, 8);
  EXPECT_GT(weak.states[1], 40);                                           // that much energy
  EXPECT_NEAR(weak.largest, zy / (1 + 0.01 * weak.states[1]), 0.05 * zy);  // of the last period, while it falls
  wear.weaker = 0, wear.softer = 0.02, wear.pinched = 0.5, wear.p = 0.3;
  const Law worn = laws::pinching(wear);
  const double energy = 10, z[] = {0, energy};
  double rate[2];
  worn.rate(0, 0, 1.5, z, rate);
  EXPECT_NEAR(rate[0], 1.5 * (1 - 0.5 * (1 - std::exp(-0.3 * energy))) / (1 + 0.02 * energy), 1e-12);
}

TEST(Laws, side_by_side_add_their_forces_and_keep_their_states) {
  const Law slip = laws::slip(1, [](double, double, double) { return 0.35; }), soft = laws::maxwell(0.5, 1);
  EXPECT_NEAR(loop_of(laws::both(slip, soft)).work, loop_of(slip).work + loop_of(soft).work, 1e-9);
  EXPECT_NEAR(loop_of(laws::both(soft, slip)).work, loop_of(slip).work + loop_of(soft).work, 1e-9);
}

/// What a tie rests on: the two are one motion, to what the noise of the record hides.
TEST(Cases, a_mean_force_and_an_offset_are_one_on_a_linear_oscillator) {
  const Scale& scale = scale_named("milli");
  const RecordOptions options{.rows = 600, .substeps = 8};
  const Records pushed = make_records(case_named("tie_mean"), scale, options);
  const Columns still = make_record(Physics{}, scale, multisine(0.15, 2.2, 40, options.seed), 1.0, options);
  double apart = 0;
  for (int i = 0; i < options.rows; ++i)
    apart = std::max(apart, std::abs(pushed.train.clean_y[i] - (still.clean_y[i] - 0.3 * scale.length)));
  EXPECT_LT(apart, 0.05 * scale.length);  // the start at rest is 0.3 of it beside the mean, and e^(-0.03 * 60) is left
}

TEST(Faults, are_as_large_beside_any_excitation) {
  const Scale& scale = scale_named("milli");
  const auto hidden = [&](Excited excited) {
    RecordOptions options{.rows = 250, .noise_db = 200, .force_noise_db = 200, .substeps = 8};
    options.excited = excited;
    const FaultyRecords records = make_faulty(fault_named("base_motion"), scale, options);
    std::vector<double> sizes{deviation(records.train.extra), deviation(records.test.extra)};
    for (const FaultyColumns& more : records.more) sizes.push_back(deviation(more.extra));
    return sizes;
  };
  for (const Excited excited : {Excited::noise, Excited::tones}) {
    const std::vector<double> sizes = hidden(excited);
    EXPECT_EQ(sizes.size(), excited == Excited::tones ? 3u : 2u);
    // Twelve lines beat over so short a record; beside a tone the size would else be a sixth, beside noise 2.7 times.
    for (const double size : sizes) EXPECT_NEAR(size / sizes[0], 1, 0.5) << to_string(excited);
  }
}

TEST(Cases, the_hidden_effect_carries_a_tenth_to_four_tenths_of_the_restoring_force) {
  for (const Case& each : cases()) {
    if (each.kind == Kind::null) continue;
    const Records records = make_records(each, scale_named("milli"), {.rows = 1500, .substeps = 4});
    if (each.name == "linear_stiffness") continue;  // it carries all
    EXPECT_GT(records.train.hidden_share, each.physics.law ? 0.05 : 0.1) << each.name;
    EXPECT_LT(records.train.hidden_share, each.physics.law ? 0.6 : 0.4) << each.name;
    EXPECT_LT(records.train.stuck_share, 0.1) << each.name;
  }
}

TEST(Records, carry_the_stated_noise_and_repeat_by_seed) {
  const RecordOptions options{.rows = 4000, .noise_db = 30, .seed = 5, .substeps = 8};
  const Columns one = make_records(case_named("null_linear"), scale_named("micro"), options).train;
  const Columns two = make_records(case_named("null_linear"), scale_named("micro"), options).train;
  EXPECT_EQ(one.y, two.y);
  double noise = 0, signal = 0;
  for (std::size_t i = 0; i < one.y.size(); ++i) {
    noise += (one.y[i] - one.clean_y[i]) * (one.y[i] - one.clean_y[i]);
    signal += one.clean_y[i] * one.clean_y[i];
  }
  EXPECT_NEAR(10 * std::log10(signal / noise), 30,
              0.5);  // 4000 samples: 0.1 dB; the motion's mean adds a little
}

TEST(Records, scale_with_mass_length_and_time) {
  const RecordOptions options{.rows = 500, .substeps = 8};
  const Scale base{"base", 1, 1 / (2 * M_PI), 1, 40}, other{"other", 3, 2 / (2 * M_PI), 5, 40};
  const Columns a = make_record(Physics{}, base, step(70), 1, options);
  const Columns b = make_record(Physics{}, other, step(70), 1, options);
  EXPECT_NEAR(b.t[7], a.t[7] / 2, 1e-12);
  EXPECT_NEAR(b.clean_y[400], 5 * a.clean_y[400], 1e-9);
  EXPECT_NEAR(b.clean_F[400], 60 * a.clean_F[400], 1e-9);  // m omega^2 L = 3 * 4 * 5
}

// ---- several masses, against the oscillator ----

constexpr int chain_rows = 800;
constexpr double chain_spacing = 0.1;

Chain one_mass() {
  Chain chain = in_a_row({1}, 1, 0.06);
  chain.links[0].k3 = 0.2;
  chain.links[0].coulomb = 0.3;
  return chain;
}

TEST(Chain, of_one_mass_is_the_oscillator_sticking_included) {
  Physics physics;
  physics.k3 = 0.2;
  physics.coulomb = 0.3;
  const Signal signal = multisine(0.2, 1.5, 10, 3);
  const Motion expected = integrate(physics, signal, 0.15, {}, chain_rows, chain_spacing, 16);
  const ChainMotion motion = integrate(one_mass(), {signal}, 0.15, 0, chain_rows, chain_spacing, 16);
  EXPECT_GT(expected.stuck, 0.05 * chain_rows * chain_spacing);
  EXPECT_LT(largest_difference(motion.x[0], expected.x), 1e-4);  // of 1: sticking is looked at once in a step
}

TEST(Chain, of_two_masses_that_cannot_slide_apart_moves_as_one) {
  Chain chain;
  chain.masses = {0.5, 0.5};
  chain.links = {one_mass().links[0], {}};
  chain.links[1].of = 1;
  chain.links[1].from = 0;
  chain.links[1].coulomb = 100;
  Physics physics;
  physics.k3 = 0.2;
  physics.coulomb = 0.3;
  const Signal signal = multisine(0.2, 1.5, 10, 3);
  const Motion expected = integrate(physics, signal, 0.15, {}, chain_rows, chain_spacing, 16);
  const ChainMotion motion = integrate(chain, {signal}, 0.15, 0, chain_rows, chain_spacing, 16);
  EXPECT_LT(largest_difference(motion.x[0], motion.x[1]), 1e-9);
  EXPECT_LT(largest_difference(motion.x[0], expected.x), 1e-4);
}

// Driven alike between two walls, equal masses move alike, and the joint does nothing.
TEST(Chain, of_equal_masses_driven_alike_is_the_oscillator_whatever_the_joint) {
  Chain chain = in_a_row({1, 1}, 1, 0.06, true);
  chain.driven = {0, 1};
  chain.links[1].k3 = 3;
  chain.links[1].maxwell_k = 2;
  chain.links[1].maxwell = 0.5;
  chain.links[1].bouc_k = 1;
  const Signal signal = multisine(0.2, 1.5, 10, 3);
  const Motion expected = integrate({}, signal, 0.15, {}, chain_rows, chain_spacing, 16);
  const ChainMotion motion = integrate(chain, {signal, signal}, 0.15, 0, chain_rows, chain_spacing, 16);
  EXPECT_LT(largest_difference(motion.x[0], expected.x), 1e-8);
  EXPECT_LT(largest_difference(motion.x[1], expected.x), 1e-8);
}

}  // namespace
}  // namespace truth
