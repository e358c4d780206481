#include "truth/oscillator.hpp"

#include <algorithm>
#include <cmath>

namespace truth {
namespace {

/// The branch that every non-smooth term is on. sliding: sign of v, 0 while stuck.
struct Mode {
  int sliding = 1;
  int stop = 0;       // 1 while the stop is touched
  int clearance = 0;  // -1, 0, +1: which side of the clearance is touched
  int z_sign = 1;
};

constexpr int guard_count = 5;
using Guards = std::array<double, guard_count>;

class Integrator {
 public:
  Integrator(const Physics& physics, const Signal& signal, double level)
      : p_(physics), signal_(signal), level_(level) {}

  void enter(double tau, const State& s) {
    mode_.stop = s.x > p_.stop_gap;
    mode_.clearance = s.x > p_.clearance_gap ? 1 : s.x < -p_.clearance_gap ? -1 : 0;
    mode_.z_sign = s.z < 0 ? -1 : 1;
    if (s.v != 0) {
      mode_.sliding = s.v > 0 ? 1 : -1;
    } else {
      leave_rest(tau, s);
    }
  }

  /// Steps by h, split at the ends of modes.
  void advance(double tau, State& s, double h) {
    double left = h;
    for (int split = 0; left > 0; ++split) {
      const Guards before = guards(tau, s);
      State end = step(tau, s, left);
      int crossed = first_crossing(before, guards(tau + left, end));
      if (crossed < 0 || split == 50) {
        count_stuck(left);
        s = end;
        return;
      }
      double low = 0, high = left;  // the earliest crossing lies in (low, high]
      while (high - low > 1e-13 * h) {
        const double middle = 0.5 * (low + high);
        const int found = first_crossing(before, guards(tau + middle, step(tau, s, middle)));
        if (found >= 0) {
          high = middle;
          crossed = found;
        } else {
          low = middle;
        }
      }
      s = step(tau, s, high);
      tau += high;
      left -= high;
      count_stuck(high);
      change_mode(tau, s, crossed);
      ++events;
    }
  }

  /// Force of all hidden effects.
  double hidden(double tau, const State& s) const {
    if (p_.coulomb == 0) return frictionless(s);
    return mode_.sliding ? frictionless(s) + p_.coulomb * mode_.sliding : level_ * signal_(tau) - linear(s);
  }
  double linear(const State& s) const { return 2 * p_.zeta * s.v + p_.k * s.x; }

  long events = 0;
  double stuck = 0;

 private:
  /// The hidden effects without Coulomb friction.
  double frictionless(const State& s) const {
    double f = p_.constant + (p_.k2 + p_.k3 * s.x) * s.x * s.x + (p_.viscous + p_.drag * mode_.sliding * s.v) * s.v;
    if (mode_.stop) f += p_.stop_k * (s.x - p_.stop_gap);
    if (mode_.clearance) f += p_.clearance_k * (s.x - mode_.clearance * p_.clearance_gap);
    if (p_.bouc_k != 0) f += p_.bouc_k * s.z;
    if (p_.other) f += p_.other(s.x, s.v);
    return f;
  }
  /// What would accelerate the mass if there were no Coulomb friction.
  double drive(double tau, const State& s) const { return level_ * signal_(tau) - linear(s) - frictionless(s); }

  State rate(double tau, const State& s) const {
    if (mode_.sliding == 0) return {0, 0, 0};
    const double dz =
        p_.bouc_k == 0 ? 0 : s.v - s.z * s.v * (p_.bouc_beta * mode_.sliding + p_.bouc_gamma * mode_.z_sign);
    return {s.v, drive(tau, s) - p_.coulomb * mode_.sliding, dz};
  }

  State step(double tau, const State& s, double h) const {
    const auto at = [&s](const State& k, double by) { return State{s.x + by * k.x, s.v + by * k.v, s.z + by * k.z}; };
    const State k1 = rate(tau, s), k2 = rate(tau + h / 2, at(k1, h / 2)), k3 = rate(tau + h / 2, at(k2, h / 2)),
                k4 = rate(tau + h, at(k3, h));
    const auto sum = [h](double a, double b, double c, double d) { return h / 6 * (a + 2 * b + 2 * c + d); };
    return {s.x + sum(k1.x, k2.x, k3.x, k4.x), s.v + sum(k1.v, k2.v, k3.v, k4.v), s.z + sum(k1.z, k2.z, k3.z, k4.z)};
  }

  /// Positive within the mode; a guard that falls below zero ends it. Absent terms have a guard that stays
  /// at 1.
  Guards guards(double tau, const State& s) const {
    Guards g;
    g.fill(1);
    g[0] = mode_.sliding ? mode_.sliding * s.v : p_.coulomb - std::abs(drive(tau, s));
    if (p_.stop_k != 0) g[1] = mode_.stop ? s.x - p_.stop_gap : p_.stop_gap - s.x;
    if (p_.clearance_k != 0) {
      g[2] = mode_.clearance > 0 ? s.x - p_.clearance_gap : p_.clearance_gap - s.x;
      g[3] = mode_.clearance < 0 ? -p_.clearance_gap - s.x : s.x + p_.clearance_gap;
    }
    if (p_.bouc_k != 0) g[4] = mode_.z_sign * s.z;
    return g;
  }

  /// A guard counts where it is negative at the end; one that starts at (or, by rounding, below) zero just
  /// after its own event must also have fallen further, or the event would be found again.
  static int first_crossing(const Guards& before, const Guards& after) {
    for (int i = 0; i < guard_count; ++i) {
      if (after[i] < 0 && after[i] < before[i]) return i;
    }
    return -1;
  }

