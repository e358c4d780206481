// The end of a run by the user's own condition.
#include <cmath>

#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::Index;

/// Each look at an interval divides it so; looks until the place is known to a part of 1e-7 of a sample.
constexpr int parts = 64, looks = 4;

/// The condition along rows of a run.
class Condition {
 public:
  Condition(const System& system, std::span<const double> theta, Expr g)
      : d_(system.dynamics()), tape_(make(system, g)), in_(d_.inputs(), 0.0), scratch_(tape_.registers() + 1) {
    std::copy(theta.begin(), theta.end(), in_.end() - static_cast<std::ptrdiff_t>(theta.size()));
  }

  /// The first row at which it holds; -1: none does.
  Index first(const Run& run, const Excitations& excitation) {
    for (Index row = 0; row < run.x.rows(); ++row) {
      if (!run.x.row(row).allFinite()) return -1;
      in_[0] = run.t0 + run.dt * static_cast<double>(row);
      for (int i = 0; i < d_.exogenous; ++i) in_[1 + i] = excitation[i].at(in_[0]);
      for (int i = 0; i < d_.n; ++i) in_[1 + d_.exogenous + i] = run.x(row, i);
      double value = 0;
      tape_.run_point(in_.data(), &value, scratch_.data());
      if (value > 0) return row;
    }
    return -1;
  }

 private:
  static Tape make(const System& system, Expr g) {
    Pool& pool = *system.model().pool;
    std::vector<Expr> inputs{pool.channel("t")};
    for (const Expr& input : system.equations().exogenous) inputs.push_back(input);
    for (const Expr& state : system.equations().states) inputs.push_back(state);
    for (const Parameter& p : system.model().parameters) inputs.push_back(pool.parameter(p.name));
    try {
      return Tape(std::span(&g, 1), inputs);
    } catch (const InputError& error) {
      throw InputError("simulate: stop_when: " + error.message());
    }
  }

  const Dynamics& d_;
  Tape tape_;
  std::vector<double> in_, scratch_;
};

/// The same signals on a finer base within one interval.
Excitations within(const Excitations& excitation, double from, double dt) {
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

}  // namespace

void stop_where(const System& system, std::span<const double> theta, const Excitations& excitation,
                const SimulateOptions& options, Run& run) {
  Condition condition(system, theta, options.stop_when);
  const Index row = condition.first(run, excitation);
  if (row < 0) return;
  RunSummary& summary = run.summary;
  summary.completed = true;  // what came after the end does not count
  summary.cause.clear();
  summary.ended_at = run.t0 + run.dt * static_cast<double>(row);
  summary.ended_in = run.x.row(row).transpose();
  if (row > 0) {
    double from = summary.ended_at - run.dt, dt = run.dt;
    Eigen::VectorXd x = run.x.row(row - 1).transpose();
    for (int look = 0; look < looks; ++look) {
      dt /= parts;
      const Excitations fine = within(excitation, from, dt);
      const Run close = run_free(system, theta, fine, x, 1, options);
      const Index at = condition.first(close, fine);
      if (at < 1) break;
      from += dt * static_cast<double>(at - 1);
      x = close.x.row(at - 1).transpose();
      summary.ended_at = from + dt;
      summary.ended_in = close.x.row(at).transpose();
    }
  }
  const Index rest = run.x.rows() - row;
  run.x.bottomRows(rest).setConstant(std::numeric_limits<double>::quiet_NaN());
  run.a.bottomRows(rest).setConstant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace lunid
