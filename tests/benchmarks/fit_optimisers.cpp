// lunid_fit_optimisers: the trajectory fit's Levenberg-Marquardt beside NLopt's local methods on the same free runs and
// exact gradients: three parameters of a Duffing oscillator (2 s at 800 Hz, 5 % noise) from 50 starts each.
#include <nlopt.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>

#include "benchmarks/oscillators.hpp"
#include "simulate/fit.hpp"

namespace {

using lunid::FitData;

constexpr int rows = 1601, starts = 50, unknowns = 3;
constexpr double dt = 1 / 800.0, truth[unknowns] = {2e4, 10, 1e6};

/// The problem, scaled so that each unknown is 1 at the truth.
struct Problem {
  std::unique_ptr<lunid::System> system;
  std::vector<FitData> data;
  Eigen::VectorXd measured;
  long runs = 0;

  /// Sum of squares at scaled unknowns, from rest; its gradient where asked for. Infinite where the run fails.
  double cost(const double* scaled, double* gradient) {
    ++runs;
    double theta[unknowns];
    for (int i = 0; i < unknowns; ++i) theta[i] = scaled[i] * truth[i];
    lunid::SimulateOptions options;
    options.solver = lunid::Solver::fixed;
    options.substeps = 1;
    const Eigen::VectorXd x0 = Eigen::VectorXd::Zero(2);
    const std::vector<int> wanted{0};
    if (!gradient) {
      const lunid::Run run = lunid::simulate(*system, theta, data[0].excitation, x0, options);
      return run.summary.completed ? (measured - run.x.col(0)).squaredNorm() * 1e4 : HUGE_VAL;
    }
    const lunid::SensitivityRun run =
        lunid::simulate_sensitivities(*system, theta, data[0].excitation, x0, options, wanted);
    if (!run.run.summary.completed) return HUGE_VAL;
    const Eigen::VectorXd residual = measured - run.run.x.col(0);
    for (int i = 0; i < unknowns; ++i) gradient[i] = -2e4 * truth[i] * run.dx[0].col(i).dot(residual);
    return residual.squaredNorm() * 1e4;
  }
};

Problem make_problem() {
  Problem p;
  lunid::Model model;
  model.pool = std::make_shared<lunid::Pool>();
  model.mass = model.pool->constant(1);
  model.restoring = lunid::parse(*model.pool, "k*y + c*v + k3*y^3");
  p.system = std::make_unique<lunid::System>(model);
  const std::vector<double> force = bench::sampled_force(rows, 100);
  std::vector<double> y(rows);
  bench::dormand_prince(bench::Duffing{}, force, dt, y);
  Eigen::Map<Eigen::VectorXd> values(y.data(), rows);
  std::mt19937_64 bits(1);
  std::normal_distribution<double> noise(0, 0.05 * std::sqrt(values.squaredNorm() / rows));
  for (double& value : y) value += noise(bits);
  p.measured = values;
  lunid::Channel motion, drive;
  motion.name = "y", motion.values = p.measured;
  drive.name = "F", drive.values = Eigen::Map<const Eigen::VectorXd>(force.data(), rows);
  p.data = {
      {lunid::derive_motion(lunid::Record("bench", 0, dt, {drive, motion})), lunid::Excitation(0, dt, force), {}}};
  return p;
}

/// Found: within 10 % of the best point known.
bool near(const double* scaled) {
  for (int i = 0; i < unknowns; ++i)
    if (!(std::abs(scaled[i] - 1) < 0.1)) return false;
  return true;
}

double by_nlopt(unsigned n, const double* x, double* gradient, void* problem) noexcept {
  const double cost = static_cast<Problem*>(problem)->cost(x, gradient);
  if (!std::isfinite(cost) && gradient) std::fill_n(gradient, n, 0.0);
  return std::isfinite(cost) ? cost : 1e30;
}

void report(const char* name, Problem& problem, const std::function<void(double*)>& solve) {
  problem.runs = 0;
  std::mt19937_64 bits(2);
  std::uniform_real_distribution<double> factor(std::log(0.5), std::log(2.0));
  int found = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (int s = 0; s < starts; ++s) {
    double scaled[unknowns];
    for (double& x : scaled) x = std::exp(factor(bits));
    solve(scaled);
    found += near(scaled);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("%-34s found %2d/%d   %6.1f runs   %7.2f ms a start\n", name, found, starts,
              static_cast<double>(problem.runs) / starts, 1e3 * seconds / starts);
}

}  // namespace

int main() {
  Problem problem = make_problem();
  const auto ours = [&](bool progressive) {
    return [&problem, progressive](double* x) {
      Eigen::VectorXd theta(unknowns);
      for (int i = 0; i < unknowns; ++i) theta[i] = x[i] * truth[i];
      const lunid::FitResult fit = progressive ? lunid::fit_progressively(*problem.system, theta, problem.data)
                                               : lunid::fit_trajectory(*problem.system, theta, problem.data);
      problem.runs += fit.runs;
      for (int i = 0; i < unknowns; ++i) x[i] = fit.theta[i] / truth[i];
    };
  };
  report("Levenberg-Marquardt, growing runs", problem, ours(true));
  report("Levenberg-Marquardt, whole record", problem, ours(false));
  for (const auto& [name, algorithm] :
       {std::pair{"NLopt SLSQP", NLOPT_LD_SLSQP}, std::pair{"NLopt L-BFGS", NLOPT_LD_LBFGS},
        std::pair{"NLopt MMA", NLOPT_LD_MMA}, std::pair{"NLopt BOBYQA (no gradient)", NLOPT_LN_BOBYQA}})
    report(name, problem, [&, algorithm = algorithm](double* x) {
      const nlopt_opt opt = nlopt_create(algorithm, unknowns);
      nlopt_set_lower_bounds1(opt, 0.1);
      nlopt_set_upper_bounds1(opt, 10);
      nlopt_set_min_objective(opt, by_nlopt, &problem);
      nlopt_set_ftol_rel(opt, 1e-7);
      nlopt_set_maxeval(opt, 500);
      double cost = 0;
      nlopt_optimize(opt, x, &cost);
      nlopt_destroy(opt);
    });
}