  void change_mode(double tau, State& s, int guard) {
    switch (guard) {
      case 0:
        if (mode_.sliding == 0) {
          mode_.sliding = drive(tau, s) > 0 ? 1 : -1;
        } else {
          s.v = 0;
          leave_rest(tau, s);
        }
        break;
      case 1: mode_.stop = !mode_.stop; break;
      case 2: mode_.clearance = mode_.clearance > 0 ? 0 : 1; break;
      case 3: mode_.clearance = mode_.clearance < 0 ? 0 : -1; break;
      default: mode_.z_sign = -mode_.z_sign;
    }
  }

  /// At v = 0: held by friction, or off in the direction of the drive.
  void leave_rest(double tau, const State& s) {
    const double force = drive(tau, s);
    mode_.sliding = std::abs(force) <= p_.coulomb && p_.coulomb > 0 ? 0 : force > 0 ? 1 : -1;
  }

  void count_stuck(double h) {
    if (mode_.sliding == 0) stuck += h;
  }

  const Physics& p_;
  const Signal& signal_;
  double level_;
  Mode mode_;
};

/// RK4 on (x, v, z) with a law; `substeps` is multiplied, since kinks are stepped over.
Motion integrate_law(const Physics& physics, const Signal& signal, double level, State start, int rows, double spacing,
                     int substeps) {
  const Law& law = *physics.law;
  const int steps = 4 * substeps, n = 2 + law.states;
  const double h = spacing / steps;
  using Vector = std::vector<double>;
  Vector s(n, 0.0), k1(n), k2(n), k3(n), k4(n), at(n);
  s[0] = start.x;
  s[1] = start.v;
  std::copy(law.start.begin(), law.start.end(), s.begin() + 2);
  const auto linear = [&](const Vector& x) { return 2 * physics.zeta * x[1] + physics.k * x[0]; };
  const auto rate = [&](double tau, double u, const Vector& x, Vector& out) {
    const double mass = 1 + (law.mass ? law.mass(x[0], x[1]) : 0);
    out[0] = x[1];
    out[1] = (u - linear(x) - law.force(tau, x[0], x[1], x.data() + 2)) / mass;
    if (law.rate) law.rate(tau, x[0], x[1], x.data() + 2, out.data() + 2);
    if (law.shaken) law.shaken(out[1], out.data() + 2);
  };
  const auto moved = [&](const Vector& k, double by) {
    for (int i = 0; i < n; ++i) at[i] = s[i] + by * k[i];
  };
  const auto advance = [&](double t, double u, double length, double end) {
    const double middle = level * signal(t + length / 2);
    rate(t, u, s, k1);
    moved(k1, length / 2);
    rate(t + length / 2, middle, at, k2);
    moved(k2, length / 2);
    rate(t + length / 2, middle, at, k3);
    moved(k3, length);
    rate(t + length, end, at, k4);
    for (int i = 0; i < n; ++i) s[i] += length / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  };
  const auto step = [&](double t, double u, double length, double end) {
    advance(t, u, length, end);
    if (law.settle) law.settle(s[0], s[1], s.data() + 2);
  };
  // The part of a step until just beyond the jump that falls into it, or all of it.
  const auto before_jump = [&](double t, double length) {
    const Vector start = s;
    const double side = law.jump(s[0], s[1]);
    const auto beyond = [&](double part) {
      advance(t, level * signal(t), part, level * signal(t + part));
      const bool crossed = law.jump(s[0], s[1]) * side < 0;
      s = start;
      return crossed;
    };
    if (!beyond(length)) return length;
    double low = 0, high = length;
    for (int pass = 0; pass < 30; ++pass) {
      const double middle = 0.5 * (low + high);
      (beyond(middle) ? high : low) = middle;
    }
    return high;
  };
  Motion motion;
  double now = level * signal(0);
  for (int row = 0; row < rows; ++row) {
    const double tau = row * spacing;
    rate(tau, now, s, k1);
    double hidden = law.force(tau, s[0], s[1], s.data() + 2);
    if (law.mass) hidden += law.mass(s[0], s[1]) * k1[1];
    motion.force.push_back(now);
    motion.x.push_back(s[0]);
    motion.v.push_back(s[1]);
    motion.hidden.push_back(hidden);
    motion.restoring.push_back(linear(s) + hidden);
    for (int j = 0; j < steps && row + 1 < rows; ++j) {
      const double t = tau + j * h, end = level * signal(t + h);
      const double part = law.jump ? before_jump(t, h) : h;
      step(t, now, part, part < h ? level * signal(t + part) : end);
      if (part < h) step(t + part, level * signal(t + part), h - part, end);
      now = end;
    }
  }
  return motion;
}

}  // namespace

Motion integrate(const Physics& physics, const Signal& signal, double level, State start, int rows, double spacing,
                 int substeps) {
  if (physics.law) return integrate_law(physics, signal, level, start, rows, spacing, substeps);
  Integrator run(physics, signal, level);
  run.enter(0, start);
  Motion motion;
  State s = start;
  const double h = spacing / substeps;
  for (int row = 0; row < rows; ++row) {
    const double tau = row * spacing, hidden = run.hidden(tau, s);
    motion.force.push_back(level * signal(tau));
    motion.x.push_back(s.x);
    motion.v.push_back(s.v);
    motion.hidden.push_back(hidden);
    motion.restoring.push_back(run.linear(s) + hidden);
    if (row + 1 == rows) break;
    for (int j = 0; j < substeps; ++j) run.advance(tau + j * h, s, h);
  }
  motion.events = run.events;
  motion.stuck = run.stuck;
  return motion;
}

}  // namespace truth
