#pragma once
// The work of one thread on the members of a bundle. Internal to this room.
#include "simulate/ensemble.hpp"
#include "simulate/step_tape.hpp"

namespace lunid {

/// The options of simulate() on one member.
SimulateOptions simulate_options(const EnsembleOptions& options);

/// Runs the members, side by side where the model allows it, into their places of the result. `step`: for smooth
/// systems, a substep as one tape, or null. Throws InputError(Fault::interrupted) when cancelled.
void run_job(const Ensemble& ensemble, const EnsembleOptions& options, const StepTape* step,
             std::span<const Eigen::Index> members, EnsembleResult& result);

}  // namespace lunid
