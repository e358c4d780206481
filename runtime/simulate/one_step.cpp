#include "simulate/one_step.hpp"

#include <cmath>

#include "simulate/simulate.hpp"

namespace lunid {

OneStep predict_one_step(const System& system, std::span<const double> theta, const Record& record,
                         const Excitations& excitation, const std::atomic<bool>* cancelled) {
  if (!system.model().states.empty())
    throw InputError("one-step prediction: the state '" + system.model().states[0].symbol.name() + "' is not measured");
  SimulateOptions options;
  options.solver = Solver::fixed;
  options.substeps = 4;
  options.cancelled = cancelled;
  OneStep out;
  out.y = out.v = Eigen::VectorXd::Constant(record.rows(), std::nan(""));
  for (Eigen::Index row = 0; row + 1 < record.rows(); ++row) {
    const Run run =
        simulate(system, theta, excitation.part(row, 2), measured_state(system, theta, record, row), options);
    out.y[row + 1] = shown(system, theta, run, "y")[1];
    out.v[row + 1] = shown(system, theta, run, "v")[1];
  }
  return out;
}

}  // namespace lunid
