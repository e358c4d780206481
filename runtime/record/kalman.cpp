// The Kalman smoother over displacement, velocity, acceleration and what lies above them. Square-root information form:
// the whole problem is one least-squares problem of short rows, whose forward pass is the filter and whose back
// substitution the smoother.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "record/banded.hpp"
#include "record/method_parts.hpp"

namespace lunid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of a density, from rows to seconds.
double density_unit(int order, double dt) { return std::pow(dt, 1 - 2 * order); }

double factorial(int k) { return std::tgamma(k + 1.0); }

/// A chain of `states` integrators behind white noise of density 1, over one row.
struct Chain {
  MatrixXd transition, covariance;
  explicit Chain(int states) : transition(states, states), covariance(states, states) {
    for (int i = 0; i < states; ++i)
      for (int j = 0; j < states; ++j) {
        transition(i, j) = j < i ? 0 : 1 / factorial(j - i);
        const int a = states - 1 - i, b = states - 1 - j;  // powers of the time under the integral
        covariance(i, j) = 1 / (factorial(a) * factorial(b) * (a + b + 1));
      }
  }
};

/// Rows one apart: channels in units of their noise.
struct Problem {
  const std::vector<Measurement>& measured;
  std::vector<double> noise;  ///< of each channel, rows one apart
  int lowest, states;
  Index rows;
  double dt;

  BandedLeastSquares solved(double density) const {
    const Chain chain(states);
    // W with W^T W = (density * covariance)^-1: the rows of a step are W (next - transition * now).
    const MatrixXd lower = MatrixXd(chain.covariance.llt().matrixL()) * std::sqrt(density);
    const MatrixXd weight = lower.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(states, states));
    MatrixXd step(states, 2 * states);
    step << -weight * chain.transition, weight;
    std::vector<VectorXd> steps;
    for (int r = 0; r < states; ++r) steps.push_back(step.row(r));
    BandedLeastSquares system(states * rows, 2 * states);
    for (Index i = 0; i < rows; ++i) {
      for (std::size_t c = 0; c < measured.size(); ++c) {
        const double one = 1 / noise[c];
        const double value = measured[c].values[static_cast<std::size_t>(i)] * std::pow(dt, measured[c].rank);
        system.add(states * i + measured[c].rank - lowest, {&one, 1}, value * one);
      }
      if (i + 1 == rows) break;
      for (const VectorXd& row : steps) system.add(states * i, {row.data(), static_cast<std::size_t>(row.size())}, 0);
    }
    return system;
  }
  /// -2 log likelihood but for a constant; the first state has no prior.
  double deviance(double density) const {
    const BandedLeastSquares system = solved(density);
    return system.squares() + 2 * system.log_determinant() +
           static_cast<double>(states * (rows - 1)) * std::log(density);
  }
};

using Parts = std::span<const Problem>;

double deviance(Parts parts, double density) {
  double sum = 0;
  for (const Problem& part : parts) sum += part.deviance(density);
  return sum;
}

/// The most likely density: from what the highest differences of a channel would need downwards, decade by decade until
/// it has become worse three times, then golden sections.
double most_likely(Parts parts, double highest) {
  double best = highest, least = std::numeric_limits<double>::infinity();
  int worse = 0;
  for (double density = highest; worse < 4 && density > 1e-40 * highest; density /= 10) {
    const double value = deviance(parts, density);
    worse = value < least ? 0 : worse + 1;
    if (value < least) best = density, least = value;
  }
  return minimise_over_scale(best / 10, best * 10, 10, [&](double density) { return deviance(parts, density); });
}

double highest_density(Parts parts) {
  double highest = 0;
  for (const Problem& problem : parts)
    for (const Measurement& m : problem.measured) {
      VectorXd d = Eigen::Map<const VectorXd>(m.values.data(), problem.rows) * std::pow(problem.dt, m.rank);
      for (int k = m.rank; k < problem.lowest + problem.states; ++k)
        d = (d.tail(d.size() - 1) - d.head(d.size() - 1)).eval();
      highest = std::max(highest, d.squaredNorm() / static_cast<double>(d.size()));
    }
  return 100 * highest;
}

Problem problem_of(const std::vector<Measurement>& measurements, double dt, int order) {
  const auto fail = [](const std::string& text) { refuse("kalman", text); };
  if (measurements.empty()) fail("expected at least one measured channel");
  Problem problem{measurements, {}, 2, order, static_cast<Index>(measurements[0].values.size()), dt};
  for (const Measurement& m : measurements) {
    problem.lowest = std::min(problem.lowest, m.rank);
    if (static_cast<Index>(m.values.size()) != problem.rows) fail("expected channels of one length");
    const Eigen::Map<const VectorXd> values(m.values.data(), problem.rows);
    // Noise of zero would ask for equations instead of weights.
    const double least = 1e-7 * std::sqrt((values.array() - values.mean()).square().mean());
    problem.noise.push_back(std::max(m.noise, least > 0 ? least : 1.0) * std::pow(dt, m.rank));
  }
  problem.states = order - problem.lowest;
  if (problem.rows < 6) fail("expected at least 6 rows, got " + std::to_string(problem.rows));
  return problem;
}

}  // namespace

double chosen_density(const KalmanSmoother& given, std::span<const std::vector<Measurement>> parts, double dt) {
  if (given.order < 3 || given.order > 6)
    refuse("kalman", "order: expected 3 to 6, got " + std::to_string(given.order));
  if (given.density > 0) return given.density;
  std::vector<Problem> problems;
  for (const auto& part : parts) problems.push_back(problem_of(part, dt, given.order));
  const double highest = highest_density(problems);
  return (highest > 0 ? most_likely(problems, highest) : 1) * density_unit(given.order, dt);
}

SmoothedMotion kalman_smoother(const std::vector<Measurement>& measurements, double dt, const KalmanSmoother& options) {
  const double unit = density_unit(options.order, dt), density = chosen_density(options, {&measurements, 1}, dt) / unit;
  const Problem problem = problem_of(measurements, dt, options.order);
  const BandedLeastSquares system = problem.solved(density);
  const VectorXd solution = system.solve();
  const VectorXd variance = system.inverse_band().row(0);
  SmoothedMotion motion;
  motion.lowest = problem.lowest;
  motion.density = density * unit;
  motion.log_likelihood = -0.5 * problem.deviance(density);
  const int ranks = 3 - problem.lowest;
  motion.values.resize(problem.rows, ranks);
  motion.std.resize(problem.rows, ranks);
  for (int k = 0; k < ranks; ++k) {
    const double scale = std::pow(dt, problem.lowest + k);
    for (Index i = 0; i < problem.rows; ++i) {
      motion.values(i, k) = solution[problem.states * i + k] / scale;
      motion.std(i, k) = std::sqrt(std::max(0.0, variance[problem.states * i + k])) / scale;
    }
  }
  return motion;
}

std::string kalman_words(const KalmanSmoother& method, const SmoothedMotion& motion) {
  static constexpr const char* white[] = {"jerk", "snap", "crackle", "pop"};
  return std::string("Kalman smoother, white ") + white[method.order - 3] + " of density " +
         short_number(motion.density);
}

Derivative differentiate_by(const KalmanSmoother& method, std::span<const double> x, double dt, double noise,
                            int derivative) {
  const SmoothedMotion motion = kalman_smoother({{0, x, noise}}, dt, method);
  const VectorXd std = motion.std.col(derivative);
  return {motion.values.col(derivative), std::sqrt(std.squaredNorm() / static_cast<double>(std.size())),
          kalman_words(method, motion)};
}

}  // namespace lunid
