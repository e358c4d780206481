#include "simulate/run.hpp"
namespace lunid {
Run run_sundials(const System& system, std::span<const double>, const Excitation& excitation, const Eigen::VectorXd&,
                 const SimulateOptions&) {
  Run run = empty_run(system, excitation);
  run.summary.completed = false;
  run.summary.cause = "the SUNDIALS path is not built";
  return run;
}
}
