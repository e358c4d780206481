// Three parameters of a Duffing oscillator (and its first state) from 2 s at 800 Hz, from first guesses 10 %
// off.
#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>

#include "benchmarks/oscillators.hpp"
#include "benchmarks/work.hpp"
#include "simulate/fit.hpp"

namespace bench {
namespace {

constexpr int rows = 1601, unknowns = 5;  // k c k3 y0 v0
constexpr double dt = 1 / 800.0;
using Unknowns = Eigen::Matrix<double, unknowns, 1>;

/// State and its sensitivities to the five unknowns.
struct Lane {
  double y, v, sy[unknowns], sv[unknowns];
};

Lane rate(const Unknowns& p, const Lane& s, double force) {
  Lane d;
  d.y = s.v;
  d.v = force - (p[0] + p[2] * s.y * s.y) * s.y - p[1] * s.v;
  const double slope = p[0] + 3 * p[2] * s.y * s.y, direct[unknowns] = {-s.y, -s.v, -s.y * s.y * s.y, 0, 0};
  for (int i = 0; i < unknowns; ++i) {
    d.sy[i] = s.sv[i];
    d.sv[i] = direct[i] - slope * s.sy[i] - p[1] * s.sv[i];
  }
  return d;
}

Lane moved(const Lane& s, const Lane& d, double h) {
  Lane out;
  out.y = s.y + h * d.y;
  out.v = s.v + h * d.v;
  for (int i = 0; i < unknowns; ++i) {
    out.sy[i] = s.sy[i] + h * d.sy[i];
    out.sv[i] = s.sv[i] + h * d.sv[i];
  }
  return out;
}

/// Cost, normal matrix and right side in one pass: RK4 with `substeps` per sample on the extended state.
double pass(const Unknowns& p, const std::vector<double>& force, const std::vector<double>& measured, int substeps,
            Eigen::Matrix<double, unknowns, unknowns>& normal, Unknowns& right) {
  Lane s{p[3], p[4], {0, 0, 0, 1, 0}, {0, 0, 0, 0, 1}};
  normal.setZero();
  right.setZero();
  double cost = 0;
  const double h = dt / substeps;
  for (int i = 0; i < rows; ++i) {
    const double residual = measured[i] - s.y;
    cost += residual * residual;
    const Eigen::Map<const Unknowns> gradient(s.sy);
    normal += gradient * gradient.transpose();
    right += gradient * residual;
    for (int j = 0; j < substeps && i + 1 < rows; ++j) {
      const double slope = (force[i + 1] - force[i]) / substeps, f0 = force[i] + j * slope;
      const Lane k1 = rate(p, s, f0), k2 = rate(p, moved(s, k1, h / 2), f0 + slope / 2);
      const Lane k3 = rate(p, moved(s, k2, h / 2), f0 + slope / 2), k4 = rate(p, moved(s, k3, h), f0 + slope);
      s = moved(moved(moved(moved(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
    }
  }
  return cost;
}

/// Gauss-Newton until the cost falls by less than 1e-7 of itself (the fit's own tolerance).
Unknowns hand_fit(Unknowns p, const std::vector<double>& force, const std::vector<double>& measured, int substeps) {
  Eigen::Matrix<double, unknowns, unknowns> normal;
  Unknowns right;
  double cost = pass(p, force, measured, substeps, normal, right);
  for (int iteration = 0; iteration < 40; ++iteration) {
    const Unknowns scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    const Unknowns step =
        scale.asDiagonal() *
        (scale.asDiagonal() * normal * scale.asDiagonal()).ldlt().solve(scale.cwiseProduct(right).eval());
    p += step;
    const double next = pass(p, force, measured, substeps, normal, right);
    if (cost - next < 1e-7 * cost) break;
    cost = next;
  }
  return p;
}

/// Five parameters to 8 s at 800 Hz of a noisy displacement, within 0.1 s; the truth is integrated eight times as
/// finely.
Work five_parameters() {
  constexpr int rows = 6401, finer = 8;
  const std::vector<double> truth{2e4, 10, 1e6, 2e5, 3e8}, first{2.2e4, 8, 0.8e6, 1e5, 1e8};
  auto pool = std::make_shared<lunid::Pool>();
  lunid::Model model;
  model.pool = pool;
  model.mass = pool->constant(1);
  model.restoring = lunid::parse(*pool, "k*y + c*v + k3*y^3 + k2*y^2 + k5*y^5");
  auto system = std::make_shared<lunid::System>(lunid::complete(model));
  const std::vector<double> force = sampled_force(rows, 100);
  const lunid::Excitation excitation(0, dt, force, lunid::Interpolation::linear);
  lunid::SimulateOptions options;
  options.solver = lunid::Solver::fixed;
  options.substeps = finer;
  const lunid::Run run = lunid::simulate(*system, truth, excitation, Eigen::Vector2d::Zero(), options);
  std::mt19937_64 bits(2);
  std::normal_distribution<double> noise(0, 1e-4);
  lunid::Channel motion, drive;
  motion.name = "y", motion.unit = "m", motion.values = run.x.col(0);
  for (double& y : motion.values) y += noise(bits);
  drive.name = "F", drive.unit = "N", drive.values = Eigen::Map<const Eigen::VectorXd>(force.data(), rows);
  const lunid::Record record = lunid::derive_motion(lunid::Record("bench", 0, dt, {drive, motion}));
  const std::vector<lunid::FitData> data{{record, excitation, {}}};
  const Eigen::VectorXd start = Eigen::Map<const Eigen::VectorXd>(first.data(), 5);
  const lunid::FitResult fit = lunid::fit_trajectory(*system, start, data);
  if (std::abs(fit.theta[0] / truth[0] - 1) > 0.01 || std::abs(fit.theta[2] / truth[2] - 1) > 0.05) {
    std::fprintf(stderr, "fit-5-parameters: k = %g, k3 = %g (%s)\n", fit.theta[0], fit.theta[2], fit.stopped.c_str());
    std::exit(1);
  }
  Work work{"fit-5-parameters", 1,
            [=, keep = pool] { benchmark::DoNotOptimize(lunid::fit_trajectory(*system, start, data).theta.data()); },
            [] {}};
  work.allowance = 0.1;
  return work;
}

}  // namespace

std::vector<Work> trajectory_fit_works() {
  auto force = std::make_shared<std::vector<double>>(sampled_force(rows, 100));
  auto measured = std::make_shared<std::vector<double>>(rows);
  dormand_prince(Duffing{}, *force, dt, *measured);
  std::mt19937_64 bits(1);
  std::normal_distribution<double> noise(0, 1e-4);
  for (double& y : *measured) y += noise(bits);

  auto pool = std::make_shared<lunid::Pool>();
  lunid::Model model;
  model.pool = pool;
  model.mass = pool->constant(1);
  model.restoring = lunid::parse(*pool, "k*y + c*v + k3*y^3");
  auto system = std::make_shared<lunid::System>(lunid::complete(model));
  const Eigen::Map<const Eigen::VectorXd> F(force->data(), rows), y(measured->data(), rows);
  lunid::Channel motion, drive;
  motion.name = "y", motion.unit = "m", motion.values = y;
  drive.name = "F", drive.unit = "N", drive.values = F;
  lunid::Record record("bench", 0, dt, {drive, motion});
  record = lunid::derive_motion(record);
  const std::vector<lunid::FitData> data{{record, lunid::Excitation(0, dt, *force, lunid::Interpolation::linear), {}}};
  const Eigen::VectorXd start = Eigen::Vector3d(2.2e4, 9, 0.9e6);
  const lunid::FitResult once = lunid::fit_trajectory(*system, start, data);
  const Unknowns begin{2.2e4, 9, 0.9e6, record["y"][0], record["v"][0]};
  const Unknowns hand = hand_fit(begin, *force, *measured, once.substeps);
  if (std::abs(once.theta[2] / hand[2] - 1) > 1e-3) {
    std::fprintf(stderr, "trajectory-fit: ours k3 = %g (%s), by hand %g\n", once.theta[2], once.stopped.c_str(),
                 hand[2]);
    std::exit(1);
  }
  return {
      {"trajectory-fit", 3, [=] { benchmark::DoNotOptimize(lunid::fit_trajectory(*system, start, data).theta.data()); },
       [=] { benchmark::DoNotOptimize(hand_fit(begin, *force, *measured, once.substeps)); }},
      five_parameters()};
}

}  // namespace bench
