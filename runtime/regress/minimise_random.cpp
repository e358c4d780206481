// The random searches that NLopt has not. Random numbers are counted: the same seed gives the same bits.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "record/random.hpp"
#include "regress/minimise.hpp"

namespace lunid::detail {
namespace {

using Point = std::vector<double>;

/// Back into the box, as off a mirror.
double reflected(double x) {
  x = std::fmod(std::abs(x), 2.0);
  return x > 1 ? 2 - x : x;
}

Point uniform_point(int size, Philox& random) {
  Point x(static_cast<std::size_t>(size));
  for (double& value : x) value = random.uniform();
  return x;
}

void keep(Minimum& best, const Point& x, double value) {
  if (value < best.value) best = {x, value};
}

}  // namespace

/// Metropolis steps from the best of a few probes, at a temperature that falls from the spread of the probes' values to
/// 1e-4 of it. Steps have Cauchy's distribution, whose long ones leave a minimum (Szu & Hartley 1987); their length
/// follows the temperature, so that about a third of them are taken.
Minimum anneal(const Objective& objective, const Point& start, const SearchOptions& options) {
  Philox random(options.seed, stream_of("annealing"));
  Point x = start;
  double value = objective.value(x.data(), nullptr), mean = 0, squares = 0;
  Minimum best{x, value};
  const int probes = std::max(3, options.evaluations / 10);
  for (int k = 1; k <= probes; ++k) {
    const Point at = uniform_point(objective.size, random);
    const double found = objective.value(at.data(), nullptr), change = found - mean;
    mean += change / k;
    squares += change * (found - mean);
    keep(best, at, found);
  }
  const double hot = std::sqrt(squares / probes);
  x = best.x;
  value = best.value;
  const int steps = options.evaluations - probes - 1;
  double length = 0.5;
  for (int k = 0; k < steps; ++k) {
    const double temperature = hot * std::pow(1e-4, static_cast<double>(k) / steps);
    Point next = x;
    for (double& part : next) part = reflected(part + length * std::tan(std::numbers::pi * (random.uniform() - 0.5)));
    const double found = objective.value(next.data(), nullptr);
    keep(best, next, found);
    const bool taken = found <= value || random.uniform() < std::exp((value - found) / temperature);
    length = std::clamp(length * (taken ? 1.1 : 0.95), 1e-4, 0.5);
    if (!taken) continue;
    x = std::move(next);
    value = found;
  }
  return best;
}

Minimum swarm(const Objective& objective, const Point& start, const SearchOptions& options) {
  constexpr double inertia = 0.7298, pull = 1.49618;  // Clerc & Kennedy 2002
  struct Particle {
    Point x, velocity;
    Minimum own;
  };
  Philox random(options.seed, stream_of("particle swarm"));
  const int count = std::min(10 + 2 * static_cast<int>(std::sqrt(objective.size)), options.evaluations);
  std::vector<Particle> particles;
  Minimum best;
  for (int k = 0; k < count; ++k) {
    Particle p{k == 0 ? start : uniform_point(objective.size, random), uniform_point(objective.size, random), {}};
    for (std::size_t i = 0; i < p.x.size(); ++i) p.velocity[i] = 0.5 * (p.velocity[i] - p.x[i]);
    p.own = {p.x, objective.value(p.x.data(), nullptr)};
    if (k == 0 || p.own.value < best.value) best = p.own;
    particles.push_back(std::move(p));
  }
  for (int k = count; k < options.evaluations; ++k) {
    Particle& p = particles[static_cast<std::size_t>(k % count)];
    for (std::size_t i = 0; i < p.x.size(); ++i) {
      p.velocity[i] = inertia * p.velocity[i] + pull * random.uniform() * (p.own.x[i] - p.x[i]) +
                      pull * random.uniform() * (best.x[i] - p.x[i]);
      const double free = p.x[i] + p.velocity[i];
      p.x[i] = std::clamp(free, 0.0, 1.0);
      if (p.x[i] != free) p.velocity[i] = 0;
    }
    const double value = objective.value(p.x.data(), nullptr);
    keep(p.own, p.x, value);
    keep(best, p.x, value);
  }
  return best;
}

/// The thesis (appendix I): p + jump * rand(-1, 1), its bounds applied again; each jump is followed by a descent. Jumps
/// from a minimum that stays the best grow, so that a wide puddle is left too.
Minimum jump_puddles(const Objective& objective, const Point& start, const SearchOptions& options) {
  Philox random(options.seed, stream_of("puddle jumping"));
  int used = 0;
  Objective counted = objective;
  counted.value = [&](const double* x, double* gradient) {
    ++used;
    return objective.value(x, gradient);
  };
  Minimum best = descend(counted, start);
  double jump = 0.1;
  while (used < options.evaluations) {
    Point x = best.x;
    for (double& part : x) part = std::clamp(part + jump * (2 * random.uniform() - 1), 0.0, 1.0);
    Minimum found = descend(counted, x);
    const bool lower = found.value < best.value * (1 - 1e-9);
    jump = lower ? 0.1 : std::min(1.0, 1.25 * jump);
    if (lower) best = std::move(found);
  }
  return best;
}

Minimum scatter(const Objective& objective, const Point& start, const SearchOptions& options) {
  Philox random(options.seed, stream_of("monte carlo"));
  Minimum best{start, objective.value(start.data(), nullptr)};
  for (int k = 1; k < options.evaluations; ++k) {
    const Point x = uniform_point(objective.size, random);
    keep(best, x, objective.value(x.data(), nullptr));
  }
  return best;
}

/// Steps against the gradient of one block of time, each parameter's over its own running size (Tieleman & Hinton
/// 2012), their length falling as 1/sqrt(step) (Robbins & Monro 1951).
Minimum drift(const Objective& objective, const Point& start, const SearchOptions& options) {
  constexpr double first_step = 0.1, memory = 0.9;
  Philox random(options.seed, stream_of("stochastic gradient"));
  Point x = start, gradient(x.size()), squares(x.size(), 0);
  Minimum best{x, objective.value(x.data(), nullptr)};
  const int steps = options.evaluations * objective.blocks;
  for (int k = 0; k < steps; ++k) {
    const auto block = static_cast<int>(random.below(static_cast<std::uint64_t>(objective.blocks)));
    objective.part(x.data(), gradient.data(), block);
    for (std::size_t i = 0; i < x.size(); ++i) {
      squares[i] = k == 0 ? gradient[i] * gradient[i] : memory * squares[i] + (1 - memory) * gradient[i] * gradient[i];
      if (squares[i] > 0) x[i] -= first_step / std::sqrt(1.0 + k) * gradient[i] / std::sqrt(squares[i]);
      x[i] = std::clamp(x[i], 0.0, 1.0);
    }
    if ((k + 1) % (10 * objective.blocks) == 0 || k + 1 == steps) keep(best, x, objective.value(x.data(), nullptr));
  }
  return best;
}

}  // namespace lunid::detail
