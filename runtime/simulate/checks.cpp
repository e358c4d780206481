#include <cmath>

#include "expr/digits.hpp"
#include "expr/joined.hpp"
#include "simulate/dormand_prince.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

std::string names_of(const System& system) { return joined(system.dynamics().names); }

std::string parameter_names(const System& system) {
  const std::string text = joined(system.model().parameters, &Parameter::name);
  return text.empty() ? "none" : text;
}

/// A step's error is a difference of numbers with this many roundings in them.
constexpr double least_rtol = 100 * std::numeric_limits<double>::epsilon();

void check_options(const std::string& caller, const SimulateOptions& o) {
  const auto refuse = [&](const std::string& what) { throw InputError(caller + ": " + what); };
  if (!(o.rtol > 0) || !(o.rtol < 1)) refuse("rtol: expected > 0 and < 1, got " + number(o.rtol));
  if (o.rtol < least_rtol)
    refuse("rtol: " + number(o.rtol) + " is below what rounding leaves; the least is " + number(least_rtol));
  if (!(o.atol >= 0)) refuse("atol: expected >= 0, got " + number(o.atol));
  if (o.substeps < 0) refuse("substeps: expected >= 0, got " + std::to_string(o.substeps));
  if (!(o.bound >= 0)) refuse("bound: expected >= 0, got " + number(o.bound));
  if (!(o.max_memory > 0)) refuse("max_memory: expected > 0, got " + number(o.max_memory));
  if (o.max_events < 1) refuse("max_events: expected >= 1, got " + std::to_string(o.max_events));
}

}  // namespace

std::string to_string(Solver solver) {
  switch (solver) {
    case Solver::automatic: return "auto";
    case Solver::fixed: return "fixed";
    case Solver::bdf: return "bdf";
    case Solver::adams: return "adams";
    case Solver::rk23: return "rk23";
    case Solver::rk45: return "rk45";
    case Solver::rk78: return "rk78";
    case Solver::esdirk: return "esdirk";
  }
  return "";
}

std::span<const Solver> all_solvers() {
  static constexpr Solver all[] = {Solver::automatic, Solver::fixed, Solver::bdf,  Solver::adams,
                                   Solver::rk23,      Solver::rk45,  Solver::rk78, Solver::esdirk};
  return all;
}

Solver solver_from(std::string_view name) {
  std::vector<std::string> choices;
  std::string words;
  for (const Solver s : all_solvers()) {
    if (to_string(s) == name) return s;
    choices.push_back(to_string(s));
    words += (words.empty() ? "" : s == Solver::esdirk ? " or " : ", ") + choices.back();
  }
  throw InputError("solver: expected " + words + ", got '" + std::string(name) + "'" +
                   did_you_mean(nearest_word(std::string(name), choices)));
}

void check_run(const char* caller, const System& system, std::span<const double> theta, const Excitations& excitation,
               const Eigen::VectorXd& x0, const SimulateOptions& options) {
  const std::string name = caller;
  if (system.model().imposed_motion)
    throw InputError(name + ": the motion of this model is imposed: there is no free run, only its force");
  if (static_cast<int>(theta.size()) != system.parameters())
    throw InputError(name + ": theta: expected " + std::to_string(system.parameters()) + " values (" +
                     parameter_names(system) + "), got " + std::to_string(theta.size()));
  for (std::size_t i = 0; i < theta.size(); ++i)
    if (!std::isfinite(theta[i]))
      throw InputError(name + ": parameter '" + system.model().parameters[i].name + "': expected a finite value, got " +
                       number(theta[i]));
  if (x0.size() != system.states())
    throw InputError(name + ": x0: expected " + std::to_string(system.states()) + " values (" + names_of(system) +
                     "), got " + std::to_string(x0.size()));
  for (Eigen::Index i = 0; i < x0.size(); ++i)
    if (!std::isfinite(x0[i]))
      throw InputError(name + ": x0: " + system.dynamics().names[i] + ": expected a finite value, got " +
                       number(x0[i]));
  if (excitation.empty() || excitation.rows() < 2) throw InputError(name + ": the excitation is empty");
  check_options(name, options);
  check_memory(name, excitation.rows(), run_values(system), options.max_memory);
}

int run_values(const System& system) {
  constexpr int coarse_and_fine = 3;  // substeps of the two grids of an input that every automatic run makes
  const int inputs = static_cast<int>(system.inputs().size());
  return 2 * (system.states() + system.degrees()) + inputs * (1 + coarse_and_fine * dormand_prince::nodes);
}

void check_memory(const std::string& caller, double rows, int values, double limit) {
  const double needed = rows * values * sizeof(double), giga = 1e9;
  if (needed <= limit) return;
  throw InputError(caller + ": " + number(rows) + " output points need " + number(needed / giga) +
                   " GB of memory, more than max_memory = " + number(limit / giga) +
                   " GB; take a longer dt or a shorter duration, or allow more");
}

Run empty_run(const System& system, const Excitations& excitation) {
  Run run;
  run.t0 = excitation.t0();
  run.dt = excitation.dt();
  run.x.setConstant(excitation.rows(), system.states(), std::numeric_limits<double>::quiet_NaN());
  run.a.setConstant(excitation.rows(), system.degrees(), std::numeric_limits<double>::quiet_NaN());
  return run;
}

double default_bound(const System& system, std::span<const double> theta, const Excitations& excitation,
                     const Eigen::VectorXd& x0) {
  const double time = excitation.dt() * static_cast<double>(excitation.rows() - 1);
  std::vector<InputRange> inputs;
  for (int i = 0; i < excitation.count(); ++i)
    inputs.push_back({excitation[i].at(excitation.t0()), excitation[i].peak()});
  return default_bound(system, theta, excitation.t0(), time, inputs, x0);
}

double default_bound(const System& system, std::span<const double> theta, double t0, double time,
                     std::span<const InputRange> inputs, const Eigen::VectorXd& x0) {
  const Dynamics& d = system.dynamics();
  std::vector<double> in(d.inputs(), 0.0), scratch(d.rate.registers() + 1);
  std::vector<double> here(d.rate.outputs()), rest = here, pushed = here;
  std::copy(theta.begin(), theta.end(), in.end() - d.p);
  const auto rates = [&](bool at_rest, auto input, std::vector<double>& out) {
    in[0] = t0;
    for (int i = 0; i < d.exogenous; ++i) in[1 + i] = input(inputs[static_cast<std::size_t>(i)]);
    for (int i = 0; i < d.n; ++i) in[1 + d.exogenous + i] = at_rest ? 0 : x0[i];
    d.rate.run_point(in.data(), out.data(), scratch.data());
  };
  rates(
      false, [](const InputRange& u) { return u.first; }, here);
  rates(
      true, [](const InputRange&) { return 0.0; }, rest);
  rates(
      true, [](const InputRange& u) { return u.peak; }, pushed);
  double scale = 0;
  for (int i = 0; i < d.degrees; ++i) {
    const int v = 2 * i + 1;
    const double reach = std::max(std::abs(here[v]), std::abs(pushed[v] - rest[v]));
    scale = std::max(scale, std::abs(x0[v - 1]) + std::abs(x0[v]) * time + 0.5 * reach * time * time);
  }
  return std::isfinite(scale) && scale > 0 ? 1e6 * scale : 0;
}

}  // namespace lunid
