// A free run on a sampled force: 6401 rows at 800 Hz.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "benchmarks/oscillators.hpp"
#include "benchmarks/work.hpp"
#include "simulate/simulate.hpp"

namespace bench {
namespace {

constexpr int rows = 6401;
constexpr double dt = 1 / 800.0;

/// Both must have done the same work: one answer to 1e-3 of the motion (DP5 steps once per sample).
void compare(const char* name, const Eigen::MatrixXd& ours, const std::vector<double>& hand) {
  double difference = 0, size = 0;
  for (int i = 0; i < rows; ++i) {
    difference = std::max(difference, std::abs(ours(i, 0) - hand[i]));
    size = std::max(size, std::abs(hand[i]));
  }
  if (difference <= 1e-3 * size) return;
  std::fprintf(stderr, "%s: ours and the hand-written run differ by %g of the motion\n", name, difference / size);
  std::exit(1);
}

template <class Hand>
Work free_run(const std::string& name, const std::string& restoring, std::vector<double> theta, double amplitude,
              double limit = 2) {
  auto pool = std::make_shared<lunid::Pool>();
  lunid::Model model;
  model.pool = pool;
  model.mass = pool->constant(1);
  model.restoring = lunid::parse(*pool, restoring);
  auto system = std::make_shared<lunid::System>(lunid::complete(model));
  auto force = std::make_shared<std::vector<double>>(sampled_force(rows, amplitude));
  auto hand = std::make_shared<std::vector<double>>(rows);
  const lunid::Excitation excitation(0, dt, *force, lunid::Interpolation::linear);
  const Eigen::VectorXd x0 = Eigen::VectorXd::Zero(2);
  // As in a search: the step has been chosen once, and many runs follow.
  lunid::SimulateOptions options;
  options.solver = lunid::Solver::fixed;
  options.substeps = lunid::choose_substeps(*system, theta, excitation, x0);

  dormand_prince(Hand{}, *force, dt, *hand);
  compare(name.c_str(), lunid::simulate(*system, theta, excitation, x0, options).x, *hand);
  return {name, limit,
          [=] { benchmark::DoNotOptimize(lunid::simulate(*system, theta, excitation, x0, options).x.data()); },
          [=] {
            dormand_prince(Hand{}, *force, dt, *hand);
            benchmark::DoNotOptimize(hand->data());
          }};
}

}  // namespace

std::vector<Work> free_run_works() {
  return {free_run<Duffing>("free-run-duffing", "k*y + c*v + k3*y^3", {2e4, 10, 1e6}, 100),
          free_run<TanhYield>("free-run-tanh", "c*v + e1*tanh(e2*y)", {10, 250, 80}, 60),
          free_run<VanDerPol>("free-run-van-der-pol", "k*y + (beta*y^2 - mu)*v", {2e4, 5e4, 10}, 100),
          // beside a run that does not look where the contact begins and ends
          free_run<Stop>("free-run-stop", "k*y + c*v + ks*max(y - g, 0)", {2e4, 10, 2e4, 2e-3}, 30, 10)};
}

}  // namespace bench
