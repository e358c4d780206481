// Ensembles and frequency sweeps beside a SIMD ensemble written by hand, and on two cores beside one; the time to
// compile an expression of 1000 nodes.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <memory>
#include <numbers>
#include <thread>

#include "benchmarks/oscillators.hpp"
#include "benchmarks/work.hpp"
#include "expr/tape.hpp"
#include "simulate/ensemble.hpp"

namespace bench {
namespace {

/// Four lanes; two of them in one loop are what the registers of AVX2 hold best.
typedef double Lanes __attribute__((vector_size(32)));
constexpr int group = 8;

#if defined(__x86_64__)
#define BENCH_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define BENCH_WIDE
#endif
#define BENCH_INLINE __attribute__((always_inline)) inline

struct Duffings {
  Lanes k[2], c[2], k3[2];
};

BENCH_INLINE Lanes acceleration(const Duffings& d, int u, Lanes y, Lanes v, Lanes force) {
  return force - (d.k[u] + d.k3[u] * y * y) * y - d.c[u] * v;
}

/// Dormand-Prince 5 of two groups of lanes over `rows` samples; force(u, row, place of the stage) as a functor; `rms`
/// of y of each lane.
template <class Force>
BENCH_INLINE void integrate(const Duffings& d, const Lanes* h, int rows, Force force, double* rms) {
  Lanes x[2]{}, v[2]{}, a[2], sum[2]{};
  for (int u = 0; u < 2; ++u) a[u] = acceleration(d, u, x[u], v[u], force(u, 0, 0));
  for (int row = 0; row + 1 < rows; ++row)
    for (int u = 0; u < 2; ++u) {
      const Lanes X = x[u], V = v[u], A1 = a[u], H = h[u];
      const Lanes f6 = force(u, row, 5);
      const Lanes v2 = V + H * (1. / 5 * A1), x2 = X + H * (1. / 5 * V);
      const Lanes a2 = acceleration(d, u, x2, v2, force(u, row, 1));
      const Lanes v3 = V + H * (3. / 40 * A1 + 9. / 40 * a2), x3 = X + H * (3. / 40 * V + 9. / 40 * v2);
      const Lanes a3 = acceleration(d, u, x3, v3, force(u, row, 2));
      const Lanes v4 = V + H * (44. / 45 * A1 - 56. / 15 * a2 + 32. / 9 * a3);
      const Lanes x4 = X + H * (44. / 45 * V - 56. / 15 * v2 + 32. / 9 * v3);
      const Lanes a4 = acceleration(d, u, x4, v4, force(u, row, 3));
      const Lanes v5 = V + H * (19372. / 6561 * A1 - 25360. / 2187 * a2 + 64448. / 6561 * a3 - 212. / 729 * a4);
      const Lanes x5 = X + H * (19372. / 6561 * V - 25360. / 2187 * v2 + 64448. / 6561 * v3 - 212. / 729 * v4);
      const Lanes a5 = acceleration(d, u, x5, v5, force(u, row, 4));
      const Lanes v6 =
          V + H * (9017. / 3168 * A1 - 355. / 33 * a2 + 46732. / 5247 * a3 + 49. / 176 * a4 - 5103. / 18656 * a5);
      const Lanes x6 =
          X + H * (9017. / 3168 * V - 355. / 33 * v2 + 46732. / 5247 * v3 + 49. / 176 * v4 - 5103. / 18656 * v5);
      const Lanes a6 = acceleration(d, u, x6, v6, f6);
      sum[u] += X * X;
      x[u] = X + H * (35. / 384 * V + 500. / 1113 * v3 + 125. / 192 * v4 - 2187. / 6784 * v5 + 11. / 84 * v6);
      v[u] = V + H * (35. / 384 * A1 + 500. / 1113 * a3 + 125. / 192 * a4 - 2187. / 6784 * a5 + 11. / 84 * a6);
      a[u] = acceleration(d, u, x[u], v[u], f6);
    }
  for (int l = 0; l < group; ++l) rms[l] = std::sqrt((sum[l / 4][l % 4] + x[l / 4][l % 4] * x[l / 4][l % 4]) / rows);
}

constexpr double places[] = {0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1};

BENCH_WIDE void sampled(const Duffings& d, double dt, const std::vector<double>& force, double* rms) {
  const Lanes h[2] = {Lanes{} + dt, Lanes{} + dt};
  integrate(
      d, h, static_cast<int>(force.size()),
      [&](int, int row, int place) __attribute__((always_inline)) {
        const double f = force[row] + places[place] * (force[row + 1] - force[row]);
        return Lanes{} + f;
      },
      rms);
}

/// Force amplitude*cos(omega*t), by the rotation that an expert would write: the cosine and sine of each step are
/// turned on by those of one step, and once in 64 steps made anew.
BENCH_WIDE void harmonic(const Duffings& d, const Lanes* dt, const double* amplitude, const double* omega, int rows,
                         double* rms) {
  Lanes turn_c[2][6], turn_s[2][6], c[2], s[2];
  for (int u = 0; u < 2; ++u)
    for (int p = 0; p < 6; ++p)
      for (int l = 0; l < 4; ++l) {
        const double angle = omega[4 * u + l] * dt[u][l] * places[p];
        turn_c[u][p][l] = std::cos(angle);
        turn_s[u][p][l] = std::sin(angle);
      }
  int at[2] = {-1, -1};
  integrate(
      d, dt, rows,
      [&](int u, int row, int place) __attribute__((always_inline)) {
        if (row != at[u]) {
          if (row % 64 == 0) {
            for (int l = 0; l < 4; ++l) {
              c[u][l] = amplitude[4 * u + l] * std::cos(omega[4 * u + l] * dt[u][l] * row);
              s[u][l] = amplitude[4 * u + l] * std::sin(omega[4 * u + l] * dt[u][l] * row);
            }
          } else {
            const Lanes next = c[u] * turn_c[u][5] - s[u] * turn_s[u][5];
            s[u] = s[u] * turn_c[u][5] + c[u] * turn_s[u][5];
            c[u] = next;
          }
          at[u] = row;
        }
        return c[u] * turn_c[u][place] - s[u] * turn_s[u][place];
      },
      rms);
}

/// Case 1 of the thesis: m = 1, k, c, k3.
lunid::Model duffing(std::shared_ptr<lunid::Pool> pool) {
  lunid::Model model;
  model.pool = pool;
  model.mass = pool->constant(1);
  model.restoring = lunid::parse(*pool, "k*y + c*v + k3*y^3");
  return lunid::complete(model);
}

struct Study {
  std::shared_ptr<lunid::System> system;
  lunid::Ensemble ensemble;
  lunid::EnsembleOptions options;
};

Study study_of(const lunid::Model& model, int members, int threads) {
  Study s;
  s.system = std::make_shared<lunid::System>(model);
  s.ensemble.system = s.system.get();
  s.ensemble.theta.resize(3, members);
  for (int m = 0; m < members; ++m) {
    const double part = static_cast<double>(m) / members;
    s.ensemble.theta.col(m) << 1.5e4 + 1e4 * part, 10 + 5 * part, 1e6 * (1 + part);
  }
  s.ensemble.x0.setZero(2, members);
  s.options.outputs = {lunid::output_from("rms_y", *s.system)};
  s.options.substeps = 1;
  s.options.threads = threads;
  return s;
}

Duffings duffings_of(const lunid::Ensemble& e, int first) {
  Duffings d;
  for (int l = 0; l < group; ++l) {
    const auto member = std::min<Eigen::Index>(first + l, e.members() - 1);
    d.k[l / 4][l % 4] = e.theta(0, member);
    d.c[l / 4][l % 4] = e.theta(1, member);
    d.k3[l / 4][l % 4] = e.theta(2, member);
  }
  return d;
}

/// Both must have done the same work.
void compare(const char* name, const Eigen::MatrixXd& ours, const std::vector<double>& hand) {
  for (Eigen::Index m = 0; m < ours.rows(); ++m) {
    if (std::abs(ours(m, 0) - hand[static_cast<std::size_t>(m)]) <= 1e-6 * ours(m, 0)) continue;
    std::fprintf(stderr, "%s: member %d: ours %.9g, the hand-written run %.9g\n", name, static_cast<int>(m), ours(m, 0),
                 hand[static_cast<std::size_t>(m)]);
    std::exit(1);
  }
}

Work ensemble(int threads) {
  constexpr int members = 1000, rows = 1601;
  constexpr double dt = 1 / 800.0;
  const lunid::Model model = duffing(std::make_shared<lunid::Pool>());
  auto study = std::make_shared<Study>(study_of(model, members, threads));
  auto force = std::make_shared<std::vector<double>>(sampled_force(rows, 100));
  study->ensemble.force = lunid::MemberForce::of(lunid::Excitation(0, dt, *force));
  auto rms = std::make_shared<std::vector<double>>(members + group);
  const auto hand = [=] {
    for (int m = 0; m < members; m += group) sampled(duffings_of(study->ensemble, m), dt, *force, rms->data() + m);
    benchmark::DoNotOptimize(rms->data());
  };
  const auto ours = [=] { return lunid::run_ensemble(study->ensemble, study->options).values; };
  hand();
  compare("ensemble", ours(), *rms);
  return {"ensemble", 1.5, [=] { benchmark::DoNotOptimize(ours().data()); }, hand};
}

/// 200 frequencies x 2 amplitudes, 64 samples in each of 25 periods.
Work frequency_sweep() {
  constexpr int members = 400, rows = 64 * 25 + 1;
  auto pool = std::make_shared<lunid::Pool>();
  auto study = std::make_shared<Study>(study_of(duffing(pool), members, 1));
  const lunid::Expr t = pool->channel("t"), amplitude = pool->parameter("amplitude"), omega = pool->parameter("omega");
  const lunid::Expr force = amplitude * pool->apply(lunid::Op::cos, {omega * t}), inputs[] = {t, amplitude, omega};
  Eigen::MatrixXd q(2, members);
  for (int m = 0; m < members; ++m) q.col(m) << (m < 200 ? 20 : 100), 60 + 0.9 * (m % 200);
  const Eigen::VectorXd dt = 2 * std::numbers::pi / 64 * q.row(1).cwiseInverse().transpose();
  study->ensemble.force = lunid::MemberForce::of({"F"}, lunid::TimeTape(std::span(&force, 1), inputs), q, 0, dt, rows);
  auto rms = std::make_shared<std::vector<double>>(members + group);
  const auto hand = [=, keep = pool] {
    for (int m = 0; m < members; m += group) {
      Lanes h[2];
      double a[group], w[group];
      for (int l = 0; l < group; ++l) {
        h[l / 4][l % 4] = dt[m + l];
        a[l] = q(0, m + l);
        w[l] = q(1, m + l);
      }
      harmonic(duffings_of(study->ensemble, m), h, a, w, rows, rms->data() + m);
    }
    benchmark::DoNotOptimize(rms->data());
  };
  const auto ours = [=] { return lunid::run_ensemble(study->ensemble, study->options).values; };
  hand();
  compare("frf-sweep", ours(), *rms);
  return {"frf-sweep", 1.5, [=] { benchmark::DoNotOptimize(ours().data()); }, hand};
}

/// A stop and Coulomb friction: 500 members side by side, where each by itself takes the hand-written place.
Work switches() {
  constexpr int members = 500, rows = 1601;
  auto pool = std::make_shared<lunid::Pool>();
  lunid::Model model;
  model.pool = pool;
  model.mass = pool->constant(1);
  model.restoring = lunid::parse(*pool, "k*y + c*v + Fc*sign(v) + 1e5*max(y - 0.01, 0)");
  auto study = std::make_shared<Study>();
  study->system = std::make_shared<lunid::System>(lunid::complete(model));
  study->ensemble.system = study->system.get();
  study->ensemble.theta.resize(3, members);
  for (int m = 0; m < members; ++m) {
    const double part = static_cast<double>(m) / members;
    study->ensemble.theta.col(m) << 1.5e4 + 1e4 * part, 10 + 5 * part, 5 + 20 * part;
  }
  study->ensemble.x0.setZero(2, members);
  study->options.outputs = {lunid::output_from("rms_y", *study->system)};
  study->options.substeps = 1;
  study->options.threads = 1;
  study->ensemble.force = lunid::MemberForce::of(lunid::Excitation(0, 1 / 800.0, sampled_force(rows, 100)));
  const auto alone = [=] {
    double sum = 0;
    lunid::SimulateOptions options;
    options.solver = lunid::Solver::fixed;
    options.substeps = 1;
    for (int m = 0; m < members; ++m) {
      const std::span theta(study->ensemble.theta.col(m).data(), 3);
      sum += lunid::simulate(*study->system, theta, study->ensemble.force.excitation(m), study->ensemble.x0.col(m),
                             options)
                 .x(rows - 1, 0);
    }
    benchmark::DoNotOptimize(sum);
  };
  return {"ensemble-switches", 1,
          [=, keep = pool] {
            benchmark::DoNotOptimize(lunid::run_ensemble(study->ensemble, study->options).values.data());
          },
          alone};
}

/// Processor time of this thread [s].
double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Processor time of the busiest thread of an ensemble [s]: what it takes where every thread has a core to itself,
/// whatever else the machine does meanwhile.
double busiest(Study& study) {
  const std::thread::id caller = std::this_thread::get_id();
  const double start = processor_time();
  std::map<std::thread::id, double> spent;
  study.options.finished = [&](std::span<const Eigen::Index>) {
    const std::thread::id here = std::this_thread::get_id();
    spent[here] = processor_time() - (here == caller ? start : 0);
  };
  benchmark::DoNotOptimize(lunid::run_ensemble(study.ensemble, study.options).values.data());
  spent[caller] = processor_time() - start;
  double most = 0;
  for (const auto& [id, seconds] : spent) most = std::max(most, seconds);
  return most;
}

/// An ensemble on two threads, beside one: 1.9 times faster.
Work threads() {
  constexpr int members = 4000, rows = 1601;
  const auto study = [](int threads) {
    auto made = std::make_shared<Study>(study_of(duffing(std::make_shared<lunid::Pool>()), members, threads));
    made->ensemble.force = lunid::MemberForce::of(lunid::Excitation(0, 1 / 800.0, sampled_force(rows, 100)));
    return made;
  };
  Work work{"threads", 1 / 1.9, [] {}, [] {}};
  const auto least = [](std::shared_ptr<Study> of) {  // where others use the cores, one thread may be given less to do
    return [of] {
      double seconds = busiest(*of);
      for (int run = 1; run < 10; ++run) seconds = std::min(seconds, busiest(*of));
      return seconds;
    };
  };
  work.ours_seconds = least(study(2));
  work.hand_seconds = least(study(1));
  return work;
}

/// A tape of an expression of 1000 nodes, within 1 ms.
Work compilation() {
  auto pool = std::make_shared<lunid::Pool>();
  const lunid::Expr y = pool->channel("y"), v = pool->channel("v");
  lunid::Expr f = y;
  for (int i = 0; i < 250; ++i)  // four nodes each: a sine, a product, a constant, a sum
    f = f * v + pool->apply(lunid::Op::sin, {y * (0.1 + i)});
  Work work{"compile-1000", 1,
            [=] {
              const lunid::Expr inputs[] = {y, v};
              benchmark::DoNotOptimize(lunid::Tape(std::span(&f, 1), inputs).instructions());
            },
            [keep = pool] {}};
  work.allowance = 1e-3;
  return work;
}

}  // namespace

std::vector<Work> ensemble_works() { return {ensemble(1), frequency_sweep(), switches(), threads(), compilation()}; }

}  // namespace bench
