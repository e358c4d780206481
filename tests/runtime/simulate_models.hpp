#pragma once
// What the simulation tests share: models from text, excitations, finite differences.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "simulate/simulate.hpp"

namespace lunid::testing {

struct StateText {
  std::string name, rate, min{}, max{};
  double initial = 0;
};

/// A model from the plain form of its expressions.
inline Model model_of(const std::string& mass, const std::string& restoring, const std::vector<StateText>& states = {},
                      bool imposed = false) {
  Model model;
  model.pool = std::make_shared<Pool>();
  for (const StateText& z : states) model.pool->state(z.name);
  model.mass = parse(*model.pool, mass);
  model.restoring = parse(*model.pool, restoring);
  for (const StateText& z : states) {
    InternalState state;
    state.symbol = model.pool->state(z.name);
    state.rate = parse(*model.pool, z.rate);
    state.initial = z.initial;
    if (!z.min.empty()) state.min = parse(*model.pool, z.min);
    if (!z.max.empty()) state.max = parse(*model.pool, z.max);
    model.states.push_back(state);
  }
  model.imposed_motion = imposed;
  return model;
}

/// A model of several coordinates: (mass, restoring) of each.
inline Model model_of_many(const std::vector<std::pair<std::string, std::string>>& rows,
                           const std::vector<StateText>& states = {}) {
  Model model = model_of(rows[0].first, rows[0].second, states);
  for (std::size_t i = 1; i < rows.size(); ++i)
    model.further.push_back({parse(*model.pool, rows[i].first), parse(*model.pool, rows[i].second)});
  return model;
}

/// theta in the order of the model's table from name = value pairs.
inline std::vector<double> theta_of(const System& system, const std::vector<std::pair<std::string, double>>& values) {
  std::vector<double> theta(system.parameters(), std::nan(""));
  for (const auto& [name, value] : values)
    for (int i = 0; i < system.parameters(); ++i)
      if (system.model().parameters[i].name == name) theta[i] = value;
  return theta;
}

inline Eigen::VectorXd state(std::initializer_list<double> values) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) x[i++] = value;
  return x;
}

inline Excitation zero_force(double duration, double dt) {
  const std::vector<double> force(static_cast<std::size_t>(std::lround(duration / dt)) + 1, 0.0);
  return Excitation(0, dt, force);
}

inline Excitation force_of(double duration, double dt, std::function<double(double)> f) {
  return Excitation(0, dt, std::lround(duration / dt) + 1, std::move(f));
}

inline SimulateOptions with_substeps(int substeps) {
  SimulateOptions options;
  options.solver = Solver::fixed;
  options.substeps = substeps;
  return options;
}

inline SimulateOptions with_solver(Solver solver, double rtol = 1e-8) {
  SimulateOptions options;
  options.solver = solver;
  options.rtol = rtol;
  return options;
}

/// The message of the InputError that `f` throws, or "" when it throws none.
inline std::string fault_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const InputError& error) {
    return error.message();
  }
  return "";
}

}  // namespace lunid::testing
