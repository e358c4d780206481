#include "simulate/gradient.hpp"

#include <algorithm>
#include <map>

#include "simulate/backward.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::VectorXd;

/// A symbol for lambda of a state; its name is none of the model's.
Expr lambda_symbol(Pool& pool, const std::string& state, const DynamicsSource& source) {
  const auto taken = [&](const std::string& name) {
    const auto same = [&](Expr symbol) { return symbol.name() == name; };
    return std::any_of(source.parameters.begin(), source.parameters.end(), same) ||
           std::any_of(source.states.begin(), source.states.end(), same);
  };
  std::string name = "adjoint_of_" + state;
  while (taken(name)) name += "_";
  return pool.parameter(name);
}

/// lambda' dx'/dx and lambda' dx'/dtheta: each a sum over the rates that hold the symbol.
Tape backward_tape(const DynamicsSource& source) {
  Pool& pool = source.rates[0].pool();
  std::vector<Expr> by = source.states, inputs{source.t}, lambda;
  by.insert(by.end(), source.parameters.begin(), source.parameters.end());
  std::map<std::uint32_t, std::size_t> place;
  for (std::size_t i = 0; i < by.size(); ++i) place.emplace(by[i].id(), i);
  std::vector<Expr> outputs(by.size(), pool.constant(0));
  for (std::size_t i = 0; i < source.rates.size(); ++i) {
    lambda.push_back(lambda_symbol(pool, source.states[i].name(), source));
    for (const Expr& symbol : symbols(source.rates[i])) {
      const auto at = place.find(symbol.id());
      if (at == place.end()) continue;
      const Expr slope = derivative(source.rates[i], symbol);
      if (slope.is_constant(0)) continue;
      Expr& sum = outputs[at->second];
      const Expr term = slope.is_constant(1) ? lambda[i] : lambda[i] * slope;
      sum = sum.is_constant(0) ? term : sum + term;
    }
  }
  inputs.insert(inputs.end(), source.exogenous.begin(), source.exogenous.end());
  inputs.insert(inputs.end(), by.begin(), by.end());
  inputs.insert(inputs.end(), lambda.begin(), lambda.end());
  return Tape(outputs, inputs);
}

/// Rows into a run and into the record of the motion.
struct RecordingSink : FreeSink {
  RecordingSink(Run& run, MotionRecord& motion) : FreeSink(run), motion(motion) {}
  void row(Eigen::Index row, const double* x, const double* f, const double* s) override {
    FreeSink::row(row, x, f, s);
    motion.row(row);
  }
  MotionRecord& motion;
};

}  // namespace

Adjoint::Adjoint(const System& system) : system_(system) {
  if (system.model().imposed_motion)
    throw InputError("gradient: the motion of this model is imposed: there is no free run");
  const Dynamics& d = system.dynamics();
  if (!d.smooth() && !d.dense())
    throw InputError("gradient: a model with switches or bounds: expected at most " +
                     std::to_string(Dynamics::dense_limit) + " states, got " + std::to_string(d.n));
  if (d.smooth()) tape_ = backward_tape(system.equations());
}

GradientRun Adjoint::run(std::span<const double> theta, const Excitations& given, const VectorXd& x0,
                         const SimulateOptions& options, const RowCost& cost) const {
  check_run("gradient", system_, theta, given, x0, options);
  if (options.solver != Solver::automatic && options.solver != Solver::fixed)
    throw InputError("gradient: solver: the adjoint is that of 'fixed', got '" + to_string(options.solver) + "'");
  const Excitations excitation = given.of(system_, theta);
  const Dynamics& d = system_.dynamics();
  GradientRun out;
  out.run = empty_run(system_, excitation);
  if (std::string fault = start_fault(system_, theta, excitation, x0); !fault.empty()) {
    out.run.summary.completed = false;
    out.run.summary.stopped_at = out.run.t0;
    out.run.summary.cause = std::move(fault);
    return out;
  }
  const int substeps =
      options.substeps > 0
          ? options.substeps
          : choose_by_halving(system_, theta, excitation, x0, default_tolerance, explicit_limit, options).substeps;
  FixedProblem problem = free_problem(system_, theta, excitation, x0, substeps, options);
  MotionRecord motion(d);
  RecordingSink sink(out.run, motion);
  if (!d.smooth()) problem.motion = &motion;
  summarise_fixed(out.run.summary, problem, run_fixed(problem, x0, sink), system_);
  if (!out.run.summary.completed) return out;
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(out.run.x.rows(), d.n);
  out.value = cost(out.run, slope);
  const Backward back = d.smooth() ? sweep_smooth(problem, tape_, out.run.x, slope) : motion.sweep(problem, slope);
  out.gradient.resize(d.p + d.n);
  out.gradient << back.by_theta, back.lambda;
  out.evaluations = back.evaluations;
  return out;
}

}  // namespace lunid
