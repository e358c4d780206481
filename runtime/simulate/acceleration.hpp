#pragma once
// Sensitivities of accelerations, which are no states.
#include "simulate/simulate.hpp"

namespace lunid {

/// The sensitivities of each coordinate's acceleration to theta and x0, rows x (p + n), of a run that kept those of all
/// states: the rate of those of its velocity, in the mode of the row. `excitation` as simulate_sensitivities had it. 0
/// where the motion sticks with no acceleration; NaN where it slides or is held otherwise, and where the run has none.
std::vector<Eigen::MatrixXd> acceleration_slopes(const System& system, std::span<const double> theta,
                                                 const Excitations& excitation, const SensitivityRun& run);

}  // namespace lunid
