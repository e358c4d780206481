#include "simulate/dense.hpp"

#include <cmath>

#include "expr/digits.hpp"
#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::Index;

/// Samples of the force between the row before and the time asked for.
constexpr int parts_between = 4;
/// A time nearer to a row than this part of a sample is the row.
constexpr double on_row = 1e-9;

}  // namespace

Excitations finer(const Excitations& excitation, int parts) {
  const double dt = excitation.dt() / parts;
  const Index rows = (excitation.rows() - 1) * parts + 1;
  Excitations fine;
  for (int i = 0; i < excitation.count(); ++i) {
    const Excitation& signal = excitation[i];
    const bool between =
        signal.interpolation() == Interpolation::hold || signal.interpolation() == Interpolation::linear;
    Eigen::VectorXd samples(rows);
    if (between) {
      const Eigen::VectorXd refined = signal.refined(parts);  // the middles of the parts, too
      for (Index row = 0; row < rows; ++row) samples[row] = refined[2 * row];
    }
    fine.add(excitation.channel(i),
             between ? Excitation(excitation.t0(), dt, {samples.data(), static_cast<std::size_t>(rows)},
                                  signal.interpolation())
                     : Excitation(excitation.t0(), dt, rows, [signal](double t) { return signal.at(t); }));
  }
  return fine;
}

Excitations within(const Excitations& excitation, double from, double dt, int parts) {
  Excitations fine;
  for (int i = 0; i < excitation.count(); ++i) {
    const Excitation& signal = excitation[i];
    const bool held = signal.interpolation() == Interpolation::hold;
    const double value = signal.at(from);
    fine.add(excitation.channel(i),
             Excitation(from, dt, parts + 1, [=](double t) { return held ? value : signal.at(t); }));
  }
  return fine;
}

SimulateOptions options_between_rows(const SimulateOptions& options, const Run& run) {
  SimulateOptions inner = options;
  inner.stop_when = {};
  inner.substeps = 0;
  if (options.solver == Solver::automatic)
    inner.solver = run.summary.solver.starts_with("fixed") ? Solver::fixed : Solver::bdf;
  return inner;
}

Run run_up_to(const System& system, std::span<const double> theta, const Excitations& given,
              const SimulateOptions& options, const Run& run, double t) {
  Index rows = 0;
  while (rows < run.x.rows() && run.x.row(rows).allFinite()) ++rows;
  const double last = run.t0 + run.dt * static_cast<double>(rows - 1), place = (t - run.t0) / run.dt;
  if (!(place >= -on_row) || !(place <= static_cast<double>(rows - 1) + on_row))
    throw InputError("at: t: expected within the run, " + number(run.t0) + " to " + number(last) + " s, got " +
                     number(t));
  const auto row = std::min(static_cast<Index>(place + on_row), rows - 1);
  const double from = run.t0 + run.dt * static_cast<double>(row);
  if (std::abs(place - static_cast<double>(row)) <= on_row) {
    Run there;
    there.t0 = from;
    there.x = run.x.row(row);
    there.a = run.a.row(row);
    return there;
  }
  const Excitations excitation = given.of(system, theta);
  const Excitations fine = within(excitation, from, (t - from) / parts_between, parts_between);
  return run_prepared(system, theta, fine, run.x.row(row).transpose(), options_between_rows(options, run));
}

}  // namespace lunid
