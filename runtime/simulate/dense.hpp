#pragma once
// A run between its rows, and runs on other rows than those of their record.
#include <span>

#include "simulate/simulate.hpp"

namespace lunid {

/// The same signals on a time base `parts` times finer, parts >= 1: what they do between the samples stays.
Excitations finer(const Excitations& excitation, int parts);

/// A run from the row before `t` up to t, which its last row is, by the method of the whole run; `excitation` and
/// `options` as simulate() had them. Within rounding of a row it is that row alone. Throws InputError when t is not
/// within the rows that the run has.
Run run_up_to(const System& system, std::span<const double> theta, const Excitations& excitation,
              const SimulateOptions& options, const Run& run, double t);

}  // namespace lunid
