#pragma once
// Members of an ensemble side by side: the fixed path of fixed.hpp on many members at once. Every lane gets the bits of
// run_fixed on it alone. Internal to this room.
#include <functional>
#include <vector>

#include "simulate/fixed.hpp"
#include "simulate/step_tape.hpp"
#include "simulate/time_tape.hpp"

namespace lunid {

/// Receives the rows of a bundle: value i of lane l at [i * width + l], width being the lanes in whole groups of
/// Tape::lane_group. `f` is x', but for
/// the rates of displacements, which are speeds and stand among the states.
struct LaneSink {
  virtual ~LaneSink() = default;
  virtual void row(Eigen::Index row, const double* x, const double* f) = 0;
};

/// Problems that share dynamics, rows, substeps and hold.
struct BundleProblem {
  std::span<const FixedProblem> lanes;
  std::span<const double* const> x0;  ///< the first state of each
  /// An excitation that is an expression of time, for all lanes at once, where a problem has no stage grid: its outputs
  /// are the exogenous inputs; `q` of each lane.
  const TimeTape* force = nullptr;
  std::span<const double* const> q;
  /// A substep as one tape, of this system and this force, where that is worthwhile; else null.
  const StepTape* step = nullptr;
  /// The bound of a lane, asked for where the motion passes the one that its problem gives. Empty: that one holds.
  std::function<double(int lane)> true_bound;
};

/// Lanes for this many members: whole groups.
inline int bundle_width(std::size_t members) {
  return (static_cast<int>(members) + Tape::lane_group - 1) / Tape::lane_group * Tape::lane_group;
}

/// Runs the bundle of a system without switches and bounds; outcomes[l] is that of lane l. Allocates nothing while it
/// steps. Throws InputError(Fault::interrupted) when cancelled.
void run_bundle(const BundleProblem& problem, LaneSink& sink, std::span<FixedOutcome> outcomes);
/// The same of a system with switches or bounds whose events a tape tells (StepTape::tells_events), with stage grids
/// that do not jump at the samples; `step` is there. Lanes with an event take that substep alone. Allocates there.
void run_switch_bundle(const BundleProblem& problem, LaneSink& sink, std::span<FixedOutcome> outcomes);

}  // namespace lunid
