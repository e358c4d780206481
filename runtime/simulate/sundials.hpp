#pragma once
// A run by SUNDIALS that can be taken up again. Internal to this room.
#include <limits>
#include <memory>

#include "simulate/fixed.hpp"
#include "simulate/simulate.hpp"

namespace lunid {

class SundialsRun {
 public:
  /// `options.solver` is one of SUNDIALS' own; `sensitivities` only with CVODES' methods (is_multistep). The system,
  /// theta, the excitation and the sink, which receives the rows, must outlive it.
  SundialsRun(const System& system, std::span<const double> theta, const Excitations& excitation,
              const Eigen::VectorXd& x0, const SimulateOptions& options, RowSink& sink, bool sensitivities);
  ~SundialsRun();

  /// Goes on to the end, or to the sample at which it has spent this much. True at its end: completed or stopped.
  /// Throws InputError(Fault::interrupted) when cancelled, and what a force throws.
  bool go(double budget = std::numeric_limits<double>::infinity());
  /// What it has cost so far, after go(), in evaluations of the rate by the fixed path.
  double spent() const;
  RunSummary summary() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lunid
