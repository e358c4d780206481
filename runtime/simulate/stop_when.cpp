// The end of a run by the user's own condition.
#include <cmath>

#include "simulate/run.hpp"

namespace lunid {
namespace {

using Eigen::Index;

/// Each look at an interval divides it so; looks until the place is known to a part of 1e-7 of a sample.
constexpr int parts = 64, looks = 4;
/// Places at which the condition is looked at from a row to the next.
constexpr int looks_between = 4;

/// The condition along rows of a run.
class Condition {
 public:
  Condition(const System& system, std::span<const double> theta, Expr g)
      : d_(system.dynamics()), tape_(make(system, g)), in_(d_.inputs(), 0.0), scratch_(tape_.registers() + 1) {
    std::copy(theta.begin(), theta.end(), in_.end() - static_cast<std::ptrdiff_t>(theta.size()));
  }

  bool holds(double t, const Eigen::VectorXd& x, const Excitations& excitation) {
    in_[0] = t;
    for (int i = 0; i < d_.exogenous; ++i) in_[1 + i] = excitation[i].at(t);
    std::copy(x.begin(), x.end(), in_.begin() + 1 + d_.exogenous);
    double value = 0;
    tape_.run_point(in_.data(), &value, scratch_.data());
    return value > 0;
  }
  bool holds_at(const Run& run, Index row, const Excitations& excitation) {
    return holds(run.t0 + run.dt * static_cast<double>(row), run.x.row(row).transpose(), excitation);
  }
  /// Between a row and the next, by what their states and speeds say of the states there: a first look.
  bool may_hold_after(const Run& run, Index row, const Excitations& excitation) {
    for (int look = 1; look < looks_between; ++look) {
      const double part = static_cast<double>(look) / looks_between;
      if (holds(run.t0 + run.dt * (static_cast<double>(row) + part), between(run, row, part), excitation)) return true;
    }
    return false;
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

  /// Cubics through displacements with their speeds and through speeds with their accelerations; else straight lines.
  static Eigen::VectorXd between(const Run& run, Index row, double s) {
    Eigen::VectorXd x = ((1 - s) * run.x.row(row) + s * run.x.row(row + 1)).transpose();
    const auto cubic = [&](Index state, double slope, double next_slope) {
      const double from = run.x(row, state), to = run.x(row + 1, state);
      x[state] = from + s * s * (3 - 2 * s) * (to - from) + s * (1 - s) * run.dt * ((1 - s) * slope - s * next_slope);
    };
    for (Index i = 0; i < run.a.cols(); ++i) {
      cubic(2 * i, run.x(row, 2 * i + 1), run.x(row + 1, 2 * i + 1));
      cubic(2 * i + 1, run.a(row, i), run.a(row + 1, i));
    }
    return x;
  }

  const Dynamics& d_;
  Tape tape_;
  std::vector<double> in_, scratch_;
};

/// Where it first holds between a row and the next, to a part of a sample; the run is made anew there.
class Search {
 public:
  Search(const System& system, std::span<const double> theta, const Excitations& excitation,
         const SimulateOptions& options, const Run& run)
      : system_(system),
        theta_(theta),
        excitation_(excitation),
        options_(options_between_rows(options, run)),
        run_(run) {
    if (options_.solver == Solver::fixed) options_.substeps = 1;
  }

  bool find(Condition& condition, Index row, RunSummary& summary) const {
    double from = run_.t0 + run_.dt * static_cast<double>(row), dt = run_.dt;
    Eigen::VectorXd x = run_.x.row(row).transpose();
    for (int look = 0; look < looks; ++look) {
      dt /= parts;
      const Excitations fine = within(excitation_, from, dt, parts);
      const Run close = run_prepared(system_, theta_, fine, x, options_);
      Index at = 1;
      while (at < close.x.rows() && close.x.row(at).allFinite() && !condition.holds_at(close, at, fine)) ++at;
      if (at == close.x.rows() || !close.x.row(at).allFinite()) return look > 0;
      from += dt * static_cast<double>(at - 1);
      x = close.x.row(at - 1).transpose();
      summary.ended_at = from + dt;
      summary.ended_in = close.x.row(at).transpose();
    }
    return true;
  }

 private:
  const System& system_;
  std::span<const double> theta_;
  const Excitations& excitation_;
  SimulateOptions options_;
  const Run& run_;
};

}  // namespace

void stop_where(const System& system, std::span<const double> theta, const Excitations& excitation,
                const SimulateOptions& options, Run& run) {
  Condition condition(system, theta, options.stop_when);
  const Search search(system, theta, excitation, options, run);
  RunSummary& summary = run.summary;
  for (Index row = 0; row < run.x.rows() && run.x.row(row).allFinite(); ++row) {
    const bool here = condition.holds_at(run, row, excitation);
    if (here) {
      summary.ended_at = run.t0 + run.dt * static_cast<double>(row);
      summary.ended_in = run.x.row(row).transpose();
    }
    const bool looked = row > 0 && (here || condition.may_hold_after(run, row - 1, excitation));
    const bool found = looked && search.find(condition, row - 1, summary);
    if (!here && !found) continue;
    summary.completed = true;  // what came after the end does not count
    summary.cause.clear();
    const Index rest = run.x.rows() - row;
    run.x.bottomRows(rest).setConstant(std::numeric_limits<double>::quiet_NaN());
    run.a.bottomRows(rest).setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
}

}  // namespace lunid
