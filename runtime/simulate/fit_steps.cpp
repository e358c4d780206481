#include "simulate/fit_steps.hpp"

#include <algorithm>
#include <cmath>

#include "record/spectrum.hpp"
#include "simulate/fit_problem.hpp"
#include "simulate/integrator.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

struct Piece {
  Eigen::Index first, rows;
};

/// The part of a motion that moves most (the beginning of a decay, a sweep's passage through resonance): what the
/// choice of a step is made on.
Piece liveliest(std::span<const double> motion) {
  const auto all = std::ssize(motion), rows = std::min<Eigen::Index>(all, 400);
  const auto step = [&](Eigen::Index i) {
    return std::pow(motion[static_cast<std::size_t>(i)] - motion[static_cast<std::size_t>(i - 1)], 2);
  };
  double moves = 0, most = -1;
  Eigen::Index first = 0;
  for (Eigen::Index i = 1; i < all; ++i) {
    moves += step(i);
    if (i >= rows) moves -= step(i - rows + 1);
    if (i + 1 < rows || !(moves > most)) continue;
    most = moves;
    first = i + 1 - rows;
  }
  return {first, rows};
}

/// Rows of a piece before a run leaves ten times what was measured: what a first guess does beyond is not the motion
/// that is fitted, and asks for other steps.
Eigen::Index rows_near(std::span<const double> measured, const Eigen::VectorXd& ran) {
  double most = 0;
  for (const double value : measured) most = std::max(most, std::abs(value));
  Eigen::Index row = 0;
  while (row < ran.size() && std::abs(ran[row]) < 10 * most) ++row;
  return row;
}

struct Steps {
  int substeps = 1;
  bool stiff = false;  ///< no explicit step is short enough
};

/// For one record, where it moves most.
Steps steps_for(const System& system, std::span<const double> theta, const FitData& data, const FitOptions& options) {
  constexpr Eigen::Index least = 20;
  const std::string channel = first_channel(system, data, options);
  const auto measured = data.record[channel];
  // A tenth of what the sensor's noise hides.
  const double tolerance = std::clamp(0.1 * data.record.channel(channel).noise / spread_of(measured), 1e-5, 1e-3);
  Piece piece = liveliest(measured);
  const Eigen::VectorXd x0 = measured_state(system, theta, data.record, piece.first);
  const auto part = [&] { return data.excitation.part(piece.first, piece.rows); };
  const auto choose = [&] { return choose_substeps(system, theta, part(), x0, tolerance); };
  if (const int substeps = choose(); substeps < explicit_limit) return {substeps, false};
  Run run = simulate(system, theta, part(), x0);
  const Eigen::Index near =
      rows_near(measured.subspan(static_cast<std::size_t>(piece.first)), shown(system, theta, run, channel));
  if (near >= least && near < piece.rows) {
    piece.rows = near;
    if (const int substeps = choose(); substeps < explicit_limit) return {substeps, false};
    run = simulate(system, theta, part(), x0);
  }
  return {explicit_limit, run.summary.solver.starts_with(sundials_name(Solver::bdf))};
}

/// For all records.
Steps steps_for(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                const FitOptions& options) {
  if (system.model().imposed_motion) return {4, false};
  Steps all;
  for (const auto& d : data) {
    const Steps own = steps_for(system, own_values(system, theta), d, options);
    all = {std::max(all.substeps, own.substeps), all.stiff || own.stiff};
  }
  return all;
}

}  // namespace

bool states_alone(const Model& model, const std::vector<FitData>& data, const FitOptions& options) {
  if (!model.measures.empty()) return false;
  for (const FitData& d : data)
    for (const Output& o : outputs_of(model, d.record, options.channels))
      if (state_of(model, o.channel) < 0) return false;
  return true;
}

std::string first_channel(const System& system, const FitData& data, const FitOptions& options) {
  return outputs_of(system.model(), data.record, options.channels)[0].channel;
}

FitOptions with_steps(const System& system, const Eigen::VectorXd& theta, const std::vector<FitData>& data,
                      FitOptions options) {
  const bool moves = !system.model().imposed_motion;
  Steps steps;
  if (options.substeps == 0) {
    steps = steps_for(system, theta, data, options);
    options.substeps = steps.substeps;
  }
  if (options.solver == Solver::automatic && moves) options.solver = steps.stiff ? Solver::bdf : Solver::fixed;
  if (options.gradient != Gradient::automatic) return options;
  const FitLayout layout(system.parameters(), static_cast<int>(data.size()), options.separate);
  const bool possible = options.solver == Solver::fixed && moves && options.whitening.average == 1 &&
                        options.whitening.ar.empty() && options.hold.empty() &&
                        states_alone(system.model(), data, options) &&
                        (system.dynamics().smooth() || system.dynamics().dense());
  const bool better = layout.size() >= adjoint_parameters || !system.dynamics().dense();
  options.gradient = possible && better ? Gradient::adjoint : Gradient::forward;
  return options;
}

double shortest_period(std::span<const double> motion) {
  const auto rows = static_cast<double>(motion.size());
  const auto period = [](std::span<const double> x) {
    const double omega = dominant_frequency(x, 1);
    return omega > 0 ? 2 * M_PI / omega : INFINITY;
  };
  const double whole = period(motion), spread = spread_of(motion);
  double shortest = std::min(whole, rows);
  const auto piece = static_cast<std::size_t>(std::max(16.0, 2 * shortest));
  for (std::size_t first = 0; first + piece <= motion.size(); first += piece) {
    const auto part = motion.subspan(first, piece);
    if (spread_of(part) > 0.5 * spread) shortest = std::min(shortest, period(part));
  }
  return shortest;
}

}  // namespace lunid
